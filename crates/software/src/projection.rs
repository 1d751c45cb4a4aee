//! The largest scalar along each ray, or the smallest: `slot/technique/mip.wgsl` and `minip.wgsl`.
//!
//! Samples at the middles of spans that may hold most come first. Then only those are looked at that may hold more than what
//! was found, and in them only cells whose corners are beyond it.

use volgraph_reference::{Rays, Window};
use volgraph_volume::Grid;

use crate::ahead::Ahead;
use crate::cells::{CellRays, cubic_of, load, whole_steps};
use crate::grid::{Cells, Corners, VoxelGrid};
use crate::lanes::{COUNT, Lanes, Portable, Work, four, with_lanes};
use crate::packet::Packet;
use crate::ranges::RangeMap;
use crate::tiles::{Shown, draw};

/// What the extreme is taken of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Extremum {
    /// The trilinear field, cell by cell.
    Field,
    /// Samples at whole steps of this world length from the entry into the box on, and at the exit.
    Samples(f32),
}

/// A projection of scalars to be drawn.
#[derive(Clone, Copy, Debug)]
pub struct Projection<'a> {
    /// Where the volume is.
    pub placement: &'a Grid,
    /// Its voxels.
    pub voxels: &'a VoxelGrid,
    /// Bounds of what is near a point; everything is looked at where there are none.
    pub ranges: Option<&'a RangeMap>,
    /// Whether the largest scalar is shown, not the smallest.
    pub is_largest: bool,
    /// What it is the extreme of.
    pub extremum: Extremum,
    /// The scalars that show nothing and most.
    pub window: Window,
    /// Linear colour of the window's high end.
    pub color: [f32; 3],
}

/// A projection of a grid of cells: of negated scalars where the smallest one is shown.
struct Of<'a, S, const IS_LARGEST: bool> {
    projection: &'a Projection<'a>,
    grid: &'a S,
    /// Raw scalars of the window: the low end, and per scalar.
    low: f32,
    per_scalar: f32,
}

struct Picture<'a> {
    projection: &'a Projection<'a>,
    rays: &'a Rays,
    behind: &'a [[f32; 4]],
}

impl Work for Picture<'_> {
    type Output = Vec<[f32; 4]>;
    fn with<L: Lanes>(self, l: L) -> Self::Output {
        match &self.projection.voxels.cells {
            Cells::Faces(grid) => self.of(l, grid),
            Cells::Edges(grid) => self.of(l, grid),
            Cells::Singles(grid) => self.of(l, grid),
        }
    }
}

impl Picture<'_> {
    fn of<L: Lanes, S: Corners>(&self, l: L, grid: &S) -> Vec<[f32; 4]> {
        if self.projection.is_largest {
            self.drawn::<L, S, true>(l, grid)
        } else {
            self.drawn::<L, S, false>(l, grid)
        }
    }

    #[expect(clippy::cast_possible_truncation, reason = "walks are in f32")]
    fn drawn<L: Lanes, S: Corners, const IS_LARGEST: bool>(&self, l: L, grid: &S) -> Vec<[f32; 4]> {
        let projection = self.projection;
        let of = Of::<S, IS_LARGEST> {
            projection,
            grid,
            low: (projection.window.low - projection.voxels.offset) as f32,
            per_scalar: projection.window.span.recip() as f32,
        };
        draw(l, projection.placement, self.rays, self.behind, &of)
    }
}

/// Most spans that are walked before others are judged by what was found.
const RUN: usize = 4;

/// Below all scalars.
const NOTHING: f32 = -3e38;

