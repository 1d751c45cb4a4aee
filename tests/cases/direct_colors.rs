//! Volumes whose voxels have colours of their own: drawn as they are, and only where there are any.

use glam::DVec3;
use volgraph_picture::srgb::linear_from_srgb;
use volgraph_tests::slabs::slabs;
use volgraph_tests::{STAGES, Stage, adapters, box_interval, graph, ray, render};

const DIMS: [u32; 3] = [6, 5, 4];

fn color([x, y, z]: [u32; 3]) -> [u8; 3] {
    [x * 43 + z * 11, 250 - y * 60, (x + 2 * y + 5 * z) * 9]
        .map(|value| u8::try_from(value).unwrap())
}

/// An NRRD file with red, green and blue per voxel.
fn file() -> Vec<u8> {
    let [nx, ny, nz] = DIMS;
    let mut bytes = format!(
        "NRRD0004\ntype: uchar\ndimension: 4\nsizes: 3 {nx} {ny} {nz}\nkinds: RGB-color domain domain domain\nencoding: raw\n\n"
    )
    .into_bytes();
    for z in 0..nz {
        for y in 0..ny {
            for x in 0..nx {
                bytes.extend(color([x, y, z]));
            }
        }
    }
    bytes
}

/// Linear light at a point of index space, trilinear between voxels.
fn light(point: DVec3) -> [f64; 3] {
    let last = DVec3::from_array(DIMS.map(f64::from)) - 1.0;
    let place = point.clamp(DVec3::ZERO, last);
    let low = place.floor().min(last);
    let mut sum = [0.0; 3];
    for corner in 0..8_u32 {
        let pick = |axis: usize| {
            let part = place[axis] - low[axis];
            let high = (low[axis] + 1.0).min(last[axis]) as u32;
            if corner >> axis & 1 == 1 {
                (high, part)
            } else {
                (low[axis] as u32, 1.0 - part)
            }
        };
        let [x, y, z] = [0, 1, 2].map(pick);
        for (sum, channel) in sum.iter_mut().zip(color([x.0, y.0, z.0])) {
            *sum += x.1 * y.1 * z.1 * linear_from_srgb(f64::from(channel) / 255.0);
        }
    }
    sum
}

fn stage(slots: &str) -> Stage {
    Stage::new()
        .with("v.nrrd", file())
        .with(
            "transfer.ron",
            "(domain: data, reference_length: (world: 1), color: (0, 1, 0), extinction: [(0.0, 0.3), (255.0, 0.3)])",
        )
        .with(
            "graph.ron",
            graph(
                r#"path: "v.nrrd""#,
                "orbit(azimuth: 33, elevation: 21, fov_y: 40)",
                "{ \"pattern\": \"uniform\", \"color\": [0.0, 0.0, 0.0, 0.0] }",
                slots,
                r#"{ "step": 0.1, "early_termination": 0.0 }"#,
            ),
        )
}

#[test]
fn colours_of_voxels_are_composited_as_they_are() {
    let stage = stage(r#"{ "colors": "volume" }"#);
    let low = DVec3::splat(-0.5);
    let high = DVec3::from_array(DIMS.map(f64::from)) - 0.5;
    for backend in adapters() {
        for form in STAGES {
            let set = format!("image.stage={form}");
            let (picture, view) = render(&stage, &[&set], &backend, [40, 32]);
            let (mut worst, mut met, mut hues) = (0.0_f64, 0, [0.0_f64; 3]);
            for y in 0..picture.height {
                for x in 0..picture.width {
                    let (origin, direction) = ray(&view, x, y);
                    let Some((near, far)) = box_interval((origin, direction), low, high) else {
                        continue;
                    };
                    let length = (far - near) / 400.0;
                    let expected = slabs((0..400).map(|part| {
                        let at = near + (f64::from(part) + 0.5) * length;
                        (light(origin + direction * at), 0.3 * length)
                    }));
                    let drawn = picture.color[(y * picture.width + x) as usize];
                    for (drawn, expected) in drawn.iter().zip(expected) {
                        worst = worst.max((f64::from(*drawn) - expected).abs());
                    }
                    for (hue, channel) in hues.iter_mut().zip(drawn) {
                        *hue = hue.max(f64::from(channel));
                    }
                    met += 1;
                }
            }
            // Half floats have eleven digits, filters of software drivers eight.
            assert!(worst <= 1.5e-3, "{backend} {form}: {worst}");
            assert!(
                met > 200 && hues.iter().all(|hue| *hue > 0.1),
                "{met} {hues:?}"
            );
        }
    }
}

#[test]
fn colours_that_are_not_there_are_refused_and_the_reference_says_what_it_does_not_compute() {
    let stage = stage(r#"{ "colors": "volume" }"#);
    let code = |sets: &[&str]| {
        let opened = stage.open("graph.ron", sets, &adapters()[0], [8, 8]);
        opened
            .err()
            .unwrap()
            .into_iter()
            .next()
            .unwrap()
            .code
            .to_string()
    };
    assert_eq!(code(&["volume.component=1"]), "no-colors");
    assert_eq!(code(&["image.renderer=software"]), "not-covered");
}
