//! The field of a volume: its samples, where they are, and the walk of a ray from cell to cell.
//!
//! Beside the grid the samples at its edge go on, so that positions in the outer half of the outermost voxels take the
//! outermost samples, as with the renderer's clamped textures. So along a ray the field is one polynomial between two
//! crossings of the planes through samples; one of nearest samples also jumps at the faces between them.

use std::fmt;
use std::sync::Arc;

use glam::{DAffine3, DMat3, DVec3, IVec3};
use volgraph_volume::{Grid, ScalarType, Volume};

use crate::curve::{Curve, Kernel, Line, along, corners, trilinear, trilinear_gradient};
use crate::rays::Ray;

/// Samples, in the smallest type that holds each of them exactly.
#[derive(Debug)]
enum Samples {
    Single(Vec<f32>),
    Double(Vec<f64>),
}

/// A volume's scalar field.
#[derive(Clone)]
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
    kernel: Kernel,
}

/// All that a picture depends on; the samples by their digest.
impl fmt::Debug for Field {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            samples: _,
            dims,
            last: _,
            index_from_world,
            box_low,
            box_high,
            min_spacing,
            range,
            digest,
            kernel,
        } = self;
        f.debug_struct("Field")
            .field("samples", digest)
            .field("dims", dims)
            .field("index_from_world", index_from_world)
            .field("box", &(box_low, box_high))
            .field("min_spacing", min_spacing)
            .field("range", range)
            .field("kernel", kernel)
            .finish()
    }
}

/// The distances between which a ray (origin and slope) is between three pairs of planes; `None` where it never is.
pub(crate) fn between_slabs(
    (origin, slope): (DVec3, DVec3),
    (low, high): (DVec3, DVec3),
) -> Option<(f64, f64)> {
    let (mut near, mut far) = (f64::NEG_INFINITY, f64::INFINITY);
    for axis in 0..3 {
        let (low, high) = (low[axis] - origin[axis], high[axis] - origin[axis]);
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

/// The distances, not behind the origin, between which a ray is in the box of a grid; `None` where it misses it.
#[must_use]
pub fn interval(grid: &Grid, ray: &Ray) -> Option<(f64, f64)> {
    let index_from_world = grid.world_from_index.inverse();
    let line = (
        index_from_world.transform_point3(ray.origin),
        index_from_world.transform_vector3(ray.direction),
    );
    let (near, far) = between_slabs(line, grid.box_index())?;
    let near = near.max(0.0);
    (near < far).then_some((near, far))
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
            kernel: Kernel::Linear,
        }
    }

    /// The same with another scalar between samples.
    #[must_use]
    pub fn with_kernel(self, kernel: Kernel) -> Self {
        Self { kernel, ..self }
    }

    /// The same samples at another place.
    #[must_use]
    pub fn placed(self, index_from_world: DAffine3) -> Self {
        Self {
            index_from_world,
            ..self
        }
    }

    /// What the scalar is between samples.
    #[must_use]
    pub fn kernel(&self) -> Kernel {
        self.kernel
    }

    /// World length of the smallest spacing.
    #[must_use]
    pub fn min_spacing(&self) -> f64 {
        self.min_spacing
    }

    /// The smallest and the largest sample.
    #[must_use]
    pub fn range(&self) -> (f64, f64) {
        self.range
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
        let (near, far) = between_slabs(self.in_index(ray), (self.box_low, self.box_high))?;
        let near = near.max(0.0);
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

    /// An index clamped to the grid.
    #[must_use]
    pub fn clamped(&self, index: IVec3) -> IVec3 {
        index.clamp(IVec3::ZERO, self.last.as_ivec3())
    }

    /// Samples along each axis.
    #[must_use]
    pub fn dims(&self) -> [usize; 3] {
        self.dims
    }

    /// A ray between two distances in index coordinates.
    pub(crate) fn line(&self, ray: &Ray, start: f64, end: f64) -> Line {
        let (origin, slope) = self.in_index(ray);
        Line {
            start: origin + start * slope,
            change: (end - start) * slope,
        }
    }

    /// The trilinear scalar at a position in index coordinates.
    #[must_use]
    pub fn at(&self, position: DVec3) -> f64 {
        let position = position.clamp(DVec3::ZERO, self.last);
        let cell = position.floor();
        trilinear(&corners(self, cell.as_ivec3()), position - cell)
    }

    /// Its gradient by index coordinates; beside the grid it is 0 along the axis.
    #[must_use]
    pub fn gradient(&self, position: DVec3) -> DVec3 {
        let clamped = position.clamp(DVec3::ZERO, self.last);
        let cell = clamped.floor().min((self.last - 1.0).max(DVec3::ZERO));
        let along = trilinear_gradient(&corners(self, cell.as_ivec3()), clamped - cell);
        DVec3::select(position.cmpeq(clamped), along, DVec3::ZERO)
    }

    /// Gradient of the trilinear field by world coordinates at a world position.
    pub(crate) fn world_gradient(&self, world: DVec3) -> DVec3 {
        let at = self.index_from_world.transform_point3(world);
        self.world_from_index_gradient() * self.gradient(at)
    }

    /// Calls `visit` with the curves along a ray between two distances, front to back, until it returns true. With faces
    /// they end half-way between samples as well.
    pub fn walk(
        &self,
        ray: &Ray,
        ends: (f64, f64),
        with_faces: bool,
        mut visit: impl FnMut(&Curve) -> bool,
    ) {
        let with_faces = with_faces || self.kernel.has_faces();
        self.stretches(ray, ends, with_faces, |start, end| {
            let scalar = along(self, &self.line(ray, start, end));
            visit(&Curve { start, end, scalar })
        });
    }

    /// Calls `visit` with the distances between which a ray meets no plane through samples, nor half-way between them
    /// where `with_faces` says so, until it returns true.
    pub(crate) fn stretches(
        &self,
        ray: &Ray,
        (near, far): (f64, f64),
        with_faces: bool,
        mut visit: impl FnMut(f64, f64) -> bool,
    ) {
        let (origin, slope) = self.in_index(ray);
        let per_sample = if with_faces { 2 } else { 1 };
        let scale = f64::from(per_sample);
        let lasts = self.dims.map(|n| (n as i64 - 1) * i64::from(per_sample));
        // The next plane on each axis, and which way it goes.
        let mut plane = [0_i64; 3];
        let mut next = [f64::INFINITY; 3];
        let steps = [0, 1, 2].map(|axis| if slope[axis] < 0.0 { -1_i64 } else { 1 });
        let crossing = |axis: usize, plane: i64| {
            if (0..=lasts[axis]).contains(&plane) {
                (plane as f64 / scale - origin[axis]) / slope[axis]
            } else {
                f64::INFINITY
            }
        };
        for axis in 0..3 {
            if slope[axis] == 0.0 {
                continue;
            }
            let at = scale * (origin[axis] + near * slope[axis]);
            let last = lasts[axis] as f64;
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
                if visit(start, end) {
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
}
