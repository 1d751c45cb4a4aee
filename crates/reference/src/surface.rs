//! Surfaces along one ray: isosurfaces where the field takes their levels, and the faces of a solid at cuts.

use glam::DVec3;

use crate::clip::towards_eye;
use crate::curve::Curve;
use crate::lit::Shine;
use crate::look::Lamp;
use crate::scene::Shadow;
use crate::shadow::{self, Lit};
use crate::sight::{Part, Sight};

/// A surface that a curve meets.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hit {
    /// The parameter of the curve.
    pub(crate) w: f64,
    /// Linear colour towards the eye, and its opacity.
    pub(crate) color: [f64; 3],
    pub(crate) opacity: f64,
    /// Unit normal towards the eye.
    pub(crate) normal: DVec3,
    /// Bound of the error of the lamps' shares that reach it.
    pub(crate) error: f64,
}

/// What a walk over the parts of a ray has come through.
pub(crate) struct SurfaceWalk {
    has_faces: bool,
    /// Absolute tolerance of the lamps' shares.
    tolerance: f64,
    /// Where the last curve ended, and whether that was in the solid.
    end: f64,
    is_solid: bool,
    /// Of each isosurface, whether the last curve ended above it.
    is_above: Vec<bool>,
}

impl SurfaceWalk {
    pub(crate) fn new(has_faces: bool, tolerance: f64) -> Self {
        Self {
            has_faces,
            tolerance,
            end: f64::NEG_INFINITY,
            is_solid: false,
            is_above: Vec::new(),
        }
    }

    /// The surfaces that the next curve of a part meets, in order.
    pub(crate) fn hits(
        &mut self,
        sight: &Sight<'_>,
        part: &Part,
        curve: &Curve,
        hits: &mut Vec<Hit>,
    ) {
        let look = sight.look(part);
        let first = curve.at(0.0);
        if curve.start <= part.near {
            self.is_above = look.layers.iter().map(|l| first >= l.level).collect();
            let goes_on = self.is_solid && part.near <= self.end;
            if self.has_faces && part.is_face && !goes_on && look.is_solid(first) {
                let layer = &look.layers[0];
                if layer.opacity > 0.0 {
                    let mut normal = sight.face_normal(part);
                    if normal == DVec3::ZERO {
                        normal = gradient_normal(sight, curve, 0.0);
                    }
                    let point = Lit {
                        world: sight.ray.at(curve.start),
                        normal,
                        is_face: true,
                    };
                    hits.push(Hit {
                        w: 0.0,
                        color: self.color(sight, part, &point, first, layer.color),
                        opacity: layer.opacity,
                        normal,
                        error: self.error(sight),
                    });
                }
            }
        }
        let mut low = 0.0;
        for high in curve.turns().as_slice().iter().copied().chain([1.0]) {
            let value = curve.at(high);
            let mut met: Vec<(f64, usize)> = Vec::new();
            for (at, layer) in look.layers.iter().enumerate() {
                if (value >= layer.level) != self.is_above[at] {
                    self.is_above[at] = value >= layer.level;
                    met.push((curve.scalar.solve(low, high, layer.level), at));
                }
            }
            met.sort_by(|a, b| a.0.total_cmp(&b.0));
            for (w, at) in met {
                let layer = &look.layers[at];
                if layer.opacity > 0.0 {
                    let normal = gradient_normal(sight, curve, w);
                    let point = Lit {
                        world: sight.ray.at(curve.distance(w)),
                        normal,
                        is_face: false,
                    };
                    hits.push(Hit {
                        w,
                        color: self.color(sight, part, &point, layer.level, layer.color),
                        opacity: layer.opacity,
                        normal,
                        error: self.error(sight),
                    });
                }
            }
            low = high;
        }
        self.end = curve.end;
        self.is_solid = look.is_solid(curve.at(1.0));
    }

    /// Of shares that are all or nothing there is none.
    fn error(&self, sight: &Sight<'_>) -> f64 {
        if sight.scene.shadow == Shadow::Matter {
            self.tolerance
        } else {
            0.0
        }
    }

    /// Linear colour towards the eye of a point.
    fn color(
        &self,
        sight: &Sight<'_>,
        part: &Part,
        point: &Lit,
        scalar: f64,
        color: [f64; 3],
    ) -> [f64; 3] {
        let look = sight.look(part);
        let Some(lamps) = &look.lamps else {
            return color;
        };
        let material = look.material_at(scalar);
        let to_eye = -sight.ray.direction;
        let reaches = |lamp: &Lamp, direction, reach| {
            shadow::transmittance(sight, point, lamp, direction, reach, self.tolerance)
        };
        let (world, normal) = (point.world, point.normal);
        Shine::new(lamps, world, normal, to_eye, material.shininess, reaches).on(color, &material)
    }
}

/// The field's normal towards the eye; where it is flat, the direction back.
fn gradient_normal(sight: &Sight<'_>, curve: &Curve, w: f64) -> DVec3 {
    let scene = sight.scene;
    let gradient = scene.gradients.along(&scene.field, &sight.ray, curve);
    let normal = towards_eye(gradient.at(w), &sight.ray);
    if normal == DVec3::ZERO {
        -sight.ray.direction
    } else {
        normal
    }
}
