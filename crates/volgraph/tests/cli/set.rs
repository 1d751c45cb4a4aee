//! Graphs that are changed in their files, and volumes that stand in a graph's place.

use std::fs;

use crate::{SPHERE, Scratch, TRANSFER, graph};

#[test]
fn a_change_is_written_where_its_value_stands() {
    let scratch = Scratch::new();
    scratch.write("t.ron", TRANSFER);
    let text = format!("// mine\n{}", graph(SPHERE));
    let file = scratch.write("g.ron", &text);
    let wanted = text.replace("(8, 8, 8)", "(9.0, 8.0, 8.0)").replace(
        "\"box\" }),\n    }",
        "\"box\" }, params: { \"step\": 0.25 }),\n    }",
    );
    assert_ne!(text, wanted);
    let args = ["set", "g.ron", "image.step=0.25", "v.dims=(9, 8, 8)"];
    let dry = scratch.run(&[&args[..], &["--dry-run"]].concat());
    assert_eq!(dry.code, Some(0), "{dry:?}");
    assert!(
        dry.stdout
            .contains("+        \"v\": analytic(field: \"sphere\", dims: (9.0,"),
        "{dry:?}"
    );
    assert_eq!(fs::read_to_string(&file).unwrap(), text);
    let run = scratch.run(&args);
    assert_eq!(run.code, Some(0), "{run:?}");
    assert_eq!(fs::read_to_string(&file).unwrap(), wanted);
    // What would make it wrong leaves it.
    for (bad, code) in [
        ("image.stepp=1", "unknown-param"),
        ("no.step=1", "unknown-node"),
        ("image.renderer=software", "bad-edit"),
    ] {
        let run = scratch.run(&["set", "g.ron", bad]);
        assert_eq!(run.code, Some(1), "{run:?}");
        assert!(run.stderr.contains(code), "{run:?}");
        assert_eq!(fs::read_to_string(&file).unwrap(), wanted);
    }
    let out = scratch.run(&["set", "g.ron", "--unset", "image.step", "-o", "sub.ron"]);
    assert_eq!(out.code, Some(0), "{out:?}");
    assert!(
        !fs::read_to_string(scratch.path().join("sub.ron"))
            .unwrap()
            .contains("0.25")
    );
    assert_eq!(fs::read_to_string(&file).unwrap(), wanted);
}

#[test]
fn a_ready_graph_is_no_file() {
    let scratch = Scratch::new();
    let run = scratch.run(&["set", "quickstart", "image.step=2"]);
    assert_eq!(run.code, Some(1));
    assert!(
        run.stderr.contains("-o FILE.ron")
            && run.stderr.contains("volgraph graphs quickstart --write"),
        "{run:?}"
    );
    let run = scratch.run(&["set", "quickstart", "image.step=2", "-o", "q.ron"]);
    assert_eq!(run.code, Some(0), "{run:?}");
    assert_eq!(scratch.run(&["check", "q.ron"]).code, Some(0));
}

#[test]
fn a_volume_stands_in_a_graphs_place() {
    let scratch = Scratch::new();
    // A ramp with a heap in the middle: whole numbers without a unit.
    let voxel = |i: u32| match (i % 8, i / 8 % 8, i / 64) {
        (2..6, 2..6, 2..6) => 200 + (i % 5) as u8,
        (x, _, _) => (x * 3) as u8,
    };
    let voxels: Vec<u8> = (0..512).map(voxel).collect();
    scratch.write("a_8x8x8_uint8.raw", voxels);
    let run = scratch.run(&["plan", "a_8x8x8_uint8.raw", "--size", "32x32"]);
    assert_eq!(run.code, Some(0), "{run:?}");
    assert!(
        run.stderr.contains("the preset solid") && run.stderr.contains("graphs --for"),
        "{run:?}"
    );
    let saved = scratch.run(&["graphs", "--for", "a_8x8x8_uint8.raw", "-o", "a.ron"]);
    assert_eq!(saved.code, Some(0), "{saved:?}");
    assert!(scratch.path().join("a_transfer.ron").is_file());
    assert_eq!(
        scratch.run(&["check", "a.ron", "a_transfer.ron"]).code,
        Some(0)
    );
    // A broken volume is told as one.
    scratch.write("b.nrrd", "NRRD0004\nnothing\n");
    let broken = scratch.run(&["plan", "b.nrrd"]);
    assert_eq!(broken.code, Some(1));
    assert!(broken.stderr.contains("b.nrrd"), "{broken:?}");
}

#[test]
fn presets_become_transfer_functions() {
    let scratch = Scratch::new();
    scratch.write(
        "a_4x4x4_uint8.raw",
        (0..64).map(|i| i * 4).collect::<Vec<u8>>(),
    );
    let list = scratch.run(&["transfer", "--list"]);
    assert!(
        list.stdout.contains("ct-bone") && list.stdout.contains("viridis"),
        "{list:?}"
    );
    let args = [
        "transfer",
        "--preset",
        "solid",
        "a_4x4x4_uint8.raw",
        "-o",
        "t.ron",
    ];
    let run = scratch.run(&args);
    assert_eq!(run.code, Some(0), "{run:?}");
    assert_eq!(scratch.run(&["check", "t.ron"]).code, Some(0));
    assert_eq!(scratch.run(&args).code, Some(1), "it is there already");
    let text = fs::read_to_string(scratch.path().join("t.ron")).unwrap();
    let own = format!("// mine\n\n(\n{}", text.split_once("(\n").unwrap().1);
    scratch.write("t.ron", &own);
    let forced = scratch.run(&[&args[..], &["--force"]].concat());
    assert_eq!(forced.code, Some(0), "{forced:?}");
    assert_eq!(
        fs::read_to_string(scratch.path().join("t.ron")).unwrap(),
        own
    );
    let refused = scratch.run(&["transfer", "--preset", "ct-bone", "a_4x4x4_uint8.raw"]);
    assert!(
        refused.code == Some(1) && refused.stderr.contains("not-hounsfield"),
        "{refused:?}"
    );
}
