//! Isosurfaces: thin shells, grazing rays, two roots in a step; gradients that vanish, and few bits for them.

use glam::DVec3;
use volgraph_graph::View;

use super::SIZE;
use crate::stress::case::{Bound, Case, Method, Point, Quantity, Truth};
use crate::stress::scene_text::{SceneText, VolumeText};

/// Nothing of it is used.
pub(super) const CLEAR: &str = "(domain: range, color: (1, 1, 1), extinction: [(0, 0), (1, 0)])";

pub(super) fn cases() -> Vec<Case> {
    vec![
        thin_shell(),
        grazing(),
        two_roots(),
        zero_gradient(),
        weak_gradients(),
    ]
}

/// The cubic hit of a trilinear field is exact but for f32: scalars are off by some 1e-6 of the range, and rays that are not
/// judged are those that a 1e-5 of it moves by a tenth.
const EXACT: Bound = Bound {
    of: |_| 0.1,
    why: "roots of the field's own cubics; a tenth of a voxel is what rounding may move a grazing hit by",
};

const HIT: Bound = Bound {
    of: |_| 0.1,
    why: "as for the exact roots",
};

fn refinements(linear_and_bisection_hold: bool) -> Vec<Method> {
    let method = if linear_and_bisection_hold {
        Method::holds
    } else {
        Method::fails
    };
    vec![
        method("linear", &[("refinement", "linear")], HIT),
        method(
            "bisection",
            &[("refinement", "bisection"), ("bisections", "12")],
            HIT,
        ),
        Method::holds("cubic", &[("refinement", "cubic")], EXACT),
    ]
}

const CENTRE: DVec3 = DVec3::new(10.3, 10.7, 10.9);
const BALL: [u32; 3] = [22; 3];
const ORBIT: &str = "orbit(azimuth: 33, elevation: 21, fov_y: 32, distance: 38)";

fn from_centre(index: [f64; 3]) -> f64 {
    DVec3::from_array(index).distance(CENTRE)
}

fn isosurface(name: &str, volume: VolumeText, camera: &str) -> SceneText {
    SceneText::new(name, volume, CLEAR, camera)
        .with(&[("slots.technique", "isosurface"), ("isovalue", "0.5")])
}

fn at_step(scene: &SceneText, step: f64) -> Point {
    Point::new(step, scene.clone().with(&[("step", format!("{step:?}"))]))
}

fn thin_shell() -> Case {
    let shell = |index| (1.0 - (from_centre(index) - 7.0).abs() / 0.8).max(0.0);
    let scene = isosurface("shell", VolumeText::floats("shell", BALL, shell), ORBIT);
    Case {
        name: "thin-shell",
        breaks: "A shell thinner than a step lies between two samples that are both outside of it.",
        swept: "step (voxels)",
        size: SIZE,
        quantity: Quantity::Depth,
        truth: Truth::FirstCrossing { share: 0.5 },
        points: [0.25, 0.5, 1.0, 2.0, 4.0]
            .map(|step| at_step(&scene, step))
            .into(),
        methods: refinements(false),
    }
}

fn grazing() -> Case {
    let ripples = |[x, y, z]: [f64; 3]| {
        (0.5 + (6.0 + 0.8 * (0.9 * x).sin() * (0.7 * y).cos() - z) / 24.0).clamp(0.0, 1.0)
    };
    let volume = VolumeText::floats("ripples", [32, 32, 14], ripples);
    let point = |elevation: f64| {
        let camera =
            format!("orbit(azimuth: 20, elevation: {elevation:?}, projection: orthographic)");
        let scene = isosurface(&format!("grazing_{elevation}"), volume.clone(), &camera);
        Point::new(elevation, scene)
    };
    Case {
        name: "grazing-isosurface",
        breaks: "A ray that grazes a surface is inside of it for less than a step, or meets it between two samples that \
                 are on one side.",
        swept: "angle to the surface (degrees)",
        size: SIZE,
        quantity: Quantity::Depth,
        truth: Truth::FirstCrossing { share: 0.5 },
        points: [30.0, 10.0, 3.0, 1.0].map(point).into(),
        methods: refinements(false),
    }
}

fn two_roots() -> Case {
    let spots = |index: [f64; 3]| {
        let is_spot = index.iter().all(|n| (n - 2.0).rem_euclid(5.0) == 0.0);
        if is_spot { 1.0 } else { 0.0 }
    };
    let scene = isosurface("spots", VolumeText::floats("spots", [20; 3], spots), ORBIT);
    Case {
        name: "two-roots",
        breaks: "Within one cell the field goes above the level and back again: one voxel stands out, and both crossings \
                 are within one step.",
        swept: "step (voxels)",
        size: SIZE,
        quantity: Quantity::Depth,
        truth: Truth::FirstCrossing { share: 0.5 },
        points: [0.25, 1.0, 4.0].map(|step| at_step(&scene, step)).into(),
        methods: refinements(false),
    }
}

