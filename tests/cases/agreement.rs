//! Fragment and compute run the same walk: they agree on every ready graph, on every backend, and draw something.

use volgraph::{Findings, ParamOverride, Picture, Scene};
use volgraph_measure::compare_without_flip;
use volgraph_tests::repository::{
    COMPARISONS, PARTS_AND_PROJECTIONS, SOLIDS, VOLUMES, graph_file, scans,
};
use volgraph_tests::{STAGES, adapters, load, start};

/// Odd, so that workgroups of the compute stage reach over the edges.
const SIZE: [u32; 2] = [49, 41];

fn render(scene: &Scene, backend: &str, form: &str) -> Result<Picture, Findings> {
    let form = ParamOverride::parse(&format!("image.stage={form}")).unwrap();
    let scene = scene.with_sets(&[form])?;
    Ok(start(scene, backend, SIZE)?.render()?.0)
}

/// What is wrong with a graph; nothing where both forms agree.
fn disagreement(name: &str, scene: &Scene) -> Vec<String> {
    let mut wrong = Vec::new();
    for backend in adapters() {
        let drawn = STAGES.map(|form| {
            render(scene, &backend, form)
                .unwrap_or_else(|findings| panic!("{name} on {backend}: {findings}"))
        });
        let [fragment, compute] = &drawn;
        let comparison = compare_without_flip(fragment, compute).unwrap();
        if comparison.max.error > 1e-5 {
            wrong.push(format!("{name} on {backend}: {:?}", comparison.max));
        }
        if fragment
            .color
            .iter()
            .all(|color| color == &fragment.color[0])
        {
            wrong.push(format!("{name} on {backend} is empty"));
        }
    }
    wrong
}

fn agree(names: &[&str]) {
    let wrong = names.iter().flat_map(|name| {
        // These need no file from outside.
        let scene = load(&graph_file(name), &[]).unwrap_or_else(|findings| panic!("{findings}"));
        disagreement(name, &scene)
    });
    let wrong: Vec<String> = wrong.collect();
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn fragment_and_compute_agree_on_solids() {
    agree(SOLIDS);
}

#[test]
fn fragment_and_compute_agree_on_volumes() {
    agree(VOLUMES);
}

#[test]
fn fragment_and_compute_agree_on_parts_and_projections() {
    agree(PARTS_AND_PROJECTIONS);
}

#[test]
fn fragment_and_compute_agree_on_comparisons() {
    agree(COMPARISONS);
}

#[test]
fn fragment_and_compute_agree_on_scans_that_are_here() {
    let (mut wrong, mut absent) = (Vec::new(), Vec::new());
    for name in scans() {
        match load(&graph_file(&name), &[]) {
            Ok(scene) => wrong.extend(disagreement(&name, &scene)),
            Err(findings) => {
                // Only the absence of a volume that may not lie in the repository is no failure.
                let mut codes = findings.clone().into_iter().map(|finding| finding.code);
                assert!(
                    codes.all(|code| code == "data-missing"),
                    "{name}: {findings}"
                );
                absent.push(name);
            }
        }
    }
    if !absent.is_empty() {
        println!(
            "not compared, for their volumes are not here (set VOLGRAPH_DATA): {}",
            absent.join(", ")
        );
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}
