//! Gradients of the field along a ray: of what the samples say, unquantised.

use glam::{DMat3, DVec3, IVec3};

use crate::curve::{
    Curve, Kernel, Line, QUARTERS, along, corner, corners, derivatives, trilinear,
    trilinear_gradient,
};
use crate::field::Field;
use crate::polynomial::Polynomial;
use crate::rays::Ray;

/// What the gradient at a point is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Gradients {
    /// Trilinear between central differences at the samples.
    #[default]
    StoredCentral,
    /// Trilinear between Sobel's differences at the samples.
    StoredSobel,
    /// Differences of the field one sample to each side of the point.
    Central,
    /// The gradient of the trilinear field.
    Trilinear,
    /// The gradient of the cubic B-spline over the samples.
    Bspline,
}

/// A gradient along a ray where its components are polynomials, by world coordinates.
#[derive(Clone, Copy, Debug)]
pub(crate) struct GradientCurve([Polynomial; 3]);

impl GradientCurve {
    pub(crate) fn at(&self, w: f64) -> DVec3 {
        DVec3::from_array([0, 1, 2].map(|i| self.0[i].at(w)))
    }

    /// Along a direction.
    pub(crate) fn towards(&self, direction: DVec3) -> Polynomial {
        let [x, y, z] = [0, 1, 2].map(|i| self.0[i].times(direction[i]));
        x.plus(&y).plus(&z)
    }

    /// Times a vector that changes along the ray.
    pub(crate) fn dot(&self, other: &[Polynomial; 3]) -> Polynomial {
        let [x, y, z] = [0, 1, 2].map(|i| self.0[i].by(&other[i]));
        x.plus(&y).plus(&z)
    }

    /// The square of its length.
    pub(crate) fn square(&self) -> Polynomial {
        self.dot(&self.0)
    }
}

impl Gradients {
    /// Along a curve of the ray.
    pub(crate) fn along(self, field: &Field, ray: &Ray, curve: &Curve) -> GradientCurve {
        let line = field.line(ray, curve.start, curve.end);
        let cell = line.cell();
        let per_index = match self {
            Self::StoredCentral => stored(field, &line, central_at),
            Self::StoredSobel => stored(field, &line, sobel_at),
            Self::Central => {
                [DVec3::X, DVec3::Y, DVec3::Z].map(|aside| central(field, &line, aside))
            }
            Self::Trilinear => {
                let corners = corners(field, cell.as_ivec3());
                let at = QUARTERS.map(|w| trilinear_gradient(&corners, line.at(w) - cell));
                [0, 1, 2].map(|axis| Polynomial::through(at.map(|gradient| gradient[axis])))
            }
            Self::Bspline => derivatives(field, &line, Kernel::Bspline),
        };
        GradientCurve(in_world(&field.world_from_index_gradient(), &per_index))
    }
}

fn in_world(matrix: &DMat3, per_index: &[Polynomial; 3]) -> [Polynomial; 3] {
    [0, 1, 2].map(|row| {
        let [x, y, z] = [0, 1, 2].map(|i| per_index[i].times(matrix.col(i)[row]));
        x.plus(&y).plus(&z)
    })
}

fn central(field: &Field, line: &Line, aside: DVec3) -> Polynomial {
    let after = along(field, &line.shifted(aside));
    let before = along(field, &line.shifted(-aside));
    after.plus(&before.times(-1.0)).times(0.5)
}

/// Trilinear between gradients at samples; beside the grid those at its edge go on.
fn stored(
    field: &Field,
    line: &Line,
    at_sample: impl Fn(&Field, IVec3) -> DVec3,
) -> [Polynomial; 3] {
    let cell = line.cell();
    let gradients: [DVec3; 8] =
        std::array::from_fn(|i| at_sample(field, field.clamped(cell.as_ivec3() + corner(i))));
    [0, 1, 2].map(|axis| {
        let values = gradients.map(|gradient| gradient[axis]);
        Polynomial::through(QUARTERS.map(|w| trilinear(&values, line.at(w) - cell)))
    })
}

fn central_at(field: &Field, index: IVec3) -> DVec3 {
    let across = |aside: IVec3| {
        0.5 * (field.sample_clamped(index + aside) - field.sample_clamped(index - aside))
    };
    DVec3::new(across(IVec3::X), across(IVec3::Y), across(IVec3::Z))
}

/// Weights 1 2 1 across, differences along.
fn sobel_at(field: &Field, index: IVec3) -> DVec3 {
    let mut sum = DVec3::ZERO;
    for number in 0..27 {
        let offset = IVec3::new(number % 3 - 1, number / 3 % 3 - 1, number / 9 - 1);
        let smoothing = (2 - offset.abs()).as_dvec3();
        let across = DVec3::new(
            smoothing.y * smoothing.z,
            smoothing.x * smoothing.z,
            smoothing.x * smoothing.y,
        );
        sum += field.sample_clamped(index + offset) * offset.as_dvec3() * across;
    }
    sum / 32.0
}
