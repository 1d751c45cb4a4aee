//! The trilinear field of a volume, and the cubics that it is along a ray.
//!
//! Positions in the outer half of the outermost voxels take the outermost samples: the coordinate is clamped, as the
//! renderer's textures are. So along a ray the field is a cubic between two crossings of the planes through samples.

use std::sync::Arc;

use glam::{DAffine3, DMat3, DVec3, IVec3};
use volgraph_volume::{ScalarType, Volume};

use crate::rays::Ray;

/// Samples, in the smallest type that holds each of them exactly.
#[derive(Debug)]
enum Samples {
    Single(Vec<f32>),
    Double(Vec<f64>),
}

/// A volume's scalar field.
#[derive(Clone, Debug)]
pub struct Field {
    samples: Arc<Samples>,
    dims: [usize; 3],
    last: DVec3,
    index_from_world: DAffine3,
    box_low: DVec3,
    box_high: DVec3,
    min_spacing: f64,
    range: (f64, f64),
    digest: [u8; 32],
}

/// The field along a ray between two distances: a cubic of a parameter that is 0 at the start and 1 at the end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cubic {
    /// World distance from the ray's origin where it starts.
    pub start: f64,
    /// Where it ends.
    pub end: f64,
    /// Of the powers 0 to 3 of the parameter.
    pub terms: [f64; 4],
    /// The cell: the lowest of its samples' indices.
    pub cell: [i32; 3],
}

impl Cubic {
    /// The scalar.
    #[must_use]
    pub fn at(&self, w: f64) -> f64 {
        let [a, b, c, d] = self.terms;
        a + w * (b + w * (c + w * d))
    }

    /// Its derivative by the parameter.
    #[must_use]
    pub fn slope(&self, w: f64) -> f64 {
        let [_, b, c, d] = self.terms;
        b + w * (2.0 * c + w * 3.0 * d)
    }

    /// World distance from the ray's origin.
    #[must_use]
    pub fn distance(&self, w: f64) -> f64 {
        self.start + w * (self.end - self.start)
    }

    /// 0, the parameters between at which it turns, and 1: it is monotone between neighbours.
    #[must_use]
    pub fn turns(&self) -> ([f64; 4], usize) {
        let [_, b, c, d] = self.terms;
        let mut turns = [0.0; 4];
        let mut count = 1;
        let (first, second) = quadratic_roots(3.0 * d, 2.0 * c, b);
        for root in [first, second] {
            if root > turns[count - 1] && root < 1.0 {
                turns[count] = root;
                count += 1;
            }
        }
        turns[count] = 1.0;
        (turns, count + 1)
    }

    /// The parameter in `low..high`, between which the cubic is monotone, at which it takes a value between those at the
    /// ends: bisection, with Newton's steps where they stay inside.
    #[must_use]
    pub fn solve(&self, low: f64, high: f64, value: f64) -> f64 {
        let (mut low, mut high) = (low, high);
        let rises = self.at(high) >= self.at(low);
        let mut w = 0.5 * (low + high);
        for _ in 0..64 {
            let off = self.at(w) - value;
            if off == 0.0 {
                break;
            }
            if (off > 0.0) == rises {
                high = w;
            } else {
                low = w;
            }
            let step = w - off / self.slope(w);
            let next = if step > low && step < high {
                step
            } else {
                0.5 * (low + high)
            };
            if next == w || high - low <= f64::EPSILON {
                break;
            }
            w = next;
        }
        w
    }
}

/// The real roots of `a x² + b x + c`, rising; those that there are not are not-a-number.
fn quadratic_roots(a: f64, b: f64, c: f64) -> (f64, f64) {
    let discriminant = b * b - 4.0 * a * c;
    if discriminant < 0.0 {
        return (f64::NAN, f64::NAN);
    }
    // No cancellation: the larger root in size first, the other by the product of both.
    let q = -0.5 * (b + discriminant.sqrt().copysign(b));
    let (first, second) = (q / a, c / q);
    // Also where one of them is not-a-number.
    if first <= second {
        (first, second)
    } else {
        (second, first)
    }
}

