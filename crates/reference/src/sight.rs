//! A ray through a scene: its parts, each of one label, between what a clip cuts away.

use glam::DVec3;

use crate::clip::{Visible, towards_eye};
use crate::curve::Curve;
use crate::look::Look;
use crate::rays::Ray;
use crate::scene::Scene;

/// A part of a ray: world distances from its origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Part {
    pub(crate) near: f64,
    pub(crate) far: f64,
    /// Unit world normal, towards the eye, of the cut that it starts at; zeros where it starts at none.
    pub(crate) cut_normal: DVec3,
    /// Whether it starts at a face: at a cut or at the box, and not at the eye.
    pub(crate) is_face: bool,
    /// Which of the scene's looks it has.
    pub(crate) look: usize,
}

/// A ray and its parts.
pub(crate) struct Sight<'s> {
    pub(crate) scene: &'s Scene,
    pub(crate) ray: Ray,
    pub(crate) parts: Vec<Part>,
}

impl<'s> Sight<'s> {
    /// A ray between two distances in the volume's box; `is_outside` says that it comes in from outside at the first.
    pub(crate) fn new(scene: &'s Scene, ray: Ray, ends: (f64, f64), is_outside: bool) -> Self {
        let whole = Visible {
            near: ends.0,
            far: ends.1,
            cut_normal: DVec3::ZERO,
        };
        let visible = match &scene.clip {
            Some(clip) => clip.visible(&ray, ends),
            None => vec![whole],
        };
        let mut parts = Vec::with_capacity(visible.len());
        for Visible {
            near,
            far,
            cut_normal,
        } in visible
        {
            let is_face = near > ends.0 || is_outside;
            let Some(labels) = &scene.labels else {
                parts.push(Part {
                    near,
                    far,
                    cut_normal,
                    is_face,
                    look: 0,
                });
                continue;
            };
            let mut part = (near, cut_normal, is_face);
            for stretch in labels.stretches(&ray, (near, far)) {
                if labels
                    .is_visible
                    .get(stretch.label)
                    .copied()
                    .unwrap_or(true)
                {
                    parts.push(Part {
                        near: part.0,
                        far: stretch.far,
                        cut_normal: part.1,
                        is_face: part.2,
                        look: labels.look(stretch.label),
                    });
                }
                part = (stretch.far, stretch.normal, true);
            }
        }
        Self { scene, ray, parts }
    }

    pub(crate) fn look(&self, part: &Part) -> &'s Look {
        let looks = &self.scene.looks;
        looks.get(part.look).unwrap_or(&looks[0])
    }

    /// Calls `visit` with the curves of a part until it returns true.
    pub(crate) fn walk(&self, part: &Part, visit: impl FnMut(&Curve) -> bool) {
        self.scene
            .field
            .walk(&self.ray, (part.near, part.far), false, visit);
    }

    /// World length in which the normal behind a cut turns to the field's.
    pub(crate) fn voxel(&self) -> f64 {
        self.scene.field.min_spacing()
    }

    /// The normal of the cut that a part starts at, or of the box's face; zeros where it starts at neither.
    pub(crate) fn face_normal(&self, part: &Part) -> DVec3 {
        if part.cut_normal != DVec3::ZERO {
            return part.cut_normal;
        }
        let field = &self.scene.field;
        let line = field.line(&self.ray, part.near, part.near + 1.0);
        let (low, high) = field.box_index();
        let away = (line.start - low).abs().min((line.start - high).abs());
        let least = away.min_element();
        if least > 1e-6 {
            return DVec3::ZERO;
        }
        let normal = DVec3::from_array([0, 1, 2].map(|axis| {
            if away[axis] <= least + 1e-9 {
                -line.change[axis].signum()
            } else {
                0.0
            }
        }));
        towards_eye(field.world_from_index_gradient() * normal, &self.ray)
    }
}
