//! Projections and isosurfaces of the software raycaster: to closed forms, to the float64 reference, and to each other.

#![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

mod common;

use glam::DVec3;
use volgraph_optics::Material;
use volgraph_reference::{
    Background, Field, Gradients, Lamp, Layer, Look, Materials, Place, Rays, Scene, Shadow, Silent,
    Technique, Tone, Window, render,
};
use volgraph_software::{Extremum, Isosurface, Projection, RangeMap, Refinement, VoxelGrid};
use volgraph_volume::{Grid, ScalarType, Volume};

use common::{EYE, bits, rays, volume};

const MATERIAL: Material = Material {
    ambient: 0.3,
    diffuse: 0.6,
    specular: 0.4,
    shininess: 20.0,
};

/// What is drawn of a volume.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Shows {
    Largest(Extremum),
    Smallest(Extremum),
    Surface(Refinement),
}

/// A volume and all that its pictures need.
struct Stand {
    volume: Volume,
    grid: VoxelGrid,
    ranges: RangeMap,
    lamps: Option<Vec<Lamp>>,
    /// Of the volume's range.
    level: f64,
    is_solid_below: bool,
    has_faces: bool,
}

impl Stand {
    fn new(volume: Volume) -> Self {
        let grid = VoxelGrid::new(&volume).unwrap();
        let lamp = |place, color| Lamp { place, color };
        Self {
            ranges: RangeMap::new(&volume, &grid),
            grid,
            volume,
            lamps: Some(vec![
                lamp(Place::Eye, [0.7, 0.6, 0.5]),
                lamp(Place::Towards(DVec3::Y), [0.3; 3]),
                lamp(Place::At(DVec3::new(0.9, 0.2, 1.0)), [0.2, 0.3, 0.4]),
            ]),
            level: 0.5,
            is_solid_below: false,
            has_faces: true,
        }
    }

    fn range(&self) -> (f64, f64) {
        self.volume.statistics().range().unwrap()
    }

    fn level(&self) -> f64 {
        let (low, high) = self.range();
        low + self.level * (high - low)
    }

    fn window(&self) -> Window {
        let (low, high) = self.range();
        Window {
            low,
            span: high - low,
        }
    }

    /// The picture, with leaps or without, with the machine's own instructions or without.
    fn drawn(&self, shows: Shows, rays: &Rays, leaps: bool, is_own: bool) -> Vec<[f32; 4]> {
        let ranges = leaps.then_some(&self.ranges);
        let (low, high) = self.range();
        let projection = |is_largest, extremum| {
            let it = Projection {
                placement: self.volume.grid(),
                voxels: &self.grid,
                ranges,
                is_largest,
                extremum,
                window: self.window(),
                color: [1.0, 0.8, 0.6],
            };
            if is_own {
                it.render(rays, &[])
            } else {
                it.render_portable(rays, &[])
            }
        };
        match shows {
            Shows::Largest(extremum) => projection(true, extremum),
            Shows::Smallest(extremum) => projection(false, extremum),
            Shows::Surface(refinement) => {
                let it = Isosurface {
                    placement: self.volume.grid(),
                    voxels: &self.grid,
                    ranges,
                    level: self.level(),
                    value_range: high - low,
                    refinement,
                    has_faces: self.has_faces,
                    is_solid_below: self.is_solid_below,
                    color: [0.8, 0.7, 0.5],
                    light: self.lamps.as_deref().map(|lamps| (lamps, MATERIAL)),
                };
                if is_own {
                    it.render(rays, &[])
                } else {
                    it.render_portable(rays, &[])
                }
            }
        }
    }

    fn truth(&self, shows: Shows, rays: &Rays) -> Vec<[f64; 4]> {
        let technique = match shows {
            Shows::Largest(_) => Technique::Maximum,
            Shows::Smallest(_) => Technique::Minimum,
            Shows::Surface(_) => Technique::Surfaces {
                has_faces: self.has_faces,
                with_matter: false,
            },
        };
        let look = Look {
            matter: None,
            materials: Materials {
                default: MATERIAL,
                by_transfer: false,
            },
            lamps: self.lamps.clone(),
            layers: vec![Layer {
                level: self.level(),
                color: [0.8, 0.7, 0.5],
                opacity: 1.0,
            }],
            is_solid_below: self.is_solid_below,
            tone: Tone::Window(self.window(), [1.0, 0.8, 0.6]),
        };
        let scene = Scene {
            rays: *rays,
            field: Field::new(&self.volume),
            gradients: Gradients::StoredCentral,
            clip: None,
            labels: None,
            technique,
            looks: vec![look],
            shadow: Shadow::None,
            background: Background::Nothing,
        };
        render(&scene, 1e-8, &Silent).unwrap().color
    }