impl Field {
    /// The field of a volume; not-a-number is its smallest value and infinite values are its nearest finite ones, as they
    /// are drawn.
    #[must_use]
    pub fn new(volume: &Volume) -> Self {
        let grid = volume.grid();
        let voxels = volume.voxels();
        let is_single = !matches!(
            voxels.scalar_type(),
            ScalarType::U32 | ScalarType::I32 | ScalarType::U64 | ScalarType::I64 | ScalarType::F64
        );
        let is_finite = !volume.statistics().has_non_finite();
        let drawn = |value: f64| {
            if is_finite {
                value
            } else {
                volume.drawn(value)
            }
        };
        let samples = if is_single {
            let mut samples = Vec::with_capacity(voxels.len());
            #[expect(
                clippy::cast_possible_truncation,
                reason = "all values of these types are f32"
            )]
            voxels.for_each(|value| samples.push(drawn(value) as f32));
            Samples::Single(samples)
        } else {
            let mut samples = Vec::with_capacity(voxels.len());
            voxels.for_each(|value| samples.push(drawn(value)));
            Samples::Double(samples)
        };
        let (box_low, box_high) = grid.box_index();
        Self {
            samples: Arc::new(samples),
            dims: grid.dims.map(|n| n as usize),
            last: DVec3::from_array(grid.dims.map(|n| f64::from(n) - 1.0)),
            index_from_world: grid.world_from_index.inverse(),
            box_low,
            box_high,
            min_spacing: grid.min_spacing(),
            range: volume.statistics().range().unwrap_or((0.0, 0.0)),
            digest: *volume.digest().as_bytes(),
        }
    }

    /// World length of the smallest spacing.
    #[must_use]
    pub fn min_spacing(&self) -> f64 {
        self.min_spacing
    }

    /// World length of the shortest side of its box.
    #[must_use]
    pub fn shortest_side(&self) -> f64 {
        let spacing = self.spacing();
        (spacing * (self.box_high - self.box_low)).min_element()
    }

    /// World length from a sample to the next along each axis.
    #[must_use]
    pub fn spacing(&self) -> DVec3 {
        let world_from_index = self.index_from_world.matrix3.inverse();
        DVec3::from_array([0, 1, 2].map(|axis| world_from_index.col(axis).length()))
    }

    /// The smallest and the largest sample.
    #[must_use]
    pub fn range(&self) -> (f64, f64) {
        self.range
    }

    /// Digest of the volume.
    #[must_use]
    pub fn digest(&self) -> [u8; 32] {
        self.digest
    }

    /// Index coordinates (0 at the first sample) from world positions.
    #[must_use]
    pub fn index_from_world(&self) -> &DAffine3 {
        &self.index_from_world
    }

    /// The box in index coordinates.
    #[must_use]
    pub fn box_index(&self) -> (DVec3, DVec3) {
        (self.box_low, self.box_high)
    }

    /// World gradients from gradients by index coordinates.
    #[must_use]
    pub fn world_from_index_gradient(&self) -> DMat3 {
        self.index_from_world.matrix3.transpose()
    }

    /// The distances, not behind the origin, between which a ray is in the box; `None` where it misses it.
    #[must_use]
    pub fn interval(&self, ray: &Ray) -> Option<(f64, f64)> {
        let (origin, slope) = self.in_index(ray);
        let (mut near, mut far) = (0.0_f64, f64::INFINITY);
        for axis in 0..3 {
            let (low, high) = (
                self.box_low[axis] - origin[axis],
                self.box_high[axis] - origin[axis],
            );
            if slope[axis] == 0.0 {
                if low > 0.0 || high < 0.0 {
                    return None;
                }
                continue;
            }
            let (a, b) = (low / slope[axis], high / slope[axis]);
            near = near.max(a.min(b));
            far = far.min(a.max(b));
        }
        (near < far).then_some((near, far))
    }

    fn in_index(&self, ray: &Ray) -> (DVec3, DVec3) {
        (
            self.index_from_world.transform_point3(ray.origin),
            self.index_from_world.transform_vector3(ray.direction),
        )
    }

    fn sample(&self, x: usize, y: usize, z: usize) -> f64 {
        let at = (z * self.dims[1] + y) * self.dims[0] + x;
        match &*self.samples {
            Samples::Single(samples) => f64::from(samples[at]),
            Samples::Double(samples) => samples[at],
        }
    }

    /// A sample, the index clamped to the grid.
    #[must_use]
    pub fn sample_clamped(&self, index: IVec3) -> f64 {
        let [x, y, z] = [0, 1, 2].map(|axis| {
            let last = self.dims[axis] - 1;
            usize::try_from(index[axis]).unwrap_or(0).min(last)
        });
        self.sample(x, y, z)
    }

    /// The scalar at a position in index coordinates, which is clamped to the samples.
    #[must_use]
    pub fn at(&self, position: DVec3) -> f64 {
        let cell = position.clamp(DVec3::ZERO, self.last).floor();
        self.in_cell(&self.corners(cell.as_ivec3()), cell, position)
    }

    /// Gradient by index coordinates of the trilinear field at a position; along an axis on which the position is clamped
    /// it is 0.
    #[must_use]
    pub fn gradient(&self, position: DVec3) -> DVec3 {
        let clamped = position.clamp(DVec3::ZERO, self.last);
        let cell = clamped.floor().min((self.last - 1.0).max(DVec3::ZERO));
        let c = self.corners(cell.as_ivec3());
        let w = clamped - cell;
        let mix = |a: f64, b: f64, w: f64| a + w * (b - a);
        let face = |low: [f64; 4], high: [f64; 4], u: f64, v: f64| {
            let d = |i: usize| high[i] - low[i];
            mix(mix(d(0), d(1), u), mix(d(2), d(3), u), v)
        };
        let along = DVec3::new(
            face([c[0], c[2], c[4], c[6]], [c[1], c[3], c[5], c[7]], w.y, w.z),
            face([c[0], c[1], c[4], c[5]], [c[2], c[3], c[6], c[7]], w.x, w.z),
            face([c[0], c[1], c[2], c[3]], [c[4], c[5], c[6], c[7]], w.x, w.y),
        );
        DVec3::select(position.cmpeq(clamped), along, DVec3::ZERO)
    }

    /// The samples at the corners of a cell; bit 0 of the place is x, bit 1 y, bit 2 z.
    fn corners(&self, cell: IVec3) -> [f64; 8] {
        let [x, y, z] = [0, 1, 2].map(|axis| {
            let last = self.dims[axis] - 1;
            let low = usize::try_from(cell[axis]).unwrap_or(0).min(last);
            [low, (low + 1).min(last)]
        });
        std::array::from_fn(|i| self.sample(x[i & 1], y[i >> 1 & 1], z[i >> 2]))
    }

    /// The scalar of a cell's own trilinear polynomial.
    fn in_cell(&self, c: &[f64; 8], cell: DVec3, position: DVec3) -> f64 {
        let w = position.clamp(DVec3::ZERO, self.last) - cell;
        let mix = |a: f64, b: f64, w: f64| a + w * (b - a);
        let (low, high) = (
            mix(mix(c[0], c[1], w.x), mix(c[2], c[3], w.x), w.y),
            mix(mix(c[4], c[5], w.x), mix(c[6], c[7], w.x), w.y),
        );
        mix(low, high, w.z)
    }

    /// Calls `visit` with the cubics along a ray between two distances, front to back, until it returns true.
    pub fn walk(&self, ray: &Ray, (near, far): (f64, f64), mut visit: impl FnMut(&Cubic) -> bool) {
        let (origin, slope) = self.in_index(ray);
        // The next plane through samples on each axis, and which way it goes.
        let mut plane = [0_i64; 3];
        let mut next = [f64::INFINITY; 3];
        let steps = [0, 1, 2].map(|axis| if slope[axis] < 0.0 { -1_i64 } else { 1 });
        let crossing = |axis: usize, plane: i64| {
            let last = self.dims[axis] as i64 - 1;
            if (0..=last).contains(&plane) {
                (plane as f64 - origin[axis]) / slope[axis]
            } else {
                f64::INFINITY
            }
        };
        for axis in 0..3 {
            if slope[axis] == 0.0 {
                continue;
            }
            let at = origin[axis] + near * slope[axis];
            let last = self.dims[axis] as f64 - 1.0;
            plane[axis] = if steps[axis] > 0 {
                (at.floor() + 1.0).clamp(0.0, last + 1.0) as i64
            } else {
                (at.ceil() - 1.0).clamp(-1.0, last) as i64
            };
            next[axis] = crossing(axis, plane[axis]);
        }
        let mut start = near;
        while start < far {
            let first = if next[0] <= next[1] && next[0] <= next[2] {
                0
            } else if next[1] <= next[2] {
                1
            } else {
                2
            };
            let end = next[first].min(far);
            if end > start {
                let cubic = self.cubic(origin, slope, start, end);
                if visit(&cubic) {
                    return;
                }
                start = end;
            }
            if next[first] <= start {
                plane[first] += steps[first];
                next[first] = crossing(first, plane[first]);
            }
        }
    }

    fn cubic(&self, origin: DVec3, slope: DVec3, start: f64, end: f64) -> Cubic {
        let middle = origin + 0.5 * (start + end) * slope;
        let cell = middle.clamp(DVec3::ZERO, self.last).floor();
        let corners = self.corners(cell.as_ivec3());
        // Through four of its values (Newton's divided differences).
        let [a, b, c, d] = [0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0]
            .map(|w| self.in_cell(&corners, cell, origin + (start + w * (end - start)) * slope));
        let cube = 4.5 * (d - 3.0 * c + 3.0 * b - a);
        let square = 4.5 * (a - 2.0 * b + c) - cube;
        Cubic {
            start,
            end,
            terms: [a, d - a - cube - square, square, cube],
            cell: cell.as_ivec3().to_array(),
        }
    }
}
