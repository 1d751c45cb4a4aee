//! Rays through convex solids of glass, in f64: what a pixel of `refraction_surface` should show.

use glam::DVec3;
use volgraph::View;

/// The background as bent rays see it: `place.y / 2 + 1 / 2`, on a plane behind the volume and one before it.
pub struct Beyond {
    view: View,
    behind: f64,
    before: f64,
}

impl Beyond {
    /// Planes so many radii of the box behind and before its middle.
    pub fn new(view: &View, (low, high): (DVec3, DVec3), radii: f64) -> Self {
        let camera = &view.camera;
        let middle = (0.5 * (low + high) - camera.eye).dot(camera.forward);
        let reach = radii * 0.5 * low.distance(high);
        Self {
            view: *view,
            behind: middle + reach,
            before: middle - reach,
        }
    }

    pub fn color(&self, from: DVec3, direction: DVec3) -> f64 {
        let camera = &self.view.camera;
        let lens = self.view.lens();
        let along = direction.dot(camera.forward);
        let depth = if along < 0.0 {
            self.before
        } else {
            self.behind
        };
        let from = from - camera.eye;
        let met = from + direction * ((depth - from.dot(camera.forward)) / along);
        let scale = if lens.is_orthographic {
            1.0
        } else {
            self.behind
        };
        let place = met.dot(camera.up) / (scale * lens.half_extent[1]);
        (0.5 * place + 0.5).clamp(0.0, 1.0)
    }
}

/// Fresnel's share of unpolarised light that is mirrored; `cosine` of the angle to the normal in front.
pub fn reflectance(front: f64, back: f64, cosine: f64) -> f64 {
    let sine = front / back * (1.0 - cosine * cosine).sqrt();
    if sine >= 1.0 {
        return 1.0;
    }
    let refracted = (1.0 - sine * sine).sqrt();
    let across = (front * cosine - back * refracted) / (front * cosine + back * refracted);
    let within = (back * cosine - front * refracted) / (back * cosine + front * refracted);
    0.5 * (across * across + within * within)
}

/// One of the shapes that a solid is the common part of.
pub enum Shape {
    Ball(DVec3, f64),
    /// A point of the face, and the normal outwards.
    Half(DVec3, DVec3),
}

impl Shape {
    pub fn block(low: DVec3, high: DVec3) -> Vec<Self> {
        DVec3::AXES
            .into_iter()
            .flat_map(|axis| [Self::Half(low, -axis), Self::Half(high, axis)])
            .collect()
    }

    /// Where a ray is inside, and the outward normals there.
    fn interval(&self, (origin, direction): (DVec3, DVec3)) -> [(f64, DVec3); 2] {
        let infinity = f64::INFINITY;
        match self {
            Self::Ball(centre, radius) => {
                let along = (*centre - origin).dot(direction);
                let aside = (origin + along * direction - centre).length_squared();
                let square = radius * radius - aside;
                if square <= 0.0 {
                    return [(infinity, DVec3::ZERO), (-infinity, DVec3::ZERO)];
                }
                [along - square.sqrt(), along + square.sqrt()]
                    .map(|t| (t, (origin + t * direction - *centre).normalize()))
            }
            Self::Half(point, normal) => {
                let rise = direction.dot(*normal);
                let t = (*point - origin).dot(*normal) / rise;
                if rise > 0.0 {
                    [(-infinity, *normal), (t, *normal)]
                } else {
                    [(t, *normal), (infinity, *normal)]
                }
            }
        }
    }
}

pub struct Solid {
    pub shapes: Vec<Shape>,
    pub index: f64,
    /// Per voxel.
    pub extinction: f64,
    pub max_interfaces: u32,
}

/// What happens to a ray.
pub struct Way {
    pub color: f64,
    /// How often it meets the surface.
    pub interfaces: u32,
    /// The cosine of its flattest angle to a surface, outside of it; near 0 as well where it is just mirrored.
    pub least_cosine: f64,
    /// The ray that is left in the end.
    pub ray: (DVec3, DVec3),
}

impl Solid {
    fn interval(&self, ray: (DVec3, DVec3)) -> [(f64, DVec3); 2] {
        self.shapes
            .iter()
            .map(|shape| shape.interval(ray))
            .reduce(|a, b| {
                [
                    if a[0].0 > b[0].0 { a[0] } else { b[0] },
                    if a[1].0 < b[1].0 { a[1] } else { b[1] },
                ]
            })
            .unwrap()
    }

    /// What a pixel shows: mirrored shares show what is behind in their direction.
    pub fn color(&self, ray: (DVec3, DVec3), beyond: &Beyond) -> f64 {
        self.trace(ray, |from, direction| beyond.color(from, direction))
            .color
    }

    /// What happens to a ray, its colour aside.
    pub fn way(&self, ray: (DVec3, DVec3)) -> Way {
        self.trace(ray, |_, _| 0.0)
    }

    fn trace(
        &self,
        (mut origin, mut direction): (DVec3, DVec3),
        beyond: impl Fn(DVec3, DVec3) -> f64,
    ) -> Way {
        let [(near, normal), (far, _)] = self.interval((origin, direction));
        let (mut color, mut share, mut interfaces, mut least_cosine) = (0.0, 1.0, 0, 1.0_f64);
        if far <= near.max(0.0) {
            return Way {
                color: beyond(origin, direction),
                interfaces,
                least_cosine,
                ray: (origin, direction),
            };
        }
        if near > 0.0 {
            origin += near * direction;
            interfaces = 1;
            let cosine = -normal.dot(direction);
            least_cosine = least_cosine.min(cosine);
            let mirrored = reflectance(1.0, self.index, cosine);
            color += mirrored * beyond(origin, direction + 2.0 * cosine * normal);
            share -= mirrored;
            let sine = direction + cosine * normal;
            let refracted = (1.0 - sine.length_squared() / self.index.powi(2)).sqrt();
            direction = sine / self.index - refracted * normal;
        }
        while interfaces < self.max_interfaces {
            let [_, (far, normal)] = self.interval((origin, direction));
            origin += far * direction;
            interfaces += 1;
            share *= (-self.extinction * far).exp();
            let cosine = normal.dot(direction);
            // The angle outside, which is the larger one.
            let outside = 1.0 - (self.index * self.index) * (1.0 - cosine * cosine);
            least_cosine = least_cosine.min(outside.abs().sqrt());
            let mirrored = reflectance(self.index, 1.0, cosine);
            let inner = direction - 2.0 * cosine * normal;
            if mirrored >= 1.0 {
                direction = inner;
                continue;
            }
            color += share * mirrored * beyond(origin, inner);
            share *= 1.0 - mirrored;
            let sine = (direction - cosine * normal) * self.index;
            direction = sine + (1.0 - sine.length_squared()).sqrt() * normal;
            break;
        }
        color += share * beyond(origin, direction);
        Way {
            color,
            interfaces,
            least_cosine,
            ray: (origin, direction),
        }
    }
}
