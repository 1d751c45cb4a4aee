//! Colours of isosurfaces: composited in order, in front of and behind what a volume adds.

use glam::DVec3;
use volgraph::{Picture, View};
use volgraph_tests::trilinear::Trilinear;
use volgraph_tests::{STAGES, Stage, adapters, box_interval, graph, ray, render};

pub const SIZE: [u32; 2] = [32, 32];
const CENTRE: DVec3 = DVec3::new(10.3, 10.7, 10.9);
pub const SPHERES: [u32; 3] = [22; 3];

pub fn distance(x: u32, y: u32, z: u32) -> f32 {
    DVec3::new(f64::from(x), f64::from(y), f64::from(z)).distance(CENTRE) as f32
}

/// Dimensions, and the value of each voxel.
pub type Voxels = ([u32; 3], fn(u32, u32, u32) -> f32);

/// A volume in index space, a transfer function, a camera, slots and parameters.
pub fn stage(
    (dims, value): Voxels,
    grid: &str,
    transfer: &str,
    camera: &str,
    [slots, params]: [&str; 2],
) -> Stage {
    let volume = format!(
        r#"path: "v_{}x{}x{}_float32.raw"{grid}"#,
        dims[0], dims[1], dims[2]
    );
    let graph = graph(&volume, camera, "{}", slots, params);
    let normal = r#""color": "image.color", "normal": "image.normal""#;
    Stage::new()
        .with_floats("v", dims, value)
        .with("transfer.ron", transfer)
        .with(
            "graph.ron",
            graph.replace(r#""color": "image.color""#, normal),
        )
}

pub const CLEAR: &str = "(points: [(at: 0, color: (1, 1, 1), opacity: 0)])";

/// The largest error of colour and opacity over all pixels, and the number of those where there is something. The truth
/// may give several colours, all of them within the roundings of the field.
fn worst_color(
    picture: &Picture,
    view: &View,
    (low, high): (DVec3, DVec3),
    truth: impl Fn((DVec3, DVec3), (f64, f64)) -> Vec<[f64; 4]>,
) -> (f64, usize) {
    let (mut worst, mut met) = (0.0_f64, 0);
    let opacity = picture.opacity.as_ref().unwrap();
    for y in 0..view.size[1] {
        for x in 0..view.size[0] {
            let at = (y * view.size[0] + x) as usize;
            let ray = ray(view, x, y);
            let truths = box_interval(ray, low, high)
                .map_or(vec![[0.0; 4]], |interval| truth(ray, interval));
            met += usize::from(truths[0][3] > 0.0);
            let error = |truth: &[f64; 4]| {
                // The background is black and opaque.
                let colors = (0..3)
                    .map(|channel| (f64::from(picture.color[at][channel]) - truth[channel]).abs());
                colors.fold((f64::from(opacity[at]) - truth[3]).abs(), f64::max)
            };
            worst = worst.max(truths.iter().map(error).fold(f64::INFINITY, f64::min));
        }
    }
    (worst, met)
}

/// Surfaces of (colour, opacity), front to back.
fn over(surfaces: impl IntoIterator<Item = ([f64; 3], f64)>) -> [f64; 4] {
    let mut result = [0.0; 4];
    for (color, opacity) in surfaces {
        let through = 1.0 - result[3];
        for channel in 0..3 {
            result[channel] += through * opacity * color[channel];
        }
        result[3] += through * opacity;
    }
    result
}

const SHELLS: [(f64, [f64; 3], f64); 4] = [
    (5.5, [0.0, 1.0, 0.0], 0.5),
    (7.0, [1.0, 0.0, 0.0], 0.4),
    (2.0, [0.0, 0.0, 1.0], 0.6),
    (5.0, [1.0, 1.0, 0.0], 0.25),
];

fn shells(more: &str) -> String {
    let each = SHELLS.iter().zip(1..).map(|((level, [r, g, b], opacity), number)| {
        format!(r#" "isovalue_{number}": {level:?}, "color_{number}": [{r:?}, {g:?}, {b:?}, {opacity:?}],"#)
    });
    let each: String = each.collect();
    format!(
        r#"{{ "surfaces": 4, "isovalue_unit": "data", "early_termination": 0.0,{each} {more} }}"#
    )
}

#[test]
fn translucent_spheres_are_composited_in_the_order_of_the_ray() {
    // In any order given, several within one step, each met twice by one ray.
    let camera = "orbit(azimuth: 33, elevation: 21, fov_y: 32, distance: 30)";
    let slots = r#"{ "technique": "isosurfaces_translucent" }"#;
    let params = shells(r#""refinement": "cubic""#);
    let stage = stage((SPHERES, distance), "", CLEAR, camera, [slots, &params]);
    let field = Trilinear::new(SPHERES, distance);
    let bounds = (DVec3::splat(-0.5), DVec3::splat(21.5));
    let truth = |ray: (DVec3, DVec3), interval: (f64, f64)| {
        // A grazed shell is met or not by rounding of the scalars.
        [0.0, 2e-5, -2e-5]
            .map(|moved| {
                let mut met: Vec<(f64, [f64; 3], f64)> = Vec::new();
                for (level, color, opacity) in SHELLS {
                    let crossings = field.crossings(ray, interval, level + moved);
                    met.extend(
                        crossings
                            .iter()
                            .map(|(distance, _)| (*distance, color, opacity)),
                    );
                }
                met.sort_by(|a, b| a.0.total_cmp(&b.0));
                over(met.into_iter().map(|(_, color, opacity)| (color, opacity)))
            })
            .to_vec()
    };
    for backend in adapters() {
        for form in STAGES {
            for step in [1, 4, 8] {
                let sets = [format!("image.stage={form}"), format!("image.step={step}")];
                let (picture, view) =
                    render(&stage, &sets.each_ref().map(String::as_str), &backend, SIZE);
                let (worst, met) = worst_color(&picture, &view, bounds, truth);
                // Roundings of products of eight transparencies.
                assert!(worst <= 1e-5, "{backend} {form} {step}: {worst}");
                assert!(met > 400, "{met}");
            }
        }
        // Linear refinement loses what lies in one step twice: the check sees that.
        let (picture, view) = render(
            &stage,
            &["image.step=8", "image.refinement=linear"],
            &backend,
            SIZE,
        );
        assert!(worst_color(&picture, &view, bounds, truth).0 > 0.05);
    }
}

/// From 0 to 1 over eight voxels along x, centre to centre.
pub const RAMP: Voxels = ([9, 9, 9], |x, _, _| x as f32 / 8.0);
const RAMP_BOX: (DVec3, DVec3) = (DVec3::ZERO, DVec3::splat(8.0));
/// From the low side, from the high side, and from inside of the upper half.
pub const RAMP_CAMERAS: [&str; 3] = [
    "look_at(eye: (-20, 6, 5), target: (4, 4, 4), fov_y: 30)",
    "look_at(eye: (25, 2, 7), target: (4, 4, 4), fov_y: 30)",
    "look_at(eye: (6.2, 4.1, 4.3), target: (0, 4, 4), fov_y: 70)",
];

#[test]
fn levels_in_one_segment_keep_the_order_of_the_field_both_ways() {
    let slots = r#"{ "technique": "isosurfaces_translucent" }"#;
    let levels = [
        (0.6, [1.0, 0.0, 0.0], 0.5),
        (0.3, [0.0, 1.0, 0.0], 0.3),
        (0.61, [0.0, 0.0, 1.0], 0.9),
    ];
    let each = levels.iter().zip(1..).map(|((level, [r, g, b], opacity), number)| {
        format!(r#" "isovalue_{number}": {level:?}, "color_{number}": [{r:?}, {g:?}, {b:?}, {opacity:?}],"#)
    });
    let params = format!(
        r#"{{ "step": 32.0, "surfaces": 3, "isovalue_unit": "data", {} }}"#,
        each.collect::<String>()
    );
    for camera in RAMP_CAMERAS {
        let stage = stage(
            RAMP,
            ", node_centred: true",
            CLEAR,
            camera,
            [slots, &params],
        );
        let truth = |(origin, direction): (DVec3, DVec3), (near, far): (f64, f64)| {
            let mut met: Vec<(f64, [f64; 3], f64)> = levels
                .iter()
                .map(|(level, color, opacity)| {
                    ((8.0 * level - origin.x) / direction.x, *color, *opacity)
                })
                .filter(|(at, ..)| (near..far).contains(at))
                .collect();
            met.sort_by(|a, b| a.0.total_cmp(&b.0));
            vec![over(
                met.into_iter().map(|(_, color, opacity)| (color, opacity)),
            )]
        };
        for backend in adapters() {
            // Without refinement all lie at the end of the ray's one segment; with bisection the two close ones meet.
            for refinement in ["none", "linear", "bisection", "cubic"] {
                let sets = [
                    format!("image.refinement={refinement}"),
                    "image.bisections=1".to_owned(),
                ];
                let (picture, view) =
                    render(&stage, &sets.each_ref().map(String::as_str), &backend, SIZE);
                let (worst, met) = worst_color(&picture, &view, RAMP_BOX, truth);
                assert!(
                    worst <= 1e-5 && met > 50,
                    "{backend} {camera} {refinement}: {worst}, {met}"
                );
            }
        }
    }
}

#[test]
fn what_lies_in_front_of_and_behind_a_surface_has_its_own_colour_at_any_step() {
    const FRONT: ([f64; 3], f64) = ([1.0, 0.2, 0.1], 0.05);
    const BEHIND: ([f64; 3], f64) = ([0.1, 0.3, 1.0], 0.2);
    const SURFACE: [f64; 3] = [0.2, 0.9, 0.3];
    let transfer = "(domain: data, color: [(0, (1, 0.2, 0.1)), (0.5, (1, 0.2, 0.1)), (0.5, (0.1, 0.3, 1)), (1, (0.1, 0.3, 1))],
                     extinction: [(0, 0.05), (0.5, 0.05), (0.5, 0.2), (1, 0.2)])";
    // Tables blur the step at the isovalue by an entry.
    let slots = r#"{ "technique": "isosurface_dvr", "classify": "post" }"#;
    let params = r#"{ "isovalue": 0.5, "isovalue_unit": "data", "early_termination": 0.0, "surface_color": [0.2, 0.9, 0.3] }"#;
    for (number, camera) in RAMP_CAMERAS.into_iter().enumerate() {
        let stage = stage(
            RAMP,
            ", node_centred: true",
            transfer,
            camera,
            [slots, params],
        );
        for (faces, opacity) in [("open", 0.6), ("drawn", 0.6), ("open", 0.0), ("drawn", 1.0)] {
            if number != 1 && opacity != 0.6 {
                continue;
            }
            let truth = |(origin, direction): (DVec3, DVec3), (near, far): (f64, f64)| {
                let side = |length: f64, (color, extinction): ([f64; 3], f64)| {
                    (color, 1.0 - (-extinction * length).exp())
                };
                let hit = (4.0 - origin.x) / direction.x;
                let starts_solid = origin.x + direction.x * near > 4.0;
                let sides = if starts_solid {
                    [BEHIND, FRONT]
                } else {
                    [FRONT, BEHIND]
                };
                let mut layers = Vec::new();
                if starts_solid && near > 0.0 && faces == "drawn" {
                    layers.push((SURFACE, opacity));
                }
                if (near..far).contains(&hit) {
                    layers.extend([
                        side(hit - near, sides[0]),
                        (SURFACE, opacity),
                        side(far - hit, sides[1]),
                    ]);
                } else {
                    layers.push(side(far - near, sides[0]));
                }
                vec![over(layers)]
            };
            for backend in adapters() {
                for (refinement, step, form) in
                    [("linear", 1, 0), ("cubic", 4, 1), ("linear", 16, 1)]
                {
                    let sets = [
                        format!("image.cut_faces={faces}"),
                        format!("image.surface_opacity={opacity}"),
                        format!("image.refinement={refinement}"),
                        format!("image.step={step}"),
                        format!("image.stage={}", STAGES[form]),
                    ];
                    let (picture, view) =
                        render(&stage, &sets.each_ref().map(String::as_str), &backend, SIZE);
                    let (worst, met) = worst_color(&picture, &view, RAMP_BOX, truth);
                    // The hit is exact to 1e-5 voxels, and colours are products of a few f32.
                    assert!(worst <= 1e-5, "{backend} {camera} {sets:?}: {worst}");
                    assert!(met > 100);
                }
            }
        }
        // The check itself sees the surface left out of the pieces: without refinement it lies at a segment's end.
        let sets = [
            "image.refinement=none",
            "image.step=4",
            "image.surface_opacity=0.6",
            "image.cut_faces=open",
        ];
        let (picture, view) = render(&stage, &sets, &adapters()[0], SIZE);
        let whole = |_: (DVec3, DVec3), (near, far): (f64, f64)| {
            vec![over([(FRONT.0, 1.0 - (-FRONT.1 * (far - near)).exp())])]
        };
        assert!(worst_color(&picture, &view, RAMP_BOX, whole).0 > 0.01);
    }
}

#[test]
fn pieces_of_a_segment_are_integrated_up_to_the_isovalue() {
    // Extinction grows with the scalar: that of a piece is the mean of its ends times its length.
    let transfer = "(domain: data, color: (1, 1, 1), extinction: [(0, 0), (1, 0.4)])";
    let slots = r#"{ "technique": "isosurface_dvr", "classify": "preintegrated_2d" }"#;
    let params = r#"{ "isovalue": 0.3, "isovalue_unit": "data", "early_termination": 0.0, "surface_color": [0, 0, 0],
                      "surface_opacity": 0.7, "cut_faces": "open" }"#;
    for camera in RAMP_CAMERAS {
        let stage = stage(
            RAMP,
            ", node_centred: true",
            transfer,
            camera,
            [slots, params],
        );
        let truth = |(origin, direction): (DVec3, DVec3), (near, far): (f64, f64)| {
            let piece = |start: f64, end: f64| {
                let mean = 0.4 * (origin.x + direction.x * 0.5 * (start + end)) / 8.0;
                ([1.0; 3], 1.0 - (-mean * (end - start)).exp())
            };
            let hit = (2.4 - origin.x) / direction.x;
            if (near..far).contains(&hit) {
                vec![over([piece(near, hit), ([0.0; 3], 0.7), piece(hit, far)])]
            } else {
                vec![over([piece(near, far)])]
            }
        };
        for backend in adapters() {
            for step in ["image.step=3", "image.step=16"] {
                let (picture, view) = render(&stage, &[step], &backend, SIZE);
                let (worst, met) = worst_color(&picture, &view, RAMP_BOX, truth);
                // As for volumes without a surface: entries of the table, and their bilinear mean.
                assert!(
                    worst <= 1e-4 && met > 100,
                    "{backend} {camera} {step}: {worst}"
                );
            }
        }
    }
}
