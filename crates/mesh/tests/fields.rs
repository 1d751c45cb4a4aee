//! Volumes of signed distance: grids, bands, gradients, progress.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod common;

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use common::{below, both, cuboid, icosphere, mesh, moved, torus};
use glam::DVec3;
use volgraph_mesh::{FieldOptions, Mesh, Resolution, Sign, SignedDistance, Up, distance_field};
use volgraph_volume::{Values, Volume, Voxels};

const HALF: DVec3 = DVec3::new(1.0, 2.0, 0.5);

fn values(volume: &Volume) -> &[f32] {
    match volume.voxels() {
        Voxels::F32(values) => values,
        other => panic!("{}", other.scalar_type()),
    }
}

#[test]
fn size_and_place_change_nothing_but_the_unit() {
    let options = FieldOptions {
        resolution: Resolution::LongestAxis(32),
        ..FieldOptions::default()
    };
    let plain = distance_field(&mesh(torus(2.0, 0.7, 40, 20)), &options).unwrap();
    for scale in [1e-20, 1e-3, 1e20] {
        let faces = moved(
            torus(2.0, 0.7, 40, 20),
            DVec3::new(5.0, -7.0, 1.0) * scale,
            scale,
        );
        let scaled = distance_field(&mesh(faces), &options).unwrap();
        assert_eq!(scaled.grid().dims, plain.grid().dims);
        for (a, b) in values(&plain).iter().zip(values(&scaled)) {
            let b = f64::from(*b) / scale;
            assert!((f64::from(*a) - b).abs() < 1e-6, "{a}, {b}");
        }
    }
    for scale in [1e-40, 1e40] {
        let faces = moved(icosphere(1), DVec3::ZERO, scale);
        let error = distance_field(&mesh(faces), &options).unwrap_err();
        assert_eq!(error.code(), "mesh-bad-value");
    }
}

/// The steps between neighbours are at most a voxel, and most gradients are of length 1.
#[test]
fn gradients_are_of_length_one() {
    let field = distance_field(&mesh(torus(2.0, 0.7, 100, 50)), &FieldOptions::default()).unwrap();
    let [nx, ny, nz] = field.grid().dims.map(|n| n as usize);
    let (values, voxel) = (values(&field), field.grid().min_spacing());
    let at = |x: usize, y: usize, z: usize| f64::from(values[(z * ny + y) * nx + x]);
    let (mut good, mut all, mut steepest) = (0, 0, 0.0_f64);
    for (x, y, z) in
        (1..nz - 1).flat_map(|z| (1..ny - 1).flat_map(move |y| (1..nx - 1).map(move |x| (x, y, z))))
    {
        let gradient = DVec3::new(
            at(x + 1, y, z) - at(x - 1, y, z),
            at(x, y + 1, z) - at(x, y - 1, z),
            at(x, y, z + 1) - at(x, y, z - 1),
        ) / (2.0 * voxel);
        steepest = steepest.max((at(x, y, z) - at(x + 1, y, z)).abs() / voxel);
        all += 1;
        good += i32::from((gradient.length() - 1.0).abs() < 0.02);
    }
    let share = f64::from(good) / f64::from(all);
    assert!(share > 0.97, "{share}");
    assert!(steepest < 1.0 + 1e-5, "{steepest}");
}

#[test]
fn fields_are_the_distances_at_the_voxels() {
    for faces in [
        torus(2.0, 0.7, 40, 20),
        below(0.3, icosphere(3)),
        both(icosphere(2), moved(icosphere(2), DVec3::X, 1.0)),
    ] {
        let mesh = mesh(faces);
        let distance = SignedDistance::new(&mesh, Sign::Auto).unwrap();
        for band in [None, Some(2.5), Some(0.3)] {
            let options = FieldOptions {
                resolution: Resolution::LongestAxis(40),
                band,
                ..FieldOptions::default()
            };
            let field = distance_field(&mesh, &options).unwrap();
            let limit = band.map_or(f64::INFINITY, |band| band * field.grid().min_spacing());
            let [nx, ny, _] = field.grid().dims;
            for (i, &value) in (0_u32..).zip(values(&field)) {
                let index = DVec3::new(
                    f64::from(i % nx),
                    f64::from(i / nx % ny),
                    f64::from(i / nx / ny),
                );
                let p = field.grid().world_from_index.transform_point3(index);
                let want = distance.at(p).clamp(-limit, limit);
                assert!(
                    (f64::from(value) - want).abs() < 1e-6,
                    "{band:?} {index}: {value}, not {want}"
                );
            }
        }
    }
}

