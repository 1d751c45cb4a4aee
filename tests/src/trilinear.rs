//! The trilinear field of a grid in float64, and where rays cross a level of it: the truth for exact isosurfaces.

use glam::{DVec3, IVec3};

/// Voxel values with x fastest; the world is the index space.
pub struct Trilinear {
    dims: IVec3,
    values: Vec<f64>,
}

impl Trilinear {
    /// A field of the values that a volume of [`crate::Stage::with_floats`] has.
    #[must_use]
    pub fn new(dims: [u32; 3], value: impl Fn(u32, u32, u32) -> f32) -> Self {
        let mut values = Vec::new();
        for z in 0..dims[2] {
            for y in 0..dims[1] {
                values.extend((0..dims[0]).map(|x| f64::from(value(x, y, z))));
            }
        }
        let dims = glam::UVec3::from_array(dims).as_ivec3();
        Self { dims, values }
    }

    fn voxel(&self, index: IVec3) -> f64 {
        let at = index.clamp(IVec3::ZERO, self.dims - 1);
        self.values[((at.z * self.dims.y + at.y) * self.dims.x + at.x) as usize]
    }

    /// The scalar at a place, continued from the cell at `index`.
    fn in_cell(&self, index: IVec3, place: DVec3) -> f64 {
        let part = place - index.as_dvec3();
        let mut sum = 0.0;
        for corner in 0..8 {
            let offset = IVec3::new(corner & 1, corner >> 1 & 1, corner >> 2);
            let weight = |part: f64, side: i32| if side == 1 { part } else { 1.0 - part };
            let weight =
                weight(part.x, offset.x) * weight(part.y, offset.y) * weight(part.z, offset.z);
            sum += weight * self.voxel(index + offset);
        }
        sum
    }

    /// All distances along a ray, in order, at which the field crosses a level between two distances, each with its slope
    /// there. A cubic in each cell, split at its extremes and bisected to the last bit.
    #[must_use]
    pub fn crossings(
        &self,
        (origin, direction): (DVec3, DVec3),
        (near, far): (f64, f64),
        level: f64,
    ) -> Vec<(f64, f64)> {
        let mut faces = vec![near, far];
        for axis in 0..3 {
            faces.extend(
                (-1..=self.dims[axis])
                    .map(|plane| (f64::from(plane) - origin[axis]) / direction[axis]),
            );
        }
        faces.retain(|distance| (near..=far).contains(distance));
        faces.sort_by(f64::total_cmp);
        let mut found = Vec::new();
        for pair in faces.windows(2) {
            let (start, end) = (pair[0], pair[1]);
            let index = (origin + direction * (0.5 * (start + end)))
                .floor()
                .as_ivec3();
            let at = |w: f64| {
                self.in_cell(index, origin + direction * (start + w * (end - start))) - level
            };
            // The cubic through four of its values (Newton's divided differences), in the monomials of w.
            let [a, b, c, d] = [0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0].map(at);
            let cubic = 4.5 * (d - 3.0 * c + 3.0 * b - a);
            let square = 4.5 * (a - 2.0 * b + c) - cubic;
            let linear = d - a - cubic - square;
            let mut knots = vec![0.0, 1.0];
            let root = (square * square - 3.0 * cubic * linear).max(0.0).sqrt();
            knots.extend([-1.0, 1.0].map(|sign| (-square + sign * root) / (3.0 * cubic)));
            knots.push(-linear / (2.0 * square));
            knots.retain(|w| (0.0..=1.0).contains(w));
            knots.sort_by(f64::total_cmp);
            for piece in knots.windows(2) {
                let (mut low, mut high) = (piece[0], piece[1]);
                let is_above = at(low) >= 0.0;
                if (at(high) >= 0.0) == is_above {
                    continue;
                }
                for _ in 0..60 {
                    let middle = 0.5 * (low + high);
                    if (at(middle) >= 0.0) == is_above {
                        low = middle;
                    } else {
                        high = middle;
                    }
                }
                let slope = (3.0 * cubic * low + 2.0 * square) * low + linear;
                found.push((start + low * (end - start), slope / (end - start)));
            }
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use super::Trilinear;
    use glam::DVec3;

    #[test]
    fn crossings_of_a_product_are_its_roots() {
        // x y z along the diagonal is a cubic; so is x (1 - x) twice at one level.
        let ray = (DVec3::ZERO, DVec3::ONE);
        let product = Trilinear::new([2; 3], |x, y, z| (x * y * z) as f32);
        let found = product.crossings(ray, (0.0, 1.0), 0.125);
        assert_eq!(found.len(), 1);
        assert!((found[0].0 - 0.5).abs() < 1e-12 && (found[0].1 - 0.75).abs() < 1e-9);
        let bump = Trilinear::new([2, 2, 1], |x, y, _| if x == y { 0.0 } else { 1.0 });
        let found = bump.crossings((DVec3::ZERO, DVec3::new(1.0, 1.0, 1e-9)), (0.0, 1.0), 0.375);
        let distances: Vec<f64> = found.iter().map(|(distance, _)| *distance).collect();
        assert_eq!(distances.len(), 2);
        assert!((distances[0] - 0.25).abs() < 1e-7 && (distances[1] - 0.75).abs() < 1e-7);
    }
}
