//! Orders that are not told do not hold, and options that have no part in what is done are refused.

use super::{planted, scene};
use crate::{Run, Scratch};

/// A run that fails with one finding, which says this.
fn fails(run: &Run, code: &str, words: &str) {
    run.refused(&[code]);
    assert!(run.stderr.contains(words), "{words}: {run:?}");
}

#[test]
fn a_declared_order_that_nothing_shows_fails() {
    let scratch = Scratch::new();
    // No surface is in the picture, so no depth is.
    let isosurface = ["--slot", "technique=isosurface"];
    let outside = ["--set", "image.isovalue=5", "--size", "16x16"];
    let run = scratch.run(&[&["verify"], &isosurface[..], &outside].concat());
    fails(&run, "order-untold", "no pixel has a depth");
    assert!(run.stdout.contains("depth: in no pixel"), "{run:?}");
}

#[test]
fn pictures_that_never_change_tell_no_order() {
    let scratch = Scratch::new();
    // One colour wherever the ray goes: the step has no part in it.
    let flat = planted(
        &scratch,
        "slot/technique/dvr.wgsl",
        &[(
            "compositing_result(state.composite)",
            "RayResult(vec4f(0.5 * f32(state.composite.transmittance >= 0.0)), ray.near)",
        )],
        "flat.wgsl",
    );
    let technique = format!("technique={flat}");
    for expected in [&[][..], &["--expect", "2"]] {
        let args = ["verify", "--json", "--size", "16x16", "--slot", &technique];
        let run = scratch.run(&[&args[..], expected].concat());
        assert_eq!(run.code, Some(1), "{run:?}");
        assert!(run.stderr.contains("error[order-untold]"), "{run:?}");
        assert!(
            run.stderr.contains("is the same in all pictures"),
            "{run:?}"
        );
        let color = &run.json()["studies"][0]["quantities"][0];
        assert_eq!(
            (&color["verdict"], &color["untold"]),
            (&"untold".into(), &"unchanged".into())
        );
    }
}

#[test]
fn an_axis_that_is_named_and_cannot_be_measured_fails() {
    let scratch = scene();
    for (args, words) in [
        (&["--orders=grid"][..], "opacity is stated for voxels"),
        (&["--orders=step", "--from", "1e6"], "steps are"),
        (&["--from", "1e6"], "steps are"),
        (&["--orders=pixel", "--size", "4096x1"], "more than 4096"),
    ] {
        let run = scratch.run(&[&["verify", "graph.ron"], args].concat());
        fails(&run, "not-measured", words);
    }
}

#[test]
fn options_that_have_no_part_are_refused() {
    let scratch = scene();
    let run = scratch.run(&["verify", "graph.ron", "--against", "reference"]);
    fails(&run, "no-picture", "`--against`");
    let orders = [
        "--orders",
        "--as",
        "technique=dvr",
        "--from",
        "1",
        "--halvings",
        "4",
    ];
    let more = [
        "--tolerance-order",
        "0.15",
        "--expect",
        "2",
        "--floor",
        "2e-5",
        "--svg",
        "s",
    ];
    let run = scratch.run(&[&["verify", "a.png"], &orders[..], &more].concat());
    let all = "`--orders`, `--as`, `--from`, `--halvings`, `--tolerance-order`, `--expect`, `--floor`, `--svg` cannot be given";
    fails(&run, "no-orders", all);
    let set = ["--set", "image.step=1", "--expect", "2"];
    let run = scratch.run(&[&["verify", "a.exr"], &set[..]].concat());
    run.refused(&["own-settings", "no-orders"]);
}
