//! C60 as sixty Gaussians.

use glam::DVec3;

/// The sum of sixty Gaussians exp(−|p − aᵢ|² / (2 σ²)) on the corners aᵢ of a truncated icosahedron, divided by
/// its value at an atom, which is the same for all sixty by symmetry.
///
/// The corners are the even permutations of (0, ±1, ±3φ), (±1, ±(2+φ), ±2φ), (±φ, ±2, ±(2φ+1)) with the golden
/// ratio φ, scaled to the radius. The brightest points lie a little beside the atoms, towards their neighbours,
/// and pass 1 by less than 1e-3 for the default radius and σ.
#[derive(Clone, Debug, PartialEq)]
pub struct C60 {
    atoms: Vec<DVec3>,
    sigma: f64,
    scale: f64,
}

impl C60 {
    /// Atoms at distance `radius` from the centre, with standard deviation `sigma`, both positive.
    pub(super) fn new(radius: f64, sigma: f64) -> Self {
        let golden = (1.0 + 5.0_f64.sqrt()) / 2.0;
        let kinds = [
            DVec3::new(0.0, 1.0, 3.0 * golden),
            DVec3::new(1.0, 2.0 + golden, 2.0 * golden),
            DVec3::new(golden, 2.0, 2.0 * golden + 1.0),
        ];
        let mut atoms = Vec::with_capacity(60);
        for corner in kinds {
            for signs in 0..8_u32 {
                let sign = |bit: u32| if signs & bit == 0 { 1.0 } else { -1.0 };
                // Zero has no sign: its mirror image is itself.
                if corner.x == 0.0 && signs & 1 != 0 {
                    continue;
                }
                let DVec3 { x, y, z } = corner * DVec3::new(sign(1), sign(2), sign(4));
                let turned = [
                    DVec3::new(x, y, z),
                    DVec3::new(y, z, x),
                    DVec3::new(z, x, y),
                ];
                atoms.extend(turned.map(|atom| atom.normalize() * radius));
            }
        }
        let mut field = Self {
            atoms,
            sigma,
            scale: 1.0,
        };
        field.scale = 1.0 / field.value(field.atoms[0]);
        field
    }

    /// The sixty atoms, in the cube `[-1, 1]³` for radii up to 1.
    #[must_use]
    pub fn atoms(&self) -> &[DVec3] {
        &self.atoms
    }

    fn density(&self, p: DVec3, atom: DVec3) -> f64 {
        (-p.distance_squared(atom) / (2.0 * self.sigma * self.sigma)).exp() * self.scale
    }

    pub(super) fn value(&self, p: DVec3) -> f64 {
        self.atoms.iter().map(|&atom| self.density(p, atom)).sum()
    }

    pub(super) fn gradient(&self, p: DVec3) -> DVec3 {
        let slope =
            |&atom: &DVec3| (atom - p) * (self.density(p, atom) / (self.sigma * self.sigma));
        self.atoms.iter().map(slope).sum()
    }
}
