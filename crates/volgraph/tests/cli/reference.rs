//! `volgraph reference`, and the reference in place of an adapter.

use super::Scratch;

/// A constant volume: the ray through its middle crosses 16 voxels of extinction 0.1.
const GRAPH: &str = r#"(
    sources: {
        "volume": analytic(field: "constant", dims: (16, 16, 16)),
        "colors": transfer(path: "transfer.ron"),
    },
    camera: orbit(azimuth: 0, elevation: 0),
    nodes: {
        "box":   (kind: "proxy_box", in: { "volume": "volume" }),
        "image": (kind: "raycast", in: { "volume": "volume", "transfer": "colors", "rays": "box" }),
    },
    outputs: { "color": "image.color" },
)"#;

const TRANSFER: &str = "(color: (1, 0.5, 0.25), extinction: [(0, 0.1)])";

/// What hides the drivers of a Linux machine.
const NO_DRIVERS: &[(&str, &str)] = &[
    ("VK_ICD_FILENAMES", "/nonexistent"),
    ("VK_DRIVER_FILES", "/nonexistent"),
    ("__EGL_VENDOR_LIBRARY_DIRS", "/nonexistent"),
];

fn scratch() -> Scratch {
    let scratch = Scratch::new();
    scratch.write("graph.ron", GRAPH);
    scratch.write("transfer.ron", TRANSFER);
    scratch
}

#[test]
fn it_is_computed_once_and_kept() {
    let scratch = scratch();
    let args = [
        "reference",
        "graph.ron",
        "-o",
        "a.exr",
        "--size",
        "9x9",
        "--json",
    ];
    let first = scratch.run(&args);
    assert_eq!(first.code, Some(0), "{}", first.stderr);
    assert!(
        first.stdout.contains("\"is_cached\": false"),
        "{}",
        first.stdout
    );
    let again = scratch.run(&args);
    assert!(
        again.stdout.contains("\"is_cached\": true"),
        "{}",
        again.stdout
    );
    let anew = scratch.run(&[&args[..], &["--no-cache"]].concat());
    assert!(
        anew.stdout.contains("\"is_cached\": false"),
        "{}",
        anew.stdout
    );
    // Another tolerance, view or transfer function is another picture.
    for change in [
        &["--tolerance", "1e-6"][..],
        &["--camera", "orbit(azimuth: 1, elevation: 0)"],
        &["--size", "8x8"],
    ] {
        let args = [&args[..4], &["--json"], change].concat();
        let other = scratch.run(&args);
        assert!(
            other.stdout.contains("\"is_cached\": false"),
            "{}",
            other.stdout
        );
    }
    scratch.write("transfer.ron", TRANSFER.replace("0.25", "0.75"));
    let other = scratch.run(&args);
    assert!(
        other.stdout.contains("\"is_cached\": false"),
        "{}",
        other.stdout
    );

    let picture = volgraph::Picture::load(&scratch.path().join("a.exr")).unwrap();
    let middle = picture.color[4 * 9 + 4];
    let opacity = 1.0 - (-1.6_f32).exp();
    for (channel, factor) in [1.0, 0.5, 0.75, 1.0].into_iter().enumerate() {
        assert!(
            (middle[channel] - factor * opacity).abs() < 1e-7,
            "{middle:?}"
        );
    }
}

#[test]
fn what_it_does_not_compute_is_refused_by_name() {
    let scratch = scratch();
    let sets = ["--set", "image.slots.technique=translucency"];
    let run = scratch.run(&[&["reference", "graph.ron", "-o", "a.exr"][..], &sets].concat());
    assert_eq!(run.code, Some(1));
    assert!(run.stderr.contains("not-covered"), "{}", run.stderr);
    assert!(run.stderr.contains("translucency"), "{}", run.stderr);
    assert!(run.stderr.contains("graph.ron:9:"), "{}", run.stderr);
}

