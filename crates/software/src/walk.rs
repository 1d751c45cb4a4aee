//! A walk of eight rays through a volume, segment by segment, from front to back.

use crate::empty::DistanceMap;
use crate::grid::Sampled;
use crate::lanes::{COUNT, Lanes, three};
use crate::packet::Packet;
use crate::raycast::Raycast;

/// Segments of one packet: from where to where, of which rays.
#[derive(Clone, Copy)]
pub(crate) struct Segments<L: Lanes> {
    /// World distance from the entry.
    pub(crate) start: L::F,
    pub(crate) end: L::F,
    /// Rays that have this segment and are not done.
    pub(crate) active: L::M,
    /// Those of them whose segment is shorter than a step.
    pub(crate) is_short: bool,
    /// Where a whole segment would end.
    pub(crate) whole_end: L::F,
}

/// How segments are classified.
pub(crate) trait Classified<L: Lanes> {
    fn new(walk: &Walk<'_, L>) -> Self;

    /// Premultiplied colour and transmittance of segments; `None` where no active one shows anything.
    fn segments<S: Sampled>(
        &mut self,
        walk: &Walk<'_, L>,
        cells: &S,
        segments: &Segments<L>,
    ) -> Option<[L::F; 4]>;

    /// The next segments do not begin where the last ones ended.
    fn leapt(&mut self) {}
}

/// Segments that a look at bricks costs as much as.
const LOOKS: u32 = 4;

/// Eight rays.
pub(crate) struct Walk<'a, L: Lanes> {
    pub(crate) l: L,
    pub(crate) raycast: &'a Raycast<'a>,
    entry: [L::F; 3],
    slope: [L::F; 3],
    inverse: [L::F; 3],
    length: L::F,
    longest: f32,
}

impl<'a, L: Lanes> Walk<'a, L> {
    #[inline(always)]
    pub(crate) fn new(l: L, raycast: &'a Raycast<'a>, packet: &Packet) -> Self {
        let slope = three(
            #[inline(always)]
            |axis| l.floats(packet.slope[axis]),
        );
        let tiny = l.splat(1e-20);
        let inverse = three(
            #[inline(always)]
            |axis| {
                let size = l.max(slope[axis], l.sub(l.splat(0.0), slope[axis]));
                let slope = l.select(l.less(size, tiny), tiny, slope[axis]);
                l.div(l.splat(1.0), slope)
            },
        );
        Self {
            l,
            raycast,
            entry: three(
                #[inline(always)]
                |axis| l.floats(packet.entry[axis]),
            ),
            slope,
            inverse,
            length: l.floats(packet.length),
            longest: packet.length.into_iter().fold(0.0, f32::max),
        }
    }

    /// Index coordinates at world distances from the entry.
    #[inline(always)]
    pub(crate) fn position(&self, distance: L::F) -> [L::F; 3] {
        three(
            #[inline(always)]
            |axis| self.l.mul_add(distance, self.slope[axis], self.entry[axis]),
        )
    }

    /// Light of the rays: premultiplied colour, and the share that goes through.
    #[inline(always)]
    pub(crate) fn shown<S: Sampled, C: Classified<L>>(&self, cells: &S) -> [[f32; COUNT]; 4] {
        let l = self.l;
        let step = self.raycast.step_world;
        let bound = l.splat(self.raycast.early_termination);
        let mut classify = C::new(self);
        let mut color = [l.splat(0.0); 3];
        let mut open = l.splat(1.0);
        let mut index = 0_u32;
        let mut look_at = 0_u32;
        loop {
            #[expect(clippy::cast_precision_loss, reason = "as shaders count segments")]
            let [start, whole_end] = [index as f32 * step, (index + 1) as f32 * step];
            if start >= self.longest {
                break;
            }
            let starts = l.splat(start);
            let active = l.both(l.less(starts, self.length), l.at_least(open, bound));
            if l.bits(active) == 0 {
                break;
            }
            if let Some(map) = self.raycast.empty
                && index >= look_at
            {
                let (next, again) = self.look(map, index, start, active);
                look_at = again;
                if next > index {
                    index = next;
                    classify.leapt();
                    continue;
                }
            }
            let whole_end = l.splat(whole_end);
            let is_short = l.both(active, l.less(self.length, whole_end));
            let segments = Segments {
                start: starts,
                end: l.max(l.min(whole_end, self.length), starts),
                active,
                is_short: l.bits(is_short) != 0,
                whole_end,
            };
            index += 1;
            if let Some(shown) = classify.segments(self, cells, &segments) {
                let zero = l.splat(0.0);
                for channel in 0..3 {
                    let shown = l.select(active, shown[channel], zero);
                    color[channel] = l.mul_add(open, shown, color[channel]);
                }
                open = l.mul(open, l.select(active, shown[3], l.splat(1.0)));
            }
        }
        let [r, g, b] = color;
        [l.array(r), l.array(g), l.array(b), l.array(open)]
    }

