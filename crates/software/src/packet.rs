//! Eight neighbouring rays, from float64 to where they cross the volume's box.

use glam::{DAffine3, DVec3};
use volgraph_reference::Rays;
use volgraph_volume::Grid;

use crate::lanes::COUNT;

/// Pixels of a packet to the right and down.
pub(crate) const SIZE: [u32; 2] = [4, 2];

/// Eight rays inside of the box.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Packet {
    /// Where they enter it, in index coordinates.
    pub(crate) entry: [[f32; COUNT]; 3],
    /// What is added to that for each world unit.
    pub(crate) slope: [[f32; COUNT]; 3],
    /// World distance to where they leave it; 0 of rays that do not meet it.
    pub(crate) length: [f32; COUNT],
}

/// The box and its rays.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lens<'a> {
    rays: &'a Rays,
    low: DVec3,
    high: DVec3,
    /// In index coordinates: the eye, and per unit to the right, to the top and into the picture.
    eye: DVec3,
    right: DVec3,
    up: DVec3,
    forward: DVec3,
    corners: [DVec3; 8],
    /// World lengths that are rounding errors.
    least: f64,
}

impl<'a> Lens<'a> {
    pub(crate) fn new(rays: &'a Rays, grid: &Grid) -> Self {
        let (low, high) = grid.box_index();
        let index_from_world: DAffine3 = grid.world_from_index.inverse();
        let vector = |v: DVec3| index_from_world.transform_vector3(v);
        Self {
            rays,
            low,
            high,
            eye: index_from_world.transform_point3(rays.eye),
            right: vector(rays.right) * rays.half_extent[0],
            up: vector(rays.up) * rays.half_extent[1],
            forward: vector(rays.forward),
            corners: grid.corners_world(),
            least: 1e-4 * grid.min_spacing(),
        }
    }

    /// The rays of the pixels to the right of and below one.
    #[inline(always)]
    #[expect(clippy::cast_possible_truncation, reason = "walks are in f32")]
    pub(crate) fn packet(&self, x: u32, y: u32) -> Packet {
        let mut packet = Packet {
            entry: [[0.0; COUNT]; 3],
            slope: [[0.0; COUNT]; 3],
            length: [0.0; COUNT],
        };
        let [width, height] = self.rays.size;
        let [half_width, half_height] = self.rays.half_extent;
        let mut lane = 0;
        for y in y..y + SIZE[1] {
            for x in x..x + SIZE[0] {
                let [across, up] = self.rays.place(x, y);
                let aside = across * self.right + up * self.up;
                let (origin, slope) = if self.rays.is_orthographic {
                    (self.eye + aside, self.forward)
                } else {
                    let (a, b) = (across * half_width, up * half_height);
                    // The directions are orthonormal in the world.
                    let length = (1.0 + a * a + b * b).sqrt();
                    (self.eye, (self.forward + aside) / length)
                };
                // A ray along a face has no crossing with it; a tiny slope keeps the division finite.
                let tiny = slope.abs().cmplt(DVec3::splat(1e-20));
                let inverse = DVec3::select(tiny, DVec3::splat(1e-20), slope).recip();
                let (a, b) = (
                    (self.low - origin) * inverse,
                    (self.high - origin) * inverse,
                );
                let near = a.min(b).max_element().max(0.0);
                let far = a.max(b).min_element();
                let entry = origin + near * slope;
                for axis in 0..3 {
                    packet.entry[axis][lane] = entry[axis] as f32;
                    packet.slope[axis][lane] = slope[axis] as f32;
                }
                if far > near + self.least && x < width && y < height {
                    packet.length[lane] = (far - near) as f32;
                }
                lane += 1;
            }
        }
        packet
    }

    /// The pixels that the box may cover: from x and y up to x and y, without the latter.
    pub(crate) fn bounds(&self) -> [[u32; 2]; 2] {
        let rays = self.rays;
        let mut low = [f64::INFINITY; 2];
        let mut high = [f64::NEG_INFINITY; 2];
        for corner in self.corners {
            let from_eye = corner - rays.eye;
            let depth = from_eye.dot(rays.forward);
            let distance = if rays.is_orthographic { 1.0 } else { depth };
            if distance < 1e-6 * from_eye.length() {
                // It reaches beside the eye or behind it.
                return [[0; 2], rays.size];
            }
            let place = [from_eye.dot(rays.right), -from_eye.dot(rays.up)];
            for axis in 0..2 {
                let at = place[axis] / (distance * rays.half_extent[axis]);
                let pixel = (0.5 + 0.5 * at) * f64::from(rays.size[axis]);
                low[axis] = low[axis].min(pixel);
                high[axis] = high[axis].max(pixel);
            }
        }
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "clamped to the picture"
        )]
        let pixel = |at: f64, axis: usize| at.clamp(0.0, f64::from(rays.size[axis])) as u32;
        [
            [0, 1].map(|axis| pixel(low[axis] - 1.0, axis)),
            [0, 1].map(|axis| pixel(high[axis] + 2.0, axis)),
        ]
    }
}
