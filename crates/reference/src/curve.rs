//! The field along a ray inside of one cell: a polynomial of the distance, and what it is made of.

use glam::{DVec3, IVec3};

use crate::field::Field;
use crate::polynomial::{Polynomial, Roots};

/// What the scalar is between samples.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Kernel {
    /// That of the nearest sample.
    Nearest,
    /// Trilinear.
    #[default]
    Linear,
    /// The cubic B-spline over the samples, which it does not pass through.
    Bspline,
    /// The cubic through the samples with central differences as its slopes (Catmull and Rom 1974).
    CatmullRom,
}

impl Kernel {
    /// Whether it jumps or bends half-way between samples.
    pub(crate) fn has_faces(self) -> bool {
        self == Self::Nearest
    }

    /// The weights of the four samples around a place that is 0 to 1 between the two in the middle.
    fn weights(self) -> [Polynomial; 4] {
        let sixth = 1.0 / 6.0;
        let (factor, terms) = match self {
            Self::Nearest | Self::Linear => (
                1.0,
                [
                    [0.0; 4],
                    [1.0, -1.0, 0.0, 0.0],
                    [0.0, 1.0, 0.0, 0.0],
                    [0.0; 4],
                ],
            ),
            Self::Bspline => (
                sixth,
                [
                    [1.0, -3.0, 3.0, -1.0],
                    [4.0, 0.0, -6.0, 3.0],
                    [1.0, 3.0, 3.0, -3.0],
                    [0.0, 0.0, 0.0, 1.0],
                ],
            ),
            Self::CatmullRom => (
                0.5,
                [
                    [0.0, -1.0, 2.0, -1.0],
                    [2.0, 0.0, -5.0, 3.0],
                    [0.0, 1.0, 4.0, -3.0],
                    [0.0, 0.0, -1.0, 1.0],
                ],
            ),
        };
        terms.map(|terms| Polynomial::new(&terms).times(factor))
    }
}

/// The field along a ray between two distances: a polynomial of a parameter that is 0 at the start and 1 at the end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Curve {
    /// World distance from the ray's origin where it starts.
    pub start: f64,
    /// Where it ends.
    pub end: f64,
    /// The scalar.
    pub scalar: Polynomial,
}

impl Curve {
    /// The scalar.
    #[must_use]
    pub fn at(&self, w: f64) -> f64 {
        self.scalar.at(w)
    }

    /// World distance from the ray's origin.
    #[must_use]
    pub fn distance(&self, w: f64) -> f64 {
        self.start + w * (self.end - self.start)
    }

    /// The parameters at which it turns.
    #[must_use]
    pub fn turns(&self) -> Roots {
        self.scalar.turns()
    }
}

/// A line in index coordinates, with a parameter that is 0 at its start and 1 at its end.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Line {
    pub(crate) start: DVec3,
    pub(crate) change: DVec3,
}

impl Line {
    pub(crate) fn at(&self, w: f64) -> DVec3 {
        self.start + w * self.change
    }

    /// The cell that it runs through, the lowest of its samples: it may lie beside the grid, whose samples at the edge go
    /// on there.
    pub(crate) fn cell(&self) -> DVec3 {
        self.at(0.5).floor()
    }

    pub(crate) fn shifted(&self, by: DVec3) -> Self {
        Self {
            start: self.start + by,
            ..*self
        }
    }
}

/// Where a cubic is looked at.
pub(crate) const QUARTERS: [f64; 4] = [0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0];

/// The field along a line inside of one cell.
pub(crate) fn along(field: &Field, line: &Line) -> Polynomial {
    match field.kernel() {
        Kernel::Nearest => {
            let index = (line.at(0.5) + 0.5).floor().as_ivec3();
            Polynomial::new(&[field.sample_clamped(index)])
        }
        Kernel::Linear => {
            let cell = line.cell();
            let corners = corners(field, cell.as_ivec3());
            Polynomial::through(QUARTERS.map(|w| trilinear(&corners, line.at(w) - cell)))
        }
        kernel => separable(field, line, [kernel.weights(); 3]),
    }
}

/// The derivatives by index coordinates of a kernel's field along a line inside of one cell.
pub(crate) fn derivatives(field: &Field, line: &Line, kernel: Kernel) -> [Polynomial; 3] {
    let value = kernel.weights();
    let slope = value.map(|weight| weight.derivative());
    [
        separable(field, line, [slope, value, value]),
        separable(field, line, [value, slope, value]),
        separable(field, line, [value, value, slope]),
    ]
}

/// The sum over the 64 samples around a cell, weighted along each axis.
fn separable(field: &Field, line: &Line, weights: [[Polynomial; 4]; 3]) -> Polynomial {
    let cell = line.cell();
    let place = line.start - cell;
    let [x, y, z] = [0, 1, 2].map(|axis| {
        weights[axis].map(|weight: Polynomial| weight.of(place[axis], line.change[axis]))
    });
    let first = cell.as_ivec3() - 1;
    let mut sum = Polynomial::new(&[0.0]);
    for (k, across) in (0..).zip(&z) {
        let mut plane = Polynomial::new(&[0.0]);
        for (j, along) in (0..).zip(&y) {
            let mut row = Polynomial::new(&[0.0]);
            for (i, weight) in (0..).zip(&x) {
                let sample = field.sample_clamped(first + IVec3::new(i, j, k));
                row = row.plus(&weight.times(sample));
            }
            plane = plane.plus(&along.by(&row));
        }
        sum = sum.plus(&across.by(&plane));
    }
    sum
}

/// The samples at the corners of a cell; bit 0 of the place is x, bit 1 y, bit 2 z.
pub(crate) fn corners(field: &Field, cell: IVec3) -> [f64; 8] {
    std::array::from_fn(|i| field.sample_clamped(cell + corner(i)))
}

/// Which corner of a cell has a number.
pub(crate) fn corner(number: usize) -> IVec3 {
    IVec3::new(
        (number & 1) as i32,
        (number >> 1 & 1) as i32,
        (number >> 2 & 1) as i32,
    )
}

fn mix(a: f64, b: f64, w: f64) -> f64 {
    a + w * (b - a)
}

/// Between values at the corners of a cell, at a place in it.
pub(crate) fn trilinear(c: &[f64; 8], w: DVec3) -> f64 {
    let (low, high) = (
        mix(mix(c[0], c[1], w.x), mix(c[2], c[3], w.x), w.y),
        mix(mix(c[4], c[5], w.x), mix(c[6], c[7], w.x), w.y),
    );
    mix(low, high, w.z)
}

/// The derivatives of that by the place.
pub(crate) fn trilinear_gradient(c: &[f64; 8], w: DVec3) -> DVec3 {
    let face = |low: [f64; 4], high: [f64; 4], u: f64, v: f64| {
        let d = |i: usize| high[i] - low[i];
        mix(mix(d(0), d(1), u), mix(d(2), d(3), u), v)
    };
    DVec3::new(
        face([c[0], c[2], c[4], c[6]], [c[1], c[3], c[5], c[7]], w.y, w.z),
        face([c[0], c[1], c[4], c[5]], [c[2], c[3], c[6], c[7]], w.x, w.z),
        face([c[0], c[1], c[2], c[3]], [c[4], c[5], c[6], c[7]], w.x, w.y),
    )
}
