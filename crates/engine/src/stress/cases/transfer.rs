//! Transfer functions that are narrow, that jump, that are opaque.

use super::{SIZE, classify_methods};
use crate::stress::case::{Bound, Case, Expect, Method, Point, Quantity, Truth};
use crate::stress::scene_text::{SceneText, VolumeText};

pub(super) fn cases(classify: &[String]) -> Vec<Case> {
    vec![narrow(classify), discontinuous(classify), opaque()]
}

/// Scalars that grow linearly aslant, from 0 to 1 over 16 voxels and more: the trilinear field is exactly that, and what
/// is left of the errors is the classification's own.
pub(super) fn ramp() -> VolumeText {
    VolumeText::floats("ramp", [17; 3], |[x, y, z]| {
        (0.5 * x + 0.3 * y + 0.2 * z) / 16.0
    })
    .node_centred()
}

/// Along the ramp: the scalar changes by 0.018 to 0.032 a voxel along the rays.
const ALONG: &str = "orbit(azimuth: -33, elevation: 21, fov_y: 30)";

fn narrow(classify: &[String]) -> Case {
    let point = |width: f64| {
        let height = 0.035 / width;
        let peak = |at: f64| {
            let (from, to) = (at - 0.5 * width, at + 0.5 * width);
            format!("({from:?}, 0.0), ({at:?}, {height:?}), ({to:?}, 0.0)")
        };
        let transfer = format!(
            "(domain: range, color: [(0.4, (1, 0.3, 0.2)), (0.4, (0.3, 1, 0.3)), (0.6, (0.3, 1, 0.3)), \
             (0.6, (0.2, 0.4, 1))], extinction: [{}, {}, {}])",
            peak(0.3),
            peak(0.5),
            peak(0.7)
        );
        Point::new(
            width,
            SceneText::new(&format!("narrow_{width}"), ramp(), &transfer, ALONG),
        )
    };
    // The entries along the tables of the others are 1024.
    let bound = |choice: &str| Bound {
        of: if choice == "preintegrated_3d" {
            |width| 1e-3 + 0.7 * (1.0 / 511.0 / width).powi(2)
        } else {
            |width| 1e-3 + 0.7 * (1.0 / 1023.0 / width).powi(2)
        },
        why: "the field is linear, so what is left is the table: K'' d²/8 at both ends of a ray, of an integral K whose \
              slope changes by 0.07 within half a width, over the slope of the scalar",
    };
    Case {
        name: "narrow-transfer",
        breaks: "A peak of the transfer function that is narrower than what the scalar changes in a step falls between \
                 two samples.",
        swept: "width of the peaks (of the data's range)",
        size: SIZE,
        quantity: Quantity::Color,
        truth: Truth::Reference,
        points: [0.1, 0.03, 0.01, 0.003].map(point).into(),
        methods: classify_methods(classify, Expect::Fails, Expect::Holds, bound),
    }
}

fn discontinuous(classify: &[String]) -> Case {
    let transfer = "(domain: range, color: [(0.55, (1, 0.3, 0.2)), (0.55, (0.2, 0.4, 1))], \
                    extinction: [(0.3, 0.0), (0.3, 0.4), (0.45, 0.4), (0.45, 0.0), (0.55, 0.0), (0.55, 1.5), \
                                 (0.7, 1.5), (0.7, 0.05)])";
    let scene = SceneText::new("discontinuous", ramp(), transfer, ALONG);
    let point = |step: f64| Point::new(step, scene.clone().with(&[("step", format!("{step:?}"))]));
    let bound = |choice: &str| Bound {
        of: if choice == "preintegrated_3d" {
            |_| 0.08
        } else {
            |_| 0.04
        },
        why: "a jump by 1.5 is spread over an entry of the table: a quarter of that at both ends of a ray, over the slope \
              of the scalar, 0.018 a voxel and more",
    };
    Case {
        name: "discontinuous-transfer",
        breaks: "Where the transfer function jumps, a sample takes one side for the whole step: the edge is off by up \
                 to half a step, in rings.",
        swept: "step (voxels)",
        size: SIZE,
        quantity: Quantity::Color,
        truth: Truth::Reference,
        points: [4.0, 2.0, 1.0, 0.5].map(point).into(),
        methods: classify_methods(classify, Expect::Fails, Expect::Holds, bound),
    }
}

fn opaque() -> Case {
    let transfer = "(domain: range, points: [(at: 0.0, color: (1, 1, 1), opacity: 0), \
                    (at: 0.4, color: (1, 1, 0), opacity: 0), (at: 0.4, color: (1, 0.5, 0), opacity: 1), \
                    (at: 0.6, color: (0, 0.2, 1), opacity: 1), (at: 1.0, color: (0, 0.2, 1), opacity: 1)])";
    let scene = SceneText::new("opaque", ramp(), transfer, ALONG);
    let point = |step: f64| Point::new(step, scene.clone().with(&[("step", format!("{step:?}"))]));
    let bound = Bound {
        of: |_| 0.15,
        why: "a jump by 16 a voxel is spread over an entry (1/1023): a quarter of that at the start of a ray, over the \
              slope of the scalar, 0.026 a voxel",
    };
    Case {
        name: "opacity-1",
        breaks: "An opaque segment shows the colour at its front; one that mixes its colours without attenuation inside, \
                 or takes that of its middle, shows what is hidden.",
        swept: "step (voxels)",
        size: SIZE,
        quantity: Quantity::Color,
        truth: Truth::Reference,
        points: [4.0, 1.0, 0.25].map(point).into(),
        methods: vec![
            Method::fails("post", &[("slots.classify", "post")], bound),
            Method::holds(
                "preintegrated_2d",
                &[("slots.classify", "preintegrated_2d")],
                bound,
            ),
        ],
    }
}
