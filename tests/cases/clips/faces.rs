//! How cut faces are lit, and where they are.

use glam::DVec3;
use volgraph_tests::{Stage, adapters, box_interval, graph, ray, render};

use super::PERSPECTIVE;

const SIZE: [u32; 2] = [40, 40];

/// Blinn-Phong by the default light at infinity: the factor of the colour, and what the highlight adds.
fn phong(normal: DVec3, direction: DVec3, light: DVec3) -> (f64, f64) {
    let light = light.normalize();
    let diffuse = normal.dot(light);
    if diffuse <= 0.0 {
        return (0.3, 0.0);
    }
    let half_way = (light - direction).normalize();
    (
        0.3 + 0.7 * diffuse,
        0.25 * normal.dot(half_way).max(0.0).powi(32),
    )
}

const LIGHT: DVec3 = DVec3::new(0.6, -0.5, 0.7);
const COLOR: [f64; 3] = [0.7, 0.4, 0.2];

/// A solid block that a clip shape cuts, lit from the side; `clip` is the source of a clip volume.
fn solid(camera: &str, technique: &str, clip: &str, params: &str) -> Stage {
    let own = if technique == "dvr" {
        r#""early_termination": 0.0"#
    } else {
        r#""surface_color": [0.7, 0.4, 0.2], "isovalue": 0.5, "isovalue_unit": "data""#
    };
    let params = format!(r#"{{ "light_1": [0.6, -0.5, 0.7, 0.0], {own}, {params} }}"#);
    let slots = format!(r#"{{ "technique": "{technique}", "clip": "{clip}", "light": "phong" }}"#);
    let text = graph(
        r#"path: "v_12x10x8_float32.raw", spacing: (1, 1.5, 2)"#,
        camera,
        r#"{ "color": [0, 0, 0, 0] }"#,
        &slots,
        &params,
    )
    .replace(
        "sources: {",
        &format!(r#"sources: {{ "clip": volume({CLIP}),"#),
    )
    .replace(
        r#""rays": "box""#,
        r#""rays": "box", "clip_volume": "clip""#,
    );
    Stage::new()
        .with_floats("v", [12, 10, 8], |_, _, _| 0.75)
        .with_floats("c", [9, 7, 8], |x, y, z| {
            SLOPE.dot(clip_world(x, y, z)) as f32
        })
        .with(
            "transfer.ron",
            "(points: [(at: 0.5, color: (0.7, 0.4, 0.2), opacity: 1)])",
        )
        .with("graph.ron", text)
}

/// The clip volume: a ramp, with voxels of its own, around the block.
const CLIP: &str = r#"path: "c_9x7x8_float32.raw", spacing: (3, 5, 4), origin: (-6, -8, -7)"#;
const SLOPE: DVec3 = DVec3::new(0.2, 0.3, -0.4);

fn clip_world(x: u32, y: u32, z: u32) -> DVec3 {
    DVec3::new(f64::from(x), f64::from(y), f64::from(z)) * DVec3::new(3.0, 5.0, 4.0)
        - DVec3::new(6.0, 8.0, 7.0)
}

/// The solid block's box.
const LOW: DVec3 = DVec3::new(-0.5, -0.75, -1.0);
const HIGH: DVec3 = DVec3::new(11.5, 14.25, 15.0);
/// The unit of `space: box`.
const HALF_SIDE: f64 = 6.0;

/// Where a ray meets a cut, and the normal there towards the eye; `None` where it enters through no cut.
type Meet = Box<dyn Fn((DVec3, DVec3)) -> Option<(f64, DVec3)>>;

/// The plane `n · p = d`, of which the side is kept that the normal points to.
fn meet_plane(normal: DVec3, distance: f64) -> Meet {
    Box::new(move |(origin, direction)| {
        let slope = normal.dot(direction);
        let cut = (distance - normal.dot(origin)) / slope;
        (slope > 0.0).then_some((cut, -normal))
    })
}

/// The wall of a sphere that is cut out.
fn meet_sphere(centre: DVec3, radius: f64) -> Meet {
    Box::new(move |(origin, direction)| {
        let middle = (centre - origin).dot(direction);
        let nearest = (origin + direction * middle - centre).length_squared();
        let half = (radius * radius - nearest).sqrt();
        let (near, _) = box_interval((origin, direction), LOW, HIGH)?;
        // Rays that enter the block inside of the sphere.
        let cut = middle + half;
        (middle - half < near - 0.01)
            .then(|| (cut, (centre - origin - direction * cut).normalize()))
    })
}

#[test]
fn a_cut_face_is_lit_by_the_normal_of_the_cut() {
    let centre = 0.5 * (LOW + HIGH);
    let plane = DVec3::new(-0.9, 0.5, -0.6).normalize();
    let slope = SLOPE.normalize();
    let hollow = DVec3::new(0.6, -1.0, 0.8);
    let behind = "orbit(azimuth: 213, elevation: -21, fov_y: 40)";
    let shapes: [(&str, &str, Meet, &str); 5] = [
        (
            "planes",
            r#""plane_1": [-0.9, 0.5, -0.6, 0.05]"#,
            meet_plane(plane, plane.dot(centre) + 0.05 * HALF_SIDE),
            PERSPECTIVE,
        ),
        (
            "box",
            r#""clip_low": [0, 0.35, 0], "clip_high": [1, 1, 1]"#,
            meet_plane(DVec3::Y, LOW.y + 0.35 * (HIGH.y - LOW.y)),
            PERSPECTIVE,
        ),
        (
            "sphere",
            r#""clip_centre": [0.6, -1.0, 0.8], "clip_radius": 0.9, "clip_keep": "outside""#,
            meet_sphere(centre + hollow * HALF_SIDE, 0.9 * HALF_SIDE),
            PERSPECTIVE,
        ),
        (
            "volume",
            r#""clip_isovalue": 0.3, "clip_isovalue_unit": "data""#,
            meet_plane(slope, 0.3 / SLOPE.length()),
            PERSPECTIVE,
        ),
        (
            "volume",
            r#""clip_isovalue": 0.3, "clip_isovalue_unit": "data", "clip_keep": "outside""#,
            meet_plane(-slope, -0.3 / SLOPE.length()),
            behind,
        ),
    ];
    for (clip, params, meet, camera) in shapes {
        // Any step: the first segments behind a cut are lit by it.
        for (technique, step) in [("dvr", 0.3), ("dvr", 4.0), ("isosurface", 1.0)] {
            let params = format!(r#""step": {step}, {params}"#);
            let stage = solid(camera, technique, clip, &params);
            for backend in adapters() {
                // The two forms run the same walk (see `agreement`).
                let (picture, view) = render(&stage, &[], &backend, SIZE);
                let depth = picture.depth.unwrap();
                let mut faces = 0;
                for (at, pixel) in (0..).zip(&picture.color) {
                    let line = ray(&view, at % SIZE[0], at / SIZE[0]);
                    let Some((near, far)) = box_interval(line, LOW, HIGH) else {
                        continue;
                    };
                    // Two voxels are opaque whatever the light; thinner slivers are not.
                    let Some((cut, normal)) =
                        meet(line).filter(|(cut, _)| *cut > near + 0.01 && *cut < far - 2.0)
                    else {
                        continue;
                    };
                    faces += 1;
                    let (share, highlight) = phong(normal, line.1, LIGHT);
                    for channel in 0..3 {
                        let expected = COLOR[channel] * share + highlight;
                        let error = (f64::from(pixel[channel]) - expected).abs();
                        assert!(
                            error < 2e-4,
                            "{clip} {technique} {step} {backend}: {pixel:?}, not {expected}"
                        );
                    }
                    if technique == "isosurface" {
                        let error = (f64::from(depth[at as usize]) - cut).abs();
                        assert!(error < 1e-4, "{clip} {backend}: depth {error}");
                    }
                }
                assert!(faces > 60, "{clip} {params}: {faces} pixels show the cut");
            }
        }
    }
}

#[test]
fn a_clear_cut_is_lit_by_its_normal_within_a_voxel_whatever_the_step() {
    let normal = DVec3::new(-0.9, 0.5, -0.6).normalize();
    let meet = meet_plane(normal, normal.dot(0.5 * (LOW + HIGH)) + 0.05 * HALF_SIDE);
    for step in [0.3, 0.7, 4.0] {
        let params = format!(r#""step": {step}, "plane_1": [-0.9, 0.5, -0.6, 0.05]"#);
        let stage = solid(PERSPECTIVE, "dvr", "planes", &params).with(
            "transfer.ron",
            "(points: [(at: 0.5, color: (0.7, 0.4, 0.2), opacity: 0.3)])",
        );
        for backend in adapters() {
            let (picture, view) = render(&stage, &[], &backend, SIZE);
            let mut faces = 0;
            for (at, pixel) in (0..).zip(&picture.color) {
                let line = ray(&view, at % SIZE[0], at / SIZE[0]);
                let Some((near, far)) = box_interval(line, LOW, HIGH) else {
                    continue;
                };
                let Some((cut, normal)) =
                    meet(line).filter(|(cut, _)| *cut > near + 0.01 && *cut < far - 0.01)
                else {
                    continue;
                };
                faces += 1;
                let through = |length: f64| 0.7_f64.powf(length);
                // The field is flat: behind the first voxel there is no surface, and no light.
                let skin = (far - cut).min(1.0);
                let (share, highlight) = phong(normal, line.1, LIGHT);
                for channel in 0..3 {
                    let face = (COLOR[channel] * share + highlight) * (1.0 - through(skin));
                    let expected = face + COLOR[channel] * (through(skin) - through(far - cut));
                    let error = (f64::from(pixel[channel]) - expected).abs();
                    assert!(error < 1e-4, "{step} {backend}: {pixel:?}, not {expected}");
                }
            }
            assert!(faces > 100, "{faces} pixels show the cut");
        }
    }
}

#[test]
fn a_curved_cut_is_where_the_interpolated_clip_volume_says() {
    // A sphere's distances in voxels three times as large as the block's: a cubic along each ray in each voxel.
    let stage = solid(PERSPECTIVE, "isosurface", "volume", r#""step": 1.0, "clip_isovalue": 2.0, "clip_isovalue_unit": "data", "clip_keep": "outside""#)
        .with_floats("c", [9, 7, 8], |x, y, z| {
            (8.0 - clip_world(x, y, z).distance(DVec3::new(7.0, 2.0, 7.0))) as f32
        });
    let sphere: Vec<f32> = (0..9 * 7 * 8)
        .map(|at| {
            (8.0 - clip_world(at % 9, at / 9 % 7, at / 63).distance(DVec3::new(7.0, 2.0, 7.0)))
                as f32
        })
        .collect();
    let field = |world: DVec3| {
        let at = ((world + DVec3::new(6.0, 8.0, 7.0)) / DVec3::new(3.0, 5.0, 4.0))
            .clamp(DVec3::ZERO, DVec3::new(8.0, 6.0, 7.0));
        let low = at.floor().min(DVec3::new(7.0, 5.0, 6.0));
        let part = at - low;
        let mut sum = 0.0;
        for corner in 0..8_u32 {
            let is_high = [corner & 1, corner >> 1 & 1, corner >> 2 & 1].map(f64::from);
            let index = low + DVec3::from_array(is_high);
            let weight: f64 = (0..3)
                .map(|axis| {
                    if is_high[axis] > 0.5 {
                        part[axis]
                    } else {
                        1.0 - part[axis]
                    }
                })
                .product();
            sum += weight * f64::from(sphere[(index.x + 9.0 * (index.y + 7.0 * index.z)) as usize]);
        }
        sum - 2.0
    };
    for backend in adapters() {
        let (picture, view) = render(&stage, &[], &backend, SIZE);
        let depth = picture.depth.unwrap();
        let (mut faces, mut worst) = (0, 0.0_f64);
        for (at, seen) in (0..).zip(&depth) {
            let (origin, direction) = ray(&view, at % SIZE[0], at / SIZE[0]);
            let Some((near, far)) = box_interval((origin, direction), LOW, HIGH) else {
                continue;
            };
            // Rays that enter where it is cut away; the first change of side is the face, unless it is a sliver.
            let value = |distance: f64| field(origin + direction * distance);
            if value(near) <= 1e-3 {
                continue;
            }
            let fine = (far - near) / 4096.0;
            let Some(first) = (1..4096).find(|turn| value(near + f64::from(*turn) * fine) < 0.0)
            else {
                continue;
            };
            let (mut a, mut b) = (
                near + f64::from(first - 1) * fine,
                near + f64::from(first) * fine,
            );
            for _ in 0..40 {
                let middle = 0.5 * (a + b);
                if value(middle) < 0.0 {
                    b = middle;
                } else {
                    a = middle;
                }
            }
            faces += 1;
            let error = (f64::from(*seen) - a).abs();
            worst = worst.max(error);
        }
        println!("{backend}: {worst:.1e} world units over {faces} pixels");
        assert!(faces > 60, "{faces} pixels show the cut");
        // The refinements leave a thousandth of a clip voxel, which is 3 to 5 world units wide.
        assert!(worst < 3e-3, "{backend}: {worst}");
    }
}
