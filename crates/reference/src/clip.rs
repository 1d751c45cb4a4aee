//! What of a ray is visible: closed forms of convex shapes, or the crossings of another volume's field.

use glam::DVec3;

use crate::field::Field;
use crate::rays::Ray;

/// A clip: what of the volume is kept.
#[derive(Clone, Debug)]
pub struct Clip {
    /// The shape.
    pub shape: Shape,
    /// Whether what lies outside of the shape is kept, and not what lies inside.
    pub keeps_outside: bool,
}

/// A shape in the world.
#[derive(Clone, Debug)]
pub enum Shape {
    /// Where `normal · position >= height` for each (normal, height).
    Planes(Vec<(DVec3, f64)>),
    /// A ball.
    Sphere {
        /// World position of its middle.
        centre: DVec3,
        /// World length.
        radius: f64,
    },
    /// Where another volume is at an isovalue or above it; around its grid the samples at the edge go on.
    Volume {
        /// Its field, where it lies.
        field: Box<Field>,
        /// The isovalue in its data units.
        level: f64,
    },
}

/// A visible stretch of a ray: world distances from its origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Visible {
    /// Where it starts.
    pub near: f64,
    /// Where it ends.
    pub far: f64,
    /// Unit world normal, towards the eye, of the cut that it starts at; zeros where it starts at none.
    pub cut_normal: DVec3,
}

impl Clip {
    /// The visible stretches of a ray between two distances, in order.
    #[must_use]
    pub fn visible(&self, ray: &Ray, (near, far): (f64, f64)) -> Vec<Visible> {
        let inside = match &self.shape {
            Shape::Planes(planes) => between_planes(planes, ray),
            Shape::Sphere { centre, radius } => in_sphere(*centre, *radius, ray),
            Shape::Volume { field, level } => {
                return self.of_volume(field, *level, ray, (near, far));
            }
        };
        let first = inside.first.0.clamp(near, far);
        let last = inside.last.0.clamp(first, far);
        let stretch = |near: f64, far: f64, normal: DVec3| Visible {
            near,
            far,
            cut_normal: normal,
        };
        if !self.keeps_outside {
            let is_cut = first > near;
            let normal = if is_cut { inside.first.1 } else { DVec3::ZERO };
            let visible = stretch(first, last, towards_eye(normal, ray));
            return (last > first).then_some(visible).into_iter().collect();
        }
        if last <= first {
            return vec![stretch(near, far, DVec3::ZERO)];
        }
        let before = stretch(near, first, DVec3::ZERO);
        let after = stretch(last, far, towards_eye(inside.last.1, ray));
        let is_some = |visible: &Visible| visible.far > visible.near;
        [before, after].into_iter().filter(is_some).collect()
    }

    fn of_volume(
        &self,
        field: &Field,
        level: f64,
        ray: &Ray,
        (near, far): (f64, f64),
    ) -> Vec<Visible> {
        let is_kept = |value: f64| {
            if self.keeps_outside {
                value <= level
            } else {
                value >= level
            }
        };
        let mut visible = Vec::new();
        // Where the stretch starts that the walk is in, if it is in one.
        let mut start = None;
        let mut is_first = true;
        field.walk(ray, (near, far), false, |curve| {
            if is_first && is_kept(curve.at(0.0)) {
                start = Some((near, DVec3::ZERO));
            }
            is_first = false;
            let mut low = 0.0;
            for high in curve.turns().as_slice().iter().copied().chain([1.0]) {
                if is_kept(curve.at(high)) != start.is_some() {
                    let at = curve.distance(curve.scalar.solve(low, high, level));
                    if let Some((near, cut_normal)) = start.take() {
                        visible.push(Visible {
                            near,
                            far: at,
                            cut_normal,
                        });
                    } else {
                        start = Some((at, towards_eye(volume_normal(field, ray.at(at)), ray)));
                    }
                }
                low = high;
            }
            false
        });
        if let Some((near, cut_normal)) = start {
            visible.push(Visible {
                near,
                far,
                cut_normal,
            });
        }
        visible.retain(|stretch| stretch.far > stretch.near);
        visible
    }
}

/// Where a line is inside of a convex shape, and the normals where it comes in and goes out.
struct Inside {
    first: (f64, DVec3),
    last: (f64, DVec3),
}

const NOWHERE: Inside = Inside {
    first: (f64::INFINITY, DVec3::ZERO),
    last: (f64::NEG_INFINITY, DVec3::ZERO),
};

fn between_planes(planes: &[(DVec3, f64)], ray: &Ray) -> Inside {
    let mut inside = Inside {
        first: (f64::NEG_INFINITY, DVec3::ZERO),
        last: (f64::INFINITY, DVec3::ZERO),
    };
    for (normal, height) in planes {
        let above = normal.dot(ray.origin) - height;
        let slope = normal.dot(ray.direction);
        if slope.abs() < 1e-14 * normal.length() {
            if above < 0.0 {
                return NOWHERE;
            }
            continue;
        }
        let crossing = -above / slope;
        if slope > 0.0 && crossing > inside.first.0 {
            inside.first = (crossing, *normal);
        } else if slope < 0.0 && crossing < inside.last.0 {
            inside.last = (crossing, *normal);
        }
    }
    inside
}

fn in_sphere(centre: DVec3, radius: f64, ray: &Ray) -> Inside {
    let from_centre = ray.origin - centre;
    let middle = -from_centre.dot(ray.direction);
    let nearest = from_centre + middle * ray.direction;
    let square = radius * radius - nearest.length_squared();
    if square <= 0.0 {
        return NOWHERE;
    }
    let half = square.sqrt();
    let end = |distance: f64| (distance, ray.at(distance) - centre);
    Inside {
        first: end(middle - half),
        last: end(middle + half),
    }
}

/// Along the clip volume's gradient, by central differences of one sample to each side.
fn volume_normal(field: &Field, world: DVec3) -> DVec3 {
    let at = field.index_from_world().transform_point3(world);
    let across = |aside: DVec3| field.at(at + aside) - field.at(at - aside);
    let per_index = DVec3::new(across(DVec3::X), across(DVec3::Y), across(DVec3::Z));
    field.world_from_index_gradient() * per_index
}

/// A unit normal towards the eye; zeros of zeros.
pub(crate) fn towards_eye(normal: DVec3, ray: &Ray) -> DVec3 {
    let normal = normal.normalize_or_zero();
    if normal.dot(ray.direction) > 0.0 {
        -normal
    } else {
        normal
    }
}
