//! Resampling against closed forms.

use super::*;
use crate::Voxels;

fn grid(dims: [u32; 3]) -> Grid {
    Grid {
        dims,
        world_from_index: DAffine3 {
            matrix3: DMat3::from_cols(
                DVec3::new(0.0, 2.0, 0.0),
                DVec3::new(3.0, 0.0, 1.0),
                DVec3::new(0.0, 0.5, 4.0),
            ),
            translation: DVec3::new(10.0, 20.0, 30.0),
        },
        node_centred: false,
    }
}

fn field(p: DVec3) -> f64 {
    1.0 + 2.0 * p.x - 3.0 * p.y + 0.5 * p.z + p.x * p.y - 0.25 * p.x * p.y * p.z
}

/// The field over the indices of a grid.
fn sampled(grid: Grid) -> Volume {
    let [nx, ny, nz] = grid.dims;
    let mut voxels = Vec::new();
    for z in 0..nz {
        for y in 0..ny {
            for x in 0..nx {
                voxels.push(field(DVec3::new(x.into(), y.into(), z.into())));
            }
        }
    }
    Volume::new("v", grid, voxels.into()).unwrap()
}

fn run(volume: &Volume, target: Target, filter: Filter) -> Volume {
    resample(volume, target, filter, &Watch::default()).unwrap()
}

#[test]
fn a_trilinear_field_survives_inside() {
    for node_centred in [false, true] {
        let old = sampled(Grid {
            node_centred,
            ..grid([13, 10, 9])
        });
        let index_from_world = old.grid().world_from_index.inverse();
        for target in [
            Target::Dims([5, 6, 4]),
            Target::Dims([26, 11, 9]),
            Target::Dims([1, 10, 3]),
            Target::Spacing(DVec3::new(3.1, 1.7, 9.0)),
        ] {
            let new = run(&old, target, Filter::Linear);
            let [mx, my, mz] = new.grid().dims;
            let mut tested = 0;
            for (x, y, z) in
                (0..mx).flat_map(|x| (0..my).flat_map(move |y| (0..mz).map(move |z| (x, y, z))))
            {
                let world = DVec3::new(x.into(), y.into(), z.into());
                let at = index_from_world
                    .transform_point3(new.grid().world_from_index.transform_point3(world));
                // Inside: the whole length of the new sample lies between old centres.
                let half = new.grid().spacing() / old.grid().spacing() / 2.0;
                let half = DVec3::select(half.cmpgt(DVec3::splat(0.5)), half, DVec3::ZERO);
                let last = DVec3::new(12.0, 9.0, 8.0);
                // (The far end of a node-centred box may be passed by half a sample.)
                let half = if node_centred { DVec3::ZERO } else { half };
                let inside = (at - half).cmpge(DVec3::splat(-1e-9)).all()
                    && (at + half).cmple(last + 1e-9).all();
                if inside {
                    let got = new.voxel([x, y, z]);
                    assert!((got - field(at)).abs() < 1e-7, "{target:?} {at}: {got}");
                    tested += 1;
                }
            }
            assert!(
                tested > 0 || target == Target::Dims([1, 10, 3]),
                "{target:?}"
            );
        }
    }
}

#[test]
fn the_box_stays_and_so_does_the_mean() {
    let old = sampled(grid([12, 10, 9]));
    for dims in [[6, 5, 3], [5, 7, 2], [24, 20, 18], [1, 1, 1]] {
        let new = run(&old, Target::Dims(dims), Filter::Linear);
        for (a, b) in old
            .grid()
            .corners_world()
            .iter()
            .zip(new.grid().corners_world())
        {
            assert!(a.abs_diff_eq(b, 1e-10), "{a} {b}");
        }
        // Doubling reads the outer half voxel as constant, which is what the mean of the box is made of.
        let (a, b) = (old.statistics().mean, new.statistics().mean);
        if dims[0] <= 12 {
            assert!((a - b).abs() < 1e-9, "{dims:?}: {a} {b}");
        }
    }
    let nodes = Grid {
        node_centred: true,
        ..grid([5, 4, 3])
    };
    let new = run(&sampled(nodes), Target::Dims([9, 2, 7]), Filter::Linear);
    for (a, b) in nodes.corners_world().iter().zip(new.grid().corners_world()) {
        assert!(a.abs_diff_eq(b, 1e-10), "{a} {b}");
    }
}

