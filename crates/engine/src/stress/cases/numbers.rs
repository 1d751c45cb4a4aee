//! Data of extreme numbers: tiny, huge, beyond the whole numbers of f32, and no numbers at all.

use super::rays::{HALF_STEP, both_stages};
use super::surfaces::CLEAR;
use super::{ASLANT, BLOB, SIZE, SOFT, blob};
use crate::stress::case::{Bound, Case, Method, Point, Quantity, Truth};
use crate::stress::scene_text::{SceneText, VolumeText};

pub(super) fn cases() -> Vec<Case> {
    vec![scales(), scaled_surfaces(), large_integers(), not_finite()]
}

/// Up to the ends of what is drawn: data that spans more or less is refused by name (`value-range`).
const SCALES: [f64; 5] = [2e-30, 1e-10, 1.0, 1e10, 1e30];

fn scaled(scale: f64) -> VolumeText {
    VolumeText::floats(&format!("scale_{scale:e}"), BLOB, blob(scale))
}

fn scales() -> Case {
    let point = |scale: f64| {
        let name = format!("scale_{scale:e}");
        Point::named(
            scale,
            format!("{scale:e}"),
            SceneText::new(&name, scaled(scale), SOFT, ASLANT),
        )
    };
    Case {
        name: "tiny-and-huge-scalars",
        breaks: "Squares, differences and table places of scalars of 1e-30 and 1e30 leave the range of f32.",
        swept: "largest scalar",
        size: SIZE,
        quantity: Quantity::Color,
        truth: Truth::Reference,
        points: SCALES.map(point).into(),
        methods: both_stages(HALF_STEP),
    }
}

fn scaled_surfaces() -> Case {
    let point = |scale: f64| {
        let scene = SceneText::new(&format!("scaled_{scale:e}"), scaled(scale), CLEAR, ASLANT)
            .with(&[
                ("slots.technique", "isosurface"),
                ("isovalue", "0.3"),
                ("slots.light", "phong"),
            ]);
        Point::named(scale, format!("{scale:e}"), scene)
    };
    let bound = Bound {
        of: |_| 0.1,
        why: "roots of the field's own cubics; linear ones may miss a surface that is grazed",
    };
    Case {
        name: "tiny-and-huge-isosurfaces",
        breaks: "Roots of a cubic take products of three scalars, which leave the range of f32.",
        swept: "largest scalar",
        size: SIZE,
        quantity: Quantity::Depth,
        truth: Truth::FirstCrossing { share: 0.3 },
        points: SCALES.map(point).into(),
        methods: vec![
            Method::reported(
                "linear",
                &[("refinement", "linear"), ("step", "0.5")],
                bound,
            ),
            Method::holds("cubic", &[("refinement", "cubic")], bound),
        ],
    }
}

fn large_integers() -> Case {
    let point = |base: f64| {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "whole numbers below 2^32"
        )]
        let value = move |index: [f64; 3]| (base + blob(1000.0)(index)).round() as u32;
        let name = format!("integers_{base}");
        let volume = VolumeText::words(&name, BLOB, value);
        Point::named(
            base,
            format!("{base:.0}"),
            SceneText::new(&name, volume, SOFT, ASLANT),
        )
    };
    Case {
        name: "large-integers",
        breaks: "f32 holds whole numbers up to 2^24: above it, neighbours of a thousand values fall together.",
        swept: "smallest scalar (the data spans 1000 more)",
        size: SIZE,
        quantity: Quantity::Color,
        truth: Truth::Reference,
        points: [0.0, 16_777_216.0, 1_073_741_824.0, 4_294_966_000.0]
            .map(point)
            .into(),
        methods: both_stages(HALF_STEP),
    }
}

fn not_finite() -> Case {
    let kinds = [
        ("not-a-number", f64::NAN),
        ("infinity", f64::INFINITY),
        ("minus infinity", f64::NEG_INFINITY),
    ];
    let point = |(at, (label, odd)): (usize, (&str, f64))| {
        let value = move |index: [f64; 3]| {
            let is_odd = (index[0] + 3.0 * index[1] + 5.0 * index[2]).rem_euclid(97.0) == 0.0;
            if is_odd { odd } else { blob(1.0)(index) }
        };
        let name = format!("odd_{at}");
        let volume = VolumeText::floats(&name, BLOB, value);
        Point::named(
            at as f64,
            label,
            SceneText::new(&name, volume, SOFT, ASLANT),
        )
    };
    let bound = Bound {
        of: |_| 0.06,
        why: "single voxels stand out by the whole range: over such a kink a chord of half a step is off by 2 h²/8, \
              extinction 0.5, for two of them on a ray",
    };
    Case {
        name: "not-finite-data",
        breaks: "One voxel that is no number makes all samples around it, and all that is composited behind, no number.",
        swept: "what one voxel of 97 is",
        size: SIZE,
        quantity: Quantity::Color,
        truth: Truth::Reference,
        points: kinds.into_iter().enumerate().map(point).collect(),
        methods: both_stages(bound),
    }
}
