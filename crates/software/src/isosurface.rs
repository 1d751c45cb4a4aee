//! The first isosurface along each ray, opaque: `slot/technique/isosurface.wgsl`.

use volgraph_optics::Material;
use volgraph_reference::{Lamp, Rays};
use volgraph_volume::Grid;

use crate::ahead::Ahead;
use crate::cells::{CellRays, cubic_of, load, sign, trilinear, whole_steps};
use crate::grid::{Cells, Corners, VoxelGrid};
use crate::lanes::{COUNT, Lanes, Portable, Work, three, with_lanes};
use crate::packet::Packet;
use crate::ranges::RangeMap;
use crate::shine::Shine;
use crate::tiles::{Shown, draw};

/// How crossings are found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Refinement {
    /// As roots of the cubics that the trilinear field is along a ray in its cells: exact, and all of them.
    Cubic,
    /// Linear between samples at whole steps of this world length from the entry into the box on.
    Linear(f32),
}

/// An isosurface to be drawn.
#[derive(Clone, Copy, Debug)]
pub struct Isosurface<'a> {
    /// Where the volume is.
    pub placement: &'a Grid,
    /// Its voxels.
    pub voxels: &'a VoxelGrid,
    /// Bounds of what is near a point; everything is looked at where there are none.
    pub ranges: Option<&'a RangeMap>,
    /// The data value on it.
    pub level: f64,
    /// The difference of data values that gradients are shares of; no change of less than 1e-15 of it per voxel has a normal.
    pub value_range: f64,
    /// How crossings are found.
    pub refinement: Refinement,
    /// Whether the box shows faces of the solid.
    pub has_faces: bool,
    /// Whether the solid is below the level.
    pub is_solid_below: bool,
    /// Linear colour.
    pub color: [f32; 3],
    /// The lights, four at most, and what the surface makes of them; it shows its own colour where there are none.
    pub light: Option<(&'a [Lamp], Material)>,
}

struct Of<'a, S> {
    isosurface: &'a Isosurface<'a>,
    grid: &'a S,
    shine: Option<Shine>,
    level: f32,
    /// Shares of the data's range per raw scalar.
    per_scalar: f32,
}

struct Picture<'a> {
    isosurface: &'a Isosurface<'a>,
    rays: &'a Rays,
    behind: &'a [[f32; 4]],
}

impl Work for Picture<'_> {
    type Output = Vec<[f32; 4]>;
    fn with<L: Lanes>(self, l: L) -> Self::Output {
        match &self.isosurface.voxels.cells {
            Cells::Faces(grid) => self.of(l, grid),
            Cells::Edges(grid) => self.of(l, grid),
            Cells::Singles(grid) => self.of(l, grid),
        }
    }
}

impl Picture<'_> {
    #[expect(clippy::cast_possible_truncation, reason = "walks are in f32")]
    fn of<L: Lanes, S: Corners>(&self, l: L, grid: &S) -> Vec<[f32; 4]> {
        let isosurface = self.isosurface;
        let of = Of {
            isosurface,
            grid,
            shine: isosurface
                .light
                .map(|(lamps, material)| Shine::new(isosurface.placement, lamps, material)),
            level: (isosurface.level - isosurface.voxels.offset) as f32,
            per_scalar: if isosurface.value_range > 0.0 {
                isosurface.value_range.recip() as f32
            } else {
                1.0
            },
        };
        draw(l, isosurface.placement, self.rays, self.behind, &of)
    }
}

/// No crossing.
const NONE: f32 = 3e38;

/// What a walk has come to.
#[derive(Clone, Copy)]
struct Met<L: Lanes> {
    /// 1 where the field was last at the level or above it, else -1.
    side: L::F,
    /// World distances from the entries to the first crossing.
    distance: L::F,
}

impl<L: Lanes, S: Corners> Shown<L> for Of<'_, S> {
    #[inline(always)]
    fn shown(&self, l: L, packet: &Packet) -> [[f32; COUNT]; 4] {
        let isosurface = self.isosurface;
        let rays = CellRays::new(l, packet, isosurface.voxels);
        let ahead = Ahead::new(l, packet, isosurface.ranges, rays.last);
        let (zero, one) = (l.splat(0.0), l.splat(1.0));
        let is_ray = l.less(zero, rays.length);
        let side = sign(l, self.above(l, rays.entry));
        let mut met = Met {
            side,
            distance: l.splat(NONE),
        };
        let is_face = self.faces(l, packet, side, is_ray);
        met.distance = l.select(is_face, zero, met.distance);
        let mut span = 0;
        while span < ahead.count {
            let is_open = l.both(is_ray, l.less(l.splat(NONE / 2.0), met.distance));
            if l.bits(is_open) == 0 {
                break;
            }
            let from = span;
            while span < ahead.count && self.may_cross(l, &ahead, span, &met, is_ray) {
                span += 1;
            }
            if span == from {
                span += 1;
                continue;
            }
            // A few at a time: most rays end at the first surface.
            span = span.min(from + 2);
            let (start, end) = (ahead.start(from), ahead.start(span));
            met = match isosurface.refinement {
                Refinement::Cubic => self.cells(&rays, start, end, met),
                Refinement::Linear(step) => self.segments(&rays, start, end, step, met),
            };
        }
        let is_met = l.both(is_ray, l.less(met.distance, l.splat(NONE / 2.0)));
        if l.bits(is_met) == 0 {
            return [[0.0; COUNT], [0.0; COUNT], [0.0; COUNT], [1.0; COUNT]];
        }
        let distance = l.select(is_met, met.distance, zero);
        let color = self.color(&rays, distance, is_face);
        let [r, g, b] = three(
            #[inline(always)]
            |i| l.array(l.select(is_met, color[i], zero)),
        );
        [r, g, b, l.array(l.select(is_met, zero, one))]
    }
}

