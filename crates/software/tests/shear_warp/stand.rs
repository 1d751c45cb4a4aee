//! Volumes, rays and settings of the tests.

use std::path::Path;

use glam::{DAffine3, DMat3, DQuat, DVec3};
use volgraph_optics::TransferFunction;
use volgraph_reference::{Field, Look, Materials, Matter, Rays, Scene, Silent, render};
use volgraph_software::Units;
use volgraph_software::shear_warp::{
    BufferSlice, Correction, Hidden, Lookup, Runs, Shear, ShearWarp, SlabClassify, SlabTable,
    Slices,
};
use volgraph_volume::analytic::{AnalyticField, sample};
use volgraph_volume::{Grid, ScalarType, Volume};

/// A peak, a step and a ramp, with nothing at small scalars and in a gap.
pub const TRANSFER: &str = "(domain: range, points: [(at: 0, color: (0, 0, 0), opacity: 0),
    (at: 0.25, color: (0.1, 0.2, 0.9), opacity: 0), (at: 0.4, color: (0.1, 0.6, 0.8), opacity: 0.05),
    (at: 0.5, color: (0.1, 0.6, 0.8), opacity: 0), (at: 0.6, color: (1, 0.8, 0.2), opacity: 0),
    (at: 1, color: (1, 0.9, 0.9), opacity: 0.35)])";

/// One without kinks or gaps.
pub const SMOOTH: &str = "(domain: range, points: [(at: 0, color: (0.1, 0.2, 0.9), opacity: 0.01),
    (at: 1, color: (1, 0.8, 0.2), opacity: 0.2)])";

/// What is asked of a picture.
#[derive(Clone, Copy, Debug)]
pub struct Asked {
    pub classify: SlabClassify,
    pub lookup: Lookup,
    pub correction: Correction,
    pub table_size: u32,
    pub scale: f64,
    pub slices_per_voxel: u32,
    pub early_termination: f32,
    pub buffer: BufferSlice,
    pub has_runs: bool,
}

pub const ASKED: Asked = Asked {
    classify: SlabClassify::Preintegrated,
    lookup: Lookup::Nearest,
    correction: Correction::Exact,
    table_size: 256,
    scale: 1.0,
    slices_per_voxel: 1,
    early_termination: 0.0,
    buffer: BufferSlice::Slice,
    has_runs: false,
};

/// Parallel rays against a direction, towards the origin.
pub fn rays(from: DVec3, half: f64, size: [u32; 2]) -> Rays {
    let forward = -from.normalize();
    let up = if forward.y.abs() > 0.9 {
        DVec3::Z
    } else {
        DVec3::Y
    };
    let right = forward.cross(up).normalize();
    Rays {
        eye: from.normalize() * 100.0,
        right,
        up: right.cross(forward),
        forward,
        half_extent: [half * f64::from(size[0]) / f64::from(size[1]), half],
        is_orthographic: true,
        size,
    }
}

/// These voxels in a grid that is turned and sheared, with sides of different lengths, in the middle of the world.
pub fn placed(volume: &Volume) -> Volume {
    let dims = volume.grid().dims.map(f64::from);
    let spacing = DVec3::new(1.0, 0.8, 0.7) / DVec3::from_array(dims);
    let shear = DMat3::from_cols(
        DVec3::X,
        DVec3::new(0.2, 1.0, 0.0),
        DVec3::new(-0.1, 0.3, 1.0),
    );
    let turn = DMat3::from_quat(DQuat::from_axis_angle(DVec3::ONE.normalize(), 0.4));
    let matrix = turn * shear * DMat3::from_diagonal(spacing);
    let middle = DVec3::from_array(dims) * 0.5 - 0.5;
    let grid = Grid {
        world_from_index: DAffine3 {
            matrix3: matrix,
            translation: -(matrix * middle),
        },
        ..*volume.grid()
    };
    Volume::new("v", grid, volume.voxels().clone()).unwrap()
}

pub fn field(name: &str, dims: [u32; 3], ty: ScalarType) -> Volume {
    let field = AnalyticField::by_name(name, &[]).unwrap();
    placed(&sample(&field, dims, ty).unwrap())
}

pub struct Stand {
    pub volume: Volume,
    pub transfer: TransferFunction,
}

impl Stand {
    pub fn new(volume: Volume, text: &str) -> Self {
        let transfer = TransferFunction::parse(Path::new("t.ron"), text).unwrap();
        Self { volume, transfer }
    }

    pub fn units(&self) -> Units {
        let (low, high) = self.volume.statistics().range().unwrap();
        Units {
            values: (low, if high > low { high - low } else { 1.0 }),
            spacing: self.volume.grid().min_spacing(),
        }
    }

    pub fn with<R>(&self, asked: Asked, rays: &Rays, draw: impl FnOnce(&ShearWarp<'_>) -> R) -> R {
        let grid = self.volume.grid();
        let axis = Shear::main_axis(grid, rays);
        let slices = Slices::new(&self.volume, axis);
        let world = [
            Shear::along(grid, rays, axis).world_per_slice,
            grid.spacing()[axis],
        ];
        let table = SlabTable::new(
            &self.transfer,
            self.units(),
            slices.offset,
            asked.classify,
            asked.lookup,
            asked.correction,
            asked.table_size,
            world.map(|world| world / f64::from(asked.slices_per_voxel)),
        )
        .unwrap();
        let hidden = Hidden::new(
            &self.transfer,
            self.units(),
            asked.classify,
            asked.table_size,
        );
        let runs = asked.has_runs.then(|| Runs::new(&slices, &hidden));
        draw(&ShearWarp {
            placement: grid,
            slices: &slices,
            table: &table,
            runs: runs.as_ref(),
            scale: asked.scale,
            slices_per_voxel: asked.slices_per_voxel,
            early_termination: asked.early_termination,
            buffer: asked.buffer,
        })
    }

    pub fn draw(&self, asked: Asked, rays: &Rays) -> Vec<[f32; 4]> {
        self.with(asked, rays, |it| it.render(rays, &[]))
    }

    pub fn truth(&self, rays: Rays) -> Vec<[f64; 4]> {
        let Units { values, spacing } = self.units();
        let matter = Matter::new(&self.transfer, values, spacing, &Materials::NONE);
        let scene = Scene::unlit(rays, Field::new(&self.volume), Look::unlit(matter));
        render(&scene, 1e-8, &Silent).unwrap().color
    }
}

pub fn bits(picture: &[[f32; 4]]) -> Vec<[u32; 4]> {
    let pixels = picture.iter();
    pixels.map(|pixel| pixel.map(f32::to_bits)).collect()
}

pub fn error(drawn: &[[f32; 4]], truth: &[[f64; 4]]) -> f64 {
    let differences = drawn
        .iter()
        .zip(truth)
        .flat_map(|(drawn, truth)| (0..4).map(|i| (f64::from(drawn[i]) - truth[i]).powi(2)));
    (differences.sum::<f64>() / (4 * truth.len()) as f64).sqrt()
}

/// From each face, and from odd angles along each main axis and both ways.
pub const FROM: [DVec3; 12] = [
    DVec3::X,
    DVec3::NEG_X,
    DVec3::Y,
    DVec3::NEG_Y,
    DVec3::Z,
    DVec3::NEG_Z,
    DVec3::new(1.1, 0.7, 1.7),
    DVec3::new(-1.1, 0.4, -1.7),
    DVec3::new(1.9, 0.7, -1.2),
    DVec3::new(-1.9, -0.7, 1.2),
    DVec3::new(0.3, 1.9, 1.2),
    DVec3::new(0.3, -1.9, 1.5),
];
