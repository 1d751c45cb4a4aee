//! A walk of eight rays through a volume, segment by segment, from front to back.

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

/// Eight rays.
pub(crate) struct Walk<'a, L: Lanes> {
    pub(crate) l: L,
    pub(crate) raycast: &'a Raycast<'a>,
    entry: [L::F; 3],
    slope: [L::F; 3],
    length: L::F,
    longest: f32,
}

impl<'a, L: Lanes> Walk<'a, L> {
    #[inline(always)]
    pub(crate) fn new(l: L, raycast: &'a Raycast<'a>, packet: &Packet) -> Self {
        Self {
            l,
            raycast,
            entry: three(
                #[inline(always)]
                |axis| l.floats(packet.entry[axis]),
            ),
            slope: three(
                #[inline(always)]
                |axis| l.floats(packet.slope[axis]),
            ),
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

    /// Light of the rays, of these of their segments: premultiplied colour, and the share that goes through.
    #[inline(always)]
    pub(crate) fn shown<S: Sampled, C: Classified<L>>(
        &self,
        cells: &S,
        spans: impl Iterator<Item = [u32; 2]>,
    ) -> [[f32; COUNT]; 4] {
        let l = self.l;
        let step = self.raycast.step_world;
        let bound = l.splat(self.raycast.early_termination);
        let mut classify = C::new(self);
        let mut color = [l.splat(0.0); 3];
        let mut open = l.splat(1.0);
        let mut index = 0_u32;
        'spans: for [first, end] in spans {
            if first > index {
                index = first;
                classify.leapt();
            }
            while index < end {
                #[expect(clippy::cast_precision_loss, reason = "as shaders count segments")]
                let [start, whole_end] = [index as f32 * step, (index + 1) as f32 * step];
                if start >= self.longest {
                    break 'spans;
                }
                let starts = l.splat(start);
                let active = l.both(l.less(starts, self.length), l.at_least(open, bound));
                if l.bits(active) == 0 {
                    break 'spans;
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
        }
        let [r, g, b] = color;
        [l.array(r), l.array(g), l.array(b), l.array(open)]
    }
}
