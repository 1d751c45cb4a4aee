//! Which stage is faster is measured once on a machine: what is kept of it comes back, and what is no longer whole does not.

use std::collections::BTreeMap;
use std::fs;

use volgraph::SessionOptions;
use volgraph_tests::{Stage, adapters, gpu_alone, graph, options};

#[test]
fn a_choice_of_the_stage_is_kept_and_made_again_where_its_file_is_broken() {
    let stage = Stage::new()
        .with_floats("v", [8, 8, 8], |x, y, z| (x * y + z) as f32)
        .with("transfer.ron", "(points: [(at: 0, color: (0, 0, 1), opacity: 0), (at: 1, color: (1, 0, 0), opacity: 0.5)])")
        .with(
            "graph.ron",
            graph(
                r#"path: "v_8x8x8_float32.raw""#,
                "orbit(azimuth: 10, elevation: 10)",
                r#"{ "pattern": "checker" }"#,
                "{}",
                r#"{ "stage": "auto" }"#,
            ),
        );
    for backend in adapters() {
        let cache = stage.path().join(format!("cache of {backend}"));
        let gpu = gpu_alone(&backend);
        let measured = || -> (BTreeMap<String, f64>, usize) {
            let options = SessionOptions {
                cache: Some(cache.clone()),
                ..options(&[], &backend, [32, 32])
            };
            let registry = volgraph::registry();
            let mut session = stage
                .open_with("graph.ron", &options, registry, gpu.clone())
                .unwrap();
            let report = session.draw().unwrap();
            let image = report
                .nodes
                .iter()
                .find(|node| node.name == "image")
                .unwrap();
            (image.measured_ms.clone(), report.pipelines)
        };
        let (first, pipelines) = measured();
        assert_eq!(first.len(), 2, "{backend}: fragment and compute");
        // Times are never the same twice: the same ones were not measured again.
        assert_eq!(measured(), (first.clone(), pipelines), "{backend}");
        let files: Vec<_> = fs::read_dir(cache.join("device"))
            .unwrap()
            .flatten()
            .collect();
        assert_eq!(files.len(), 1, "{backend}");
        let mut bytes = fs::read(files[0].path()).unwrap();
        *bytes.last_mut().unwrap() ^= 1;
        for broken in [&bytes[..], &bytes[..40], &[]] {
            fs::write(files[0].path(), broken).unwrap();
            let (again, _) = measured();
            assert_ne!(again, first, "{backend}: a broken file is none");
            assert_eq!(measured().0, again, "{backend}: it was written over");
        }
    }
}
