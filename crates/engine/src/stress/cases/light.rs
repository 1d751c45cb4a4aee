//! Light that bends and light that is hidden: refraction, critical angles, shadows that start on surfaces.

use glam::DVec3;
use volgraph_graph::View;

use super::surfaces::CLEAR;
use super::{ASLANT, BLOB, SIZE, blob};
use crate::stress::case::{Bound, Case, Method, Point, Quantity, Truth};
use crate::stress::scene_text::{SceneText, VolumeText};

pub(super) fn cases() -> Vec<Case> {
    vec![straight(), index_step(), snell(), furnace(), shadows()]
}

const PLACES: &str =
    r#"{ "pattern": "gradient", "bottom": [0.0, 0.0, 0.0, 1.0], "top": [1.0, 1.0, 1.0, 1.0] }"#;
const WHITE: &str = r#"{ "pattern": "uniform", "color": [1.0, 1.0, 1.0, 1.0] }"#;

fn straight() -> Case {
    let point = |index: f64| {
        let transfer = format!(
            "(domain: range, color: (1, 0.7, 0.2), extinction: [(0.02, 0.0), (1.0, 0.5)], \
             refraction: [(0.0, {index:?}), (1.0, {index:?})])"
        );
        let volume = VolumeText::floats("blob", BLOB, blob(1.0));
        let scene =
            SceneText::new(&format!("straight_{index}"), volume, &transfer, ASLANT).before(PLACES);
        Point::new(index, scene)
    };
    let bound = Bound {
        of: |_| 1e-5,
        why: "the same segments, but for roundings of directions",
    };
    Case {
        name: "even-index",
        breaks: "Where the refractive index does not change its gradient is 0: directions that are normalised by it, or \
                 turned by its rounding, drift.",
        swept: "refractive index of all",
        size: SIZE,
        quantity: Quantity::Color,
        truth: Truth::Picture(vec![("slots.technique".to_owned(), "dvr".to_owned())]),
        points: [1.0, 1.5, 4.0].map(point).into(),
        methods: vec![Method::holds(
            "refraction",
            &[("slots.technique", "refraction")],
            bound,
        )],
    }
}

const SLAB: [u32; 3] = [33, 33, 17];
const SLAB_LOW: f64 = 3.7;
const SLAB_HIGH: f64 = 12.3;

fn slab_scene() -> SceneText {
    let volume = VolumeText::floats("slab", SLAB, |[_, _, z]| (z - 8.0).abs());
    let transfer = "(domain: data(from: 0, to: 8), color: (1, 1, 1), extinction: [(0, 0), (8, 0)], \
                    refraction: [(0, 1.5), (4.299, 1.5), (4.301, 1.0), (8, 1.0)])";
    let camera = "orbit(azimuth: 90, elevation: 40, projection: orthographic)";
    SceneText::new("slab", volume, transfer, camera).before(PLACES)
}

/// Of a ray through the slab: where it comes in and goes out, its way inside, and Fresnel's share that is mirrored.
struct Way {
    direction: DVec3,
    enters: DVec3,
    leaves: DVec3,
    mirrored_share: f64,
}

fn way(view: &View, [x, y]: [u32; 2]) -> Option<Way> {
    let ray = volgraph_nodes::reference::rays(view).ray(x, y);
    let (origin, direction) = (ray.origin, ray.direction);
    let cosine = -direction.z;
    let inner_cosine = (1.0 - (1.0 - cosine * cosine) / 2.25).sqrt();
    let enters = origin + direction * ((origin.z - SLAB_HIGH) / cosine);
    let inner = (direction / 1.5).with_z(-inner_cosine);
    let leaves = enters + inner * ((SLAB_HIGH - SLAB_LOW) / inner_cosine);
    let is_inside = |p: DVec3| p.x.min(p.y) > 1.0 && p.x.max(p.y) < 31.0;
    let across = (cosine - 1.5 * inner_cosine) / (cosine + 1.5 * inner_cosine);
    let within = (1.5 * cosine - inner_cosine) / (1.5 * cosine + inner_cosine);
    (is_inside(enters) && is_inside(leaves)).then_some(Way {
        direction,
        enters,
        leaves,
        mirrored_share: 0.5 * (across * across + within * within),
    })
}

