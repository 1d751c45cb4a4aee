//! Rays and volumes of tests.

use glam::{DAffine3, DMat3, DQuat, DVec3};
use volgraph_reference::Rays;
use volgraph_volume::analytic::{AnalyticField, sample};
use volgraph_volume::{Grid, ScalarType, Volume};

pub fn rays(eye: DVec3, size: [u32; 2], is_orthographic: bool) -> Rays {
    let forward = -eye.normalize();
    let right = forward.cross(DVec3::Y).normalize();
    let half = if is_orthographic { 0.6 } else { 0.3 };
    Rays {
        eye,
        right,
        up: right.cross(forward),
        forward,
        half_extent: [half * f64::from(size[0]) / f64::from(size[1]), half],
        is_orthographic,
        size,
    }
}

/// A field of these voxels along each axis in a box that is turned and has sides of different lengths.
pub fn volume(field: &str, dims: [u32; 3], ty: ScalarType) -> Volume {
    let field = AnalyticField::by_name(field, &[]).unwrap();
    let volume = sample(&field, dims, ty).unwrap();
    let sides = DVec3::new(1.0, 0.8, 0.7);
    let spacing = sides / DVec3::from_array(dims.map(f64::from));
    let matrix = DMat3::from_quat(DQuat::from_axis_angle(DVec3::ONE.normalize(), 0.4))
        * DMat3::from_diagonal(spacing);
    let middle = DVec3::from_array(dims.map(f64::from)) * 0.5 - 0.5;
    let grid = Grid {
        world_from_index: DAffine3 {
            matrix3: matrix,
            translation: -(matrix * middle),
        },
        ..*volume.grid()
    };
    Volume::new("v", grid, volume.voxels().clone()).unwrap()
}

pub fn bits(picture: &[[f32; 4]]) -> Vec<[u32; 4]> {
    picture
        .iter()
        .map(|pixel| pixel.map(f32::to_bits))
        .collect()
}

pub const EYE: DVec3 = DVec3::new(1.1, 0.7, 1.7);