impl<S: Corners> Of<'_, S> {
    /// Scalars above the level.
    #[inline(always)]
    fn above<L: Lanes>(&self, l: L, at: [L::F; 3]) -> L::F {
        l.sub(self.grid.sample(l, at), l.splat(self.level))
    }

    /// Which rays meet a face of the solid where they enter the box from outside.
    #[inline(always)]
    fn faces<L: Lanes>(&self, l: L, packet: &Packet, side: L::F, is_ray: L::M) -> L::M {
        let isosurface = self.isosurface;
        let solid = if isosurface.is_solid_below { -1.0 } else { 1.0 };
        let is_solid = l.less(l.splat(0.0), l.mul(side, l.splat(solid)));
        let limit = if !isosurface.has_faces {
            f32::INFINITY
        } else if packet.near[0] > 0.0 {
            -1.0
        } else {
            0.0
        };
        let is_outside = l.less(l.splat(limit), l.floats(packet.after));
        l.both(l.both(is_solid, is_outside), is_ray)
    }

    /// Whether a ray that has met nothing may cross the level in a span, or is not on the side that all of the span is on.
    #[inline(always)]
    fn may_cross<L: Lanes>(
        &self,
        l: L,
        ahead: &Ahead,
        span: usize,
        met: &Met<L>,
        is_ray: L::M,
    ) -> bool {
        let (is_below, is_above) = (ahead.high[span] < self.level, ahead.low[span] >= self.level);
        if !is_below && !is_above {
            return true;
        }
        let side = l.splat(if is_above { 1.0 } else { -1.0 });
        let differs = l.less(l.mul(side, met.side), l.splat(0.0));
        let is_open = l.both(is_ray, l.less(l.splat(NONE / 2.0), met.distance));
        l.bits(l.both(differs, is_open)) != 0
    }

    /// Sides are carried from stretch to stretch: whatever is rounded, no crossing falls between two cells.
    #[inline(always)]
    fn cells<L: Lanes>(&self, rays: &CellRays<L>, start: f32, end: f32, mut met: Met<L>) -> Met<L> {
        let l = rays.l;
        let (zero, one) = (l.splat(0.0), l.splat(1.0));
        let level = l.splat(self.level);
        let stop = l.min(rays.own(end), rays.length);
        let from = l.clamp(rays.own(start), zero, rays.length);
        let mut stretch = rays.seat(from);
        for _ in 0..rays.most {
            let is_open = l.both(
                l.less(stretch.start, stop),
                l.less(l.splat(NONE / 2.0), met.distance),
            );
            if l.bits(is_open) == 0 {
                break;
            }
            let is_open = l.both(is_open, l.less(stretch.start, stretch.end));
            let (cells, loaded) = load(rays, self.grid, &stretch);
            let is_above = l.at_least(S::lowest(l, loaded), level);
            let is_mixed = l.both(
                l.both(l.less(S::lowest(l, loaded), level), is_open),
                l.at_least(S::highest(l, loaded), level),
            );
            let whole_side = l.select(is_above, one, l.splat(-1.0));
            let mut side = l.select(is_open, whole_side, met.side);
            let mut distance = stretch.start;
            if l.bits(is_mixed) != 0 {
                let mut corners = S::corners(l, loaded);
                for corner in &mut corners {
                    *corner = l.sub(*corner, level);
                }
                let cubic = cubic_of(rays, &stretch, cells, corners);
                let [first, second] = cubic.extremes(l);
                let last = trilinear(l, corners, rays.places(cells, stretch.end));
                let sides = [
                    sign(l, cubic.at(l, first)),
                    sign(l, cubic.at(l, second)),
                    sign(l, last),
                ];
                // The first piece between extremes over which the side changes.
                let mut low = zero;
                let (mut bracket_low, mut bracket_high) = (zero, one);
                let mut end_side = met.side;
                let mut is_free = is_mixed;
                for (piece, high) in [first, second, one].into_iter().enumerate() {
                    let differs = l.less(l.mul(sides[piece], met.side), zero);
                    let is_piece = if piece == 2 {
                        differs
                    } else {
                        l.both(differs, l.less(low, high))
                    };
                    let is_first = l.both(is_piece, is_free);
                    bracket_low = l.select(is_first, low, bracket_low);
                    bracket_high = l.select(is_first, high, bracket_high);
                    end_side = l.select(is_first, sides[piece], end_side);
                    is_free = l.both(is_free, l.less(zero, l.mul(end_side, met.side)));
                    low = l.max(low, high);
                }
                let is_crossing = l.both(is_mixed, l.less(l.mul(end_side, met.side), zero));
                if l.bits(is_crossing) != 0 {
                    let w = cubic.root(l, bracket_low, bracket_high, met.side, is_crossing);
                    let length = l.sub(stretch.end, stretch.start);
                    let root = l.mul_add(w, length, stretch.start);
                    distance = l.select(is_crossing, root, distance);
                }
                side = l.select(is_mixed, end_side, side);
            }
            let is_met = l.both(is_open, l.less(l.mul(side, met.side), zero));
            met.distance = l.select(is_met, l.min(distance, rays.length), met.distance);
            met.side = l.select(is_open, side, met.side);
            stretch = rays.next(&stretch);
        }
        met
    }

    #[inline(always)]
    fn segments<L: Lanes>(
        &self,
        rays: &CellRays<L>,
        start: f32,
        end: f32,
        step: f32,
        mut met: Met<L>,
    ) -> Met<L> {
        let l = rays.l;
        let zero = l.splat(0.0);
        let [first, after] = rays.segments(start, end, step);
        let mut front_at = whole_steps(rays, first, step);
        let mut front = self.above(l, rays.position(front_at));
        let mut number = first;
        while number < after {
            number += 1;
            let back_at = whole_steps(rays, number, step);
            let is_open = l.both(
                l.less(front_at, rays.length),
                l.less(l.splat(NONE / 2.0), met.distance),
            );
            if l.bits(is_open) == 0 {
                break;
            }
            let back = self.above(l, rays.position(back_at));
            let is_met = l.both(is_open, l.less(l.mul(sign(l, front), sign(l, back)), zero));
            let change = l.select(is_met, l.sub(front, back), l.splat(1.0));
            let share = l.div(front, change);
            let distance = l.mul_add(l.sub(back_at, front_at), share, front_at);
            met.distance = l.select(is_met, distance, met.distance);
            met.side = l.select(is_open, sign(l, back), met.side);
            (front, front_at) = (back, back_at);
        }
        met
    }

    /// Colours towards the eye of the surfaces at these distances.
    #[inline(always)]
    fn color<L: Lanes>(&self, rays: &CellRays<L>, distance: L::F, is_face: L::M) -> [L::F; 3] {
        let l = rays.l;
        let isosurface = self.isosurface;
        let Some(shine) = &self.shine else {
            return three(
                #[inline(always)]
                |i| l.splat(isosurface.color[i]),
            );
        };
        let at = rays.position(distance);
        let zero = l.splat(0.0);
        // Stored gradients between voxels are differences of samples one voxel to each side: of places inside of the grid.
        let inside = three(
            #[inline(always)]
            |axis| l.clamp(at[axis], zero, l.splat(rays.last[axis])),
        );
        let mut gradient = [zero; 3];
        for axis in 0..3 {
            let (mut before, mut behind) = (inside, inside);
            before[axis] = l.sub(inside[axis], l.splat(1.0));
            behind[axis] = l.add(inside[axis], l.splat(1.0));
            let change = l.sub(self.grid.sample(l, behind), self.grid.sample(l, before));
            gradient[axis] = l.mul(change, l.splat(0.5 * self.per_scalar));
        }
        if l.bits(is_face) != 0 {
            let face = Self::face(rays);
            for axis in 0..3 {
                gradient[axis] = l.select(is_face, face[axis], gradient[axis]);
            }
        }
        let direction = shine.direction(l, rays.slope);
        let normal = shine.normal(l, gradient, direction);
        shine.color(l, isosurface.color, at, normal, direction)
    }

    /// Index-space normals of the faces of the box by which the rays enter it.
    #[inline(always)]
    fn face<L: Lanes>(rays: &CellRays<L>) -> [L::F; 3] {
        let l = rays.l;
        let beside = three(
            #[inline(always)]
            |axis| {
                let low = l.size(l.add(rays.entry[axis], l.splat(0.5)));
                let high = l.splat(rays.last[axis] + 0.5);
                l.min(low, l.size(l.sub(rays.entry[axis], high)))
            },
        );
        let nearest = l.min(l.min(beside[0], beside[1]), beside[2]);
        three(
            #[inline(always)]
            |axis| {
                let is_nearest = l.at_least(nearest, beside[axis]);
                let against = l.sub(l.splat(0.0), sign(l, rays.slope[axis]));
                l.select(is_nearest, against, l.splat(0.0))
            },
        )
    }
}

impl Isosurface<'_> {
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
            isosurface: self,
            rays,
            behind,
        }
    }
}
