//! Benches on tiny pictures: the files are there, and each frame has been drawn.

use crate::Scratch;

fn report(scratch: &Scratch, args: &[&str]) -> serde_json::Value {
    let mut all = vec!["bench", "-o", "out", "--json", "--size", "24x16"];
    all.extend(args);
    let printed = scratch.run(&all).ok().json();
    let text = std::fs::read_to_string(scratch.path().join("out/bench.json")).unwrap();
    let file: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(file, printed);
    assert_eq!(file["is_complete"], true);
    file
}

fn page(scratch: &Scratch) -> String {
    std::fs::read_to_string(scratch.path().join("out/index.html")).unwrap()
}

#[test]
fn tables_have_rates_and_ratios_of_each_technique_and_stage() {
    let scratch = Scratch::new();
    let file = report(
        &scratch,
        &[
            "--tables",
            "--filter",
            "mip_samples",
            "--filter",
            "refraction",
            "--volume",
            "torus",
            "--frames",
            "3",
            "--seconds",
            "20",
        ],
    );
    let tables = file["tables"].as_array().unwrap();
    assert_eq!(tables.len(), 2);
    for table in tables {
        assert_eq!(table["volume"], "torus");
        for (row, stage) in table["rows"]
            .as_array()
            .unwrap()
            .iter()
            .zip(["fragment", "compute"])
        {
            assert_eq!(row["stage"], stage);
            assert!(row["refused"].is_null(), "{row}");
            assert!(
                row["fps"][0].as_f64().unwrap() > 0.0
                    && row["to_limit"]["median"].as_f64().unwrap() > 0.0
            );
            let degrees: Vec<f64> = row["frames"]
                .as_array()
                .unwrap()
                .iter()
                .map(|frame| frame["degrees"].as_f64().unwrap())
                .collect();
            assert!(
                [0.0, 240.0, 120.0].starts_with(&degrees) && !degrees.is_empty(),
                "{degrees:?}"
            );
        }
    }
    let page = page(&scratch);
    assert!(
        page.contains("mip_samples")
            && page.contains("continuous refraction")
            && !page.contains("Not all of it")
    );
}

#[test]
fn growth_has_an_exponent_for_each_axis_and_a_start_has_its_times() {
    let scratch = Scratch::new();
    let file = report(
        &scratch,
        &[
            "--growth",
            "--start-up",
            "--filter",
            "mip_samples",
            "--largest-view",
            "256",
            "--largest-volume",
            "128",
            "--frames",
            "1",
            "--seconds",
            "1",
        ],
    );
    let curves = file["growth"].as_array().unwrap();
    let axes: Vec<&str> = curves
        .iter()
        .map(|curve| curve["axis"].as_str().unwrap())
        .collect();
    assert_eq!(
        axes,
        [
            "pixels",
            "steps",
            "voxels_dense",
            "voxels_sparse",
            "occupied"
        ]
    );
    for curve in curves {
        assert!(
            curve["fit"]["exponent"].is_f64() && curve["refused"].as_array().unwrap().is_empty(),
            "{curve}"
        );
    }
    let start = &file["start_up"][0];
    assert!(
        start["cold_ms"].as_f64().unwrap() > 0.0 && start["device_bytes"].as_u64().unwrap() > 0,
        "{start}"
    );
    assert!(page(&scratch).contains("<svg"));
}

#[test]
fn one_graph_is_timed_beside_its_limit() {
    let scratch = Scratch::new();
    let json = scratch
        .run(&["bench", "mip", "--size", "24x16", "--frames", "2", "--json"])
        .ok()
        .json();
    assert_eq!(json["frame_ms"]["all"].as_array().unwrap().len(), 2);
    assert!(
        json["limit"]["ratio"]["median"].as_f64().unwrap() > 0.0
            && json["device_bytes"].as_u64().unwrap() > 0
    );
    let json = scratch
        .run(&[
            "bench",
            "mip",
            "--size",
            "24x16",
            "--frames",
            "1",
            "--no-limit",
            "--json",
        ])
        .ok()
        .json();
    assert!(json["limit"].is_null());
}

#[test]
fn what_cannot_be_benched_is_told() {
    let scratch = Scratch::new();
    for (args, words) in [
        (
            vec!["bench", "mip", "quickstart"],
            "one graph is timed at a time",
        ),
        (
            vec!["bench", "--tables", "-o", "out", "--filter", "nothing"],
            "--list",
        ),
        (
            vec![
                "bench",
                "--tables",
                "-o",
                "out",
                "--volume",
                "nothing_8x8x8_uint8.raw",
            ],
            "nothing_8x8x8_uint8.raw",
        ),
        (
            vec!["bench", "--peers", ".", "-o", "out", "--filter", "nobody"],
            "`vispy-egl/mip/1/c60`",
        ),
        (vec!["bench", "--tables"], "--output"),
        (vec!["bench"], "GRAPH"),
    ] {
        let run = scratch.run(&args);
        assert!(
            run.code != Some(0) && run.stderr.contains(words),
            "{args:?}: {run:?}"
        );
    }
}
