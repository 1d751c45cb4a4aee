//! Colour and opacity of eight segments: `slot/classify/post.wgsl` and `integral_1d.wgsl`.

use crate::grid::Sampled;
use crate::lanes::{Lanes, four, three};
use crate::tables::{Attenuation, Classify, Tables};
use crate::walk::{Classified, Segments, Walk};

/// The transfer function at the centre of a segment.
pub(crate) struct Post<L: Lanes> {
    place: (L::F, L::F),
}

/// Factor and summand of places.
#[inline(always)]
fn places<L: Lanes>(l: L, tables: &Tables) -> (L::F, L::F) {
    (l.splat(tables.place.0), l.splat(tables.place.1))
}

/// Whether any active lane is above the scalars of which nothing is seen.
#[inline(always)]
fn is_clear<L: Lanes>(l: L, tables: &Tables, place: L::F, active: L::M) -> bool {
    let above = l.less(l.splat(tables.clear_below), place);
    l.bits(l.both(above, active)) == 0
}

impl<L: Lanes> Classified<L> for Post<L> {
    #[inline(always)]
    fn new(walk: &Walk<'_, L>) -> Self {
        Self {
            place: places(walk.l, walk.raycast.tables),
        }
    }

    #[inline(always)]
    fn segments<S: Sampled>(
        &mut self,
        walk: &Walk<'_, L>,
        cells: &S,
        segments: &Segments<L>,
    ) -> Option<[L::F; 4]> {
        let (l, tables) = (walk.l, walk.raycast.tables);
        let length = l.sub(segments.end, segments.start);
        let centre = l.mul_add(length, l.splat(0.5), segments.start);
        let scalar = cells.sample(l, walk.position(centre));
        let place = l.mul_add(scalar, self.place.0, self.place.1);
        if is_clear(l, tables, place, segments.active) {
            return None;
        }
        let inside = l.clamp(place, l.splat(0.0), l.splat(tables.last));
        let entry = l.truncated(l.add(inside, l.splat(0.5)));
        let mut shown = l.gather_rows(&tables.whole, entry);
        if segments.is_short {
            let [r, g, b, extinction] = l.gather_rows(&tables.rows, entry);
            let per_extinction = l.mul(length, l.splat(tables.halvings_per_world));
            let through = l.halved(l.mul(extinction, per_extinction));
            let opacity = l.sub(l.splat(1.0), through);
            let is_whole = l.at_least(segments.end, segments.whole_end);
            let short = [
                l.mul(r, opacity),
                l.mul(g, opacity),
                l.mul(b, opacity),
                through,
            ];
            for channel in 0..4 {
                shown[channel] = l.select(is_whole, shown[channel], short[channel]);
            }
        }
        Some(shown)
    }
}

/// Means of the transfer function between the scalars of a segment's ends.
pub(crate) struct Integral1d<L: Lanes> {
    place: (L::F, L::F),
    is_exact: bool,
    /// At the front of the next segment; `None` after a leap.
    front: Option<L::F>,
    /// Integral up to there: a float, and what is left of it.
    integral: Option<[[L::F; 4]; 2]>,
}

/// Of all fours of lines, of which the first starts at 0 and the last is 1, those with the smallest error: slopes over
/// halvings and starts.
const LINES: [(f32, f32); 4] = [
    (0.795_102_7 * std::f32::consts::LN_2, 0.0),
    (0.347_700_56 * std::f32::consts::LN_2, 0.262_390_86),
    (0.081_134_1 * std::f32::consts::LN_2, 0.692_492_3),
    (0.0, 1.0),
];

impl<L: Lanes> Integral1d<L> {
    /// The place of the scalar at distances from the entry.
    #[inline(always)]
    fn place_at<S: Sampled>(&self, walk: &Walk<'_, L>, cells: &S, distance: L::F) -> L::F {
        let scalar = cells.sample(walk.l, walk.position(distance));
        walk.l.mul_add(scalar, self.place.0, self.place.1)
    }

    /// The integral up to places.
    #[inline(always)]
    fn integral_to(l: L, tables: &Tables, place: L::F) -> [[L::F; 4]; 2] {
        // Column 0 is what is below the range, the last one what is above.
        let one = l.splat(1.0);
        let from_first = l.clamp(l.add(place, one), l.splat(0.0), l.splat(tables.last + 1.0));
        let column = l.truncated(from_first);
        let part = l.sub(place, l.sub(l.float(column), one));
        let row = l.mul_whole(column, l.whole(3));
        let integral = l.gather_rows(&tables.integrals, row);
        let rest = l.gather_rows(&tables.integrals, l.add_whole(row, l.whole(1)));
        let change = l.gather_rows(&tables.integrals, l.add_whole(row, l.whole(2)));
        let rest = four(
            #[inline(always)]
            |i| l.mul_add(part, change[i], rest[i]),
        );
        [integral, rest]
    }

