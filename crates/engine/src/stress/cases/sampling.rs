//! Steps, and the rate that Carson's rule asks for.

use std::f64::consts::PI;
use std::fmt::Write as _;

use super::{ASLANT, INTEGRATED, SIZE, SOFT_WHY, blob_scene, classify_methods, soft_bound};
use crate::stress::case::{Bound, Case, Expect, Method, Point, Quantity, Truth};
use crate::stress::scene_text::{SceneText, VolumeText};

pub(super) fn cases(classify: &[String]) -> Vec<Case> {
    vec![steps(classify), carson()]
}

fn steps(classify: &[String]) -> Case {
    let scene = blob_scene("steps", ASLANT);
    let point = |step: f64| {
        let step_text = format!("{step:?}");
        Point::new(
            step,
            scene
                .clone()
                .with(&[("step", step_text.as_str()), ("preintegration_size", "512")]),
        )
    };
    // From half the width of the blob on nothing is claimed.
    let bound = Bound {
        of: |step| {
            if step <= 2.0 {
                soft_bound(step) + 2.5e-4 + 2e-4
            } else {
                f64::INFINITY
            }
        },
        why: SOFT_WHY,
    };
    Case {
        name: "step",
        breaks: "Steps as long as what is drawn miss it: all methods need a few samples across a feature of the field.",
        swept: "step (voxels)",
        size: SIZE,
        quantity: Quantity::Color,
        truth: Truth::Reference,
        points: [0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0]
            .map(point)
            .into(),
        methods: classify_methods(classify, Expect::Holds, Expect::Holds, |_| bound),
    }
}

/// Cycles per voxel of the field, and per unit of the scalar of the transfer function.
const FIELD_FREQUENCY: f64 = 1.0 / 16.0;
const TRANSFER_FREQUENCY: f64 = 6.0;

/// The step in voxels that samples twice a cycle of the composition: its highest frequency is that of the transfer
/// function times the field's largest slope, π times its frequency for values from 0 to 1.
fn carson_step() -> f64 {
    0.5 / (TRANSFER_FREQUENCY * PI * FIELD_FREQUENCY)
}

fn carson() -> Case {
    let volume = VolumeText::floats("waves", [48, 16, 16], |[x, _, _]| {
        0.5 + 0.5 * (2.0 * PI * FIELD_FREQUENCY * x).sin()
    });
    let mut extinction = String::new();
    for at in 0..=256 {
        let s = f64::from(at) / 256.0;
        let value = 0.03 * (1.0 - (2.0 * PI * TRANSFER_FREQUENCY * s).cos());
        // Writing to a String does not fail.
        let _ = write!(extinction, "({s:?}, {value:?}), ");
    }
    let transfer = format!("(domain: range, color: (1, 0.8, 0.5), extinction: [{extinction}])");
    let scene = SceneText::new(
        "carson",
        volume,
        &transfer,
        "look_at(eye: (-40.0, 9.3, 8.1), target: (24.0, 7.5, 7.5), fov_y: 14)",
    );
    let point = |ratio: f64| {
        let step = format!("{:?}", ratio * carson_step());
        Point::new(ratio, scene.clone().with(&[("step", step)]))
    };
    let anywhere = Bound {
        of: |_| 8e-3,
        why: "two levels of 255",
    };
    let by_the_rule = Bound {
        of: |ratio| if ratio <= 1.0 { 8e-3 } else { f64::INFINITY },
        why: "at the rule's rate and above nothing of the composition is lost; below it nothing is claimed",
    };
    Case {
        name: "carson",
        breaks: "The transfer function of the field has a higher band limit than the field: its own, times the field's \
                 largest slope. Samples farther apart than half a cycle of that alias.",
        swept: "step over that of the rule",
        size: SIZE,
        quantity: Quantity::Color,
        truth: Truth::Reference,
        points: [8.0, 4.0, 2.0, 1.5, 1.0, 0.5, 0.25].map(point).into(),
        methods: vec![
            Method::fails("post at any step", &[("slots.classify", "post")], anywhere),
            Method::holds(
                "post by the rule",
                &[("slots.classify", "post")],
                by_the_rule,
            ),
            Method::reported("preintegrated_2d", INTEGRATED, anywhere),
        ],
    }
}
