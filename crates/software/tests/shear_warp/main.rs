//! Pictures of shear-warp: to closed forms, to the float64 reference, and to each other.

#![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

mod stand;

use glam::DVec3;
use volgraph_reference::Rays;
use volgraph_software::shear_warp::{BufferSlice, Correction, Lookup, SlabClassify};
use volgraph_volume::{Grid, ScalarType, Volume};

use self::stand::{ASKED, Asked, FROM, SMOOTH, Stand, TRANSFER, bits, error, field, rays};

#[test]
fn threads_instructions_buffers_and_runs_do_not_change_a_bit() {
    let types = [ScalarType::U8, ScalarType::I16, ScalarType::F32];
    for (at, from) in FROM.into_iter().enumerate() {
        let stand = Stand::new(field("c60", [37, 30, 21], types[at % 3]), TRANSFER);
        let rays = rays(from, 0.6, [61, 43]);
        for (classify, lookup, scale, slices_per_voxel) in [
            (SlabClassify::Preintegrated, Lookup::Nearest, 1.0, 1),
            (SlabClassify::Preintegrated, Lookup::Bilinear, 1.7, 2),
            (SlabClassify::Post, Lookup::Nearest, 1.0, 1),
            (SlabClassify::Post, Lookup::Nearest, 0.6, 3),
        ] {
            let asked = Asked {
                classify,
                lookup,
                scale,
                slices_per_voxel,
                early_termination: 1e-2,
                ..ASKED
            };
            let plain = stand.with(asked, &rays, |it| it.render_portable(&rays, &[]));
            let plain = bits(&plain);
            assert!(plain.iter().any(|pixel| f32::from_bits(pixel[3]) > 0.2));
            for buffer in [BufferSlice::Slice, BufferSlice::Image] {
                for has_runs in [false, true] {
                    let asked = Asked {
                        buffer,
                        has_runs,
                        ..asked
                    };
                    assert!(bits(&stand.draw(asked, &rays)) == plain, "{from} {asked:?}");
                }
            }
            for threads in [1, 2, 5] {
                let pool = rayon::ThreadPoolBuilder::new()
                    .num_threads(threads)
                    .build()
                    .unwrap();
                let drawn = pool.install(|| stand.draw(asked, &rays));
                assert!(bits(&drawn) == plain, "{threads} threads");
            }
        }
    }
}