    /// Colour times extinction, and extinction, linear between entries.
    #[inline(always)]
    fn linear(l: L, tables: &Tables, place: L::F) -> [L::F; 4] {
        #[expect(clippy::cast_precision_loss, reason = "some thousand")]
        let last = (tables.rows.len() - 1) as f32;
        let entry = l.clamp(
            l.mul(place, l.splat(tables.rows_per_place)),
            l.splat(0.0),
            l.splat(last),
        );
        let low = l.truncated(l.min(entry, l.splat(last - 1.0)));
        let part = l.sub(entry, l.float(low));
        let near = l.gather_rows(&tables.rows, low);
        let far = l.gather_rows(&tables.rows, l.add_whole(low, l.whole(1)));
        let extinction = l.mix(near[3], far[3], part);
        let [r, g, b] = three(
            #[inline(always)]
            |i| l.mul(l.mix(near[i], far[i], part), extinction),
        );
        [r, g, b, extinction]
    }
}

impl<L: Lanes> Classified<L> for Integral1d<L> {
    #[inline(always)]
    fn new(walk: &Walk<'_, L>) -> Self {
        let tables = walk.raycast.tables;
        Self {
            place: places(walk.l, tables),
            is_exact: tables.classify == Classify::Integral1d(Attenuation::Exact),
            front: None,
            integral: None,
        }
    }

    #[inline(always)]
    fn leapt(&mut self) {
        self.front = None;
        self.integral = None;
    }

    #[inline(always)]
    fn segments<S: Sampled>(
        &mut self,
        walk: &Walk<'_, L>,
        cells: &S,
        segments: &Segments<L>,
    ) -> Option<[L::F; 4]> {
        let (l, tables) = (walk.l, walk.raycast.tables);
        let front = match self.front {
            Some(front) => front,
            None => self.place_at(walk, cells, segments.start),
        };
        let back = self.place_at(walk, cells, segments.end);
        self.front = Some(back);
        // Nothing is seen below the threshold, but what is between two samples may be above (Knittel 2002, section 2.3).
        if is_clear(l, tables, l.max(front, back), segments.active) {
            self.integral = None;
            return None;
        }
        let [integral_front, rest_front] = match self.integral {
            Some(integral) => integral,
            None => Self::integral_to(l, tables, front),
        };
        let [integral, rest] = Self::integral_to(l, tables, back);
        self.integral = Some([integral, rest]);
        let change = l.sub(back, front);
        let zero = l.splat(0.0);
        let size = l.max(change, l.sub(zero, change));
        let is_flat = l.less(size, l.splat(1.0));
        let per_change = l.div(l.splat(1.0), l.select(is_flat, l.splat(1.0), change));
        let mut mean = four(
            #[inline(always)]
            |i| {
                let whole = l.sub(integral[i], integral_front[i]);
                let sum = l.add(whole, l.sub(rest[i], rest_front[i]));
                l.max(l.mul(sum, per_change), zero)
            },
        );
        // Inside of one entry the table knows no more than its mean.
        if l.bits(l.both(is_flat, segments.active)) != 0 {
            let centre = l.mul(l.add(front, back), l.splat(0.5));
            let linear = Self::linear(l, tables, centre);
            for channel in 0..4 {
                mean[channel] = l.select(is_flat, linear[channel], mean[channel]);
            }
        }
        let length = l.sub(segments.end, segments.start);
        let halvings = l.mul(mean[3], l.mul(length, l.splat(tables.halvings_per_world)));
        let opacity = if self.is_exact {
            l.sub(l.splat(1.0), l.halved(halvings))
        } else {
            let [a, b, c, _] = four(
                #[inline(always)]
                |line| {
                    let (slope, start) = LINES[line];
                    l.mul_add(halvings, l.splat(slope), l.splat(start))
                },
            );
            l.min(l.min(a, b), l.min(c, l.splat(1.0)))
        };
        let share = l.div(opacity, l.max(mean[3], l.splat(1e-30)));
        Some([
            l.mul(mean[0], share),
            l.mul(mean[1], share),
            l.mul(mean[2], share),
            l.sub(l.splat(1.0), opacity),
        ])
    }
}
