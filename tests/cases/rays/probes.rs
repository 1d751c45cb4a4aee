//! Probes tell what a volume is at a place, where a ray hits and where most of its pixel comes from.

use std::collections::BTreeSet;

use glam::DVec3;
use volgraph::ray::Status;
use volgraph::{Probe, RayStudy};
use volgraph_tests::{Stage, adapters, graph};

use super::{PIXELS, SIZE, at, of, ready};

/// 2 x + 3 y - z + 7 in index coordinates.
fn slope(x: u32, y: u32, z: u32) -> f32 {
    2.0 * x as f32 + 3.0 * y as f32 - z as f32 + 7.0
}

#[test]
fn a_probe_tells_position_voxel_value_gradient_and_hit() {
    let volume = r#"path: "v_12x8x6_float32.raw", spacing: (1, 1.5, 0.5), origin: (200, -50, 30)"#;
    let camera = "orbit(azimuth: 25, elevation: 20, fov_y: 30)";
    let slots = r#"{ "technique": "isosurface" }"#;
    let params = r#"{ "isovalue": 31, "isovalue_unit": "data", "cut_faces": "open", "step": 0.5 }"#;
    let stage = Stage::new()
        .with_floats("v", [12, 8, 6], slope)
        .with("transfer.ron", "(color: (1, 1, 1), extinction: [(0, 0.1)])")
        .with("graph.ron", graph(volume, camera, "{}", slots, params));
    for backend in adapters() {
        let mut session = stage.open("graph.ron", &[], &backend, SIZE).unwrap();
        let (picture, _) = session.render().unwrap();
        let there = Probe::at(&session, [203.25, -47.0, 31.0]).unwrap();
        let index = DVec3::from_array(there.index);
        assert!(
            index.distance(DVec3::new(3.25, 2.0, 2.0)) < 1e-9,
            "{there:?}"
        );
        assert_eq!(there.voxel, Some([3, 2, 2]));
        assert!((there.value.unwrap() - 17.5).abs() < 1e-6, "{there:?}");
        let gradient = DVec3::from_array(there.gradient.unwrap());
        assert!(
            gradient.distance(DVec3::new(2.0, 2.0, -2.0)) < 1e-6,
            "{there:?}"
        );
        assert_eq!(there.label, None);
        let beside = Probe::at(&session, [0.0; 3]).unwrap();
        assert!(!beside.is_inside && beside.value.is_none() && beside.gradient.is_none());
        // On an outer face of the box the field is even across it.
        let face = Probe::at(&session, [199.5, -47.0, 31.0]).unwrap();
        assert_eq!(
            (face.voxel, face.gradient.unwrap()[0]),
            (Some([0, 2, 2]), 0.0)
        );

        let mut hits = 0;
        for pixel in PIXELS {
            let study = RayStudy::of(&session, at(pixel)).unwrap();
            let number = (pixel[1] * SIZE[0] + pixel[0]) as usize;
            let drawn = f64::from(picture.depth.as_ref().unwrap()[number]);
            assert_eq!(study.depth.is_some(), drawn.is_finite(), "{pixel:?}");
            let (Some(depth), Some(hit)) = (study.depth, study.hit) else {
                continue;
            };
            hits += 1;
            assert!((depth - drawn).abs() < 1e-3, "{depth} {drawn}");
            assert!((hit.value.unwrap() - 31.0).abs() < 1e-3, "{hit:?}");
            // All light is met in the segment of the hit.
            let strongest = study.strongest.unwrap();
            let apart = DVec3::from_array(strongest.world).distance(DVec3::from_array(hit.world));
            assert!(apart < 0.5, "{apart}");
        }
        assert!(hits >= 3, "{hits}");
    }
}

#[test]
fn labels_are_told_of_segments_and_probes() {
    for backend in adapters() {
        let session = ready("segments.ron", &[], &backend);
        let study = RayStudy::of(&session, [24.0, 20.0]).unwrap();
        let mut seen = BTreeSet::new();
        for segment in of(&study, Status::Taken) {
            let middle = 0.5 * (segment.start + segment.end);
            let world =
                DVec3::from_array(study.origin) + middle * DVec3::from_array(study.direction);
            let probe = Probe::at(&session, world.to_array()).unwrap();
            // Segments are cut where labels change.
            assert_eq!(
                probe.label.map(u32::from),
                Some(segment.label),
                "{segment:?}"
            );
            seen.insert(segment.label);
        }
        assert!(seen.len() >= 2, "{seen:?}");
    }
}
