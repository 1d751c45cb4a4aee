//! Graphs that volgraph carries: drawn by name, listed, written.

use volgraph::Picture;

use super::SMALL;
use crate::{SPHERE, Scratch, TRANSFER, graph, graphs_in, root};

fn metadata(picture: &Picture, key: &str) -> String {
    let entry = picture.metadata.iter().find(|(name, _)| name == key);
    entry.unwrap_or_else(|| panic!("{key}")).1.clone()
}

#[test]
fn ready_graphs_are_drawn_by_name_without_a_file() {
    let scratch = Scratch::new();
    for (name, place) in [
        ("graphs/quickstart.ron", "graphs/quickstart.ron"),
        ("quickstart", "quickstart"),
        ("embedded:/graphs/image_background.ron", ""),
    ] {
        let run = scratch.render(name, "a.png").ok();
        let told = format!("note: there is no file {place} here");
        assert_eq!(
            run.stderr.contains(&told),
            !place.is_empty(),
            "{}",
            run.stderr
        );
    }
    let path = metadata(&scratch.picture("a.png"), "graph.path");
    assert_eq!(path, "embedded:/graphs/image_background.ron");
    // Findings name the embedded file and show its lines; the other commands take the names as well.
    let run = scratch.run(&["plan", "engine"]);
    run.refused(&["data-missing"]);
    for part in [
        "embedded:/graphs/scans/engine.ron:5:",
        "\"engine\": volume(path: ",
        "file engine_256x256x128_uint8.raw.gz",
    ] {
        assert!(run.stderr.contains(part), "{part}: {}", run.stderr);
    }
    let check = scratch
        .run(&[
            "check",
            "quickstart",
            "embedded:/graphs/transfer/molecule.ron",
        ])
        .ok();
    assert!(check.stdout.contains("2 files checked"), "{check:?}");
    scratch
        .run(&[
            "bench",
            "quickstart",
            "--size",
            "16x16",
            "--frames",
            "1",
            "--warm-up",
            "0",
        ])
        .ok();
    let lost = scratch.run(&["render", "quikstart", "-o", "b.png"]);
    lost.refused(&["io"]);
    assert!(
        lost.stderr.contains("did you mean `quickstart`?"),
        "{}",
        lost.stderr
    );
    // Volumes come from the folders of data.
    let mut voxels = vec![0_u8; 103 * 94 * 161];
    voxels[500_000..800_000].fill(200);
    scratch.write("data/tooth_103x94x161_uint8.raw", voxels);
    let overridden = [
        "render",
        "tooth",
        "-o",
        "c.png",
        "--data",
        "data",
        "--set",
        "tooth.path=tooth_103x94x161_uint8.raw",
    ];
    scratch.run(&[&overridden[..], &SMALL[..]].concat()).ok();
}

#[test]
fn files_on_disk_win_and_never_fall_back_to_embedded_ones() {
    let scratch = Scratch::new();
    let small = graph(SPHERE).replace("t.ron", "transfer/molecule.ron");
    scratch.write("graphs/quickstart.ron", &small);
    // The transfer function is not there, and volgraph's own is not read in its place.
    let run = scratch.render("quickstart", "a.png");
    run.refused(&["io"]);
    for part in [
        "graphs/transfer/molecule.ron",
        "`path: \"embedded:/graphs/transfer/molecule.ron\"`",
    ] {
        assert!(run.stderr.contains(part), "{part}: {}", run.stderr);
    }
    scratch.write("graphs/transfer/molecule.ron", TRANSFER);
    scratch.render("quickstart", "a.exr").ok();
    let path = |picture: &str| metadata(&scratch.picture(picture), "graph.path");
    assert_eq!(path("a.exr"), "graphs/quickstart.ron");
    // Nearer ones first.
    scratch.write(
        "quickstart.ron",
        small.replace(
            "transfer/molecule.ron",
            "embedded:/graphs/transfer/molecule.ron",
        ),
    );
    scratch.render("quickstart", "b.exr").ok();
    assert_eq!(path("b.exr"), "quickstart.ron");
    let colors = |picture: &str| scratch.picture(picture).color;
    assert_ne!(
        colors("a.exr"),
        colors("b.exr"),
        "volgraph's own transfer function was named"
    );
    scratch.write(
        "quickstart.ron",
        small.replace(
            "transfer/molecule.ron",
            "embedded:/graphs/transfer/molecul.ron",
        ),
    );
    let run = scratch.render("quickstart", "c.exr");
    run.refused(&["io"]);
    assert!(
        run.stderr
            .contains("carries no file `embedded:/graphs/transfer/molecul.ron`"),
        "{}",
        run.stderr
    );
    // A file of the name that cannot be read is an error, and not another graph.
    scratch.write("hydrogen.ron", "no graph");
    scratch.render("hydrogen", "c.exr").refused(&["ron-syntax"]);
}

#[test]
fn ready_graphs_are_listed_shown_and_written() {
    let scratch = Scratch::new();
    let list = scratch.run(&["graphs"]).ok().stdout;
    for part in [
        "quickstart ",
        "A molar: enamel as a white cap",
        "[needs tooth_103x94x161_uint8.raw.gz]",
        "[needs no file]",
    ] {
        assert!(list.contains(part), "{part}: {list}");
    }
    let count = graphs_in("graphs").len() + graphs_in("graphs/scans").len();
    assert_eq!(list.lines().count(), count);
    let json = scratch.run(&["graphs", "--json"]).ok().json();
    assert_eq!(json.as_array().unwrap().len(), count);
    let shown = scratch.run(&["graphs", "quickstart"]).ok().stdout;
    assert_eq!(
        shown,
        std::fs::read_to_string(root().join("graphs/quickstart.ron")).unwrap()
    );
    scratch
        .run(&["graphs", "quickstat"])
        .refused(&["unknown-graph"]);
    scratch.run(&["graphs", "image_background", "--write"]).ok();
    let files = [
        "image_background.ron",
        "images/backdrop.png",
        "transfer/image_background.ron",
    ];
    assert_eq!(scratch.files(), files);
    for file in files {
        let original = std::fs::read(root().join("graphs").join(file)).unwrap();
        assert_eq!(
            std::fs::read(scratch.path().join(file)).unwrap(),
            original,
            "{file}"
        );
    }
    assert_eq!(
        scratch.render("image_background", "a.png").ok().stderr,
        "",
        "the copy is drawn"
    );
    scratch.write("transfer/image_background.ron", "mine");
    let run = scratch.run(&["graphs", "image_background", "--write"]);
    run.refused(&["file-exists"; 3]);
    assert!(run.stderr.contains("--force"), "{}", run.stderr);
    scratch
        .run(&["graphs", "image_background", "--write", "--force"])
        .ok();
    scratch.run(&["check", "."]).ok();
}
