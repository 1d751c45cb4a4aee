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

    /// The field along a ray between two distances: a cubic in each cell that the ray runs through.
    #[must_use]
    pub fn cubics(
        &self,
        (origin, direction): (DVec3, DVec3),
        (near, far): (f64, f64),
    ) -> Vec<Cubic> {
        let mut faces = vec![near, far];
        for axis in 0..3 {
            faces.extend(
                (-1..=self.dims[axis])
                    .map(|plane| (f64::from(plane) - origin[axis]) / direction[axis]),
            );
        }
        faces.retain(|distance| (near..=far).contains(distance));
        faces.sort_by(f64::total_cmp);
        let cubic = |pair: &[f64]| {
            let (start, end) = (pair[0], pair[1]);
            let index = (origin + direction * (0.5 * (start + end)))
                .floor()
                .as_ivec3();
            // Through four of its values (Newton's divided differences).
            let [a, b, c, d] = [0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0]
                .map(|w| self.in_cell(index, origin + direction * (start + w * (end - start))));
            let cubic = 4.5 * (d - 3.0 * c + 3.0 * b - a);
            let square = 4.5 * (a - 2.0 * b + c) - cubic;
            Cubic {
                start,
                end,
                terms: [a, d - a - cubic - square, square, cubic],
            }
        };
        faces.windows(2).map(cubic).collect()
    }

    /// All distances along a ray, in order, at which the field crosses a level between two distances, each with its slope
    /// there: the cubics split at their extremes and bisected to the last bit.
    #[must_use]
    pub fn crossings(&self, ray: (DVec3, DVec3), range: (f64, f64), level: f64) -> Vec<(f64, f64)> {
        let mut found = Vec::new();
        for cubic in self.cubics(ray, range) {
            for piece in cubic.knots().windows(2) {
                let (mut low, mut high) = (piece[0], piece[1]);
                let is_above = cubic.at(low) >= level;
                if (cubic.at(high) >= level) == is_above {
                    continue;
                }
                for _ in 0..60 {
                    let middle = 0.5 * (low + high);
                    if (cubic.at(middle) >= level) == is_above {
                        low = middle;
                    } else {
                        high = middle;
                    }
                }
                let length = cubic.end - cubic.start;
                found.push((cubic.start + low * length, cubic.slope(low) / length));
            }
        }
        found
    }

    /// The largest scalar along a ray between two distances, and the distance of it.
    #[must_use]
    pub fn largest(&self, ray: (DVec3, DVec3), range: (f64, f64)) -> (f64, f64) {
        let cubics = self.cubics(ray, range);
        let places = cubics.iter().flat_map(|cubic| {
            let length = cubic.end - cubic.start;
            let knots = cubic.knots().into_iter();
            knots.map(move |w| (cubic.at(w), cubic.start + w * length))
        });
        places.fold((f64::NEG_INFINITY, 0.0), |best, place| {
            if place.0 > best.0 { place } else { best }
        })
    }

    /// The integral of the field along a ray between two distances.
    #[must_use]
    pub fn integral(&self, ray: (DVec3, DVec3), range: (f64, f64)) -> f64 {
        let cubics = self.cubics(ray, range);
        cubics
            .iter()
            .map(|Cubic { start, end, terms }| {
                let [a, b, c, d] = terms;
                (a + b / 2.0 + c / 3.0 + d / 4.0) * (end - start)
            })
            .sum()
    }
}

/// The field along a part of a ray: a cubic of `w`, 0 at its start and 1 at its end.
pub struct Cubic {
    start: f64,
    end: f64,
    terms: [f64; 4],
}

impl Cubic {
    fn at(&self, w: f64) -> f64 {
        let [a, b, c, d] = self.terms;
        a + w * (b + w * (c + w * d))
    }

    fn slope(&self, w: f64) -> f64 {
        let [_, b, c, d] = self.terms;
        b + w * (2.0 * c + w * 3.0 * d)
    }

    /// Its ends, and its extremes between them.
    fn knots(&self) -> Vec<f64> {
        let [_, b, c, d] = self.terms;
        let mut knots = vec![0.0, 1.0];
        let root = (c * c - 3.0 * d * b).max(0.0).sqrt();
        knots.extend([-1.0, 1.0].map(|sign| (-c + sign * root) / (3.0 * d)));
        knots.push(-b / (2.0 * c));
        knots.retain(|w| (0.0..=1.0).contains(w));
        knots.sort_by(f64::total_cmp);
        knots
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
        // 2 x (1 - x) has its largest value 1/2 in the middle, and an integral of 1/3 along the diagonal.
        let ray = (DVec3::ZERO, DVec3::new(1.0, 1.0, 1e-9));
        let (largest, place) = bump.largest(ray, (0.0, 1.0));
        assert!((largest - 0.5).abs() < 1e-9 && (place - 0.5).abs() < 1e-6);
        assert!((bump.integral(ray, (0.0, 1.0)) - 1.0 / 3.0).abs() < 1e-9);
    }
}