/// The background that a ray meets, on a plane two radii of the box behind its middle, or before it.
fn beyond(view: &View, from: DVec3, direction: DVec3) -> f64 {
    let camera = &view.camera;
    let dims = DVec3::from_array(SLAB.map(f64::from));
    let middle = (0.5 * (dims - 1.0) - camera.eye).dot(camera.forward);
    let along = direction.dot(camera.forward);
    let depth = middle + dims.length().copysign(along);
    let from = from - camera.eye;
    let met = from + direction * ((depth - from.dot(camera.forward)) / along);
    (0.5 * met.dot(camera.up) / view.lens().half_extent[1] + 0.5).clamp(0.0, 1.0)
}

/// Snell's law alone: behind the slab a ray goes on as it came.
fn refracted(view: &View, pixel: [u32; 2], _: f64) -> Option<[f64; 4]> {
    let way = way(view, pixel)?;
    let color = beyond(view, way.leaves, way.direction);
    Some([color, color, color, 1.0])
}

/// With the shares that both faces mirror.
fn refracted_and_mirrored(view: &View, pixel: [u32; 2], _: f64) -> Option<[f64; 4]> {
    let way = way(view, pixel)?;
    let share = way.mirrored_share;
    let inner = (way.leaves - way.enters).normalize();
    let mirrored = beyond(view, way.enters, way.direction.with_z(-way.direction.z));
    let within = beyond(view, way.leaves, inner.with_z(-inner.z));
    let through = beyond(view, way.leaves, way.direction);
    let color = share * mirrored + (1.0 - share) * (share * within + (1.0 - share) * through);
    Some([color, color, color, 1.0])
}

fn slab_points() -> Vec<Point> {
    let scene = slab_scene();
    [4.0, 1.0, 0.25]
        .map(|step| Point::new(step, scene.clone().with(&[("step", format!("{step:?}"))])))
        .into()
}

fn index_step() -> Case {
    let bound = Bound {
        of: |_| 0.01,
        why: "a shift of half a voxel of the picture's 50",
    };
    Case {
        name: "refractive-step",
        breaks: "Where the refractive index jumps within a step, a ray that is bent by sampled gradients turns at the \
                 wrong place and by the wrong angle.",
        swept: "step (voxels)",
        size: SIZE,
        quantity: Quantity::Color,
        truth: Truth::Form(refracted),
        points: slab_points(),
        methods: vec![Method::fails(
            "refraction",
            &[("slots.technique", "refraction")],
            bound,
        )],
    }
}

fn snell() -> Case {
    let bound = Bound {
        of: |_| 2e-5,
        why: "the field is linear, so hits and normals are exact: what is left is f32",
    };
    Case {
        name: "refractive-surface",
        breaks: "The same jump as an isosurface: by Snell's law and Fresnel's equations at the root itself no step \
                 matters.",
        swept: "step (voxels)",
        size: SIZE,
        quantity: Quantity::Color,
        truth: Truth::Form(refracted_and_mirrored),
        points: slab_points(),
        methods: vec![Method::holds(
            "refraction_surface",
            &[
                ("slots.technique", "refraction_surface"),
                ("isovalue", "4.3"),
                ("isovalue_unit", "data"),
                ("solid", "below"),
                ("refractive_index", "1.5"),
                ("transmission_color", "[1.0, 1.0, 1.0]"),
            ],
            bound,
        )],
    }
}

/// White, whatever a ray does.
fn white(_: &View, _: [u32; 2], _: f64) -> Option<[f64; 4]> {
    Some([1.0; 4])
}

