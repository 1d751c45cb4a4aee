//! Orbitals of hydrogen.
//!
//! ψ = f(r) S(p) with f(r) = exp(−ρ/2) L(ρ), ρ = 2 r / n, the associated Laguerre polynomial L of degree
//! n − l − 1 and order 2l + 1, and the real solid harmonic S of degree l, a polynomial in x, y, z. Both come by
//! their three-term recurrences, with derivatives beside the values, so that the gradient of ψ² = 2 ψ ∇ψ is exact.
//! The maximum of ψ² is that of (f(r) rˡ)² times that of S² on the unit sphere; each is found by a scan and a
//! golden section.

use glam::DVec3;

/// |ψ_nlm|² of a real orbital of hydrogen (e.g. Griffiths, Introduction to Quantum Mechanics, eq. 4.89), divided
/// by its maximum over all space: values are in 0..1. For m > 0 the orbital goes with cos(m φ), for m < 0 with
/// sin(|m| φ). The unit of length is the cube's: `extent` Bohr radii to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hydrogen {
    n: u32,
    l: u32,
    m: i32,
    extent: f64,
    /// 1 / max |f(r) rˡ S(û)|.
    scale: f64,
}

/// Π(z, s) with s = r², and its two partial derivatives.
#[derive(Clone, Copy)]
struct Polar {
    value: f64,
    by_z: f64,
    by_s: f64,
}

impl Hydrogen {
    /// Quantum numbers, integers as floats, and half the edge of the cube in Bohr radii (0 for 2n² + n, which
    /// holds nearly all of the density).
    ///
    /// # Errors
    /// Cause and remedy where the numbers are no integers or not `l < n <= 10`, `|m| <= l`.
    pub(super) fn new(n: f64, l: f64, m: f64, extent: f64) -> Result<Self, (String, &'static str)> {
        let integers = [n, l, m].iter().all(|number| number.fract() == 0.0);
        if !integers || !(1.0..=10.0).contains(&n) || !(0.0..n).contains(&l) || m.abs() > l {
            return Err((
                format!("n = {n}, l = {l}, m = {m} are no quantum numbers of an orbital"),
                "give integers with 1 <= n <= 10, 0 <= l < n, -l <= m <= l",
            ));
        }
        let extent = if extent > 0.0 {
            extent
        } else {
            2.0 * n * n + n
        };
        let mut field = Self {
            n: n as u32,
            l: l as u32,
            m: m as i32,
            extent,
            scale: 1.0,
        };
        // Beyond r = 4 n² + 8 every orbital only decays (the outer turning point is at 2 n²).
        let radial = |r: f64| (field.radial(r).0 * r.powi(field.l as i32)).abs();
        let polar = |theta: f64| {
            let (sine, cosine) = theta.sin_cos();
            (field.polar(cosine, 1.0).value * sine.powi(field.m.abs())).abs()
        };
        let strongest = maximum(radial, 4.0 * n * n + 8.0) * maximum(polar, std::f64::consts::PI);
        field.scale = 1.0 / strongest;
        Ok(field)
    }

    pub(super) fn value(&self, p: DVec3) -> f64 {
        let p = p * self.extent;
        let (radial, _) = self.radial(p.length());
        let (angular, _) = self.solid_harmonic(p);
        (radial * angular * self.scale).powi(2)
    }

    pub(super) fn gradient(&self, p: DVec3) -> DVec3 {
        let p = p * self.extent;
        let (radial, radial_slope) = self.radial(p.length());
        let (angular, angular_gradient) = self.solid_harmonic(p);
        let outwards = p.normalize_or_zero();
        let wave = radial * angular * self.scale;
        let slope = (radial * angular_gradient + radial_slope * angular * outwards) * self.scale;
        2.0 * wave * slope * self.extent
    }

