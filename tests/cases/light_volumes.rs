//! Light that a volume lets through, along rays and from a grid, against its closed form.

use glam::DVec3;
use volgraph::{Change, Outcome, ParamOverride};
use volgraph_graph::CameraDesc;
use volgraph_graph::camera::Pose;
use volgraph_tests::{STAGES, Stage, adapters, box_interval, graph, ray, render};

use crate::lights::{clip_below, pixels, surface};

/// The field is z, so that there is a normal; the medium is the same everywhere. `Stage` with volume and transfer.
fn ramp() -> Stage {
    Stage::new().with_floats("v", [17, 17, 17], |_, _, z| {
        f32::from(u16::try_from(z).unwrap())
    })
}

const VOLUME: &str = r#"path: "v_17x17x17_float32.raw", node_centred: true"#;
const LOOK: &str =
    "look_at(eye: (14, -20, 40), target: (8, 8, 8), projection: orthographic, height: 20)";
const HIGH: DVec3 = DVec3::splat(16.0);

/// Of opacity 0.1 per voxel, the stage's medium.
fn extinction() -> f64 {
    -(0.9_f64.ln())
}

/// A plane at z = 8 under the medium.
fn plane(shadow: &str, params: &str) -> Stage {
    let slots = format!(r#""shadow": "{shadow}", "gradient": "central""#);
    let params = format!(r#""solid": "below", {params}"#);
    let stage = surface(ramp(), VOLUME, LOOK, &slots, &params);
    let text = std::fs::read_to_string(stage.path().join("graph.ron")).unwrap();
    let text = text.replace(r#""isovalue": 0,"#, r#""isovalue": 8,"#);
    stage.with("graph.ron", text)
}

/// The way from a point to the light: direction, and the distance that lies in the box.
fn way(point: DVec3, light: DVec3, is_point: bool) -> (DVec3, f64, DVec3) {
    let towards = if is_point { light - point } else { light };
    let direction = towards.normalize();
    let faces = ((HIGH - point) / direction).max((DVec3::ZERO - point) / direction);
    let reach = if is_point {
        towards.length()
    } else {
        f64::INFINITY
    };
    (direction, faces.min_element().min(reach), faces)
}

/// Points of the plane that pixels see, with the red of those.
fn plane_points(stage: &Stage, sets: &[&str], backend: &str) -> Vec<(DVec3, f64)> {
    let drawn = render(stage, sets, backend, [32, 32]);
    pixels(&drawn)
        .filter_map(|(ray, value)| {
            let (near, far) = box_interval(ray, DVec3::ZERO, HIGH)?;
            let distance = (8.0 - ray.0.z) / ray.1.z;
            let point = ray.0 + distance * ray.1;
            (near < distance && distance < far).then_some((point, value))
        })
        .collect()
}

const SUN: DVec3 = DVec3::new(0.5, 0.3, 1.0);

#[test]
fn a_medium_attenuates_light_by_its_way_to_the_face() {
    let params = format!(r#""light_1": [{}, {}, {}, 0]"#, SUN.x, SUN.y, SUN.z);
    for classify in ["post", "preintegrated_2d"] {
        let stage = plane("transmittance", &params);
        for backend in adapters() {
            let set = format!("image.slots.classify={classify}");
            let points = plane_points(&stage, &[&set], &backend);
            assert!(points.len() > 250);
            for (point, value) in points {
                let (direction, length, _) = way(point, SUN, false);
                let expected = direction.z * (-extinction() * length).exp();
                // A walk ends where less than 1/4096 gets through, which is nowhere here; the rest is rounding.
                assert!(
                    (value - expected).abs() < 1e-4,
                    "{backend} {classify} {point}: {value}, not {expected}"
                );
            }
        }
    }
}

/// Between points at distance h, T = exp(-τ d) is off by at most h²/8 of its second derivatives along the three axes,
/// each (τ ∂d)² T, where all points around leave by the same face: then d = distance to the face / component of the
/// direction. Halves add 2⁻¹¹, and weights of 8 bits 1/512 of the differences along three axes.
fn grid_bound(h: f64, slope: f64) -> f64 {
    let change = extinction() * slope;
    3.0 * h * h / 8.0 * change * change + 0.5_f64.powi(11) + 3.0 * h * change / 512.0
}

#[test]
fn a_grid_of_light_is_as_near_as_its_points_lie() {
    let params = format!(r#""light_1": [{}, {}, {}, 0]"#, SUN.x, SUN.y, SUN.z);
    let stage = plane("light_volume", &params);
    for backend in adapters() {
        for resolution in [17_u32, 40] {
            let set = format!("image.light_resolution={resolution}");
            let h = 16.0 / f64::from(resolution - 1);
            let mut checked = 0;
            for (point, value) in plane_points(&stage, &[&set], &backend) {
                let (direction, length, faces) = way(point, SUN, false);
                let mut sorted = faces.to_array();
                sorted.sort_by(f64::total_cmp);
                let slope = 1.0 / direction.min_element();
                // A cell's corner may leave by another face: the distances to both change by as much in it.
                if sorted[1] - sorted[0] < 2.0 * 3.0_f64.sqrt() * h * slope {
                    continue;
                }
                checked += 1;
                let expected = direction.z * (-extinction() * length).exp();
                let face = if faces.z == length {
                    direction.z
                } else {
                    slope.recip()
                };
                let bound = grid_bound(h, face.recip());
                assert!(
                    (value - expected).abs() < bound,
                    "{backend} {resolution} {point}: {value}, not {expected}"
                );
            }
            assert!(checked > 30, "{resolution}: {checked}");
        }
    }
}

#[test]
fn lights_at_points_are_in_both_spaces_and_inside_of_the_volume() {
    // In halves of the smallest side from the middle: 8 voxels each.
    for (given, is_inside) in [([0.2, 0.1, 2.0], false), ([0.3, -0.2, 0.6], true)] {
        let world = DVec3::splat(8.0) + 8.0 * DVec3::from_array(given);
        let in_box = format!(
            "image.light_1=[{}, {}, {}, 1]",
            given[0], given[1], given[2]
        );
        let in_world = format!("image.light_1=[{}, {}, {}, 1]", world.x, world.y, world.z);
        let stage = plane("transmittance", "");
        for backend in adapters() {
            let shown = plane_points(&stage, &[&in_box], &backend);
            let sets = ["image.space=world", in_world.as_str()];
            assert_eq!(plane_points(&stage, &sets, &backend).len(), shown.len());
            for (seen, also) in shown.iter().zip(plane_points(&stage, &sets, &backend)) {
                let (direction, length, _) = way(seen.0, world, true);
                assert_eq!(
                    is_inside,
                    box_interval((seen.0, direction), DVec3::ZERO, HIGH)
                        .is_some_and(|(_, far)| far > length + 1e-9)
                );
                let expected = direction.z * (-extinction() * length).exp();
                assert!(
                    (seen.1 - expected).abs() < 1e-4,
                    "{backend} {seen:?}, not {expected}"
                );
                assert!(
                    (also.1 - expected).abs() < 1e-4,
                    "{backend} {also:?}, not {expected}"
                );
            }
            // By the grid. Distances to a point outside change by at most 1/cos and 1 beside that.
            if !is_inside {
                let sets = [
                    in_box.as_str(),
                    "image.slots.shadow=light_volume",
                    "image.light_resolution=40",
                ];
                let mut checked = 0;
                for (point, value) in plane_points(&stage, &sets, &backend) {
                    let (direction, length, faces) = way(point, world, true);
                    if faces.x.min(faces.y) < faces.z + 4.0 {
                        continue;
                    }
                    checked += 1;
                    let expected = direction.z * (-extinction() * length).exp();
                    let bound = grid_bound(16.0 / 39.0, 1.0 + 1.0 / direction.z);
                    assert!(
                        (value - expected).abs() < bound,
                        "{backend} {point}: {value}, not {expected}"
                    );
                }
                assert!(checked > 60, "{checked}");
            }
        }
    }
}

#[test]
fn what_is_clipped_away_attenuates_nothing() {
    let params = format!(r#""light_1": [{}, {}, {}, 0]"#, SUN.x, SUN.y, SUN.z);
    for (shadow, bound) in [
        ("transmittance", 1e-4),
        ("light_volume", grid_bound(0.25, 1.2)),
    ] {
        let stage = plane(shadow, &params).with("slot/clip/mine.wgsl", clip_below(11.0));
        for backend in adapters() {
            let mut checked = 0;
            for (point, value) in plane_points(&stage, &["image.slots.clip=mine"], &backend) {
                let (direction, _, faces) = way(point, SUN, false);
                let length = 3.0 / direction.z;
                if faces.min_element() < length + 3.0 {
                    continue;
                }
                checked += 1;
                let expected = direction.z * (-extinction() * length).exp();
                assert!(
                    (value - expected).abs() < bound,
                    "{backend} {shadow} {point}: {value}, not {expected}"
                );
            }
            assert!(checked > 60, "{checked}");
        }
    }
}

#[test]
fn lights_add_up() {
    let lights = [
        r#""light_1": [0.5, 0.3, 1, 0], "light_1_color": [1, 0.5, 0.2]"#,
        r#""light_2": [-0.3, 0.3, 2, 1], "light_2_color": [0.2, 0.5, 1]"#,
        r#""light_3": [-0.6, 0.1, 0.5, 0], "light_3_color": [0.3, 0.7, 0.1]"#,
        r#""light_4": [0, 0, 0, 0], "light_4_color": [0.1, 0.2, 0.4]"#,
    ];
    for shadow in ["transmittance", "light_volume"] {
        let stage = plane(shadow, &format!(r#""lights": 4, {}"#, lights.join(", ")));
        let dark = |lit: usize| -> Vec<String> {
            (0..4)
                .filter(|other| *other != lit)
                .map(|other| format!("image.light_{}_color=[0, 0, 0]", other + 1))
                .collect()
        };
        for backend in adapters() {
            let all = render(&stage, &[], &backend, [24, 24]).0;
            let alone: Vec<_> = (0..4)
                .map(|lit| {
                    let sets = dark(lit);
                    let sets: Vec<&str> = sets.iter().map(String::as_str).collect();
                    render(&stage, &sets, &backend, [24, 24]).0
                })
                .collect();
            for (index, pixel) in all.color.iter().enumerate() {
                for (channel, value) in pixel.iter().take(3).enumerate() {
                    let sum: f32 = alone.iter().map(|one| one.color[index][channel]).sum();
                    assert!((value - sum).abs() < 1e-5, "{shadow} {backend} {index}");
                }
            }
            // Each by its own way: the grid's channels are not exchanged.
            for (lit, seen) in alone.iter().enumerate() {
                let mut sets = dark(lit);
                sets.push("image.slots.shadow=transmittance".to_owned());
                let sets: Vec<&str> = sets
                    .iter()
                    .filter(|set| !set.contains("resolution"))
                    .map(String::as_str)
                    .collect();
                let along_rays = render(&stage, &sets, &backend, [24, 24]).0;
                let pairs = along_rays.color.iter().zip(&seen.color);
                let sum: f32 = pairs.map(|(a, b)| (a[1] - b[1]).abs()).sum();
                assert!(sum / 576.0 < 2e-3, "{shadow} {backend} light {lit}: {sum}");
            }
            for one in &alone {
                assert!(
                    one.color.iter().any(|pixel| pixel[2] > 0.02),
                    "{shadow}: a light does nothing"
                );
            }
        }
    }
}

/// The red of a volume of one medium, whose every point is lit through it: ∫ exp(-τ s) τ N·L exp(-τ d(s)) ds.
fn volume_truth(ray: (DVec3, DVec3)) -> Option<f64> {
    let (near, far) = box_interval(ray, DVec3::ZERO, HIGH)?;
    let steps = 4000;
    let width = (far - near) / f64::from(steps);
    let sum: f64 = (0..steps)
        .map(|step| {
            let along = (f64::from(step) + 0.5) * width;
            let (direction, length, _) = way(ray.0 + (near + along) * ray.1, SUN, false);
            direction.z * (-extinction() * (along + length)).exp()
        })
        .sum();
    Some(sum * extinction() * width)
}

#[test]
fn a_volume_shades_itself() {
    let slots = r#"{ "light": "phong", "shadow": "transmittance", "gradient": "central" }"#;
    let params = format!(
        r#"{{ "ambient": 0, "diffuse": 1, "specular": 0, "step": 0.5, "early_termination": 0,
             "light_1": [{}, {}, {}, 0] }}"#,
        SUN.x, SUN.y, SUN.z
    );
    let stage = ramp()
        .with(
            "transfer.ron",
            "(points: [(at: 0.5, color: (1, 1, 1), opacity: 0.1)])",
        )
        .with("graph.ron", graph(VOLUME, LOOK, "{}", slots, &params));
    for backend in adapters() {
        for form in STAGES {
            let form = format!("image.stage={form}");
            for (set, bound) in [
                // The midpoint rule in steps of 0.5: (τ (1 + 1/0.26) 0.5)² / 24, of a color below 1.
                ("image.slots.shadow=transmittance", 3e-3),
                // Kinks where rays leave by another face, in the cells that they go through: a quarter of h times the
                // change of T there, on a share of the ray.
                ("image.slots.shadow=light_volume", 6e-3),
            ] {
                let drawn = render(&stage, &[&form, set], &backend, [24, 24]);
                let (mut met, mut worst) = (0, 0.0_f64);
                for (ray, value) in pixels(&drawn) {
                    if let Some(expected) = volume_truth(ray) {
                        met += 1;
                        worst = worst.max((value - expected).abs());
                    }
                }
                assert!(
                    worst < bound && met > 250,
                    "{backend} {form} {set}: {worst} over {met}"
                );
            }
            // Without shadows it is brighter by far more than the bound.
            let drawn = render(
                &stage,
                &[&form, "image.slots.shadow=none"],
                &backend,
                [24, 24],
            );
            assert!(
                pixels(&drawn)
                    .any(|(ray, value)| volume_truth(ray).is_some_and(|truth| value > truth + 0.1))
            );
        }
    }
}

#[test]
fn the_grid_is_made_again_when_what_it_depends_on_changes_and_no_sooner() {
    let stage = plane("light_volume", r#""light_1": [0.5, 0.3, 1, 0]"#);
    let look = |azimuth: f64| CameraDesc {
        pose: Pose::Orbit {
            azimuth,
            elevation: 50.0,
            roll: 0.0,
            distance: None,
            target: None,
            zoom: 1.0,
        },
        ..CameraDesc::default()
    };
    for backend in adapters() {
        let mut session = stage.open("graph.ron", &[], &backend, [24, 24]).unwrap();
        let first = session.draw().unwrap();
        assert!(
            first.ran().contains(&"image.light_volume"),
            "{:?}",
            first.ran()
        );
        // From here on in perspective.
        session.set_camera(&look(10.0));
        assert!(
            !session
                .draw()
                .unwrap()
                .ran()
                .contains(&"image.light_volume")
        );
        session.set_camera(&look(20.0));
        assert_eq!(
            session.draw().unwrap().ran(),
            ["image"],
            "{backend}: the camera"
        );
        let mut change = |set: &str| -> Vec<String> {
            let change = Change::Set(vec![ParamOverride::parse(set).unwrap()]);
            match session.apply(&change).unwrap() {
                Outcome::Drawn(drawn) => drawn
                    .report
                    .frame
                    .ran()
                    .iter()
                    .map(|name| (*name).to_owned())
                    .collect(),
                Outcome::Unchanged => Vec::new(),
            }
        };
        assert_eq!(change("image.ambient=0.2"), ["image"], "{backend}");
        let both = ["image.light_volume", "image"];
        assert_eq!(change("image.light_1=[0.4, 0.3, 1, 0]"), both, "{backend}");
        assert_eq!(change("image.shadow_step=0.5"), both, "{backend}");
        assert_eq!(change("image.light_resolution=32"), both, "{backend}");
        // At the eye, the light moves with it.
        assert_eq!(change("image.light_1=[0, 0, 0, 0]"), both, "{backend}");
        session.set_camera(&look(30.0));
        assert_eq!(
            session.draw().unwrap().ran(),
            both,
            "{backend}: the camera has the light"
        );
    }
}

/// Rays towards lights leap by what the transfer function shows alone: how the eye's rays step is nothing to them.
#[test]
fn the_grid_stays_where_only_the_walk_of_the_eye_changes() {
    let clear_below = "(domain: data(from: 0, to: 16), points: [(at: 9, color: (1, 1, 1), opacity: 0), (at: 16, color: (1, 1, 1), opacity: 0.3)])";
    let stage = ramp().with("half.ron", clear_below).with(
        "graph.ron",
        r#"(
    sources: { "v": volume(path: "v_17x17x17_float32.raw"), "t": transfer(path: "half.ron") },
    camera: orbit(azimuth: 20, elevation: 30),
    nodes: {
        "box":   (kind: "proxy_box", in: { "volume": "v" }),
        "image": (kind: "raycast", in: { "volume": "v", "transfer": "t", "rays": "box" },
                  slots: { "classify": "post", "light": "phong", "shadow": "light_volume" },
                  params: { "light_1": [0.5, 0.3, 1, 0] }),
    },
    outputs: { "color": "image.color" },
)"#,
    );
    for backend in adapters() {
        for (technique, traverse, sets) in [
            ("dvr", "skip", &["image.step=0.5"][..]),
            (
                "dvr",
                "adaptive",
                &["image.step=0.5", "image.step_tolerance=0.02"],
            ),
            (
                "isosurface_dvr",
                "skip",
                &["image.step=0.5", "image.isovalue=7"],
            ),
            (
                "isosurface_dvr",
                "adaptive",
                &["image.step=0.5", "image.isovalue=7"],
            ),
        ] {
            let slots = [
                format!("image.slots.technique={technique}"),
                format!("image.slots.traverse={traverse}"),
            ];
            let slots: Vec<&str> = slots.iter().map(String::as_str).collect();
            let mut session = stage.open("graph.ron", &slots, &backend, [24, 24]).unwrap();
            let first = session.draw().unwrap();
            assert!(
                first.ran().contains(&"image.light_volume"),
                "{:?}",
                first.ran()
            );
            for set in sets {
                let change = Change::Set(vec![ParamOverride::parse(set).unwrap()]);
                let Outcome::Drawn(drawn) = session.apply(&change).unwrap() else {
                    panic!("{technique} {traverse} {set}: drawn");
                };
                let ran = drawn.report.frame.ran();
                assert!(
                    !ran.contains(&"image.light_volume"),
                    "{backend}, {technique} {traverse} {set}: {ran:?}"
                );
            }
        }
    }
}

#[test]
fn a_light_at_the_eye_shines_from_there() {
    // Perspective from inside of the box: what is behind the eye takes no light.
    let stage = plane("light_volume", "");
    let text = std::fs::read_to_string(stage.path().join("graph.ron")).unwrap();
    let eye = DVec3::new(6.0, 5.0, 13.0);
    let inside = "look_at(eye: (6, 5, 13), target: (9, 9, 8), fov_y: 60)";
    stage.write("graph.ron", text.replace(LOOK, inside));
    for backend in adapters() {
        for (shadow, bound) in [("transmittance", 1e-4), ("light_volume", 2e-2)] {
            let set = format!("image.slots.shadow={shadow}");
            let sets = [set.as_str(), "image.light_resolution=48"];
            let sets = if shadow == "light_volume" {
                &sets[..]
            } else {
                &sets[..1]
            };
            let (picture, view) = render(&stage, sets, &backend, [24, 24]);
            let mut seen = 0;
            for index in 0..24 * 24 {
                let ray = ray(&view, index % 24, index / 24);
                let distance = (8.0 - ray.0.z) / ray.1.z;
                let point = ray.0 + distance * ray.1;
                if distance <= 0.0 || (point - 8.0).abs().max_element() > 7.0 {
                    continue;
                }
                seen += 1;
                let expected = -ray.1.z * (-extinction() * point.distance(eye)).exp();
                let value = f64::from(picture.color[index as usize][0]);
                assert!(
                    (value - expected).abs() < bound,
                    "{backend} {shadow} {point}: {value}, not {expected}"
                );
            }
            assert!(seen > 100, "{seen}");
        }
    }
}