/// Each pixel of the intermediate image is one exponential of its ray's length in the box. In the picture that is bilinear
/// between pixels: exact across a face; else off by an eighth of the second difference of the exponential along both axes, and more at
/// edges of the box, where the length has a kink. Pixels about which it has none are held to the former.
#[test]
fn a_constant_volume_absorbs_by_its_length() {
    let dims = [16_u32, 13, 10];
    let grid = Grid::axis_aligned(dims, DVec3::ONE, DVec3::new(-7.5, -6.0, -4.5));
    let volume = Volume::new("v", grid, vec![100_u8; 2080].into()).unwrap();
    let stand = Stand::new(volume, "(color: (1, 0.5, 0.25), extinction: [(0, 0.1)])");
    let size = [40, 36];
    let (low, high) = (DVec3::new(-8.0, -6.5, -5.0), DVec3::new(8.0, 6.5, 5.0));
    let length = |rays: &Rays, aside: [f64; 2]| {
        let origin = rays.eye + rays.right * aside[0] + rays.up * aside[1];
        let (a, b) = (
            (low - origin) / rays.forward,
            (high - origin) / rays.forward,
        );
        let (near, far) = (a.min(b), a.max(b));
        // Along a face: not a number, or on one side.
        let near = (0..3)
            .filter(|i| rays.forward[*i].abs() > 1e-9)
            .map(|i| near[i]);
        let far = (0..3)
            .filter(|i| rays.forward[*i].abs() > 1e-9)
            .map(|i| far[i]);
        let beside = (0..3)
            .any(|i| rays.forward[i].abs() <= 1e-9 && (origin[i] < low[i] || origin[i] > high[i]));
        let near = near.fold(0.0, f64::max);
        let length = far.fold(f64::INFINITY, f64::min) - near;
        if beside { 0.0 } else { length.max(0.0) }
    };
    for (at, from) in FROM.into_iter().enumerate() {
        // The last ones have the plane of their eye inside of the volume.
        for eye in [100.0, 1.5] {
            let rays = Rays {
                eye: from.normalize() * eye,
                ..rays(from, 12.0, size)
            };
            for (classify, slices_per_voxel) in [
                (SlabClassify::Preintegrated, 1),
                (SlabClassify::Preintegrated, 3),
                (SlabClassify::Post, 1),
                (SlabClassify::Post, 2),
            ] {
                let asked = Asked {
                    classify,
                    slices_per_voxel,
                    scale: 2.0,
                    table_size: 64,
                    ..ASKED
                };
                let picture = stand.draw(asked, &rays);
                let (mut met, mut worst) = (0, 0.0_f64);
                for (pixel, shown) in picture.iter().enumerate() {
                    let place = rays.place(pixel as u32 % size[0], pixel as u32 / size[0]);
                    let aside = [0, 1].map(|i| place[i] * rays.half_extent[i]);
                    let own = length(&rays, aside);
                    // Pixels of the intermediate image are half a voxel apart, seen from wherever: look a little farther.
                    let near = (0..8).map(|i| {
                        let turn = std::f64::consts::FRAC_PI_4 * f64::from(i);
                        let at = |by: f64| {
                            length(
                                &rays,
                                [aside[0] + by * turn.cos(), aside[1] + by * turn.sin()],
                            )
                        };
                        let (near, far) = (at(0.9), at(-0.9));
                        // No kink, and no edge of the box.
                        if near > 0.0 && far > 0.0 {
                            (near + far - 2.0 * own).abs()
                        } else {
                            f64::INFINITY
                        }
                    });
                    if near.fold(0.0, f64::max) > 1e-9 {
                        continue;
                    }
                    met += 1;
                    let opacity = -(-0.1 * own).exp_m1();
                    for (channel, color) in [1.0, 0.5, 0.25, 1.0].into_iter().enumerate() {
                        let truth = color * opacity;
                        worst = worst.max((f64::from(shown[channel]) - truth).abs());
                    }
                }
                // How much the length changes from pixel to pixel, which are half a voxel apart.
                let least = (0..3)
                    .map(|i| rays.forward[i].abs())
                    .filter(|it| *it > 1e-9);
                let change = 0.5 / least.fold(1.0, f64::min);
                let bound = if at < 6 {
                    2e-6
                } else {
                    2.0 * (0.1 * change).powi(2) / 8.0
                };
                assert!(met > 100, "{from} {met}");
                assert!(worst <= bound, "{from} {eye} {asked:?}: {worst}");
                let open = picture.iter().filter(|pixel| pixel[3] == 0.0);
                assert!(open.count() > 100, "{from}");
            }
        }
    }
}

/// With slabs and pixels halved together the error falls with their square. At the outline of the box, where the length of
/// rays has a kink, it falls with the distance of pixels, in pixels as few as that: an order of 1.5 in all.
#[test]
fn the_error_falls_with_slabs_and_pixels() {
    let stand = Stand::new(field("marschner_lobb", [24; 3], ScalarType::U16), SMOOTH);
    for (from, (half, least)) in [FROM[6], FROM[8], FROM[11]]
        .into_iter()
        .flat_map(|from| [(0.04, 1.75), (0.6, 1.3)].map(|it| (from, it)))
    {
        let rays = rays(from, half, [24, 24]);
        let truth = stand.truth(rays);
        for (classify, lookup) in [
            (SlabClassify::Preintegrated, Lookup::Bilinear),
            (SlabClassify::Post, Lookup::Nearest),
        ] {
            let of = |n: u32| {
                let asked = Asked {
                    classify,
                    lookup,
                    scale: f64::from(n),
                    slices_per_voxel: n,
                    ..ASKED
                };
                error(&stand.draw(asked, &rays), &truth)
            };
            // With fewer slabs and pixels the error has not settled yet.
            let errors = [8, 16].map(of);
            let order = (errors[0] / errors[1]).log2();
            assert!(
                order > least && errors[0] < 4e-3,
                "{from} {half} {classify:?} {order} {errors:?}"
            );
        }
    }
}

