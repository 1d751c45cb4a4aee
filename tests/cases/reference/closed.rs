//! The reference against closed forms, and against the harness's own roots and extremes. Bounds are its tolerance, 1e-9,
//! and ten roundings of distances (1e-12) where there is none.

use glam::DVec3;
use volgraph_tests::trilinear::Trilinear;
use volgraph_tests::truth::truth;
use volgraph_tests::{Stage, box_interval, graph, ray};

use crate::segments;

const SIZE: [u32; 2] = [20, 16];
const CAMERAS: [&str; 3] = [
    "orbit(azimuth: 33, elevation: 21, fov_y: 40)",
    "orbit(azimuth: 33, elevation: 21, projection: orthographic)",
    "look_at(eye: (3.2, 2.1, 4.4), target: (0.0, 1.0, 0.0), fov_y: 70)",
];
/// A background of nothing: what is seen is the volume's.
const CLEAR: &str = r#"{ "color": [0, 0, 0, 0] }"#;
const LOW: DVec3 = DVec3::splat(-0.5);
const HIGH: DVec3 = DVec3::splat(7.5);

/// A volume of 8 voxels to each side, in the world where its indices are.
fn stage(camera: &str, slots: &str, params: &str, value: impl Fn(u32, u32, u32) -> f32) -> Stage {
    let volume = r#"path: "v_8x8x8_float32.raw""#;
    Stage::new()
        .with_floats("v", [8, 8, 8], value)
        .with("transfer.ron", "(domain: data, reference_length: (world: 1), color: (1, 0.5, 0.25), extinction: [(0, 0), (1, 0.4)])")
        .with("graph.ron", graph(volume, camera, CLEAR, &format!("{{ {slots} }}"), &format!("{{ {params} }}")))
}

/// The largest error of any channel, over the pixels whose ray meets the box; `expected` is of a ray and its interval.
fn worst(
    stage: &Stage,
    sets: &[&str],
    expected: impl Fn((DVec3, DVec3), (f64, f64)) -> [f64; 4],
) -> f64 {
    let (truth, view) = truth(stage, sets, SIZE);
    let (mut worst, mut met) = (0.0_f64, 0);
    for y in 0..SIZE[1] {
        for x in 0..SIZE[0] {
            let seen = truth.rendered.color[(y * SIZE[0] + x) as usize];
            let ray = ray(&view, x, y);
            let expected = match box_interval(ray, LOW, HIGH) {
                Some(interval) => {
                    met += 1;
                    expected(ray, interval)
                }
                None => [0.0; 4],
            };
            for (seen, expected) in seen.iter().zip(expected) {
                let off = (seen - expected).abs();
                assert!(off.is_finite(), "{x} {y}: {seen}");
                worst = worst.max(off);
            }
        }
    }
    assert!(met > 40, "the box is hardly seen: {met}");
    worst
}

/// Matter of one colour and an optical depth.
fn seen(depth: f64) -> [f64; 4] {
    let opacity = -(-depth).exp_m1();
    [opacity, 0.5 * opacity, 0.25 * opacity, opacity]
}

#[test]
fn one_large_value_alone_has_a_range() {
    // The only value is the range's start, however large; one more than 1e20 is 1e20 again, and a range of nothing has no
    // places.
    let transfer = "(domain: range, reference_length: (world: 1), color: (1, 0.5, 0.25), extinction: [(0, 0.1), (1, 0.4)])";
    let stage = stage(CAMERAS[0], "", "", |_, _, _| 1e20).with("transfer.ron", transfer);
    let absorbed = |_, (near, far)| seen(0.1 * (far - near));
    assert!(worst(&stage, &[], absorbed) < 1e-9);
    // The isovalue half-way up is above it.
    let nothing = |_, _| [0.0; 4];
    let surface = ["image.slots.technique=isosurface"];
    assert_eq!(worst(&stage, &surface, nothing), 0.0);
}

