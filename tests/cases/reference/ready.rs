//! All ready graphs: the reference covers each, and fine steps agree with it, or refuses it by name.

use volgraph::ready_graphs;
use volgraph_tests::truth::truth_of;
use volgraph_tests::{adapters, open, root};

const SIZE: [u32; 2] = [48, 48];

/// What the reference does not compute yet.
const REFUSED: [&str; 12] = [
    "adaptive",
    "difference",
    "environment",
    "error",
    "fetch_only",
    "matcap",
    "multivolume",
    "refraction",
    "refraction_surface",
    "samples",
    "translucency",
    "volume_shadow",
];

/// Root mean square error at an eighth of a voxel: what the tables, half floats and early termination leave.
const BOUND: f64 = 2e-3;

#[test]
fn ready_graphs_agree_with_it_or_are_refused_by_name() {
    let backend = &adapters()[0];
    let mut refused = Vec::new();
    let mut wrong = Vec::new();
    // Scans need files from outside.
    let folder = root().join("graphs");
    let ready = ready_graphs();
    let graphs = ready
        .iter()
        .filter(|graph| folder.join(format!("{}.ron", graph.name)).is_file());
    for graph in graphs {
        let path = folder.join(format!("{}.ron", graph.name));
        let sets: &[&str] = match graph.name.as_str() {
            // The naive clip is wrong on purpose, at any step.
            "clip_naive" => &["image.step=0.125", "image.clip_method=accurate"],
            // Half floats round each slab.
            "slices" => &["image.step=0.125", "image.format=rgba32float"],
            // Its shells are the thinnest, and of one value each.
            "multipass" => &["image.step=0.0625"],
            // It has no step; the outline of the box is soft by a pixel of its intermediate image.
            "shear_warp" => &["image.scale=8", "image.slices_per_voxel=8"],
            _ => &["image.step=0.125"],
        };
        let truth = match truth_of(&path, sets, SIZE, 1e-9) {
            Ok((truth, _)) => truth,
            Err(findings) => {
                let codes: Vec<_> = findings.into_iter().map(|finding| finding.code).collect();
                assert_eq!(codes, ["not-covered"], "{}", graph.name);
                refused.push(graph.name.clone());
                continue;
            }
        };
        let mut session = open(&path, sets, backend, SIZE).unwrap();
        let (picture, _) = session.render().unwrap();
        let comparison = truth.compare(&picture).unwrap();
        let bound = truth.rendered.error.iter().copied().fold(0.0, f64::max);
        assert!(bound < 1e-7, "{}: {bound:e}", graph.name);
        let line = format!(
            "{}: rmse {:.1e}, largest {:.1e}",
            graph.name, comparison.rmse, comparison.max.error
        );
        // A picture of nothing agrees with everything.
        let colors = &truth.rendered.color;
        assert!(colors.iter().any(|pixel| pixel != &colors[0]), "{line}");
        if comparison.rmse > BOUND {
            wrong.push(line.clone());
        }
        lines_to_stderr(&line);
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
    assert_eq!(refused, REFUSED);
}

/// For those who run the test by hand.
fn lines_to_stderr(line: &str) {
    use std::io::Write;
    let _ = writeln!(std::io::stderr(), "{line}");
}