fn furnace() -> Case {
    let point = |index: f64| {
        let volume = VolumeText::floats("ball", [20; 3], |index| {
            DVec3::from_array(index).distance_squared(DVec3::splat(9.5))
        });
        let camera = "look_at(eye: (3.0, 8.3, 9.1), target: (16.0, 11.0, 9.6), fov_y: 110)";
        let scene = SceneText::new(&format!("furnace_{index}"), volume, CLEAR, camera)
            .before(WHITE)
            .with(&[
                ("slots.technique", "refraction_surface"),
                ("isovalue", "64.0"),
                ("isovalue_unit", "data"),
                ("solid", "below"),
                ("transmission_color", "[1.0, 1.0, 1.0]"),
            ]);
        Point::named(
            index,
            format!("{index}"),
            scene.with(&[("refractive_index", format!("{index:?}"))]),
        )
    };
    let bound = Bound {
        of: |_| 1e-5,
        why: "clear glass in an even white light is invisible: what is mirrored and what is refracted add up to 1",
    };
    Case {
        name: "critical-angle",
        breaks: "Beyond the critical angle the cosine of the refracted ray is the root of a negative number; at it, \
                 Fresnel's equations divide 0 by 0.",
        swept: "refractive index of a ball, from within",
        size: SIZE,
        quantity: Quantity::Color,
        truth: Truth::Form(white),
        points: [1.0, 1.000_001, 1.01, 1.5, 2.5, 4.0].map(point).into(),
        methods: vec![
            Method::holds("cubic", &[("refinement", "cubic")], bound),
            Method::holds("linear", &[("refinement", "linear")], bound),
        ],
    }
}

fn shadows() -> Case {
    let tilted = |[x, y, z]: [f64; 3]| 0.5 + (8.0 + 0.21 * (x - 8.0) - 0.13 * (y - 8.0) - z) / 32.0;
    let volume = VolumeText::floats("tilted", [16; 3], tilted).node_centred();
    let point = |angle: f64| {
        // Above the plane, by so many degrees.
        let normal = DVec3::new(-0.21, 0.13, 1.0).normalize();
        let along = normal.cross(DVec3::new(0.3, 1.0, 0.2)).normalize();
        let (sine, cosine) = angle.to_radians().sin_cos();
        let light = normal * sine + along * cosine;
        let light = format!("[{:?}, {:?}, {:?}, 0.0]", light.x, light.y, light.z);
        let camera = "orbit(azimuth: 20, elevation: 55, projection: orthographic, height: 8)";
        let scene =
            SceneText::new(&format!("shadow_{angle}"), volume.clone(), CLEAR, camera).with(&[
                ("slots.technique", "isosurface"),
                ("slots.light", "phong"),
                ("isovalue_unit", "data"),
                ("isovalue", "0.5"),
                ("ambient", "0.1"),
                ("diffuse", "0.9"),
                ("specular", "0.0"),
                ("light_1", light.as_str()),
            ]);
        Point::new(angle, scene)
    };
    let bound = Bound {
        of: |_| 1e-5,
        why: "a plane casts no shadow on itself: the picture is that without shadows",
    };
    Case {
        name: "shadow-rays-on-surfaces",
        breaks: "A ray towards the light starts on the surface itself: by a rounding it starts below it, and the surface \
                 shadows itself in specks.",
        swept: "angle of the light to the surface (degrees)",
        size: SIZE,
        quantity: Quantity::Color,
        truth: Truth::Picture(vec![("slots.shadow".to_owned(), "none".to_owned())]),
        points: [80.0, 30.0, 5.0, 1.0, 0.2].map(point).into(),
        methods: vec![
            Method::holds(
                "surface, linear hits",
                &[("slots.shadow", "surface")],
                bound,
            ),
            Method::holds(
                "surface, cubic hits",
                &[("slots.shadow", "surface"), ("refinement", "cubic")],
                bound,
            ),
        ],
    }
}