#[test]
#[cfg(target_os = "linux")]
fn the_software_raycaster_draws_where_there_is_no_adapter_and_says_so() {
    let scratch = scratch();
    let run = scratch.run(&["render", "graph.ron", "-o", "device.exr", "--size", "9x9"]);
    assert_eq!(run.code, Some(0), "{}", run.stderr);
    for (classify, method) in [
        ("post", "`post` at a step of 1"),
        ("preintegrated_2d", "`integral_1d` at a step of 0.5"),
    ] {
        let set = format!("image.slots.classify={classify}");
        let args = [
            "render",
            "graph.ron",
            "-o",
            "a.exr",
            "--size",
            "9x9",
            "--set",
            &set,
        ];
        let run = scratch.run_in(&args, NO_DRIVERS);
        assert_eq!(run.code, Some(0), "{}", run.stderr);
        assert!(run.stderr.contains("no adapter"), "{}", run.stderr);
        let picture = volgraph::Picture::load(&scratch.path().join("a.exr")).unwrap();
        let mut metadata = picture.metadata.iter();
        let who = metadata.find(|(key, _)| key == "adapter").unwrap();
        assert!(
            who.1.contains("software") && who.1.contains(method),
            "{who:?}"
        );
        let run = scratch.run(&["compare", "a.exr", "device.exr", "--max-error", "1e-6"]);
        assert_eq!(run.code, Some(0), "{}", run.stdout);
    }
    // Of a node that is drawn so in any case, too.
    let software = GRAPH
        .replace("\"raycast\"", "\"software_raycast\"")
        .replace(", \"rays\": \"box\"", "");
    scratch.write("software.ron", software);
    for (out, environment) in [("c.exr", &[][..]), ("d.exr", NO_DRIVERS)] {
        let args = ["render", "software.ron", "-o", out, "--size", "9x9"];
        let run = scratch.run_in(&args, environment);
        assert_eq!(run.code, Some(0), "{}", run.stderr);
    }
    let run = scratch.run(&["compare", "c.exr", "d.exr", "--max-error", "0"]);
    assert_eq!(run.code, Some(0), "{}", run.stdout);
}

#[test]
#[cfg(target_os = "linux")]
fn the_reference_draws_what_it_does_not_and_says_so() {
    let scratch = scratch();
    // Isosurfaces at 2 are nowhere: the matter alone is seen.
    let sets = [
        "--set",
        "image.slots.technique=isosurface_dvr",
        "--set",
        "image.isovalue=2",
    ];
    let args = ["render", "graph.ron", "-o", "a.exr", "--size", "9x9"];
    let run = scratch.run_in(&[&args[..], &sets].concat(), NO_DRIVERS);
    assert_eq!(run.code, Some(0), "{}", run.stderr);
    assert!(run.stderr.contains("no adapter"), "{}", run.stderr);
    let truth = volgraph::Picture::load(&scratch.path().join("a.exr")).unwrap();
    let who = truth
        .metadata
        .iter()
        .find(|(key, _)| key == "adapter")
        .unwrap();
    assert!(who.1.contains("reference"), "{who:?}");
    let run = scratch.run(&["render", "graph.ron", "-o", "b.exr", "--size", "9x9"]);
    assert_eq!(run.code, Some(0), "{}", run.stderr);
    let run = scratch.run(&["compare", "b.exr", "a.exr", "--max-error", "1e-5"]);
    assert_eq!(run.code, Some(0), "{}", run.stdout);
    // What neither can draw names both reasons.
    let sets = ["--set", "image.slots.technique=translucency"];
    let run = scratch.run_in(&[&args[..], &sets].concat(), NO_DRIVERS);
    assert_eq!(run.code, Some(1));
    assert!(run.stderr.contains("not-covered"), "{}", run.stderr);
    assert!(run.stderr.contains("mesa-vulkan-drivers"), "{}", run.stderr);
}
