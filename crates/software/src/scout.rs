//! Which parts of a tile's rays may see anything: one ray looks at bricks ahead for all of them.
//!
//! Distances are world lengths from a plane of equal distance to the eye, the nearest at which any ray of the tile enters
//! the box. The scout goes through the tile's middle; a brick, with as many around it as are empty too, is empty for the
//! whole tile where it holds all that is as far from the scout as the tile's corners.

use glam::DVec3;

use crate::empty::DistanceMap;
use crate::packet::Packet;

/// Most spans of a tile. The last one goes on to the end where there would be more.
const MOST: usize = 16;

/// Voxels that positions are rounded by, and much more.
const ROUNDING: f32 = 0.02;

/// Parts of rays that are to be walked; what is between them is empty for all of them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Spans {
    spans: [[f32; 2]; MOST],
    count: usize,
    /// World distance from the eye of their 0.
    zero: f64,
}

impl Spans {
    /// All of the rays.
    pub(crate) const WHOLE: Self = Self {
        spans: [[0.0, f32::INFINITY]; MOST],
        count: 1,
        zero: 0.0,
    };

    fn add(&mut self, from: f32, to: f32) {
        match self.spans.get_mut(self.count) {
            Some(span) => {
                *span = [from, to];
                self.count += 1;
            }
            None => self.spans[MOST - 1][1] = to,
        }
    }

    /// Numbers of a packet's segments that may see anything: from the first of each span to the one after its last.
    #[inline(always)]
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "numbers of segments; what is below 0 or beyond the last one is clamped"
    )]
    pub(crate) fn segments(
        &self,
        packet: &Packet,
        step_world: f32,
    ) -> impl Iterator<Item = [u32; 2]> + '_ {
        let per_world = step_world.recip();
        let [least, most] = packet.near.map(|near| (near - self.zero) as f32);
        self.spans[..self.count].iter().map(move |[from, to]| {
            // A little more on either side: distances are rounded.
            let first = ((from - most) * per_world - 1e-2) as u32;
            let end = ((to - least) * per_world + 1.01).min(4e9) as u32;
            [first, end]
        })
    }
}

/// A tile's rays: the one in the middle, and how far the others are from it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scout {
    /// Index coordinates at the distance 0, and what is added for each world unit.
    pub(crate) entry: DVec3,
    pub(crate) slope: DVec3,
    /// Voxels along each axis within which all rays of the tile are.
    pub(crate) beside: DVec3,
    /// World distances from the eye of the first entry and the last exit.
    pub(crate) range: [f64; 2],
}

impl Scout {
    /// The spans, of a volume of so many voxels; a look takes the scout on by at least so far.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        clippy::cast_precision_loss,
        reason = "numbers of bricks, clamped to the map; walks are in f32"
    )]
    pub(crate) fn spans(&self, map: &DistanceMap, dims: [u32; 3], least_world: f32) -> Spans {
        let entry = self.entry.as_vec3().to_array();
        let slope = self.slope.as_vec3().to_array();
        let beside = self
            .beside
            .as_vec3()
            .to_array()
            .map(|it| 1.01 * it + ROUNDING);
        let inverse = slope.map(|slope| {
            if slope.abs() < 1e-20 {
                1e20
            } else {
                slope.recip()
            }
        });
        let last = dims.map(|n| (n - 1) as f32);
        let edge = map.edge as f32;
        let [nx, ny, _] = map.dims;
        let length = (self.range[1] - self.range[0]) as f32;
        let mut spans = Spans {
            count: 0,
            zero: self.range[0],
            ..Spans::WHOLE
        };
        let mut from: Option<f32> = None;
        let mut distance = 0.0_f32;
        while distance < length {
            let at = [0, 1, 2].map(|i| entry[i] + distance * slope[i]);
            let brick = [0, 1, 2].map(|i| (at[i].clamp(0.0, last[i]) / edge) as u32);
            let place = (brick[2] * ny + brick[1]) * nx + brick[0];
            let away = map
                .away
                .get(place as usize)
                .map_or(-1, |away| away.cast_signed());
            // Bricks of the same kind on each side.
            let around = away.unsigned_abs().saturating_sub(1) as f32;
            let is_empty = away > 0;
            let mut exit = f32::INFINITY;
            for axis in 0..3 {
                let apart = if is_empty { beside[axis] } else { 0.0 };
                let first = brick[axis] as f32;
                let low = (first - around) * edge;
                let high = (first + around + 1.0) * edge;
                // The outer bricks go on outside.
                let low = if low <= 0.0 {
                    f32::NEG_INFINITY
                } else {
                    low + apart
                };
                let high = if high >= last[axis] {
                    f32::INFINITY
                } else {
                    high - apart
                };
                let face = if slope[axis] < 0.0 { low } else { high };
                let is_out = is_empty && !(low..=high).contains(&at[axis]);
                let leaves = if is_out {
                    0.0
                } else {
                    (face - at[axis]) * inverse[axis]
                };
                exit = exit.min(leaves);
            }
            if is_empty && exit > least_world {
                if let Some(from) = from.take() {
                    spans.add(from, distance);
                }
                distance += exit;
                continue;
            }
            from.get_or_insert(distance);
            distance += exit.max(least_world);
        }
        if let Some(from) = from {
            spans.add(from, f32::INFINITY);
        }
        spans
    }
}
