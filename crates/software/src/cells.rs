//! Eight rays from cell to cell, each in its own, and the cubic that the field is along a ray in each of them: what
//! `lib/cell.wgsl` does on the device (Marmitt et al. 2004).
//!
//! Where a ray enters a cell and leaves it is computed from the cell's own faces: whoever comes to a cell, from wherever,
//! finds the same stretch. So leaps change nothing.

use crate::grid::{Corners, VoxelGrid};
use crate::lanes::{Lanes, four, three};
use crate::packet::Packet;

/// Eight rays through a grid of cells.
#[derive(Clone, Copy)]
pub(crate) struct CellRays<L: Lanes> {
    pub(crate) l: L,
    pub(crate) entry: [L::F; 3],
    pub(crate) slope: [L::F; 3],
    pub(crate) length: L::F,
    /// World distance of each entry from the first one.
    pub(crate) after: L::F,
    inverse: [L::F; 3],
    /// 1 where the ray leaves cells by their high faces, else 0.
    ahead: [L::F; 3],
    /// 1 or -1.
    unit: [L::F; 3],
    pub(crate) last: [f32; 3],
    /// More cells than any ray meets.
    pub(crate) most: usize,
}

/// A stretch of each ray inside of a cell.
#[derive(Clone, Copy)]
pub(crate) struct Stretch<L: Lanes> {
    /// The voxel at the cell's low corner; -1 along an axis where the cell begins beside the grid.
    index: [L::F; 3],
    /// World distances from the entries.
    pub(crate) start: L::F,
    pub(crate) end: L::F,
    /// By which faces it ends: distances of all three.
    exits: [L::F; 3],
}

impl<L: Lanes> CellRays<L> {
    #[inline(always)]
    pub(crate) fn new(l: L, packet: &Packet, voxels: &VoxelGrid) -> Self {
        let slope = three(
            #[inline(always)]
            |axis| l.floats(packet.slope[axis]),
        );
        let is_back = three(
            #[inline(always)]
            |axis| l.less(slope[axis], l.splat(0.0)),
        );
        let (zero, one) = (l.splat(0.0), l.splat(1.0));
        #[expect(clippy::cast_precision_loss, reason = "less than 2^24 along an axis")]
        let last = voxels.dims.map(|n| (n - 1) as f32);
        Self {
            l,
            entry: three(
                #[inline(always)]
                |axis| l.floats(packet.entry[axis]),
            ),
            slope,
            length: l.floats(packet.length),
            after: l.floats(packet.after),
            inverse: three(
                #[inline(always)]
                |axis| {
                    // A ray along a face never meets it.
                    let is_along = l.less(l.size(slope[axis]), l.splat(1e-20));
                    let inverse = l.div(one, l.select(is_along, one, slope[axis]));
                    l.select(is_along, l.splat(1e20), inverse)
                },
            ),
            ahead: three(
                #[inline(always)]
                |axis| l.select(is_back[axis], zero, one),
            ),
            unit: three(
                #[inline(always)]
                |axis| l.select(is_back[axis], l.splat(-1.0), one),
            ),
            last,
            most: voxels.dims.iter().map(|n| *n as usize + 4).sum(),
        }
    }

    #[inline(always)]
    pub(crate) fn position(&self, distance: L::F) -> [L::F; 3] {
        three(
            #[inline(always)]
            |axis| self.l.mul_add(distance, self.slope[axis], self.entry[axis]),
        )
    }

    /// Distances to the planes of voxels of these numbers.
    #[inline(always)]
    fn at_faces(&self, faces: [L::F; 3]) -> [L::F; 3] {
        let l = self.l;
        three(
            #[inline(always)]
            |axis| l.mul(l.sub(faces[axis], self.entry[axis]), self.inverse[axis]),
        )
    }

    /// The stretches in the cells that the rays are in at these distances.
    #[inline(always)]
    pub(crate) fn seat(&self, distance: L::F) -> Stretch<L> {
        let l = self.l;
        let one = l.splat(1.0);
        let at = self.position(distance);
        let index = three(
            #[inline(always)]
            |axis| {
                let from_first = l.clamp(
                    l.add(at[axis], one),
                    l.splat(0.0),
                    l.splat(self.last[axis] + 1.0),
                );
                l.sub(l.float(l.truncated(from_first)), one)
            },
        );
        let faces = three(
            #[inline(always)]
            |axis| l.add(index[axis], l.sub(one, self.ahead[axis])),
        );
        let [x, y, z] = self.at_faces(faces);
        let start = l.max(l.max(x, y), l.max(z, l.splat(0.0)));
        self.stretch(index, start)
    }

    #[inline(always)]
    fn stretch(&self, index: [L::F; 3], start: L::F) -> Stretch<L> {
        let l = self.l;
        let faces = three(
            #[inline(always)]
            |axis| l.add(index[axis], self.ahead[axis]),
        );
        let exits = self.at_faces(faces);
        let exit = l.min(l.min(exits[0], exits[1]), exits[2]);
        Stretch {
            index,
            start,
            end: l.min(exit, self.length),
            exits,
        }
    }

