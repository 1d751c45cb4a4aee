//! Fragment and compute run the same walk: they agree on every ready graph, on every backend.

use std::path::PathBuf;

use volgraph_measure::compare_without_flip;
use volgraph_tests::{adapters, open, root};

fn ready_graphs() -> Vec<PathBuf> {
    let mut graphs: Vec<PathBuf> = ["graphs", "graphs/scans"]
        .iter()
        .flat_map(|folder| std::fs::read_dir(root().join(folder)).unwrap())
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "ron"))
        .collect();
    graphs.sort();
    graphs
}

#[test]
fn fragment_and_compute_agree_on_every_ready_graph() {
    let (mut compared, mut absent) = (0, Vec::new());
    for graph in ready_graphs() {
        for backend in adapters() {
            let render = |form: &str| {
                let set = format!("image.stage={form}");
                open(&graph, &[&set], &backend, [96, 80]).and_then(|mut session| session.render())
            };
            let (fragment, compute) = match (render("fragment"), render("compute")) {
                (Ok((fragment, _)), Ok((compute, _))) => (fragment, compute),
                (Err(findings), _) | (_, Err(findings)) => {
                    // Only the absence of a volume that may not lie in the repository is no failure.
                    let is_absent = findings
                        .into_iter()
                        .all(|finding| finding.code == "data-missing");
                    assert!(
                        is_absent,
                        "{} on {backend} cannot be rendered",
                        graph.display()
                    );
                    absent.push(graph.display().to_string());
                    continue;
                }
            };
            let comparison = compare_without_flip(&fragment, &compute).unwrap();
            assert!(
                comparison.max.error <= 1e-5,
                "{} on {backend}: {:?}",
                graph.display(),
                comparison.max
            );
            compared += 1;
        }
    }
    absent.dedup();
    if !absent.is_empty() {
        println!(
            "not compared, for their volumes are not here (set VOLGRAPH_DATA): {}",
            absent.join(", ")
        );
    }
    assert!(compared >= 2, "no ready graph was compared");
}