    /// f(r) and f'(r), r in Bohr radii.
    fn radial(&self, r: f64) -> (f64, f64) {
        let rho = 2.0 * r / f64::from(self.n);
        let degree = self.n - self.l - 1;
        let order = f64::from(2 * self.l + 1);
        let polynomial = laguerre(degree, order, rho);
        // L' of degree k and order a is −L of degree k − 1 and order a + 1.
        let slope = if degree > 0 {
            -laguerre(degree - 1, order + 1.0, rho)
        } else {
            0.0
        };
        let decay = (-rho / 2.0).exp();
        let by_rho = decay * (slope - polynomial / 2.0);
        (decay * polynomial, by_rho * 2.0 / f64::from(self.n))
    }

    /// S(p) = Π(z, r²) Re or Im (x + i y)^|m|, and its gradient.
    fn solid_harmonic(&self, p: DVec3) -> (f64, DVec3) {
        let m = self.m.unsigned_abs();
        // (x + i y)^m and, for its derivative, the power before.
        let (mut before, mut power) = ((0.0, 0.0), (1.0, 0.0));
        for _ in 0..m {
            before = power;
            power = (p.x * power.0 - p.y * power.1, p.x * power.1 + p.y * power.0);
        }
        let order = f64::from(m);
        let (around, by_x, by_y) = if self.m < 0 {
            (power.1, order * before.1, order * before.0)
        } else {
            (power.0, order * before.0, -order * before.1)
        };
        let polar = self.polar(p.z, p.length_squared());
        let gradient = DVec3::new(by_x, by_y, 0.0) * polar.value
            + (p * (2.0 * polar.by_s) + DVec3::Z * polar.by_z) * around;
        (polar.value * around, gradient)
    }

    /// Π_l^m(z, s) = r^(l−m) dᵐP_l/duᵐ (z / r) with s = r², by
    /// (l − m) Π_l = (2l − 1) z Π_(l−1) − (l + m − 1) s Π_(l−2).
    fn polar(&self, z: f64, s: f64) -> Polar {
        let m = self.m.unsigned_abs();
        let first: f64 = (1..=m).map(|k| f64::from(2 * k - 1)).product();
        let mut before = Polar {
            value: 0.0,
            by_z: 0.0,
            by_s: 0.0,
        };
        let mut last = Polar {
            value: first,
            ..before
        };
        for l in m + 1..=self.l {
            let a = f64::from(2 * l - 1) / f64::from(l - m);
            let b = f64::from(l + m - 1) / f64::from(l - m);
            let next = Polar {
                value: a * z * last.value - b * s * before.value,
                by_z: a * (last.value + z * last.by_z) - b * s * before.by_z,
                by_s: a * z * last.by_s - b * (before.value + s * before.by_s),
            };
            (before, last) = (last, next);
        }
        last
    }
}

/// The associated Laguerre polynomial: (k + 1) L_(k+1) = (2k + 1 + a − x) L_k − (k + a) L_(k−1).
fn laguerre(degree: u32, order: f64, x: f64) -> f64 {
    let (mut before, mut last) = (0.0, 1.0);
    for k in 0..degree {
        let k = f64::from(k);
        let next = ((2.0 * k + 1.0 + order - x) * last - (k + order) * before) / (k + 1.0);
        (before, last) = (last, next);
    }
    last
}

/// The maximum of a smooth function over `0..=end`, whose humps are wider than a thousandth of it.
fn maximum(f: impl Fn(f64) -> f64, end: f64) -> f64 {
    const STEPS: u32 = 4000;
    let step = end / f64::from(STEPS);
    let mut best = (f(0.0), 0.0);
    for i in 1..=STEPS {
        let x = f64::from(i) * step;
        let value = f(x);
        if value > best.0 {
            best = (value, x);
        }
    }
    let inverse_golden = (5.0_f64.sqrt() - 1.0) / 2.0;
    let (mut lo, mut hi) = ((best.1 - step).max(0.0), (best.1 + step).min(end));
    for _ in 0..60 {
        let (a, b) = (
            hi - (hi - lo) * inverse_golden,
            lo + (hi - lo) * inverse_golden,
        );
        if f(a) > f(b) {
            hi = b;
        } else {
            lo = a;
        }
    }
    f((lo + hi) / 2.0).max(best.0)
}