    /// The next stretches.
    #[inline(always)]
    pub(crate) fn next(&self, stretch: &Stretch<L>) -> Stretch<L> {
        let l = self.l;
        let [x, y, z] = stretch.exits;
        let exit = l.min(l.min(x, y), z);
        let index = three(
            #[inline(always)]
            |axis| {
                let is_left = l.at_least(exit, stretch.exits[axis]);
                let unit = l.select(is_left, self.unit[axis], l.splat(0.0));
                l.add(stretch.index[axis], unit)
            },
        );
        self.stretch(index, exit)
    }

    /// The cells of stretches; those beside the grid are the outer voxels, clamped.
    #[inline(always)]
    pub(crate) fn cells(&self, stretch: &Stretch<L>) -> [L::F; 3] {
        three(
            #[inline(always)]
            |axis| {
                let last = self.l.splat(self.last[axis]);
                self.l.clamp(stretch.index[axis], self.l.splat(0.0), last)
            },
        )
    }

    /// Places inside of cells, 0 to 1 along each axis.
    #[inline(always)]
    pub(crate) fn places(&self, cells: [L::F; 3], distance: L::F) -> [L::F; 3] {
        let l = self.l;
        let at = self.position(distance);
        three(
            #[inline(always)]
            |axis| l.clamp(l.sub(at[axis], cells[axis]), l.splat(0.0), l.splat(1.0)),
        )
    }

    /// Of these distances from the first entry, those from each ray's own.
    #[inline(always)]
    pub(crate) fn own(&self, distance: f32) -> L::F {
        self.l.sub(self.l.splat(distance), self.after)
    }

    /// The longest ray.
    #[inline(always)]
    pub(crate) fn longest(&self) -> f32 {
        let length = self.l.array(self.length);
        let mut longest = 0.0_f32;
        for one in length {
            longest = longest.max(one);
        }
        longest
    }

    /// Segments of a length, whole ones from each entry on, that touch what is between two distances from the first entry:
    /// the number of the first and that after the last.
    #[inline(always)]
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "numbers of segments; what is below 0 or beyond the last one is clamped"
    )]
    pub(crate) fn segments(&self, from: f32, to: f32, step: f32) -> [u32; 2] {
        let after = self.l.array(self.after);
        let mut most = 0.0_f32;
        for one in after {
            most = most.max(one);
        }
        let first = ((from - most) / step - 1e-2) as u32;
        // One more than the longest ray has.
        let longest = self.longest() / step;
        let end = (to / step).min(longest) + 1.01;
        [first, end as u32]
    }
}

/// Scalars at a cell's corners along a stretch.
#[derive(Clone, Copy)]
pub(crate) struct Cubic<L: Lanes>([L::F; 4]);

/// What a part is of a whole where that is between 0 and 1, else 1.
#[inline(always)]
fn inner_share<L: Lanes>(l: L, part: L::F, of: L::F, is_one: L::M) -> L::F {
    let one = l.splat(1.0);
    let is_same = l.less(l.splat(0.0), l.mul(part, sign(l, of)));
    let is_less = l.less(l.size(part), l.size(of));
    let is_inside = l.both(is_less, l.both(is_same, is_one));
    l.select(is_inside, l.div(part, l.select(is_inside, of, one)), one)
}

/// Trilinear between corners at a place.
#[inline(always)]
pub(crate) fn trilinear<L: Lanes>(l: L, corners: [L::F; 8], [x, y, z]: [L::F; 3]) -> L::F {
    let [a, b, c, d] = four(
        #[inline(always)]
        |i| l.mix(corners[i], corners[i + 4], z),
    );
    l.mix(l.mix(a, c, y), l.mix(b, d, y), x)
}

impl<L: Lanes> Cubic<L> {
    /// The trilinear field between corners from a place to another one, for a parameter from 0 to 1.
    #[inline(always)]
    pub(crate) fn new(l: L, corners: [L::F; 8], from: [L::F; 3], to: [L::F; 3]) -> Self {
        let change = three(
            #[inline(always)]
            |axis| l.sub(to[axis], from[axis]),
        );
        // Four edges along z, linear; between them two lines along y, of degree 2; between those the cubic.
        let edges = four(
            #[inline(always)]
            |i| {
                let rise = l.sub(corners[i + 4], corners[i]);
                [l.mul_add(rise, from[2], corners[i]), l.mul(rise, change[2])]
            },
        );
        let line = three(
            #[inline(always)]
            |i| {
                let ([a, a_1], [b, b_1]) = (edges[i % 2], edges[i % 2 + 2]);
                let (rise, rise_1) = (l.sub(b, a), l.sub(b_1, a_1));
                [
                    l.mul_add(rise, from[1], a),
                    l.add(l.mul_add(rise_1, from[1], a_1), l.mul(rise, change[1])),
                    l.mul(rise_1, change[1]),
                ]
            },
        );
        let [low, high, _] = line;
        let [r, r_1, r_2] = three(
            #[inline(always)]
            |i| l.sub(high[i], low[i]),
        );
        let (x, dx) = (from[0], change[0]);
        Self([
            l.mul_add(r, x, low[0]),
            l.add(l.mul_add(r_1, x, low[1]), l.mul(r, dx)),
            l.add(l.mul_add(r_2, x, low[2]), l.mul(r_1, dx)),
            l.mul(r_2, dx),
        ])
    }

