//! Fields of a line or two: the Marschner–Lobb signal, sphere, torus, gyroid, ramp, trilinear, constant.

use std::f64::consts::PI;

use glam::{DVec2, DVec3};

/// The test signal of Marschner and Lobb, "An Evaluation of Reconstruction Filters for Volume Rendering",
/// IEEE Visualization 1994, section 5:
///
/// ρ(x, y, z) = (1 − sin(π z / 2) + α (1 + ρ_r(√(x² + y²)))) / (2 (1 + α)), ρ_r(r) = cos(2 π f cos(π r / 2)).
///
/// In the paper f = 6 and α = 0.25. Values are in 0..1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MarschnerLobb {
    /// f, in rings per unit length.
    pub frequency: f64,
    /// α, the strength of the rings.
    pub alpha: f64,
}

impl MarschnerLobb {
    pub(super) fn value(&self, p: DVec3) -> f64 {
        let r = p.truncate().length();
        let rings = (2.0 * PI * self.frequency * (PI * r / 2.0).cos()).cos();
        (1.0 - (PI * p.z / 2.0).sin() + self.alpha * (1.0 + rings)) / (2.0 * (1.0 + self.alpha))
    }

    pub(super) fn gradient(&self, p: DVec3) -> DVec3 {
        let r = p.truncate().length();
        let phase = 2.0 * PI * self.frequency;
        // ρ_r'(r) / r; sin(πr/2) / r tends to π/2 at the axis.
        let sine_over_r = if r > 1e-8 {
            (PI * r / 2.0).sin() / r
        } else {
            PI / 2.0
        };
        let slope_over_r = (phase * (PI * r / 2.0).cos()).sin() * phase * sine_over_r * PI / 2.0;
        let across: DVec2 = self.alpha * slope_over_r * p.truncate();
        across.extend(-PI / 2.0 * (PI * p.z / 2.0).cos()) / (2.0 * (1.0 + self.alpha))
    }
}

/// Linear falloff from the centre: 0.5 + (radius − |p|) / falloff. The isosurface 0.5 is the sphere; the
/// gradient has length 1 / falloff everywhere but at the centre. Over the cube the defaults stay in 0..1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// Radius of the isosurface 0.5.
    pub radius: f64,
    /// Distance over which the value falls by 1.
    pub falloff: f64,
}

impl Sphere {
    pub(super) fn value(&self, p: DVec3) -> f64 {
        0.5 + (self.radius - p.length()) / self.falloff
    }

    pub(super) fn gradient(&self, p: DVec3) -> DVec3 {
        -p.normalize_or_zero() / self.falloff
    }
}

/// Linear falloff from a ring in the xy plane: 0.5 + (minor − √((√(x² + y²) − major)² + z²)) / falloff. The
/// isosurface 0.5 is the torus about z. Over the cube the defaults stay in 0..1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Torus {
    /// Radius of the ring.
    pub major: f64,
    /// Radius of the tube.
    pub minor: f64,
    /// Distance over which the value falls by 1.
    pub falloff: f64,
}

impl Torus {
    /// From the nearest point of the ring to `p`, in the plane of the axis and `p`: outwards, and along z.
    fn ring_offset(&self, p: DVec3) -> DVec2 {
        DVec2::new(p.truncate().length() - self.major, p.z)
    }

    pub(super) fn value(&self, p: DVec3) -> f64 {
        0.5 + (self.minor - self.ring_offset(p).length()) / self.falloff
    }

    pub(super) fn gradient(&self, p: DVec3) -> DVec3 {
        let away = self.ring_offset(p).normalize_or_zero();
        let outwards = p.truncate().normalize_or_zero();
        -(outwards * away.x).extend(away.y) / self.falloff
    }
}

/// The gyroid's level function (Schoen 1970; as a trigonometric level set, Lambert et al. 1996):
/// 0.5 + (sin kx cos ky + sin ky cos kz + sin kz cos kx) / 3 with k = π periods. Its range is 0..1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gyroid {
    /// Periods along an edge of the cube, which has length 2.
    pub periods: f64,
}

impl Gyroid {
    pub(super) fn value(&self, p: DVec3) -> f64 {
        let (s, c) = self.sines(p);
        0.5 + (s.x * c.y + s.y * c.z + s.z * c.x) / 3.0
    }

    pub(super) fn gradient(&self, p: DVec3) -> DVec3 {
        let (s, c) = self.sines(p);
        let k = PI * self.periods;
        DVec3::new(
            c.x * c.y - s.z * s.x,
            c.y * c.z - s.x * s.y,
            c.z * c.x - s.y * s.z,
        ) * (k / 3.0)
    }

    fn sines(&self, p: DVec3) -> (DVec3, DVec3) {
        let phase = p * (PI * self.periods);
        let each = |f: fn(f64) -> f64| DVec3::new(f(phase.x), f(phase.y), f(phase.z));
        (each(f64::sin), each(f64::cos))
    }
}

/// Linear along a direction d: 0.5 + (d · p) / (2 (|d_x| + |d_y| + |d_z|)), which is 0..1 over the cube. Every
/// trilinear reconstruction of it is exact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ramp {
    pub(super) gradient: DVec3,
}

impl Ramp {
    /// The ramp along a direction, whose length does not matter; `None` where it is 0 or not finite.
    #[must_use]
    pub fn along(direction: DVec3) -> Option<Self> {
        let span = direction.abs().element_sum();
        let gradient = direction / (2.0 * span);
        (span > 0.0 && gradient.is_finite()).then_some(Self { gradient })
    }

    pub(super) fn value(&self, p: DVec3) -> f64 {
        0.5 + self.gradient.dot(p)
    }
}

/// Trilinear between values at the corners of the cube `[-1, 1]³`: what a renderer makes of one cell of a grid. Along any
/// line it is a cubic without kinks, so it limits no order of convergence.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trilinear {
    /// The values; bit 0 of the place is x, bit 1 y, bit 2 z.
    pub corners: [f64; 8],
}

impl Trilinear {
    pub(super) fn value(&self, p: DVec3) -> f64 {
        let [x, y, z] = (p * 0.5 + 0.5).to_array();
        self.weighted([1.0 - x, x], [1.0 - y, y], [1.0 - z, z])
    }

    pub(super) fn gradient(&self, p: DVec3) -> DVec3 {
        let [x, y, z] = (p * 0.5 + 0.5).to_array();
        let slope = [-0.5, 0.5];
        DVec3::new(
            self.weighted(slope, [1.0 - y, y], [1.0 - z, z]),
            self.weighted([1.0 - x, x], slope, [1.0 - z, z]),
            self.weighted([1.0 - x, x], [1.0 - y, y], slope),
        )
    }

    fn weighted(&self, x: [f64; 2], y: [f64; 2], z: [f64; 2]) -> f64 {
        let corners = self.corners.iter().enumerate();
        corners
            .map(|(i, value)| value * x[i & 1] * y[i >> 1 & 1] * z[i >> 2])
            .sum()
    }
}

/// The same value everywhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Constant {
    /// The value.
    pub value: f64,
}
