//! The shear that makes parallel rays run along an axis of the volume, and the image that they meet.

use glam::{DAffine3, DMat2, DVec2, DVec3};
use volgraph_reference::Rays;
use volgraph_volume::Grid;

/// Parallel rays in index coordinates. A ray is known by the two coordinates `uv` where it passes slice 0 of the main axis;
/// at slice `z` it is at `uv + z · slope`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shear {
    /// The main axis.
    pub axis: usize,
    /// Change of the coordinates along rows and across them for each slice; -1 to 1 for the axis that rays run along most.
    pub slope: [f64; 2],
    /// Whether rays meet slices in rising order.
    pub is_rising: bool,
    /// World length of a ray from slice to slice.
    pub world_per_slice: f64,
    /// The box: along rows, across them, and along the main axis.
    pub low: [f64; 3],
    /// Its other end.
    pub high: [f64; 3],
    /// The slice where a ray passes the plane of the eye: at `uv` 0, and for each of both.
    eye: [f64; 3],
    /// `uv` of the middle of the picture, and for each of -1 to 1 to the right and to the top.
    middle: DVec2,
    uv_from_picture: DMat2,
}

/// The axes along rows and across them, of slices of a main axis.
pub(super) fn row_axes(axis: usize) -> [usize; 2] {
    match axis {
        0 => [1, 2],
        1 => [0, 2],
        _ => [0, 1],
    }
}

impl Shear {
    /// The axis of a volume that rays run along most, in voxels; of equals the first.
    #[must_use]
    pub fn main_axis(grid: &Grid, rays: &Rays) -> usize {
        let index_from_world: DAffine3 = grid.world_from_index.inverse();
        let along = index_from_world
            .transform_vector3(rays.forward)
            .abs()
            .to_array();
        let mut best = 0;
        for axis in 1..3 {
            if along[axis] > along[best] {
                best = axis;
            }
        }
        best
    }

    /// The shear of rays, which are parallel, along an axis that they are not across.
    #[must_use]
    pub fn along(grid: &Grid, rays: &Rays, axis: usize) -> Self {
        let index_from_world: DAffine3 = grid.world_from_index.inverse();
        let [i, j] = row_axes(axis);
        let order = |v: DVec3| [v[i], v[j], v[axis]];
        let vector = |v: DVec3| order(index_from_world.transform_vector3(v));
        let forward = vector(rays.forward);
        let slope = [forward[0] / forward[2], forward[1] / forward[2]];
        let uv = |at: [f64; 3]| DVec2::new(at[0] - at[2] * slope[0], at[1] - at[2] * slope[1]);
        let eye = order(index_from_world.transform_point3(rays.eye));
        let right = vector(rays.right * rays.half_extent[0]);
        let up = vector(rays.up * rays.half_extent[1]);
        let uv_from_picture = DMat2::from_cols(uv(right), uv(up));
        let picture_from_uv = uv_from_picture.inverse();
        // Along the main axis per u and v, in the plane of the eye.
        let per_uv = picture_from_uv.transpose() * DVec2::new(right[2], up[2]);
        let middle = uv(eye);
        let (low, high) = grid.box_index();
        Self {
            axis,
            slope,
            is_rising: forward[2] > 0.0,
            world_per_slice: forward[2].abs().recip(),
            low: order(low),
            high: order(high),
            eye: [eye[2] - per_uv.dot(middle), per_uv.x, per_uv.y],
            middle,
            uv_from_picture,
        }
    }

    /// The two coordinates of the ray through a place of the picture, -1 to 1 to the right and to the top.
    #[must_use]
    pub fn uv(&self, place: [f64; 2]) -> [f64; 2] {
        (self.middle + self.uv_from_picture * DVec2::from_array(place)).to_array()
    }

    /// The slice where a ray passes the plane of the eye.
    pub(super) fn eye(&self, uv: [f64; 2]) -> f64 {
        self.eye[0] + self.eye[1] * uv[0] + self.eye[2] * uv[1]
    }

    /// How much that changes along rows.
    pub(super) fn eye_per_u(&self) -> f64 {
        self.eye[1]
    }

    /// The slices between which a ray is in the box and before the eye; the first is larger where it is nowhere.
    pub(super) fn interval(&self, uv: [f64; 2]) -> [f64; 2] {
        let eye = self.eye(uv);
        let mut from = self.low[2];
        let mut to = self.high[2];
        if self.is_rising {
            from = from.max(eye);
        } else {
            to = to.min(eye);
        }
        for (axis, at) in uv.into_iter().enumerate() {
            let slope = self.slope[axis];
            let ends = [self.low[axis] - at, self.high[axis] - at];
            if slope.abs() > 1e-12 {
                let [a, b] = ends.map(|end| end / slope);
                from = from.max(a.min(b));
                to = to.min(a.max(b));
            } else if ends[0] > 0.0 || ends[1] < 0.0 {
                return [1.0, 0.0];
            }
        }
        [from, to]
    }
}

/// The intermediate image: where its pixels are in the coordinates of a shear. The outermost ones are beside the box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Pixels along rows.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Pixels for each voxel.
    pub scale: f64,
    /// The coordinates of the first pixel.
    pub first: [f64; 2],
}

impl Frame {
    /// The image of a whole box.
    #[must_use]
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "sizes of images"
    )]
    pub fn new(shear: &Shear, scale: f64) -> Self {
        let bounds = [0, 1].map(|axis| {
            let shift = [shear.low[2], shear.high[2]].map(|slice| -slice * shear.slope[axis]);
            let low = shear.low[axis] + shift[0].min(shift[1]);
            let high = shear.high[axis] + shift[0].max(shift[1]);
            [
                ((low * scale).floor() - 1.0) / scale,
                ((high * scale).ceil() + 1.0) / scale,
            ]
        });
        let size = bounds.map(|[low, high]| ((high - low) * scale).round() as usize + 1);
        Self {
            width: size[0],
            height: size[1],
            scale,
            first: bounds.map(|[low, _]| low),
        }
    }

    /// The most pixels that it may have of a grid with these voxels, from any direction.
    #[must_use]
    pub fn most_pixels(dims: [u32; 3], scale: f64) -> f64 {
        let [x, y, z] = dims.map(|n| f64::from(n) * scale);
        let pixels = |a: f64, b: f64, main: f64| (a + main + 4.0) * (b + main + 4.0);
        pixels(x, y, z).max(pixels(x, z, y)).max(pixels(y, z, x))
    }
}