    /// Differences from the reference, of each pixel the largest.
    fn differences(&self, shows: Shows, rays: &Rays) -> Vec<f64> {
        let drawn = self.drawn(shows, rays, true, true);
        let truth = self.truth(shows, rays);
        let is_dark = matches!(shows, Shows::Smallest(_));
        assert!(is_dark || truth.iter().any(|pixel| pixel[3] > 0.2));
        let pairs = drawn.iter().zip(&truth);
        pairs
            .map(|(drawn, truth)| {
                let apart = (0..4).map(|i| (f64::from(drawn[i]) - truth[i]).abs());
                apart.fold(0.0, f64::max)
            })
            .collect()
    }
}

const FIELD: Extremum = Extremum::Field;

#[test]
fn threads_instructions_and_leaps_do_not_change_a_bit() {
    let samples = Extremum::Samples(0.011);
    let all = [
        Shows::Largest(FIELD),
        Shows::Largest(samples),
        Shows::Smallest(FIELD),
        Shows::Smallest(samples),
        Shows::Surface(Refinement::Cubic),
        Shows::Surface(Refinement::Linear(0.011)),
    ];
    for ty in [ScalarType::U8, ScalarType::I16, ScalarType::F32] {
        let stand = Stand::new(volume("marschner_lobb", [37, 30, 21], ty));
        for (shows, is_orthographic) in all.into_iter().flat_map(|it| [(it, false), (it, true)]) {
            let rays = rays(EYE, [61, 43], is_orthographic);
            let plain = bits(&stand.drawn(shows, &rays, false, false));
            assert!(plain.iter().any(|pixel| f32::from_bits(pixel[3]) > 0.2));
            assert!(
                bits(&stand.drawn(shows, &rays, false, true)) == plain,
                "{ty:?} {shows:?}"
            );
            for threads in [1, 2, 5] {
                let pool = rayon::ThreadPoolBuilder::new()
                    .num_threads(threads)
                    .build()
                    .unwrap();
                let drawn = pool.install(|| stand.drawn(shows, &rays, true, true));
                assert!(
                    bits(&drawn) == plain,
                    "{ty:?} {shows:?} of {threads} threads"
                );
            }
        }
    }
}

#[test]
fn extremes_of_the_field_are_those_of_the_reference() {
    let types = [ScalarType::U8, ScalarType::U16, ScalarType::F32];
    for (ty, field) in types
        .into_iter()
        .flat_map(|ty| [(ty, "c60"), (ty, "marschner_lobb")])
    {
        let stand = Stand::new(volume(field, [33, 24, 19], ty));
        for is_orthographic in [false, true] {
            // The second is narrow, so that leaps are by the finest bricks.
            for (eye, size) in [(EYE, [40, 30]), (EYE * 6.0, [120, 90])] {
                let rays = rays(eye, size, is_orthographic);
                for shows in [Shows::Largest(FIELD), Shows::Smallest(FIELD)] {
                    let differences = stand.differences(shows, &rays);
                    let worst = differences.into_iter().fold(0.0, f64::max);
                    // Places are rounded to 1e-5 voxels.
                    assert!(worst < 2e-5, "{field} {ty:?} {shows:?}: {worst}");
                }
            }
        }
    }
}

#[test]
fn extremes_of_samples_come_near_with_the_step() {
    let stand = Stand::new(volume("marschner_lobb", [24; 3], ScalarType::U16));
    let rays = rays(EYE, [32, 32], false);
    let voxel = stand.volume.grid().min_spacing() as f32;
    let errors = [1.0, 0.25, 0.0625].map(|step| {
        let shows = Shows::Largest(Extremum::Samples(step * voxel));
        let differences = stand.differences(shows, &rays);
        let count = differences.len() as f64;
        (differences.iter().map(|it| it * it).sum::<f64>() / count).sqrt()
    });
    // Largest scalars are mostly at the faces of cells, where the field has an edge: one order, not two.
    let order = (errors[0] / errors[2]).log2() / 4.0;
    assert!(order > 0.9 && errors[2] < 1e-3, "{order} {errors:?}");
}

#[test]
fn surfaces_are_those_of_the_reference() {
    for ty in [ScalarType::U8, ScalarType::F32] {
        for (field, level) in [("c60", 0.3), ("marschner_lobb", 0.5)] {
            for (is_solid_below, has_faces) in [(false, true), (true, true), (true, false)] {
                let mut stand = Stand::new(volume(field, [33, 24, 19], ty));
                (stand.level, stand.is_solid_below, stand.has_faces) =
                    (level, is_solid_below, has_faces);
                // Inside of the box as well.
                for (eye, is_orthographic) in [
                    (EYE, false),
                    (EYE, true),
                    (DVec3::new(0.05, 0.02, 0.1), false),
                ] {
                    let rays = rays(eye, [40, 30], is_orthographic);
                    let shows = Shows::Surface(Refinement::Cubic);
                    let mut differences = stand.differences(shows, &rays);
                    differences.sort_by(f64::total_cmp);
                    let count = differences.len();
                    // Where a ray grazes the surface, rounding decides whether it meets it.
                    let (most, worst) =
                        (differences[count - 1 - count / 200], differences[count - 1]);
                    assert!(
                        most < 1e-3,
                        "{field} {ty:?} below {is_solid_below} from {eye}: {most}, at worst {worst}"
                    );
                }
            }
        }
    }
}

