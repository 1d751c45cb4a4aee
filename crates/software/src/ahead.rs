//! What lies ahead of a packet: spans of its rays, and between which scalars all that they meet is.
//!
//! Distances are world lengths from where the first ray enters the box, the same for all of its rays from the eye.

use crate::lanes::{COUNT, Lanes, three};
use crate::packet::Packet;
use crate::ranges::{RangeLevel, RangeMap};

/// Most spans of a packet.
pub(crate) const MOST: usize = 256;

/// Voxels that positions are rounded by, and much more.
pub(crate) const ROUNDING: f32 = 0.02;

/// Spans of the same length from 0 on.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ahead {
    /// Bounds of raw scalars.
    pub(crate) low: [f32; MOST],
    pub(crate) high: [f32; MOST],
    pub(crate) count: usize,
    /// World length of a span.
    pub(crate) length: f32,
}

impl Ahead {
    /// Nothing is known.
    #[inline(always)]
    fn whole(packet: &Packet) -> Self {
        Self {
            low: [f32::NEG_INFINITY; MOST],
            high: [f32::INFINITY; MOST],
            count: 1,
            length: total(packet),
        }
    }

    /// The spans of a packet in a volume of so many voxels; one where nothing is known of the volume.
    #[inline(always)]
    #[expect(
        clippy::cast_precision_loss,
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "numbers of spans"
    )]
    pub(crate) fn new<L: Lanes>(
        l: L,
        packet: &Packet,
        map: Option<&RangeMap>,
        last: [f32; 3],
    ) -> Self {
        let mut ahead = Self::whole(packet);
        let Some(map) = map else {
            return ahead;
        };
        let total = ahead.length;
        let middle = Middle::new(packet, total);
        let way = middle.way[0].abs().max(middle.way[1].abs());
        let way = way.max(middle.way[2].abs());
        let fits = |level: &&RangeLevel| {
            let apart = middle.beside + ROUNDING;
            apart <= 0.5 * level.edge && way <= level.edge * MOST as f32
        };
        let Some(level) = map.levels.iter().find(fits).or(map.levels.last()) else {
            return ahead;
        };
        // The last level's brick holds everything.
        ahead.count = ((way / level.edge).ceil() as usize).clamp(1, MOST);
        ahead.length = total / ahead.count as f32;
        let share = (ahead.count as f32).recip();
        let lanes = l.floats([0.5, 1.5, 2.5, 3.5, 4.5, 5.5, 6.5, 7.5]);
        let (base, unit) = (l.splat(map.scalars.0), l.splat(map.scalars.1));
        for first in (0..ahead.count).step_by(COUNT) {
            let at = l.mul(l.add(l.splat(first as f32), lanes), l.splat(share));
            let [x, y, z] = three(
                #[inline(always)]
                |axis| {
                    let point =
                        l.mul_add(at, l.splat(middle.way[axis]), l.splat(middle.start[axis]));
                    let inside = l.clamp(point, l.splat(0.0), l.splat(last[axis]));
                    l.truncated(l.mul(inside, l.splat(level.edge.recip())))
                },
            );
            let row = l.add_whole(l.mul_whole(y, l.whole(level.row)), x);
            let place = l.add_whole(l.mul_whole(z, l.whole(level.layer)), row);
            let word = l.gather(&level.words, place);
            let low = l.array(l.mul_add(l.half::<0>(word), unit, base));
            let high = l.array(l.mul_add(l.half::<16>(word), unit, base));
            ahead.low[first..first + COUNT].copy_from_slice(&low);
            ahead.high[first..first + COUNT].copy_from_slice(&high);
        }
        ahead
    }

    /// Where a span starts; the last one's end goes on.
    #[inline(always)]
    #[expect(clippy::cast_precision_loss, reason = "numbers of spans")]
    pub(crate) fn start(&self, span: usize) -> f32 {
        if span >= self.count {
            return f32::INFINITY;
        }
        span as f32 * self.length
    }
}

/// World length from the first entry to the last exit.
#[expect(clippy::cast_possible_truncation, reason = "walks are in f32")]
fn total(packet: &Packet) -> f32 {
    (packet.far - packet.near[0]) as f32
}

/// A line between all rays.
struct Middle {
    start: [f32; 3],
    /// From its start to its end.
    way: [f32; 3],
    /// Voxels along any axis within which all rays are.
    beside: f32,
}

impl Middle {
    #[inline(always)]
    fn new(packet: &Packet, total: f32) -> Self {
        let mut middle = Self {
            start: [0.0; 3],
            way: [0.0; 3],
            beside: 0.0,
        };
        for axis in 0..3 {
            let mut ends = [[f32::INFINITY, f32::NEG_INFINITY]; 2];
            for lane in 0..COUNT {
                if packet.length[lane] <= 0.0 {
                    continue;
                }
                let (entry, slope) = (packet.entry[axis][lane], packet.slope[axis][lane]);
                let first = entry - packet.after[lane] * slope;
                for (end, at) in ends.iter_mut().zip([first, first + total * slope]) {
                    *end = [end[0].min(at), end[1].max(at)];
                }
            }
            let [first, second] = [0, 1].map(|i| 0.5 * (ends[i][0] + ends[i][1]));
            middle.start[axis] = first;
            middle.way[axis] = second - first;
            let beside = [0, 1].map(|i| 0.5 * (ends[i][1] - ends[i][0]));
            middle.beside = middle.beside.max(beside[0]).max(beside[1]);
        }
        middle
    }
}