/// Where nothing else is in the way: the plane z = 8 from above.
fn up(_: &View, _: [u32; 2], _: f64) -> Option<[f64; 4]> {
    Some([0.0, 0.0, 1.0, 1.0])
}

fn zero_gradient() -> Case {
    let ridge = |[_, _, z]: [f64; 3]| if z == 8.0 { 1.0 } else { 0.0 };
    let volume = VolumeText::floats("ridge", [16; 3], ridge);
    let point = |below: f64| {
        let camera = "orbit(azimuth: 20, elevation: 50, projection: orthographic, height: 6)";
        let isovalue = format!("{:?}", 1.0 - below);
        let scene = isosurface(&format!("ridge_{below}"), volume.clone(), camera)
            .with_normals()
            .with(&[
                ("isovalue", isovalue.as_str()),
                ("refinement", "cubic"),
                ("slots.light", "phong"),
            ]);
        Point::new(below, scene)
    };
    let bound = Bound {
        of: |_| 1e-3,
        why: "the normal is +z wherever the surface is met; gradients that are stored in halves have 11 bits",
    };
    Case {
        name: "zero-gradient",
        breaks: "On a ridge the central difference is 0: a normal divides by it. Near the top of one it is small, of the \
                 size of its rounding.",
        swept: "how far below the top of the ridge (of the data's range)",
        size: SIZE,
        quantity: Quantity::Normal,
        truth: Truth::Form(up),
        points: [0.1, 1e-2, 1e-3, 1e-4, 1e-5].map(point).into(),
        methods: vec![
            Method::holds("analytic", &[("slots.gradient", "analytic")], bound),
            Method::holds("central", &[("slots.gradient", "central")], bound),
            Method::holds(
                "stored, half floats",
                &[("slots.gradient", "stored")],
                bound,
            ),
            Method::holds(
                "stored, 8 bits",
                &[
                    ("slots.gradient", "stored"),
                    ("slots.gradient_storage", "rgba8"),
                ],
                bound,
            ),
        ],
    }
}

/// The normal of the ball where a ray meets it first.
fn ball_normal(view: &View, [x, y]: [u32; 2], _: f64) -> Option<[f64; 4]> {
    let ray = volgraph_nodes::reference::rays(view).ray(x, y);
    let along = (CENTRE - ray.origin).dot(ray.direction);
    let aside = (ray.at(along) - CENTRE).length();
    // At the outline a small error of the hit turns the normal a lot.
    if aside > 0.8 * 7.0 {
        return None;
    }
    let normal = (ray.at(along - (49.0 - aside * aside).sqrt()) - CENTRE) / 7.0;
    Some([normal.x, normal.y, normal.z, 1.0])
}

fn weak_gradients() -> Case {
    let point = |strength: f64| {
        let weak = move |index: [f64; 3]| {
            // The range is 1, from two voxels in corners; what is looked at is a part of it around 1/2.
            if index == [0.0; 3] {
                0.0
            } else if index == [21.0; 3] {
                1.0
            } else {
                0.5 + strength * (49.0 - from_centre(index).powi(2)) / 49.0
            }
        };
        let name = format!("weak_{strength:e}");
        let scene = isosurface(&name, VolumeText::floats(&name, BALL, weak), ORBIT)
            .with_normals()
            .with(&[("refinement", "cubic"), ("slots.light", "phong")]);
        Point::new(strength, scene)
    };
    // Differences of f32 beside 1/2 are off by 2⁻²⁴ each; the gradient at the surface is 2/7 of the strength a voxel.
    let rounded = Bound {
        of: |strength| 0.03 + 2.0_f64.powi(-24) * 3.0 * 3.5 / strength,
        why: "the hit is up to 0.75/14 voxels off the ball's; f32 scalars beside 1/2 are off by 2⁻²⁵ over a gradient of \
              2/7 of the strength",
    };
    Case {
        name: "weak-gradients",
        breaks: "Gradients are stored in shares of the data's range: beside a strong edge elsewhere the codes of 8 bits, \
                 and the smallest half floats, are coarse for a weak one.",
        swept: "strength of the surface (of the data's range)",
        size: SIZE,
        quantity: Quantity::Normal,
        truth: Truth::Form(ball_normal),
        points: [5e-2, 1e-2, 1e-3, 1e-4, 1e-5].map(point).into(),
        methods: vec![
            Method::fails(
                "stored, 8 bits",
                &[
                    ("slots.gradient", "stored"),
                    ("slots.gradient_storage", "rgba8"),
                ],
                rounded,
            ),
            Method::holds(
                "stored, half floats",
                &[("slots.gradient", "stored")],
                rounded,
            ),
            Method::holds("central", &[("slots.gradient", "central")], rounded),
        ],
    }
}
