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

#[cfg(test)]
mod tests {
    use volgraph_volume::{Grid, Volume, Voxels};

    use super::*;

    /// Noise: nothing about it is symmetric.
    fn field() -> Field {
        let dims = [5, 4, 6];
        let noise = |i: u32| f64::from(i.wrapping_mul(2_654_435_761) >> 16) / 65536.0;
        let voxels = (0..120).map(noise).collect();
        let grid = Grid::axis_aligned(dims, DVec3::new(1.0, 2.0, 0.5), DVec3::ZERO);
        Field::new(&Volume::new("noise", grid, Voxels::F64(voxels)).unwrap())
    }

    /// Calls `check` at places along a ray through the whole box, its clamped rim included.
    fn along_a_ray(field: &Field, check: impl Fn(DVec3, &Curve, f64, &Ray)) {
        let ray = Ray {
            origin: DVec3::new(-1.31, -2.13, -1.69),
            direction: DVec3::new(1.1, 1.7, 0.9).normalize(),
        };
        let ends = field.interval(&ray).unwrap();
        let mut curves = 0;
        field.walk(&ray, ends, false, |curve| {
            for w in [0.0, 0.37, 1.0] {
                let world = ray.at(curve.distance(w));
                let at = field.index_from_world().transform_point3(world);
                check(at, curve, w, &ray);
            }
            curves += 1;
            false
        });
        assert!(curves > 8, "{curves}");
    }

    #[test]
    fn along_a_ray_gradients_are_those_at_its_points() {
        let field = field();
        let spacing = DVec3::new(1.0, 2.0, 0.5);
        let central = |f: &dyn Fn(DVec3) -> f64, at: DVec3| {
            let d = |aside: DVec3| 0.5 * (f(at + aside) - f(at - aside));
            DVec3::new(d(DVec3::X), d(DVec3::Y), d(DVec3::Z))
        };
        along_a_ray(&field, |at, curve, w, ray| {
            assert!((curve.at(w) - field.at(at)).abs() < 1e-12);
            let expected = central(&|at| field.at(at), at) / spacing;
            let found = Gradients::Central.along(&field, ray, curve).at(w);
            assert!(found.distance(expected) < 1e-11, "{at}: {found} {expected}");
            // Between samples: of the differences there, each clamped as a texture is.
            let last = DVec3::new(4.0, 3.0, 5.0);
            let clamped = at.clamp(DVec3::ZERO, last);
            let cell = clamped.floor().min(last - 1.0);
            let part = clamped - cell;
            let mut expected = DVec3::ZERO;
            for i in 0..8 {
                let corner = corner(i).as_dvec3();
                let weights = DVec3::ONE - (part - corner).abs();
                let there = central(&|at| field.at(at), cell + corner);
                expected += weights.x * weights.y * weights.z * there;
            }
            let found = Gradients::StoredCentral.along(&field, ray, curve).at(w);
            assert!(found.distance(expected / spacing) < 1e-11, "{at}");
        });
    }

    #[test]
    fn exact_gradients_are_the_slopes_of_their_fields() {
        for (kernel, gradients) in [
            (Kernel::Linear, Gradients::Trilinear),
            (Kernel::Bspline, Gradients::Bspline),
        ] {
            let field = field().with_kernel(kernel);
            along_a_ray(&field, |at, curve, w, ray| {
                let gradient = gradients.along(&field, ray, curve).at(w);
                let slope = curve.scalar.slope(w) / (curve.end - curve.start);
                let off = gradient.dot(ray.direction) - slope;
                assert!(off.abs() < 1e-9, "{kernel:?} {at}: {off:e}");
            });
        }
    }

    #[test]
    fn kernels_reproduce_what_they_must() {
        // A linear field is kept by each kernel inside of the rim; a B-spline smooths a single sample to 8/27 of it.
        let grid = Grid::axis_aligned([7, 7, 7], DVec3::ONE, DVec3::ZERO);
        let linear = (0..343).map(|i| f64::from(i % 7) - 2.0 * f64::from(i / 49));
        let voxels = Voxels::F64(linear.collect());
        let linear = Field::new(&Volume::new("linear", grid, voxels).unwrap());
        let mut voxels = vec![0.0; 343];
        voxels[3 + 21 + 147] = 1.0;
        let peak = Field::new(&Volume::new("peak", grid, Voxels::F64(voxels)).unwrap());
        let ray = Ray {
            origin: DVec3::splat(3.0) - 1.5 * DVec3::new(0.6, 0.64, 0.48),
            direction: DVec3::new(0.6, 0.64, 0.48),
        };
        for (kernel, top) in [
            (Kernel::Linear, 1.0),
            (Kernel::Bspline, 8.0 / 27.0),
            (Kernel::CatmullRom, 1.0),
        ] {
            let (linear, peak) = (
                linear.clone().with_kernel(kernel),
                peak.clone().with_kernel(kernel),
            );
            linear.walk(&ray, (0.0, 3.0), false, |curve| {
                let at = ray.at(curve.distance(0.7));
                assert!((curve.at(0.7) - (at.x - 2.0 * at.z)).abs() < 1e-12);
                false
            });
            let mut before = None;
            peak.walk(&ray, (0.0, 3.0), false, |curve| {
                if curve.end == 1.5 || (curve.end - 1.5).abs() < 1e-12 {
                    assert!((curve.at(1.0) - top).abs() < 1e-12, "{kernel:?}");
                }
                // No jumps from cell to cell.
                let here = curve.at(0.0);
                assert!(before.is_none_or(|value: f64| (value - here).abs() < 1e-12));
                before = Some(curve.at(1.0));
                false
            });
        }
    }
}