#[test]
fn grids_hold_the_mesh_and_its_margin() {
    let mesh = mesh(moved(cuboid(HALF), DVec3::new(10.0, 20.0, 30.0), 1.0));
    let field = |resolution, margin| {
        let options = FieldOptions {
            resolution,
            margin,
            ..FieldOptions::default()
        };
        distance_field(&mesh, &options)
    };
    // 4 units in 20 voxels between two margins of 2: voxels of 0.2, and 10 and 5 of them along the other axes.
    let volume = field(Resolution::LongestAxis(24), 2).unwrap();
    let grid = *volume.grid();
    assert_eq!(grid.dims, [14, 24, 9]);
    assert!((grid.min_spacing() - 0.2).abs() < 1e-12);
    let (lo, hi) = (grid.corners_world()[0], grid.corners_world()[7]);
    assert!(lo.abs_diff_eq(DVec3::new(8.6, 17.6, 29.1), 1e-12), "{lo}");
    assert!(hi.abs_diff_eq(DVec3::new(11.4, 22.4, 30.9), 1e-12), "{hi}");
    assert_eq!(
        volume.about().values,
        Values::Named("signed distance".into())
    );
    assert_eq!(volume.about().length_unit, None);
    let facts = &volume.about().facts;
    assert!(
        facts.contains(&("sign".into(), "pseudo-normals".into())),
        "{facts:?}"
    );

    assert_eq!(
        field(Resolution::VoxelSize(0.2), 2).unwrap().grid().dims,
        [14, 24, 9]
    );
    assert_eq!(
        field(Resolution::VoxelSize(0.19), 0).unwrap().grid().dims,
        [11, 22, 6]
    );
    let grid = *field(Resolution::Dims([20, 24, 40]), 2).unwrap().grid();
    assert_eq!(grid.dims, [20, 24, 40]);
    assert!((grid.min_spacing() - 0.2).abs() < 1e-12);
    let middle = grid.corners_world()[0].midpoint(grid.corners_world()[7]);
    assert!(
        middle.abs_diff_eq(DVec3::new(10.0, 20.0, 30.0), 1e-12),
        "{middle}"
    );

    for (resolution, margin, code) in [
        (Resolution::LongestAxis(6), 3, "mesh-option"),
        (Resolution::LongestAxis(0), 0, "mesh-option"),
        (Resolution::Dims([20, 4, 20]), 2, "mesh-option"),
        (Resolution::VoxelSize(0.0), 2, "mesh-option"),
        (Resolution::VoxelSize(f64::NAN), 2, "mesh-option"),
        (Resolution::VoxelSize(1e-9), 2, "mesh-too-large"),
        (Resolution::VoxelSize(1e-300), 2, "mesh-too-large"),
        (Resolution::LongestAxis(u32::MAX), 2, "mesh-too-large"),
        (Resolution::LongestAxis(40), u32::MAX, "mesh-option"),
    ] {
        let error = field(resolution, margin).unwrap_err();
        assert_eq!(error.code(), code, "{resolution:?}: {error}");
        assert!(!error.trouble().remedy.is_empty());
    }
    for band in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let options = FieldOptions {
            band: Some(band),
            ..FieldOptions::default()
        };
        assert_eq!(
            distance_field(&mesh, &options).unwrap_err().code(),
            "mesh-option"
        );
    }
    let options = FieldOptions {
        max_bytes: Some(1000),
        ..FieldOptions::default()
    };
    assert_eq!(
        distance_field(&mesh, &options).unwrap_err().code(),
        "mesh-too-large"
    );
}

#[test]
fn a_flat_mesh_has_a_field_too() {
    let square = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::ONE - DVec3::Z];
    let mesh = Mesh::new("square", square, vec![[0, 1, 3], [0, 3, 2]]).unwrap();
    let options = FieldOptions {
        resolution: Resolution::LongestAxis(16),
        sign: Sign::Unsigned,
        ..FieldOptions::default()
    };
    let field = distance_field(&mesh, &options).unwrap();
    assert_eq!(field.grid().dims, [16, 16, 7]);
    assert_eq!(field.statistics().min, 0.0);
}

#[test]
fn a_mesh_with_y_up_stands_on_its_feet() {
    // A tall box, higher in y: higher in z when turned.
    let tall = moved(
        cuboid(DVec3::new(1.0, 3.0, 0.5)),
        DVec3::new(0.0, 3.0, 1.0),
        1.0,
    );
    let options = FieldOptions {
        up: Up::Y,
        ..FieldOptions::default()
    };
    let field = distance_field(&mesh(tall), &options).unwrap();
    let [nx, ny, nz] = field.grid().dims;
    assert!(nz > nx && nx > ny);
    let (lo, hi) = (
        field.grid().corners_world()[0],
        field.grid().corners_world()[7],
    );
    let middle = lo.midpoint(hi);
    assert!(
        middle.abs_diff_eq(DVec3::new(0.0, -1.0, 3.0), 1e-12),
        "{middle}"
    );
    assert!(field.warnings().is_empty());
}

#[test]
fn progress_reaches_the_end_and_cancelling_stops() {
    let mesh = mesh(icosphere(2));
    let (last, calls) = (Arc::new(AtomicU64::new(0)), Arc::new(AtomicU64::new(0)));
    let cancel = Arc::new(AtomicBool::new(false));
    let (seen, counted) = (last.clone(), calls.clone());
    let mut options = FieldOptions {
        resolution: Resolution::LongestAxis(64),
        progress: Some(Arc::new(move |done, total| {
            assert!(done <= total);
            seen.fetch_max(done, Ordering::Relaxed);
            counted.fetch_add(1, Ordering::Relaxed);
        })),
        cancel: Some(cancel.clone()),
        ..FieldOptions::default()
    };
    let field = distance_field(&mesh, &options).unwrap();
    assert_eq!(last.load(Ordering::Relaxed), field.grid().voxel_count());
    let all = calls.swap(0, Ordering::Relaxed);
    // Cancelled from within the first report: the rest is not computed.
    options.progress = Some(Arc::new(move |_, _| {
        calls.fetch_add(1, Ordering::Relaxed);
        cancel.store(true, Ordering::Relaxed);
        assert!(calls.load(Ordering::Relaxed) < all / 2);
    }));
    assert_eq!(
        distance_field(&mesh, &options).unwrap_err().code(),
        "mesh-cancelled"
    );
}