    /// The segment to go on with, and the one to look at bricks again before.
    #[inline(always)]
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        clippy::cast_possible_wrap,
        clippy::cast_precision_loss,
        reason = "numbers of segments and of bricks, in f32 or clamped to what it holds"
    )]
    fn look(&self, map: &DistanceMap, index: u32, start: f32, is_active: L::M) -> (u32, u32) {
        let l = self.l;
        let active = l.bits(is_active);
        let at = self.position(l.splat(start));
        let dims = self.raycast.voxels.dims;
        let edge = map.edge as f32;
        let last = dims.map(|n| (n - 1) as f32);
        let brick = three(
            #[inline(always)]
            |axis| {
                let inside = l.clamp(at[axis], l.splat(0.0), l.splat(last[axis]));
                l.truncated(l.mul(inside, l.splat(edge.recip())))
            },
        );
        let [x, y, z] = brick;
        let [nx, ny, _] = map.dims.map(|n| n as i32);
        let row = l.add_whole(l.mul_whole(z, l.whole(ny)), y);
        let place = l.add_whole(l.mul_whole(row, l.whole(nx)), x);
        let away = l.float(l.gather(&map.away, place));
        let beside = l.sub(l.max(away, l.sub(l.splat(0.0), away)), l.splat(1.0));
        let mut exit = l.splat(1e9);
        for axis in 0..3 {
            let first = l.float(brick[axis]);
            let low = l.mul(l.sub(first, beside), l.splat(edge));
            let high = l.mul(l.add(l.add(first, beside), l.splat(1.0)), l.splat(edge));
            // The outer bricks go on outside.
            let low = l.select(l.less(l.splat(0.0), low), low, l.splat(-1e9));
            let high = l.select(l.less(high, l.splat(last[axis])), high, l.splat(1e9));
            let face = l.select(l.less(self.slope[axis], l.splat(0.0)), low, high);
            exit = l.min(exit, l.mul(l.sub(face, at[axis]), self.inverse[axis]));
        }
        let steps = l.mul(
            l.add(exit, l.splat(start)),
            l.splat(self.raycast.step_world.recip()),
        );
        // Whole segments up to there, but for rounding.
        let reach = l.clamp(l.sub(steps, l.splat(1e-3)), l.splat(0.0), l.splat(1e9));
        let is_empty = l.less(l.splat(0.0), away);
        if l.bits(is_empty) & active == active {
            let reach = l.select(is_active, reach, l.splat(1e9));
            let leap = fold(l.array(reach), f32::min) as u32;
            // A short leap says that there is more to see nearby.
            let again = if leap >= index + LOOKS {
                leap
            } else {
                index + LOOKS
            };
            return (leap.max(index), again);
        }
        // Somebody is seen until the last of those has left.
        let is_seen = l.both(is_active, l.less(away, l.splat(0.0)));
        let seen = fold(l.array(l.select(is_seen, reach, l.splat(0.0))), f32::max);
        (index, (seen as u32).max(index + LOOKS))
    }
}

/// All lanes, pair by pair.
#[inline(always)]
fn fold(a: [f32; COUNT], of: impl Fn(f32, f32) -> f32) -> f32 {
    let [a, b] = [
        of(of(a[0], a[1]), of(a[2], a[3])),
        of(of(a[4], a[5]), of(a[6], a[7])),
    ];
    of(a, b)
}