#[test]
fn what_a_clip_leaves_of_a_constant_volume_is_a_shorter_way() {
    let extinction = 0.2;
    // How long a ray is inside of each shape, in closed form; the box is 8 to each side, its middle at 3.5.
    type Inside = fn((DVec3, DVec3), (f64, f64)) -> f64;
    let shapes: [(&str, &str, Inside); 4] = [
        ("none", "", |_, (near, far)| far - near),
        (
            "planes",
            r#""planes": 1, "plane_1": [1, 2, 0.5, 0.1]"#,
            |(origin, direction), (near, far)| {
                let normal = DVec3::new(1.0, 2.0, 0.5).normalize();
                let height = normal.dot(DVec3::splat(3.5)) + 0.4;
                let crossing = (height - normal.dot(origin)) / normal.dot(direction);
                if normal.dot(direction) > 0.0 {
                    far - crossing.clamp(near, far)
                } else {
                    crossing.clamp(near, far) - near
                }
            },
        ),
        (
            "box",
            r#""clip_low": [0.25, 0, 0.125], "clip_high": [0.75, 0.5, 1]"#,
            |ray, _| {
                let (low, high) = (DVec3::new(1.5, -0.5, 0.5), DVec3::new(5.5, 3.5, 7.5));
                box_interval(ray, low, high).map_or(0.0, |(near, far)| far - near)
            },
        ),
        (
            "sphere",
            r#""clip_radius": 0.6, "clip_centre": [0.25, 0, 0]"#,
            |(origin, direction), (near, far)| {
                let from = origin - DVec3::new(4.5, 3.5, 3.5);
                let middle = -from.dot(direction);
                let square = 2.4 * 2.4 - (from + middle * direction).length_squared();
                let half = square.max(0.0).sqrt();
                (middle + half).clamp(near, far) - (middle - half).clamp(near, far)
            },
        ),
    ];
    for camera in CAMERAS {
        for (clip, params, inside) in shapes {
            let stage = stage(
                camera,
                &format!(r#""clip": "{clip}""#),
                params,
                |_, _, _| 0.5,
            );
            let error = worst(&stage, &[], |ray, interval| {
                seen(extinction * inside(ray, interval))
            });
            assert!(error < 2e-9, "{clip} {camera}: {error:e}");
            if clip == "none" {
                continue;
            }
            for method in ["accurate", "naive"] {
                let method = format!("image.clip_method={method}");
                let sets = ["image.clip_keep=outside", &method];
                let error = worst(&stage, &sets, |ray, interval| {
                    seen(extinction * (interval.1 - interval.0 - inside(ray, interval)))
                });
                assert!(error < 2e-9, "outside of {clip} {camera}: {error:e}");
            }
        }
    }
}

#[test]
fn a_ramp_has_the_closed_forms_of_its_integrals() {
    // From 0 to 1 between the middles of the outer voxels, and flat beyond.
    let at = |x: f64| (x / 7.0).clamp(0.0, 1.0);
    let up_to = |x: f64| {
        let inside = x.clamp(0.0, 7.0);
        inside * inside / 14.0 + (x - 7.0).max(0.0)
    };
    let integral = |(origin, direction): (DVec3, DVec3), (near, far): (f64, f64)| {
        let (from, to) = (origin.x + near * direction.x, origin.x + far * direction.x);
        (up_to(to) - up_to(from)) / direction.x
    };
    let ramp = |x: u32, _: u32, _: u32| x as f32 / 7.0;
    for camera in CAMERAS {
        let dvr = stage(camera, "", "", ramp);
        // The volume has f32 samples: a seventh is rounded by 3e-8.
        let error = worst(&dvr, &[], |ray, interval| {
            seen(0.4 * integral(ray, interval))
        });
        assert!(error < 1e-6, "dvr {camera}: {error:e}");

        let ends = |(origin, direction): (DVec3, DVec3), (near, far): (f64, f64)| {
            [near, far].map(|distance| at(origin.x + distance * direction.x))
        };
        let grey = |share: f64| [share; 4];
        for (technique, pick) in [
            ("mip", f64::max as fn(f64, f64) -> f64),
            ("minip", f64::min),
        ] {
            let stage = stage(camera, &format!(r#""technique": "{technique}""#), "", ramp);
            let error = worst(&stage, &[], |ray, interval| {
                let [a, b] = ends(ray, interval);
                grey(pick(a, b))
            });
            assert!(error < 1e-7, "{technique} {camera}: {error:e}");
        }
        let average = stage(camera, r#""technique": "average""#, "", ramp);
        let error = worst(&average, &[], |ray, interval| {
            grey(integral(ray, interval) / (interval.1 - interval.0))
        });
        assert!(error < 1e-7, "average {camera}: {error:e}");
        // Only what is above the window's low end absorbs: the ramp's second half, as twice the ramp less 1.
        let xray = stage(
            camera,
            r#""technique": "xray""#,
            r#""window_low": 0.5, "absorption": 1.5"#,
            ramp,
        );
        let error = worst(&xray, &[], |(origin, direction), (near, far)| {
            let above = |x: f64| {
                let inside = x.clamp(3.5, 7.0) - 3.5;
                inside * inside / 3.5 / 2.0 + (x - 7.0).max(0.0)
            };
            let (from, to) = (origin.x + near * direction.x, origin.x + far * direction.x);
            let sum = (above(to) - above(from)) / direction.x;
            grey(-(-1.5 * sum / 4.0_f64).exp_m1())
        });
        assert!(error < 1e-7, "xray {camera}: {error:e}");
    }
}

/// Blinn-Phong of the default material: 0.3, 0.7, 0.25, 32.
fn phong(normal: DVec3, to_light: DVec3, to_eye: DVec3) -> (f64, f64) {
    let diffuse = normal.dot(to_light);
    if diffuse <= 0.0 {
        return (0.3, 0.0);
    }
    let half = (to_light + to_eye + 1e-6 * normal).normalize();
    (0.3 + 0.7 * diffuse, 0.25 * normal.dot(half).powf(32.0))
}

#[test]
fn light_on_a_ramp_is_the_same_all_along_the_ray() {
    // One normal everywhere, whatever the gradient is made of: a factor of the colour, and a highlight.
    let light = DVec3::new(0.4, -0.7, 0.5);
    let ramp = |x: u32, _: u32, _: u32| 0.1 + 0.1 * x as f32;
    for gradient in ["stored", "central", "tricubic"] {
        for light_slot in ["phong", "phong_ends"] {
            let slots = format!(r#""light": "{light_slot}", "gradient": "{gradient}""#);
            let params = r#""lights": 2, "light_1": [0.4, -0.7, 0.5, 0], "light_2": [0, 0, 0, 0], "light_2_color": [0, 0, 0.5]"#;
            for camera in CAMERAS {
                let lit = stage(camera, &slots, params, ramp);
                let unlit = stage(camera, "", "", ramp);
                let (plain, _) = truth(&unlit, &[], SIZE);
                let (seen, view) = truth(&lit, &[], SIZE);
                for (at, (plain, seen)) in
                    (0..).zip(plain.rendered.color.iter().zip(&seen.rendered.color))
                {
                    let to_eye = -ray(&view, at % SIZE[0], at / SIZE[0]).1;
                    let normal = DVec3::X * to_eye.x.signum();
                    let (a, shine) = phong(normal, light.normalize(), to_eye);
                    let (b, eye_shine) = phong(normal, to_eye, to_eye);
                    let blue = a + 0.5 * (b - 0.3);
                    let opacity = plain[3];
                    let expected = [
                        opacity * (a + shine),
                        opacity * (0.5 * a + shine),
                        opacity * (0.25 * blue + shine + 0.5 * eye_shine),
                        opacity,
                    ];
                    for (seen, expected) in seen.iter().zip(expected) {
                        // The cube of the B-spline's edge is flat only at the very faces.
                        assert!(
                            (seen - expected).abs() < 4e-9,
                            "{gradient} {light_slot} {camera} {at}: {seen} {expected}"
                        );
                    }
                }
            }
        }
    }
}

/// Distances from the middle at the samples: a solid whose surface has a cubic's roots.
fn ball(x: u32, y: u32, z: u32) -> f32 {
    let from = DVec3::new(f64::from(x), f64::from(y), f64::from(z)) - DVec3::new(3.4, 3.6, 3.3);
    (from.length() / 4.0) as f32
}

#[test]
fn the_isosurface_of_a_distance_is_where_the_harness_finds_it() {
    let field = Trilinear::new([8, 8, 8], ball);
    for (camera, solid) in [
        (CAMERAS[0], "below"),
        (CAMERAS[1], "below"),
        (CAMERAS[0], "above"),
    ] {
        let params = format!(
            r#""isovalue": 0.8, "isovalue_unit": "data", "solid": "{solid}", "cut_faces": "open""#
        );
        let slots = r#""technique": "isosurface", "light": "phong", "gradient": "analytic""#;
        let stage = stage(camera, slots, &params, ball);
        let (truth, view) = truth(&stage, &[], SIZE);
        let mut met = 0;
        for at in 0..SIZE[0] * SIZE[1] {
            let ray = ray(&view, at % SIZE[0], at / SIZE[0]);
            let crossings = box_interval(ray, LOW, HIGH)
                .map(|interval| field.crossings(ray, interval, 0.8))
                .unwrap_or_default();
            let depth = truth.rendered.depth[at as usize];
            let Some((first, slope)) = crossings.first() else {
                assert_eq!(depth, f64::INFINITY, "{camera} {solid} {at}");
                continue;
            };
            met += 1;
            assert!(
                (depth - first).abs() < 1e-9 / slope.abs().min(1.0),
                "{camera} {at}: {depth} {first}"
            );
            let normal = DVec3::from_array(truth.rendered.normal[at as usize]);
            assert!((normal.length() - 1.0).abs() < 1e-12 && normal.dot(ray.1) <= 0.0);
            // The ball's own normal, but for the bend of the trilinear field in a voxel.
            let place = ray.0 + depth * ray.1 - DVec3::new(3.4, 3.6, 3.3);
            assert!(
                normal.dot(place.normalize()).abs() > 0.8,
                "{camera} {at}: {normal}"
            );
            // A light at the eye.
            let (share, shine) = phong(normal, -ray.1, -ray.1);
            let red = truth.rendered.color[at as usize][0];
            assert!((red - (0.8 * share + shine)).abs() < 1e-12, "{camera} {at}");
        }
        assert!(met > 30, "{met}");
    }
}

#[test]
fn extremes_and_layers_are_those_of_the_harness() {
    // Noise: a ray may cross a level three times in one cell.
    let noise = |x: u32, y: u32, z: u32| {
        ((x + 8 * y + 64 * z).wrapping_mul(2_654_435_761) >> 16) as f32 / 65536.0
    };
    let field = Trilinear::new([8, 8, 8], noise);
    for camera in CAMERAS {
        let window = r#""window_unit": "data", "window_high": 2"#;
        let mip = stage(camera, r#""technique": "mip""#, window, noise);
        let error = worst(&mip, &[], |ray, interval| {
            [0.5 * field.largest(ray, interval).0; 4]
        });
        assert!(error < 1e-12, "{camera}: {error:e}");
        // All crossings in order, each with its own colour: red over blue and again.
        let layers = r#""isovalue_unit": "data", "surfaces": 2, "isovalue_1": 0.7, "color_1": [1, 0, 0, 0.25],
            "isovalue_2": 0.45, "color_2": [0, 0, 1, 0.5]"#;
        let stage = stage(
            camera,
            r#""technique": "isosurfaces_translucent""#,
            layers,
            noise,
        );
        let error = worst(&stage, &[], |ray, interval| {
            let mut met = Vec::new();
            for (level, color, opacity) in
                [(0.7, [1.0, 0.0, 0.0], 0.25), (0.45, [0.0, 0.0, 1.0], 0.5)]
            {
                let crossings = field.crossings(ray, interval, level);
                met.extend(crossings.iter().map(|(at, _)| (*at, color, opacity)));
            }
            met.sort_by(|a, b| a.0.total_cmp(&b.0));
            let (mut sum, mut through) = (DVec3::ZERO, 1.0);
            for (_, color, opacity) in met {
                sum += through * opacity * DVec3::from_array(color);
                through *= 1.0 - opacity;
            }
            [sum.x, sum.y, sum.z, 1.0 - through]
        });
        assert!(error < 1e-12, "{camera}: {error:e}");
    }
}

#[test]
fn two_labels_are_two_slabs_blocky_or_smooth() {
    // Red up to x = 3.5, which is the face between voxels and where memberships are equal; blue behind.
    let meaning = r#"(segments: [(label: 1, transfer: "blue.ron")])"#;
    for camera in segments::CAMERAS {
        let stage = segments::stage(|x, _, _| u32::from(x > 3), meaning)
            .with("graph.ron", segments::graph("(1, 1, 1)", camera, "", ""));
        for boundary in ["blocky", "smooth"] {
            for hidden in [false, true] {
                if hidden {
                    stage.write("segments.ron", "(segments: [(label: 1, visible: false)])");
                } else {
                    stage.write("segments.ron", meaning);
                }
                let set = format!("image.label_boundary={boundary}");
                let error = worst(&stage, &[&set], |(origin, direction), (near, far)| {
                    // A ray that goes away from the plane has its first label to its end.
                    let crossing = (3.5 - origin.x) / direction.x;
                    let crossing = if crossing > near {
                        crossing.min(far)
                    } else {
                        far
                    };
                    let starts_red = origin.x + near * direction.x < 3.5;
                    let (first, second) = (crossing - near, far - crossing);
                    let blue = if hidden { 0.0 } else { 0.23 };
                    let [a, b] = if starts_red {
                        [0.11, blue]
                    } else {
                        [blue, 0.11]
                    };
                    let (front, back) = ((-a * first).exp(), (-b * second).exp());
                    let shows = [1.0 - front, front * (1.0 - back)];
                    let [red, other] = if starts_red {
                        shows
                    } else {
                        [shows[1], shows[0]]
                    };
                    [red, 0.0, other, 1.0 - front * back]
                });
                assert!(error < 2e-9, "{boundary} {camera} {hidden}: {error:e}");
            }
        }
    }
}
