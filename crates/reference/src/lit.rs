//! Light at a point (Blinn-Phong), and along a curve inside of a volume.

use glam::DVec3;
use volgraph_optics::Material;

use crate::curve::Curve;
use crate::gradient::GradientCurve;
use crate::look::{Lamp, Place};
use crate::polynomial::Polynomial;
use crate::rays::Ray;
use crate::sight::{Part, Sight};

/// A change of less than this part of the range per voxel is no surface: what is so flat is not lit.
const FLAT: f64 = 1e-4;

/// What a point shows of the lights: white matter, and a highlight of strength 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Shine {
    pub(crate) diffuse: [f64; 3],
    pub(crate) specular: [f64; 3],
}

impl Shine {
    /// Of a world position with a unit normal towards the eye; `reaches` says how much of a lamp in a direction, and at
    /// most so far away, gets there.
    pub(crate) fn new(
        lamps: &[Lamp],
        world: DVec3,
        normal: DVec3,
        to_eye: DVec3,
        shininess: f64,
        reaches: impl Fn(&Lamp, DVec3, f64) -> f64,
    ) -> Self {
        let mut sum = Self {
            diffuse: [0.0; 3],
            specular: [0.0; 3],
        };
        for lamp in lamps {
            let (direction, distance) = match lamp.place {
                Place::Eye => (to_eye, f64::INFINITY),
                Place::Towards(direction) => (direction, f64::INFINITY),
                Place::At(position) => {
                    let towards = position - world;
                    (towards.normalize_or_zero(), towards.length())
                }
            };
            let diffuse = normal.dot(direction);
            if diffuse > 0.0 {
                // The last term keeps opposite directions apart, as in `lib/phong.wgsl`.
                let half_way = (direction + to_eye + 1e-6 * normal).normalize();
                let highlight = normal.dot(half_way).max(0.0).powf(shininess);
                let reached = reaches(lamp, direction, distance);
                for channel in 0..3 {
                    sum.diffuse[channel] += reached * lamp.color[channel] * diffuse;
                    sum.specular[channel] += reached * lamp.color[channel] * highlight;
                }
            }
        }
        sum
    }

    /// Linear colour of a material of a colour.
    pub(crate) fn on(&self, color: [f64; 3], material: &Material) -> [f64; 3] {
        std::array::from_fn(|i| {
            color[i] * (material.ambient + material.diffuse * self.diffuse[i])
                + material.specular * self.specular[i]
        })
    }
}

/// Light along a curve of a part of a ray.
pub(crate) struct LitCurve<'c> {
    lamps: &'c [Lamp],
    ray: Ray,
    curve: Curve,
    gradient: GradientCurve,
    /// Lengths of gradients below it are flat.
    flat: f64,
    /// The normal of the cut that the part starts at, and the distances between which it turns to the field's.
    cut: Option<(DVec3, f64, f64)>,
}

impl<'c> LitCurve<'c> {
    pub(crate) fn new(sight: &Sight<'_>, part: &Part, curve: &Curve, lamps: &'c [Lamp]) -> Self {
        let scene = sight.scene;
        let voxel = sight.voxel();
        let (low, high) = scene.field.range();
        let range = if high > low { high - low } else { 1.0 };
        let is_cut = part.cut_normal != DVec3::ZERO && curve.start < part.near + voxel;
        Self {
            lamps,
            ray: sight.ray,
            curve: *curve,
            gradient: scene.gradients.along(&scene.field, &sight.ray, curve),
            flat: FLAT * range / voxel,
            cut: is_cut.then_some((part.cut_normal, part.near, voxel)),
        }
    }

    /// The unit normal towards the eye; zeros where the field is flat.
    fn normal(&self, w: f64) -> DVec3 {
        let gradient = self.gradient.at(w);
        let length = gradient.length();
        let mut normal = if length < self.flat {
            DVec3::ZERO
        } else if gradient.dot(self.ray.direction) > 0.0 {
            gradient / -length
        } else {
            gradient / length
        };
        if let Some((cut, near, voxel)) = self.cut {
            let share = (self.curve.distance(w) - near) / voxel;
            if share < 1.0 {
                let blend = cut + share * (normal - cut);
                normal = blend / blend.length().max(1e-6);
            }
        }
        normal
    }

    /// The colour that a colour of a material shows.
    pub(crate) fn color(&self, w: f64, color: [f64; 3], material: &Material) -> [f64; 3] {
        let normal = self.normal(w);
        if normal == DVec3::ZERO {
            return color;
        }
        let world = self.ray.at(self.curve.distance(w));
        let to_eye = -self.ray.direction;
        Shine::new(
            self.lamps,
            world,
            normal,
            to_eye,
            material.shininess,
            |_, _, _| 1.0,
        )
        .on(color, material)
    }

    /// The parameters at which light may jump or bend, rising: where the gradient is seen from the side, or lit from the
    /// side, or becomes flat, or where the cut's normal ends.
    pub(crate) fn splits(&self) -> Vec<f64> {
        let mut splits = Vec::new();
        let mut add = |polynomial: Polynomial| {
            splits.extend_from_slice(polynomial.sign_changes().as_slice());
        };
        add(self.gradient.towards(self.ray.direction));
        for lamp in self.lamps {
            match lamp.place {
                Place::Eye => {}
                Place::Towards(direction) => add(self.gradient.towards(direction)),
                Place::At(position) => {
                    let from = position - self.ray.at(self.curve.start);
                    let change = (self.curve.start - self.curve.end) * self.ray.direction;
                    let towards = [0, 1, 2].map(|i| Polynomial::new(&[from[i], change[i]]));
                    add(self.gradient.dot(&towards));
                }
            }
        }
        add(self
            .gradient
            .square()
            .plus(&Polynomial::new(&[-self.flat * self.flat])));
        if let Some((_, near, voxel)) = self.cut {
            let end = (near + voxel - self.curve.start) / (self.curve.end - self.curve.start);
            if 0.0 < end && end < 1.0 {
                splits.push(end);
            }
        }
        splits.sort_by(f64::total_cmp);
        splits
    }
}