impl<L: Lanes, S: Corners, const IS_LARGEST: bool> Shown<L> for Of<'_, S, IS_LARGEST> {
    #[inline(always)]
    fn shown(&self, l: L, packet: &Packet) -> [[f32; COUNT]; 4] {
        let projection = self.projection;
        let rays = CellRays::new(l, packet, projection.voxels);
        let ahead = Ahead::new(l, packet, projection.ranges, rays.last);
        // The first of those that promise most.
        let mut first = 0;
        for span in 1..ahead.count {
            if Self::bound(&ahead, span) > Self::bound(&ahead, first) {
                first = span;
            }
        }
        let mut best = l.splat(NOTHING);
        let mut sought = best;
        if projection.extremum == Extremum::Field {
            (sought, first) = self.sampled(&rays, &ahead, first);
        }
        best = self.walked(&rays, &ahead, [first, first + 1], best, sought);
        let mut span = 0;
        while span < ahead.count {
            let from = span;
            while span < ahead.count.min(from + RUN)
                && Self::is_promising(&rays, &ahead, span, l.max(best, sought))
            {
                span += 1;
            }
            if span == from {
                span += 1;
                continue;
            }
            best = self.walked(&rays, &ahead, [from, span], best, sought);
        }
        // A ray that is shorter than its places are rounded by has no stretch in any cell.
        let is_missed = l.less(best, l.splat(NOTHING / 2.0));
        if l.bits(l.both(is_missed, l.less(l.splat(0.0), rays.length))) != 0 {
            let entry = Self::signed(l, self.grid.sample(l, rays.entry));
            best = l.select(is_missed, entry, best);
        }
        let scalar = if IS_LARGEST {
            best
        } else {
            l.sub(l.splat(0.0), best)
        };
        let above = l.sub(scalar, l.splat(self.low));
        let (zero, one) = (l.splat(0.0), l.splat(1.0));
        let share = l.clamp(l.mul(above, l.splat(self.per_scalar)), zero, one);
        let color = projection.color;
        let [r, g, b, _] = four(
            #[inline(always)]
            |i| l.mul(share, l.splat(color[i % 3])),
        );
        [
            l.array(r),
            l.array(g),
            l.array(b),
            l.array(l.sub(one, share)),
        ]
    }
}

