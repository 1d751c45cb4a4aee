//! Layers beside the colour against geometry: positions, normals, samples, and what becomes of them in files.

use glam::DVec3;
use volgraph::Picture;
use volgraph_picture::SaveOptions;
use volgraph_tests::layers::{scalars, vectors};
use volgraph_tests::{STAGES, Stage, adapters, box_interval, graph, ray, render};

const OUTPUTS: &str = r#"outputs: { "color": "image.color", "normal": "image.normal", "place": "image.position",
                                     "samples": "image.samples", "label": "image.label" }"#;

/// A ramp along x in a box of 12 × 8 × 6 voxels of unequal sides, far from the world's origin.
fn stage(slots: &str, params: &str) -> Stage {
    let volume = r#"path: "v_12x8x6_float32.raw", spacing: (1, 1.5, 0.5), origin: (200, -50, 30)"#;
    let camera = "orbit(azimuth: 25, elevation: 20, fov_y: 30)";
    let text = graph(volume, camera, "{}", slots, params);
    let text = text.replace(r#"outputs: { "color": "image.color" }"#, OUTPUTS);
    Stage::new()
        .with_floats("v", [12, 8, 6], |x, _, _| x as f32)
        .with(
            "transfer.ron",
            "(domain: data, points: [(at: 0, color: (1, 1, 1), opacity: 0), (at: 12, color: (1, 1, 1), opacity: 0)])",
        )
        .with("graph.ron", text)
}

const LOW: DVec3 = DVec3::new(199.5, -50.75, 29.75);
const HIGH: DVec3 = DVec3::new(211.5, -38.75, 32.75);

#[test]
fn positions_and_normals_are_those_of_the_plane_that_is_hit() {
    // The plane where the ramp is 6: x = 206; the solid before it, seen from the side of small x, is hollow.
    let params = r#"{ "isovalue": 6, "isovalue_unit": "data", "cut_faces": "open" }"#;
    let stage = stage(r#"{ "technique": "isosurface" }"#, params);
    for backend in adapters() {
        for form in STAGES {
            let (picture, view) = render(
                &stage,
                &[&format!("image.stage={form}")],
                &backend,
                [48, 48],
            );
            let (places, normals) = (vectors(&picture, "place"), vectors(&picture, "normal"));
            let mut met = 0;
            for y in 0..48 {
                for x in 0..48 {
                    let at = (y * 48 + x) as usize;
                    let (origin, direction) = ray(&view, x, y);
                    let distance = (206.0 - origin.x) / direction.x;
                    let hit = origin + distance * direction;
                    // Pixels at the edge may fall to either side.
                    let inside = hit.cmpgt(LOW + 1e-3).all() && hit.cmplt(HIGH - 1e-3).all();
                    let outside = hit.cmplt(LOW - 1e-3).any() || hit.cmpgt(HIGH + 1e-3).any();
                    if inside {
                        met += 1;
                        let [px, py, pz, there] = places[at].map(f64::from);
                        let error = DVec3::new(px, py, pz).distance(hit);
                        // f32 near 200 has steps of 1.5e-5; the sampled ramp is linear but for rounding.
                        assert!(
                            there == 1.0 && error < 2e-4,
                            "{backend} {form}: {places:?} for {hit}, {error}"
                        );
                        let towards_eye = if direction.x > 0.0 { -1.0 } else { 1.0 };
                        let normal = DVec3::from_slice(&normals[at].map(f64::from)[..3]);
                        assert!(
                            normals[at][3] == 1.0 && normal.distance(DVec3::X * towards_eye) < 1e-3,
                            "{backend} {form}: normal {normal}"
                        );
                    } else if outside {
                        assert_eq!(
                            (places[at], normals[at]),
                            ([0.0; 4], [0.0; 4]),
                            "{backend} {form}"
                        );
                    }
                }
            }
            assert!(met > 100, "{backend} {form}: {met} pixels");
            assert!(scalars(&picture, "label").iter().all(|label| *label == 0.0));
        }
    }
}

#[test]
fn samples_are_those_of_the_walk() {
    let stage = stage("{}", r#"{ "step": 0.7 }"#);
    for backend in adapters() {
        for form in STAGES {
            let (picture, view) = render(
                &stage,
                &[&format!("image.stage={form}")],
                &backend,
                [48, 48],
            );
            let samples = scalars(&picture, "samples");
            let mut met = 0;
            for y in 0..48 {
                for x in 0..48 {
                    // One at the entry and one at the end of each segment; the smallest spacing is 0.5.
                    let length = box_interval(ray(&view, x, y), LOW, HIGH)
                        .map_or(0.0, |(near, far)| far - near);
                    let segments = length / 0.35;
                    let is_clear = (segments - segments.round()).abs() > 1e-3;
                    let expected = if length > 0.0 {
                        segments.ceil() + 1.0
                    } else {
                        0.0
                    };
                    let seen = f64::from(samples[(y * 48 + x) as usize]);
                    if is_clear || length == 0.0 {
                        met += u32::from(length > 0.0);
                        assert_eq!(seen, expected, "{backend} {form} at {x}, {y}: {length}");
                    }
                }
            }
            assert!(met > 100, "{backend} {form}: {met} pixels");
        }
    }
}

#[test]
fn layers_come_back_from_exr_as_they_were() {
    let stage = stage(
        r#"{ "technique": "isosurface" }"#,
        r#"{ "isovalue": 6, "isovalue_unit": "data" }"#,
    );
    let (picture, _) = render(&stage, &[], &adapters()[0], [24, 16]);
    let file = stage.path().join("layers.exr");
    let _ = picture.save(&file, SaveOptions::default()).unwrap();
    let mut back = Picture::load(&file).unwrap();
    let names = ["label", "normal", "place", "samples"];
    for name in names {
        assert_eq!(back.layer(name), picture.layer(name), "{name}");
    }
    assert_eq!(back.layers.len(), names.len());
    // What a layer may not be called is refused before anything is written.
    for name in ["depth", "", "a.b", "normal"] {
        back.layers[2].name = name.to_owned();
        assert!(back.check().is_err(), "{name}");
    }
}

#[test]
fn false_colors_are_those_of_the_transfer_function() {
    let graph = r#"(
    sources: { "volume": analytic(field: "constant", dims: (8, 8, 8)), "colors": transfer(path: "transfer.ron"),
               "heat": transfer(path: "heat.ron") },
    camera: orbit(azimuth: 0, elevation: 0, projection: orthographic),
    nodes: {
        "box": (kind: "proxy_box", in: { "volume": "volume" }),
        "image": (kind: "raycast", in: { "volume": "volume", "transfer": "colors", "rays": "box" }, params: { "step": 1.0 }),
        "heat_map": (kind: "false_color", in: { "layer": "image.samples", "transfer": "heat" },
                     params: { "low": 0.0, "high": 18.0 }),
    },
    outputs: { "color": "heat_map.color" },
)"#;
    let stage = Stage::new()
        .with("transfer.ron", "(points: [(at: 0, color: (1, 1, 1), opacity: 0), (at: 1, color: (1, 1, 1), opacity: 0)])")
        .with(
            "heat.ron",
            "(domain: data, points: [(at: -3, color: (0, 0, 1), opacity: 0), (at: 5, color: (1, 0, 0), opacity: 1)])",
        )
        .with("graph.ron", graph);
    for backend in adapters() {
        // Nine samples in the middle, half of 18: half of both colours. None at the corners: the first colour.
        let (picture, _) = render(&stage, &[], &backend, [32, 32]);
        let middle = picture.color[16 * 32 + 16];
        for (seen, expected) in middle.into_iter().zip([0.5, 0.0, 0.5, 1.0]) {
            // The nearest of 8192 entries.
            assert!((seen - expected).abs() < 1e-4, "{backend}: {middle:?}");
        }
        assert_eq!(picture.color[0], [0.0, 0.0, 1.0, 1.0], "{backend}");
        // On a logarithmic scale 9 is half of the way from 1 to 81; what is not above 0 is the first colour.
        let scale = [
            "heat_map.scale=logarithmic",
            "heat_map.low=1",
            "heat_map.high=81",
        ];
        let (picture, _) = render(&stage, &scale, &backend, [32, 32]);
        let middle = picture.color[16 * 32 + 16];
        for (seen, expected) in middle.into_iter().zip([0.5, 0.0, 0.5, 1.0]) {
            assert!((seen - expected).abs() < 1e-4, "{backend}: {middle:?}");
        }
        assert_eq!(picture.color[0], [0.0, 0.0, 1.0, 1.0], "{backend}");
        let refused = stage
            .open("graph.ron", &[scale[0]], &backend, [32, 32])
            .err();
        assert!(
            refused
                .unwrap()
                .to_string()
                .contains("`low` is not above 0")
        );
        // A span of nothing divides by nothing.
        let (flat, _) = render(&stage, &["heat_map.high=0"], &backend, [32, 32]);
        assert!(flat.color.iter().flatten().all(|value| value.is_finite()));
    }
}

#[test]
fn a_legend_shows_the_colours_and_the_numbers_in_pictures_that_it_fits() {
    let graph = r#"(
    sources: { "volume": analytic(field: "constant", dims: (8, 8, 8)), "heat": transfer(path: "heat.ron") },
    nodes: {
        "box": (kind: "proxy_box", in: { "volume": "volume" }),
        "image": (kind: "raycast", in: { "volume": "volume", "rays": "box" }, slots: { "technique": "mip" }),
        "heat_map": (kind: "false_color", in: { "layer": "image.samples", "transfer": "heat" },
                     params: { "low": 1000.0, "high": 1e6, "scale": "logarithmic" }),
    },
    outputs: { "color": "heat_map.color" },
)"#;
    let stage = Stage::new()
        .with(
            "heat.ron",
            "(color: [(0, (0, 0, 1)), (1, (1, 0, 0))], opacity: [(0, 1), (1, 1)])",
        )
        .with("graph.ron", graph);
    let with_legend = "heat_map.slots.legend=scale";
    for backend in adapters() {
        for size in [256, 512] {
            let (picture, _) = render(&stage, &[with_legend], &backend, [size, size]);
            let (plain, _) = render(&stage, &[], &backend, [size, size]);
            let pixels = || picture.color.iter().zip(&plain.color).enumerate();
            // It stands at the right, and is no wider than a third.
            let changed = pixels().filter(|(_, (a, b))| a != b);
            let left = changed.map(|(at, _)| at as u32 % size).min().unwrap();
            assert!(left > size * 2 / 3, "{backend} {size}: from {left}");
            // Colours from the last to the first, from top to bottom: in the middle both halves.
            let bar = left + size / 256 * 11;
            let at = |y: u32| picture.color[(y * size + bar) as usize];
            assert!(
                at(size / 8)[0] > 0.9 && at(size * 7 / 8)[2] > 0.9,
                "{backend} {size}"
            );
            assert!(
                (at(size / 2)[0] - 0.5).abs() < 0.02,
                "{backend} {size}: {:?}",
                at(size / 2)
            );
            // Numbers are bright.
            let ink = pixels().filter(|(_, (a, _))| a[1] > 0.8).count();
            assert!(ink as u32 > 60 * size / 256, "{backend} {size}: {ink}");
        }
        // Where it does not fit it is left out.
        let size = [128, 96];
        let (picture, _) = render(&stage, &[with_legend], &backend, size);
        assert_eq!(picture.color, render(&stage, &[], &backend, size).0.color);
    }
}