#[test]
fn a_spacing_is_kept_to_the_digit() {
    let old = sampled(grid([12, 10, 9]));
    let wanted = DVec3::new(1.3, 5.0, 0.7);
    let new = run(&old, Target::Spacing(wanted), Filter::Linear);
    assert!(new.grid().spacing().abs_diff_eq(wanted, 1e-12));
    let lowest = |volume: &Volume| volume.grid().corners_world()[0];
    assert!(lowest(&new).abs_diff_eq(lowest(&old), 1e-10));
}

#[test]
fn the_same_grid_gives_the_same_voxels() {
    let old = sampled(grid([5, 4, 3]));
    for filter in [Filter::Linear, Filter::Nearest, Filter::Mode] {
        let new = run(&old, Target::Dims([5, 4, 3]), filter);
        assert_eq!(new.digest(), old.digest(), "{filter:?}");
    }
}

#[test]
fn labels_are_not_mixed() {
    let values = vec![1_u16, 1, 7, 1, 9, 9, 3, 9, 5, 6, 4, 4, 8, 8, 4, 8];
    let flat = Grid::axis_aligned([4, 4, 1], DVec3::ONE, DVec3::ZERO);
    let old = Volume::new("v", flat, values.into()).unwrap();
    let new = run(&old, Target::Dims([2, 2, 1]), Filter::Mode);
    assert_eq!(new.voxels(), &Voxels::from(vec![1_u16, 1, 8, 4]));
    let near = run(&old, Target::Dims([8, 4, 1]), Filter::Nearest);
    assert_eq!(near.voxel([3, 0, 0]), 1.0);
    assert_eq!(near.voxel([4, 0, 0]), 7.0);
    let labels = Values::Labels(std::collections::BTreeMap::new());
    assert_eq!(Filter::for_values(&labels), Filter::Mode);
    assert_eq!(Filter::for_values(&Values::Hounsfield), Filter::Linear);
}

#[test]
fn integers_are_rounded_and_colours_go_along() {
    let flat = Grid::axis_aligned([4, 1, 1], DVec3::ONE, DVec3::ZERO);
    let old = Volume::new("v", flat, vec![255_u8, 255, 1, 0].into())
        .unwrap()
        .with_colors(vec![
            [255, 0, 10, 255],
            [255, 0, 10, 255],
            [1, 0, 20, 255],
            [0, 0, 20, 255],
        ])
        .unwrap();
    let new = run(&old, Target::Dims([2, 1, 1]), Filter::Linear);
    // (7/8 + 1) / 2 of 255 and 1/8 of 1: 223.2; (1/8 of 255 + 7/8 of 1 + 1 of 0) / 2: 16.4.
    assert_eq!(new.voxels(), &Voxels::from(vec![239_u8, 16]));
    assert_eq!(new.colors().unwrap(), [[239, 0, 11, 255], [16, 0, 19, 255]]);
}

#[test]
fn no_samples_and_broken_distances_are_refused() {
    let old = sampled(grid([2, 2, 2]));
    for target in [
        Target::Dims([0, 1, 1]),
        Target::Spacing(DVec3::new(1.0, f64::NAN, 1.0)),
        Target::Spacing(DVec3::new(1.0, -1.0, 1.0)),
        Target::Spacing(DVec3::new(1e-30, 1.0, 1.0)),
    ] {
        let error = resample(&old, target, Filter::Linear, &Watch::default()).unwrap_err();
        assert_eq!(error.code(), "volume-option", "{target:?}");
    }
}