    #[inline(always)]
    pub(crate) fn at(&self, l: L, w: L::F) -> L::F {
        let [a, b, c, d] = self.0;
        l.mul_add(l.mul_add(l.mul_add(d, w, c), w, b), w, a)
    }

    #[inline(always)]
    fn slope(&self, l: L, w: L::F) -> L::F {
        let [_, b, c, d] = self.0;
        let three_d = l.mul(l.splat(3.0), d);
        l.mul_add(l.mul_add(three_d, w, l.add(c, c)), w, b)
    }

    /// The extremes between 0 and 1, in order; 1 in the place of those that there are not.
    #[inline(always)]
    pub(crate) fn extremes(&self, l: L) -> [L::F; 2] {
        let [_, b, c, d] = self.0;
        let zero = l.splat(0.0);
        let a = l.mul(l.splat(3.0), d);
        let discriminant = l.sub(l.mul(c, c), l.mul(a, b));
        let has_any = l.less(zero, discriminant);
        // Of the two forms of each root the one that does not cancel.
        let root = l.sqrt(l.max(discriminant, zero));
        let minus_c = l.sub(zero, c);
        let q = l.select(l.less(c, zero), l.add(minus_c, root), l.sub(minus_c, root));
        let first = inner_share(l, b, q, has_any);
        let second = inner_share(l, q, a, has_any);
        [l.min(first, second), l.max(first, second)]
    }

    /// The roots between two places where it changes its sign and has no extreme, of these lanes; `side` is its sign at the
    /// first. Newton's steps, halving where they leave the bracket.
    #[inline(always)]
    pub(crate) fn root(&self, l: L, mut low: L::F, mut high: L::F, side: L::F, of: L::M) -> L::F {
        let (zero, half) = (l.splat(0.0), l.splat(0.5));
        let (front, back) = (self.at(l, low), self.at(l, high));
        let middle = l.mul(half, l.add(low, high));
        let is_changing = l.less(l.mul(sign(l, front), sign(l, back)), zero);
        let change = l.select(is_changing, l.sub(front, back), l.splat(1.0));
        let secant = l.mul_add(l.sub(high, low), l.div(front, change), low);
        let mut w = l.select(is_changing, secant, middle);
        let mut is_open = of;
        for _ in 0..ROOT_TURNS {
            let value = self.at(l, w);
            let is_front = l.less(zero, l.mul(sign(l, value), side));
            low = l.select(is_front, w, low);
            high = l.select(is_front, high, w);
            let slope = self.slope(l, w);
            let is_steep = l.less(zero, l.size(slope));
            let newton = l.sub(w, l.div(value, l.select(is_steep, slope, l.splat(1.0))));
            let is_inside = l.both(l.at_least(newton, low), l.at_least(high, newton));
            let middle = l.mul(half, l.add(low, high));
            let next = l.select(l.both(is_steep, is_inside), newton, middle);
            let moved = l.size(l.sub(next, w));
            // A lane that is done stays as it is, whatever its neighbours need.
            w = l.select(is_open, next, w);
            is_open = l.both(is_open, l.less(l.splat(6e-8), moved));
            if l.bits(is_open) == 0 {
                break;
            }
        }
        w
    }
}

/// Turns until a root is as good as its rounding, even where halving alone brings it nearer.
const ROOT_TURNS: u32 = 32;

/// 1 of what is 0 or more, else -1.
#[inline(always)]
pub(crate) fn sign<L: Lanes>(l: L, a: L::F) -> L::F {
    l.select(l.at_least(a, l.splat(0.0)), l.splat(1.0), l.splat(-1.0))
}

/// So many whole steps from the entries, or the rays' ends.
#[inline(always)]
#[expect(clippy::cast_precision_loss, reason = "as shaders count segments")]
pub(crate) fn whole_steps<L: Lanes>(rays: &CellRays<L>, number: u32, step: f32) -> L::F {
    rays.l.min(rays.l.splat(number as f32 * step), rays.length)
}

/// The cubics along stretches in cells of these corners.
#[inline(always)]
pub(crate) fn cubic_of<L: Lanes>(
    rays: &CellRays<L>,
    stretch: &Stretch<L>,
    cells: [L::F; 3],
    corners: [L::F; 8],
) -> Cubic<L> {
    let from = rays.places(cells, stretch.start);
    let to = rays.places(cells, stretch.end);
    Cubic::new(rays.l, corners, from, to)
}

/// What a grid holds at the cells of stretches.
#[inline(always)]
pub(crate) fn load<L: Lanes, S: Corners>(
    rays: &CellRays<L>,
    grid: &S,
    stretch: &Stretch<L>,
) -> ([L::F; 3], S::Loaded<L>) {
    let cells = rays.cells(stretch);
    (cells, grid.load(rays.l, cells))
}