impl<S: Corners, const IS_LARGEST: bool> Of<'_, S, IS_LARGEST> {
    #[inline(always)]
    fn signed<L: Lanes>(l: L, scalar: L::F) -> L::F {
        if IS_LARGEST {
            scalar
        } else {
            l.sub(l.splat(0.0), scalar)
        }
    }

    /// No scalar of a span is beyond this.
    #[inline(always)]
    fn bound(ahead: &Ahead, span: usize) -> f32 {
        if IS_LARGEST {
            ahead.high[span]
        } else {
            -ahead.low[span]
        }
    }

    /// Whether a span may hold what is beyond the best of some ray.
    #[inline(always)]
    fn is_promising<L: Lanes>(rays: &CellRays<L>, ahead: &Ahead, span: usize, best: L::F) -> bool {
        let l = rays.l;
        let is_beyond = l.less(best, l.splat(Self::bound(ahead, span)));
        let is_ray = l.less(l.splat(0.0), rays.length);
        l.bits(l.both(is_beyond, is_ray)) != 0
    }

    /// A little less than what the spans that promise most hold at their middles: what is sought is no less. And one of the
    /// spans that hold most.
    #[inline(always)]
    #[expect(clippy::cast_precision_loss, reason = "numbers of spans")]
    fn sampled<L: Lanes>(&self, rays: &CellRays<L>, ahead: &Ahead, first: usize) -> (L::F, usize) {
        let l = rays.l;
        let mut sought = l.splat(NOTHING);
        if ahead.count == 1 {
            return (sought, 0);
        }
        let mut last = first;
        let mut range = [f32::INFINITY, f32::NEG_INFINITY];
        for span in 0..ahead.count {
            range = [
                range[0].min(ahead.low[span]),
                range[1].max(ahead.high[span]),
            ];
        }
        // Much more than samples and cubics are rounded by.
        let size = range[0].abs().max(range[1].abs());
        let rounding = l.splat(1e-4 * (range[1] - range[0]) + 1e-6 * size + 1e-30);
        for turn in 0..ahead.count {
            // The most promising one, then all in order.
            let span = if turn == 0 { first } else { turn };
            if Self::is_promising(rays, ahead, span, sought) {
                let middle = rays.own((span as f32 + 0.5) * ahead.length);
                let inside = l.clamp(middle, l.splat(0.0), rays.length);
                let scalar = self.grid.sample(l, rays.position(inside));
                let found = l.sub(Self::signed(l, scalar), rounding);
                if l.bits(l.less(sought, found)) != 0 {
                    last = span;
                }
                sought = l.max(sought, found);
            }
        }
        (sought, last)
    }

    /// The best so far and of these spans, where it is beyond what is sought.
    #[inline(always)]
    fn walked<L: Lanes>(
        &self,
        rays: &CellRays<L>,
        ahead: &Ahead,
        [from, to]: [usize; 2],
        best: L::F,
        sought: L::F,
    ) -> L::F {
        let (start, end) = (ahead.start(from), ahead.start(to));
        match self.projection.extremum {
            Extremum::Field => self.cells(rays, [start, end], best, sought),
            Extremum::Samples(step) => {
                let [first, end] = rays.segments(start, end, step);
                self.samples(rays, first..=end, step, best)
            }
        }
    }

    #[inline(always)]
    fn samples<L: Lanes>(
        &self,
        rays: &CellRays<L>,
        numbers: std::ops::RangeInclusive<u32>,
        step: f32,
        mut best: L::F,
    ) -> L::F {
        let l = rays.l;
        let (mut number, last) = (*numbers.start(), *numbers.end());
        while number <= last {
            let distance = whole_steps(rays, number, step);
            let scalar = self.grid.sample(l, rays.position(distance));
            best = l.max(best, Self::signed(l, scalar));
            number += 1;
        }
        best
    }

    #[inline(always)]
    fn cells<L: Lanes>(
        &self,
        rays: &CellRays<L>,
        [start, end]: [f32; 2],
        mut best: L::F,
        sought: L::F,
    ) -> L::F {
        let l = rays.l;
        let stop = l.min(rays.own(end), rays.length);
        let from = l.clamp(rays.own(start), l.splat(0.0), rays.length);
        let mut stretch = rays.seat(from);
        for _ in 0..rays.most {
            let is_open = l.less(stretch.start, stop);
            if l.bits(is_open) == 0 {
                break;
            }
            let (cells, loaded) = load(rays, self.grid, &stretch);
            // Inside of a cell the field stays between its corners.
            let most = if IS_LARGEST {
                S::highest(l, loaded)
            } else {
                Self::signed(l, S::lowest(l, loaded))
            };
            let is_stretch = l.both(is_open, l.less(stretch.start, stretch.end));
            let is_beyond = l.both(is_stretch, l.less(l.max(best, sought), most));
            if l.bits(is_beyond) != 0 {
                let corners = S::corners(l, loaded);
                let cubic = cubic_of(rays, &stretch, cells, corners);
                let [first, second] = cubic.extremes(l);
                let [a, b, c, d] = four(
                    #[inline(always)]
                    |i| {
                        let w = [l.splat(0.0), first, second, l.splat(1.0)][i];
                        Self::signed(l, cubic.at(l, w))
                    },
                );
                let value = l.min(l.max(l.max(a, b), l.max(c, d)), most);
                best = l.select(is_beyond, l.max(best, value), best);
            }
            stretch = rays.next(&stretch);
        }
        best
    }
}

impl Projection<'_> {
    /// The picture of these rays, in rows from the top: linear premultiplied colours over those behind (over nothing where
    /// there are none).
    #[must_use]
    pub fn render(&self, rays: &Rays, behind: &[[f32; 4]]) -> Vec<[f32; 4]> {
        with_lanes(self.picture(rays, behind))
    }

    /// The same without the machine's own instructions: to the same bits, and slower.
    #[must_use]
    pub fn render_portable(&self, rays: &Rays, behind: &[[f32; 4]]) -> Vec<[f32; 4]> {
        self.picture(rays, behind).with(Portable)
    }

    fn picture<'a>(&'a self, rays: &'a Rays, behind: &'a [[f32; 4]]) -> Picture<'a> {
        Picture {
            projection: self,
            rays,
            behind,
        }
    }
}