#[test]
fn without_light_a_surface_has_its_own_colour_and_linear_crossings_come_near() {
    let mut stand = Stand::new(volume("c60", [32; 3], ScalarType::U8));
    stand.level = 0.3;
    let rays = rays(EYE, [48, 36], false);
    let voxel = stand.volume.grid().min_spacing() as f32;
    let share = |stand: &Stand, refinement: Refinement| {
        let differences = stand.differences(Shows::Surface(refinement), &rays);
        let count = differences.len() as f64;
        (differences.iter().map(|it| it * it).sum::<f64>() / count).sqrt()
    };
    let steps = [1.0, 0.25].map(|step| share(&stand, Refinement::Linear(step * voxel)));
    let cubic = share(&stand, Refinement::Cubic);
    assert!(
        cubic < steps[1] && steps[1] < 0.5 * steps[0],
        "{cubic} {steps:?}"
    );
    stand.lamps = None;
    let picture = stand.drawn(Shows::Surface(Refinement::Cubic), &rays, true, true);
    for pixel in &picture {
        assert!(
            *pixel == [0.0; 4] || *pixel == [0.8, 0.7, 0.5, 1.0],
            "{pixel:?}"
        );
    }
}

#[test]
fn a_plane_is_met_where_it_is_and_lit_by_its_own_angle() {
    // The scalar is x, and the surface the plane x = 3.5 of 8 voxels, seen along x.
    let values: Vec<u8> = (0..512).map(|at| (at % 8) as u8 * 10).collect();
    let grid = Grid::axis_aligned([8; 3], DVec3::ONE, DVec3::splat(-3.5));
    let mut stand = Stand::new(Volume::new("v", grid, values.into()).unwrap());
    stand.lamps = Some(vec![Lamp {
        place: Place::Towards(DVec3::new(-0.6, 0.8, 0.0)),
        color: [1.0; 3],
    }]);
    let rays = rays(DVec3::new(-40.0, 0.0, 0.0), [8, 8], true);
    let half_way = (DVec3::new(-0.6, 0.8, 0.0) - DVec3::X).normalize();
    let highlight = 0.4 * half_way.x.abs().powf(20.0);
    for pixel in stand.drawn(Shows::Surface(Refinement::Cubic), &rays, true, true) {
        for (channel, color) in [0.8, 0.7, 0.5].into_iter().enumerate() {
            let truth = color * (0.3 + 0.6 * 0.6) + highlight;
            assert!(
                (f64::from(pixel[channel]) - truth).abs() < 2e-6,
                "{pixel:?}"
            );
        }
    }
}

#[test]
#[ignore = "prints times"]
fn times() {
    for field in ["marschner_lobb", "c60"] {
        let field = volgraph_volume::analytic::AnalyticField::by_name(field, &[]).unwrap();
        let volume = volgraph_volume::analytic::sample(&field, [128; 3], ScalarType::U8).unwrap();
        let stand = Stand::new(volume);
        let began = std::time::Instant::now();
        let _ = RangeMap::new(&stand.volume, &stand.grid);
        println!("map {:?}", began.elapsed());
        let (low, high) = stand.volume.grid().box_index();
        println!(
            "box {:?}",
            stand.volume.grid().world_from_index.transform_point3(high)
                - stand.volume.grid().world_from_index.transform_point3(low)
        );
        let eye = DVec3::new(1.233698739002, 0.863589117302, 1.603808360703);
        let forward = -eye.normalize();
        let right = forward.cross(DVec3::Y).normalize();
        let half = (15.0_f64).to_radians().tan();
        let rays = Rays {
            eye,
            right,
            up: right.cross(forward),
            forward,
            half_extent: [half, half],
            is_orthographic: false,
            size: [512, 512],
        };
        let voxel = stand.volume.grid().min_spacing() as f32;
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(1)
            .build()
            .unwrap();
        for shows in [
            Shows::Largest(FIELD),
            Shows::Largest(Extremum::Samples(voxel)),
            Shows::Smallest(FIELD),
            Shows::Surface(Refinement::Cubic),
            Shows::Surface(Refinement::Linear(voxel)),
        ] {
            for leaps in [true, false] {
                let cpu = || {
                    let text = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap();
                    text.split(' ').next().unwrap().parse::<f64>().unwrap() / 1e6
                };
                let mut all: Vec<f64> = (0..9)
                    .map(|_| {
                        pool.install(|| {
                            let began = cpu();
                            assert!(stand.drawn(shows, &rays, leaps, true).len() > 3);
                            cpu() - began
                        })
                    })
                    .collect();
                all.sort_by(f64::total_cmp);
                println!(
                    "{shows:?} leaps {leaps}: least {:.1} median {:.1}",
                    all[0], all[4]
                );
            }
        }
    }
}
