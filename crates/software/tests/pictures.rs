//! Pictures of the software raycaster: to closed forms, to the float64 reference, and to each other.

#![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

mod common;

use std::path::Path;

use glam::DVec3;
use volgraph_optics::TransferFunction;
use volgraph_reference::{Field, Look, Materials, Matter, Rays, Scene, Silent, render};
use volgraph_software::{Attenuation, Classify, DistanceMap, Raycast, Tables, Units, VoxelGrid};
use volgraph_volume::{Grid, ScalarType, Volume, Voxels};

use common::{EYE, bits, rays, volume};

const EXACT: Classify = Classify::Integral1d(Attenuation::Exact);
const LINES: Classify = Classify::Integral1d(Attenuation::FourLines);

/// A peak, a step and a ramp, with nothing at small scalars.
const TRANSFER: &str = "(domain: range, points: [(at: 0, color: (0, 0, 0), opacity: 0),
    (at: 0.25, color: (0.1, 0.2, 0.9), opacity: 0), (at: 0.4, color: (0.1, 0.6, 0.8), opacity: 0.05),
    (at: 0.6, color: (1, 0.8, 0.2), opacity: 0.02), (at: 1, color: (1, 0.9, 0.9), opacity: 0.35)])";

fn transfer(text: &str) -> TransferFunction {
    TransferFunction::parse(Path::new("t.ron"), text).unwrap()
}

/// A volume and all that its pictures need.
struct Stand {
    volume: Volume,
    grid: VoxelGrid,
    transfer: TransferFunction,
}

impl Stand {
    fn new(volume: Volume, text: &str) -> Self {
        Self {
            grid: VoxelGrid::new(&volume).unwrap(),
            transfer: transfer(text),
            volume,
        }
    }

    fn units(&self) -> Units {
        let (low, high) = self.volume.statistics().range().unwrap();
        Units {
            values: (low, if high > low { high - low } else { 1.0 }),
            spacing: self.volume.grid().min_spacing(),
        }
    }