#[test]
fn corrections_agree_across_slices_and_where_matter_is_one() {
    // Rays across slices have slabs of the length that the uncorrected table is for.
    let grid = Grid::axis_aligned([20; 3], DVec3::ONE / 20.0, DVec3::splat(-0.475));
    let voxels = field("c60", [20; 3], ScalarType::U8).voxels().clone();
    let stand = Stand::new(Volume::new("v", grid, voxels).unwrap(), TRANSFER);
    let of = |correction, rays: &Rays| {
        stand.draw(
            Asked {
                correction,
                ..ASKED
            },
            rays,
        )
    };
    let straight = rays(DVec3::Z, 0.6, [30, 30]);
    let exact = of(Correction::Exact, &straight);
    for correction in [Correction::Scaled, Correction::None] {
        let other = of(correction, &straight);
        let pairs = exact.iter().flatten().zip(other.iter().flatten());
        let worst = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        assert!(worst < 1e-5, "{correction:?} {worst}");
    }
    // Slanted rays see too little without it, and the paper's correction is close to the exact table.
    let stand = Stand::new(stand.volume, SMOOTH);
    let slanted = rays(DVec3::new(1.0, 0.9, 1.1), 0.2, [30, 30]);
    let truth = stand.truth(slanted);
    let [exact, scaled, none] =
        [Correction::Exact, Correction::Scaled, Correction::None].map(|correction| {
            let asked = Asked {
                correction,
                lookup: Lookup::Bilinear,
                scale: 4.0,
                ..ASKED
            };
            error(&stand.draw(asked, &slanted), &truth)
        });
    assert!(
        none > 5.0 * exact && (scaled - exact).abs() < 0.1 * exact,
        "{exact} {scaled} {none}"
    );
}

#[test]
fn early_termination_is_wrong_by_its_bound_at_most() {
    let stand = Stand::new(field("marschner_lobb", [32; 3], ScalarType::U8), TRANSFER);
    let rays = rays(FROM[6], 0.6, [40, 40]);
    let draw = |early_termination| {
        let asked = Asked {
            early_termination,
            has_runs: true,
            ..ASKED
        };
        stand.draw(asked, &rays)
    };
    let (all, early) = (draw(0.0), draw(0.05));
    let pairs = all.iter().flatten().zip(early.iter().flatten());
    let worst = pairs.map(|(a, b)| a - b).fold(0.0, f32::max);
    assert!(worst > 1e-3 && worst <= 0.05, "{worst}");
}

#[test]
fn what_is_behind_shows_through_and_beside() {
    let stand = Stand::new(field("c60", [16; 3], ScalarType::U8), TRANSFER);
    let rays = rays(FROM[7], 1.2, [31, 23]);
    let behind: Vec<[f32; 4]> = (0..31 * 23)
        .map(|i| [0.2, i as f32 / 1000.0, 0.7, 1.0])
        .collect();
    let over = stand.with(ASKED, &rays, |it| it.render(&rays, &behind));
    let alone = stand.draw(ASKED, &rays);
    assert!(alone.iter().any(|pixel| pixel[3] > 0.1));
    for ((over, alone), behind) in over.iter().zip(&alone).zip(&behind) {
        for i in 0..4 {
            let truth = alone[i] + (1.0 - alone[3]) * behind[i];
            assert!((over[i] - truth).abs() < 1e-6);
        }
    }
    // All of the volume is behind the eye.
    let away = Rays {
        forward: -rays.forward,
        ..rays
    };
    assert_eq!(
        stand.with(ASKED, &away, |it| it.render(&away, &behind)),
        behind
    );
}

/// Across slices scalars are linear from slice to slice, and these are entries of the table: nothing is approximated but
/// by f32. Dense matter tells the front of a slab from its back.
#[test]
fn slabs_across_slices_are_exact_from_both_sides() {
    let values = [0_u8, 255, 30, 200].into_iter();
    let voxels: Vec<u8> = values.flat_map(|value| [value; 64]).collect();
    let grid = Grid::axis_aligned([8, 8, 4], DVec3::ONE, DVec3::new(-3.5, -3.5, -1.5));
    let dense = "(domain: range, points: [(at: 0, color: (0.1, 0.2, 0.9), opacity: 0.1),
        (at: 0.5, color: (0.2, 0.9, 0.1), opacity: 0), (at: 1, color: (1, 0.2, 0.1), opacity: 0.95)])";
    let stand = Stand::new(Volume::new("v", grid, voxels.into()).unwrap(), dense);
    for from in [DVec3::Z, DVec3::NEG_Z] {
        let rays = rays(from, 2.0, [6, 6]);
        let truth = stand.truth(rays);
        for lookup in [Lookup::Nearest, Lookup::Bilinear] {
            let drawn = stand.draw(Asked { lookup, ..ASKED }, &rays);
            let error = error(&drawn, &truth);
            assert!(error < 2e-6, "{from} {lookup:?} {error}");
        }
    }
}
