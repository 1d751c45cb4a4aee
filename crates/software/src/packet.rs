//! Eight neighbouring rays, from float64 to where they cross the volume's box.

use glam::{DAffine3, DVec3};
use volgraph_reference::Rays;
use volgraph_volume::Grid;

use crate::lanes::COUNT;
use crate::scout::Scout;

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
    /// World distances from where the first of them enters to where each does, counted from the eye or from its plane.
    pub(crate) after: [f32; COUNT],
    /// World distances from the eye, or from its plane, to where the first and the last of them enter.
    pub(crate) near: [f64; 2],
    /// The same to where the last one leaves.
    pub(crate) far: f64,
}

impl Packet {
    /// Rays that do not meet the box.
    pub(crate) const NONE: Self = Self {
        entry: [[0.0; COUNT]; 3],
        slope: [[0.0; COUNT]; 3],
        length: [0.0; COUNT],
        after: [0.0; COUNT],
        near: [f64::INFINITY, 0.0],
        far: 0.0,
    };
}

/// The smaller one, of numbers only: one instruction.
#[inline(always)]
fn smaller(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

#[inline(always)]
fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
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
    /// Of the picture's half sides, for each pixel.
    per_pixel: [f64; 2],
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
            per_pixel: rays.size.map(|side| 2.0 / f64::from(side)),
            least: 1e-4 * grid.min_spacing(),
        }
    }

    /// The rays of the pixels to the right of and below one.
    #[inline(always)]
    #[expect(clippy::cast_possible_truncation, reason = "walks are in f32")]
    pub(crate) fn packet(&self, x: u32, y: u32) -> Packet {
        let [width, height] = self.rays.size;
        // Axis by axis and lane by lane, so that the compiler takes several lanes at once.
        let (first, top) = (f64::from(x) + 0.5, f64::from(y) + 0.5);
        let mut across = [0.0; COUNT];
        let mut up = [0.0; COUNT];
        for lane in 0..COUNT {
            let (right, down) = (lane % SIZE[0] as usize, lane / SIZE[0] as usize);
            across[lane] = (first + right as f64) * self.per_pixel[0] - 1.0;
            up[lane] = 1.0 - (top + down as f64) * self.per_pixel[1];
        }
        let mut per_length = [1.0; COUNT];
        if !self.rays.is_orthographic {
            let [half_width, half_height] = self.rays.half_extent;
            for lane in 0..COUNT {
                let (a, b) = (across[lane] * half_width, up[lane] * half_height);
                // The directions are orthonormal in the world.
                per_length[lane] = 1.0 / (1.0 + a * a + b * b).sqrt();
            }
        }
        let mut origin = [[0.0; COUNT]; 3];
        let mut slope = [[0.0; COUNT]; 3];
        let mut near = [0.0; COUNT];
        let mut far = [f64::INFINITY; COUNT];
        for axis in 0..3 {
            let (eye, forward) = (self.eye[axis], self.forward[axis]);
            let (right, upward) = (self.right[axis], self.up[axis]);
            let (low, high) = (self.low[axis], self.high[axis]);
            for lane in 0..COUNT {
                let aside = across[lane] * right + up[lane] * upward;
                let (from, along) = if self.rays.is_orthographic {
                    (eye + aside, forward)
                } else {
                    (eye, (forward + aside) * per_length[lane])
                };
                // A ray along a face has no crossing with it; a tiny slope keeps the division finite.
                let inverse = 1.0 / if along.abs() < 1e-20 { 1e-20 } else { along };
                let (a, b) = ((low - from) * inverse, (high - from) * inverse);
                near[lane] = larger(near[lane], smaller(a, b));
                far[lane] = smaller(far[lane], larger(a, b));
                origin[axis][lane] = from;
                slope[axis][lane] = along;
            }
        }
        let mut packet = Packet::NONE;
        for axis in 0..3 {
            for lane in 0..COUNT {
                packet.entry[axis][lane] =
                    (origin[axis][lane] + near[lane] * slope[axis][lane]) as f32;
                packet.slope[axis][lane] = slope[axis][lane] as f32;
            }
        }
        for lane in 0..COUNT {
            let (right, down) = (lane as u32 % SIZE[0], lane as u32 / SIZE[0]);
            // Rays of pixels beyond the picture are walked nowhere.
            let is_inside = x + right < width && y + down < height;
            if is_inside && far[lane] > near[lane] + self.least {
                packet.length[lane] = (far[lane] - near[lane]) as f32;
                packet.near[0] = smaller(packet.near[0], near[lane]);
                packet.near[1] = larger(packet.near[1], near[lane]);
                packet.far = larger(packet.far, far[lane]);
            }
        }
        for (lane, near) in near.into_iter().enumerate() {
            if packet.length[lane] > 0.0 {
                packet.after[lane] = (near - packet.near[0]) as f32;
            }
        }
        packet
    }

    /// Index coordinates of a ray's start, and what is added to that for each world unit.
    fn ray(&self, x: f64, y: f64) -> (DVec3, DVec3) {
        let across = (x + 0.5) * self.per_pixel[0] - 1.0;
        let up = 1.0 - (y + 0.5) * self.per_pixel[1];
        let aside = across * self.right + up * self.up;
        if self.rays.is_orthographic {
            return (self.eye + aside, self.forward);
        }
        let [a, b] = [
            across * self.rays.half_extent[0],
            up * self.rays.half_extent[1],
        ];
        (
            self.eye,
            (self.forward + aside) / (1.0 + a * a + b * b).sqrt(),
        )
    }

    /// The ray in the middle of a tile of pixels, for all of its rays between two world distances.
    pub(crate) fn scout(&self, [left, top]: [u32; 2], size: [u32; 2], range: [f64; 2]) -> Scout {
        let [left, top] = [left, top].map(f64::from);
        let [right, low] = [left + f64::from(size[0] - 1), top + f64::from(size[1] - 1)];
        let (eye, slope) = self.ray(0.5 * (left + right), 0.5 * (top + low));
        let mut beside = DVec3::ZERO;
        for (x, y) in [(left, top), (right, top), (left, low), (right, low)] {
            let (from, along) = self.ray(x, y);
            for distance in range {
                beside = beside.max((from - eye + distance * (along - slope)).abs());
            }
        }
        Scout {
            entry: eye + range[0] * slope,
            slope,
            beside,
            range,
        }
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