    /// Draws it with a function, once with leaps where an edge of bricks is given.
    fn draw<R>(
        &self,
        classify: Classify,
        step: f64,
        early_termination: f32,
        edge: Option<u32>,
        draw: impl Fn(&Raycast<'_>) -> R,
    ) -> R {
        let units = self.units();
        let step_world = step * units.spacing;
        let tables = Tables::new(
            &self.transfer,
            units,
            self.grid.offset,
            classify,
            8192,
            step_world,
        )
        .unwrap();
        let map = edge
            .map(|edge| DistanceMap::new(&self.volume.brick_ranges(edge, [1; 2]), edge, &tables));
        draw(&Raycast {
            placement: self.volume.grid(),
            voxels: &self.grid,
            tables: &tables,
            empty: map.as_ref(),
            step_world: step_world as f32,
            early_termination,
        })
    }
}

#[test]
fn threads_instructions_and_leaps_do_not_change_a_bit() {
    let types = [ScalarType::U8, ScalarType::I16, ScalarType::F32];
    for (ty, classify) in types
        .into_iter()
        .flat_map(|ty| [Classify::Post, EXACT, LINES].map(|it| (ty, it)))
    {
        let stand = Stand::new(volume("c60", [37, 30, 21], ty), TRANSFER);
        for is_orthographic in [false, true] {
            let rays = rays(EYE, [61, 43], is_orthographic);
            let plain = stand.draw(classify, 0.7, 1e-3, None, |it| {
                it.render_portable(&rays, &[])
            });
            let plain = bits(&plain);
            assert!(plain.iter().any(|pixel| f32::from_bits(pixel[3]) > 0.2));
            for edge in [None, Some(4), Some(8)] {
                let drawn = stand.draw(classify, 0.7, 1e-3, edge, |it| it.render(&rays, &[]));
                assert!(bits(&drawn) == plain, "{ty:?} {classify:?} {edge:?}");
            }
            for threads in [1, 2, 5] {
                let pool = rayon::ThreadPoolBuilder::new()
                    .num_threads(threads)
                    .build()
                    .unwrap();
                let drawn = stand.draw(classify, 0.7, 1e-3, Some(4), |it| {
                    pool.install(|| it.render(&rays, &[]))
                });
                assert!(
                    bits(&drawn) == plain,
                    "{ty:?} {classify:?} of {threads} threads"
                );
            }
        }
    }
}

#[test]
fn samples_are_those_of_the_volume_at_any_place_and_of_any_type() {
    let dims = [5_u32, 4, 3];
    let value = |at: u32| f64::from(at * 7919 % 251) / 250.0;
    let values: Vec<f64> = (0..60).map(value).collect();
    let mut holes: Vec<f32> = values.iter().map(|value| *value as f32).collect();
    holes[17] = f32::NAN;
    holes[31] = f32::INFINITY;
    let far: Vec<f64> = values.iter().map(|value| 1e9 + value).collect();
    let all: Vec<Voxels> = vec![
        values
            .iter()
            .map(|value| (value * 255.0) as u8)
            .collect::<Vec<_>>()
            .into(),
        values
            .iter()
            .map(|value| (value * 255.0 - 128.0) as i8)
            .collect::<Vec<_>>()
            .into(),
        values
            .iter()
            .map(|value| (value * 65535.0) as u16)
            .collect::<Vec<_>>()
            .into(),
        values
            .iter()
            .map(|value| (value * 65535.0 - 32768.0) as i16)
            .collect::<Vec<_>>()
            .into(),
        holes.into(),
        values
            .iter()
            .map(|value| (value * 1e6) as i32)
            .collect::<Vec<_>>()
            .into(),
        far.into(),
    ];
    for voxels in all {
        let grid = Grid::axis_aligned(dims, DVec3::ONE, DVec3::ZERO);
        let volume = Volume::new("v", grid, voxels).unwrap();
        let (low, high) = volume.statistics().range().unwrap();
        let cells = VoxelGrid::new(&volume).unwrap();
        for i in 0..500_u32 {
            let part = |factor: u32| f64::from(i * factor % 997) / 997.0;
            let at = DVec3::new(part(71), part(193), part(401)) * 8.0 - 2.0;
            let found = f64::from(cells.sample(at)) + cells.offset;
            let truth = volume.trilinear(at);
            assert!(
                (found - truth).abs() < 2e-6 * (high - low),
                "{:?} at {at}: {found} for {truth}",
                volume.voxels().scalar_type()
            );
        }
    }
}

#[test]
fn a_constant_volume_is_one_exponential_of_all_its_length() {
    // The box is 16 voxels deep, and steps of 3 leave a segment of 1.
    let grid = Grid::axis_aligned([16; 3], DVec3::ONE, DVec3::splat(-7.5));
    let stand = Stand::new(
        Volume::new("v", grid, vec![100_u8; 4096].into()).unwrap(),
        "(color: (1, 0.5, 0.25), extinction: [(0, 0.1)])",
    );
    let rays = Rays {
        half_extent: [4.0; 2],
        ..rays(DVec3::new(0.0, 0.0, 40.0), [8, 8], true)
    };
    let behind = vec![[0.25, 0.5, 0.75, 1.0]; 64];
    for classify in [Classify::Post, EXACT] {
        let picture = stand.draw(classify, 3.0, 0.0, None, |it| it.render(&rays, &behind));
        let open = (-1.6_f32).exp();
        for pixel in &picture {
            for (channel, color) in [1.0, 0.5, 0.25, 1.0].into_iter().enumerate() {
                let truth = color * (1.0 - open) + open * behind[0][channel];
                assert!(
                    (pixel[channel] - truth).abs() < 1e-6,
                    "{classify:?} {pixel:?}"
                );
            }
        }
    }
}

/// Root of the mean squared difference from the reference, of each step.
fn errors(stand: &Stand, classify: Classify, steps: &[f64]) -> Vec<f64> {
    let rays = rays(EYE, [24, 24], false);
    let Units { values, spacing } = stand.units();
    let matter = Matter::new(&stand.transfer, values, spacing, &Materials::NONE);
    let scene = Scene::unlit(rays, Field::new(&stand.volume), Look::unlit(matter));
    let truth = render(&scene, 1e-8, &Silent).unwrap().color;
    let of_step = |step: &f64| {
        let drawn = stand.draw(classify, *step, 0.0, None, |it| it.render(&rays, &[]));
        let differences = drawn
            .iter()
            .zip(&truth)
            .flat_map(|(drawn, truth)| (0..4).map(|i| (f64::from(drawn[i]) - truth[i]).powi(2)));
        (differences.sum::<f64>() / (4 * truth.len()) as f64).sqrt()
    };
    steps.iter().map(of_step).collect()
}

#[test]
fn the_error_falls_with_the_square_of_the_step() {
    let stand = Stand::new(volume("marschner_lobb", [24; 3], ScalarType::U16), TRANSFER);
    for classify in [Classify::Post, EXACT] {
        let found = errors(&stand, classify, &[1.0, 0.5, 0.25, 0.125]);
        // Two is what the midpoint rule and means have in theory, where cells are crossed by many segments.
        let order = (found[0] / found[3]).log2() / 3.0;
        assert!(
            order > 1.85 && found[3] < 2e-4,
            "{classify:?}: {order} {found:?}"
        );
    }
    // Four lines are off by up to 0.0226 of each segment, at any step.
    let found = errors(&stand, LINES, &[1.0, 0.125]);
    assert!(found[1] > 1e-2 && found[1] < 0.1, "{found:?}");
}

#[test]
fn early_termination_is_wrong_by_its_bound_at_most() {
    let stand = Stand::new(volume("marschner_lobb", [32; 3], ScalarType::U8), TRANSFER);
    let rays = rays(EYE, [40, 40], false);
    let draw = |bound| stand.draw(EXACT, 1.0, bound, Some(4), |it| it.render(&rays, &[]));
    let (all, early) = (draw(0.0), draw(0.05));
    let pairs = all.iter().flatten().zip(early.iter().flatten());
    let worst = pairs.map(|(a, b)| a - b).fold(0.0, f32::max);
    assert!(worst > 1e-3 && worst <= 0.05, "{worst}");
}

#[test]
fn an_eye_inside_sees_what_is_before_it_and_nothing_is_drawn_beside_the_box() {
    let stand = Stand::new(volume("c60", [32; 3], ScalarType::U8), TRANSFER);
    let inside = rays(DVec3::new(0.05, 0.02, 0.1), [17, 9], false);
    let plain = stand.draw(EXACT, 1.0, 0.0, None, |it| it.render(&inside, &[]));
    let leaping = stand.draw(EXACT, 1.0, 0.0, Some(4), |it| it.render(&inside, &[]));
    assert!(bits(&plain) == bits(&leaping) && plain.iter().any(|pixel| pixel[3] > 0.1));
    // All of the volume is behind the eye.
    let away = Rays {
        forward: EYE.normalize(),
        ..rays(EYE, [17, 9], false)
    };
    let behind = vec![[0.5; 4]; 17 * 9];
    let picture = stand.draw(EXACT, 1.0, 0.0, None, |it| it.render(&away, &behind));
    assert_eq!(picture, behind);
}
