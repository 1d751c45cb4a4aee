//! Rays that are cut into parts: slivers of labels, clip surfaces through samples.

use volgraph_graph::View;

use super::{BLOB, INTEGRATED, SIZE, SOFT, blob};
use crate::stress::case::{Bound, Case, Method, Point, Quantity, Truth};
use crate::stress::scene_text::{SceneText, VolumeText};

pub(super) fn cases() -> Vec<Case> {
    vec![slivers(), cuts()]
}

fn slivers() -> Case {
    let blocks = |[x, y, z]: [f64; 3]| {
        let block = (x / 3.0).floor() + (y / 3.0).floor() + (z / 3.0).floor();
        1 + u8::from(block.rem_euclid(2.0) == 1.0)
    };
    let labels = VolumeText::bytes("blocks", BLOB, blocks);
    let volume = VolumeText::floats("blob", BLOB, blob(1.0));
    let square = "projection: orthographic, height: 40.0";
    let places = [
        ("through edges", "(-30, -30, 11.5)", "(11.5, 11.5, 11.5)"),
        ("through corners", "(-30, -30, -30)", "(11.5, 11.5, 11.5)"),
        ("along boundaries", "(-30, 12, 12)", "(0, 12, 12)"),
        (
            "beside edges",
            "(-30, -30.0001, 11.5)",
            "(11.5, 11.5, 11.5)",
        ),
        ("aslant", "(-30, -17, 24)", "(11.5, 11.5, 11.5)"),
    ];
    let point = |(at, (label, eye, target)): (usize, (&str, &str, &str))| {
        let camera = format!("look_at(eye: {eye}, target: {target}, {square})");
        let scene = SceneText::new(&format!("slivers_{at}"), volume.clone(), SOFT, &camera)
            .labelled(
                labels.clone(),
                "(segments: [(label: 1, name: \"even\"), (label: 2, name: \"odd\")])",
            )
            .with(INTEGRATED)
            .with(&[("step", "0.5")]);
        Point::named(at as f64, label, scene)
    };
    let bound = Bound {
        of: |_| 2.0 * super::soft_bound(0.5) + 2.5e-4,
        why: "both labels are the same matter: other segments of the same integral, each within order 2",
    };
    Case {
        name: "label-slivers",
        breaks: "Where a ray meets an edge of a label, a part has almost no length: what divides by it is no number, and \
                 what takes its end for its start walks for ever.",
        swept: "rays and boundaries",
        size: SIZE,
        quantity: Quantity::Color,
        truth: Truth::Picture(vec![("slots.labels".to_owned(), "none".to_owned())]),
        points: places.into_iter().enumerate().map(point).collect(),
        methods: vec![Method::holds(
            "boundaries of voxels",
            &[("slots.labels", "volume")],
            bound,
        )],
    }
}

const EXTINCTION: f64 = 0.2;

/// Rays straight down, through what lies below a height.
fn below(_: &View, _: [u32; 2], height: f64) -> Option<[f64; 4]> {
    let opacity = 1.0 - (-EXTINCTION * (height + 0.5)).exp();
    Some([opacity, opacity, opacity, opacity])
}

fn cuts() -> Case {
    let volume = VolumeText::floats("even", [16; 3], |_| 1.0);
    let transfer = format!(
        "(domain: data(from: 0, to: 2), color: (1, 1, 1), extinction: [(0, {EXTINCTION:?}), (2, {EXTINCTION:?})])"
    );
    // Segments end at 15.5 less whole numbers.
    let places = [
        ("at a voxel's centre", 8.0),
        ("at the end of a segment", 8.5),
        ("a hundred-thousandth above it", 8.50001),
        ("a hundred-thousandth below it", 8.49999),
        ("a third into a segment", 8.17),
        ("at the first sample", 15.5),
        ("a sliver at the bottom", -0.499),
    ];
    let point = |(label, height): (&str, f64)| {
        let camera = "look_at(eye: (7.5, 7.5, 40.0), target: (7.5, 7.5, 0.0), up: (0, 1, 0), \
                      projection: orthographic, height: 12.0)";
        let name = format!("cut_{height}");
        let plane = format!("[0.0, 0.0, -1.0, {:?}]", (7.5 - height) / 8.0);
        let scene = SceneText::new(&name, volume.clone(), &transfer, camera).with(&[
            ("slots.clip", "planes"),
            ("planes", "1"),
            ("plane_1", plane.as_str()),
            ("early_termination", "0.0"),
        ]);
        Point::named(height, label, scene)
    };
    let bound = Bound {
        of: |_| 2.4e-5,
        why: "the matter is even, so what is left is f32 (16 roundings), and parts shorter than a ten-thousandth of a \
              voxel count as nothing (0.2e-4)",
    };
    Case {
        name: "cut-through-samples",
        breaks: "A clip surface through a sample: whether the segment before or behind it is drawn is left to a rounding, \
                 and drawn whole it is too much by a step.",
        swept: "height of the cut (voxels)",
        size: SIZE,
        quantity: Quantity::Color,
        truth: Truth::Form(below),
        points: places.map(point).into(),
        methods: vec![
            Method::fails("naive", &[("clip_method", "naive")], bound),
            Method::holds("accurate", &[("clip_method", "accurate")], bound),
        ],
    }
}
