//! What a volume is made of: the stretches of one label along a ray.
//!
//! Labels meet at the faces of their voxels, or where their trilinear memberships are equal: inside of a cell of the
//! labels a membership is a cubic along the ray, and the label that has most changes only where two of them are equal.

use glam::DVec3;

use crate::clip::towards_eye;
use crate::curve::{QUARTERS, corner, trilinear};
use crate::field::{Field, between_slabs};
use crate::polynomial::Polynomial;
use crate::rays::Ray;

/// Labels there are.
pub const LABELS: usize = 256;

/// A volume of labels.
#[derive(Clone, Debug)]
pub struct Labels {
    /// The label of each voxel, as a number, where it lies.
    pub field: Field,
    /// The box in its index coordinates outside of which is label 0.
    pub low: DVec3,
    /// The box's other corner.
    pub high: DVec3,
    /// Whether labels meet at the faces of voxels.
    pub is_blocky: bool,
    /// Of each label, which of the scene's looks it has.
    pub looks: Vec<usize>,
    /// Of each label, whether it is drawn.
    pub is_visible: Vec<bool>,
}

/// A stretch of one label.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretch {
    /// World distance from the ray's origin where it ends.
    pub far: f64,
    /// The label.
    pub label: usize,
    /// Unit world normal, towards the eye, of the boundary at its end; zeros where nothing ends.
    pub normal: DVec3,
}

impl Labels {
    /// The look of a label.
    #[must_use]
    pub fn look(&self, label: usize) -> usize {
        self.looks.get(label).copied().unwrap_or(0)
    }

    /// The stretches of a ray between two distances, in order.
    #[must_use]
    pub fn stretches(&self, ray: &Ray, (near, far): (f64, f64)) -> Vec<Stretch> {
        let mut found: Vec<Stretch> = Vec::new();
        // Label 0 outside of the box, which is walked through as a stretch of its own.
        let (first, last) = self.inside(ray).map_or((far, far), |(first, last)| {
            let first = first.clamp(near, far);
            (first, last.clamp(first, far))
        });
        let mut add = |far: f64, label: usize, normal: &dyn Fn(f64, usize) -> DVec3| {
            if let Some(before) = found.last_mut() {
                if before.label == label {
                    before.far = far;
                    return;
                }
                before.normal = normal(before.far, before.label);
            }
            found.push(Stretch {
                far,
                label,
                normal: DVec3::ZERO,
            });
        };
        if first > near {
            add(first, 0, &|_, _| DVec3::ZERO);
        }
        let face = |at: f64, _: usize| self.face_normal(ray, at);
        let mut is_entry = true;
        self.field
            .stretches(ray, (first, last), self.is_blocky, |start, end| {
                if self.is_blocky {
                    let middle = self.index(ray, 0.5 * (start + end));
                    let label = self.label_at((middle + 0.5).floor());
                    add(end, label, &face);
                } else {
                    self.smooth(ray, (start, end), |end, label| {
                        let rival = |at: f64, before: usize| {
                            if is_entry {
                                self.face_normal(ray, at)
                            } else {
                                self.boundary_normal(ray, at, before, label)
                            }
                        };
                        add(end, label, &rival);
                        is_entry = false;
                    });
                }
                false
            });
        if far > last {
            add(far, 0, &face);
        }
        found
    }

    fn index(&self, ray: &Ray, distance: f64) -> DVec3 {
        self.field
            .index_from_world()
            .transform_point3(ray.at(distance))
    }

    fn label_at(&self, index: DVec3) -> usize {
        let value = self.field.sample_clamped(index.as_ivec3());
        value.clamp(0.0, (LABELS - 1) as f64) as usize
    }

    /// Distances between which a ray is in the box.
    fn inside(&self, ray: &Ray) -> Option<(f64, f64)> {
        let origin = self.index(ray, 0.0);
        let slope = self
            .field
            .index_from_world()
            .transform_vector3(ray.direction);
        between_slabs((origin, slope), (self.low, self.high))
    }

    /// Calls `visit` with the end and the label of each part of a cell in which one label has most.
    fn smooth(&self, ray: &Ray, (start, end): (f64, f64), mut visit: impl FnMut(f64, usize)) {
        let line = self.field.line(ray, start, end);
        let cell = line.cell();
        let corners: [usize; 8] =
            std::array::from_fn(|i| self.label_at(cell + corner(i).as_dvec3()));
        let mut present = corners.to_vec();
        present.sort_unstable();
        present.dedup();
        if let [label] = present[..] {
            return visit(end, label);
        }
        let memberships: Vec<Polynomial> = present
            .iter()
            .map(|label| {
                let shares = corners.map(|other| if other == *label { 1.0 } else { 0.0 });
                Polynomial::through(QUARTERS.map(|w| trilinear(&shares, line.at(w) - cell)))
            })
            .collect();
        let mut cuts = vec![1.0];
        for (at, one) in memberships.iter().enumerate() {
            for other in &memberships[at + 1..] {
                let lead = one.plus(&other.times(-1.0));
                cuts.extend_from_slice(lead.sign_changes().as_slice());
            }
        }
        cuts.sort_by(f64::total_cmp);
        let mut low = 0.0;
        for high in cuts {
            if high > low {
                let middle = 0.5 * (low + high);
                let most = memberships.iter().map(|share| share.at(middle));
                let mut best = (f64::NEG_INFINITY, 0);
                for (share, label) in most.zip(&present) {
                    // Of two with as much the lower one, but for rounding.
                    if share > best.0 + 1e-12 {
                        best = (share, *label);
                    }
                }
                visit(start + high * (end - start), best.1);
            }
            low = high;
        }
    }

    /// How much of a place is one label's less another's.
    fn lead(&self, index: DVec3, label: usize, rival: usize) -> f64 {
        let last = DVec3::from_array(self.field.dims().map(|n| n as f64 - 1.0));
        let index = index.clamp(DVec3::ZERO, last);
        let cell = index.floor();
        let shares = std::array::from_fn(|i| {
            let there = self.label_at(cell + corner(i).as_dvec3());
            f64::from(u8::from(there == label)) - f64::from(u8::from(there == rival))
        });
        trilinear(&shares, index - cell)
    }

    /// Of the boundary of two labels: the gradient of how much one leads, over half a voxel to each side.
    fn boundary_normal(&self, ray: &Ray, distance: f64, label: usize, rival: usize) -> DVec3 {
        let at = self.index(ray, distance);
        let across = |aside: DVec3| {
            self.lead(at + 0.5 * aside, label, rival) - self.lead(at - 0.5 * aside, label, rival)
        };
        let per_index = DVec3::new(across(DVec3::X), across(DVec3::Y), across(DVec3::Z));
        self.facing(per_index, ray)
    }

    /// Of the face of a voxel, or of the box, that a ray passes at a distance.
    fn face_normal(&self, ray: &Ray, distance: f64) -> DVec3 {
        let at = self.index(ray, distance);
        // How far the place is from a face on each axis; faces lie half-way between samples, or at the box.
        let off = |axis: usize| {
            let of_voxel = ((at[axis] + 0.5) - (at[axis] + 0.5).round()).abs();
            let of_box = (at[axis] - self.low[axis])
                .abs()
                .min((at[axis] - self.high[axis]).abs());
            if self.is_blocky {
                of_voxel.min(of_box)
            } else {
                of_box
            }
        };
        let nearest = [0, 1, 2].map(off);
        let least = nearest.into_iter().fold(f64::INFINITY, f64::min);
        let slope = self
            .field
            .index_from_world()
            .transform_vector3(ray.direction);
        let normal = DVec3::from_array([0, 1, 2].map(|axis: usize| {
            if nearest[axis] <= least + 1e-9 {
                -slope[axis].signum()
            } else {
                0.0
            }
        }));
        self.facing(normal, ray)
    }

    fn facing(&self, per_index: DVec3, ray: &Ray) -> DVec3 {
        let normal = towards_eye(self.field.world_from_index_gradient() * per_index, ray);
        if normal == DVec3::ZERO {
            -ray.direction
        } else {
            normal
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::DAffine3;
    use volgraph_volume::{Grid, Volume, Voxels};

    use super::*;

    fn labels(is_blocky: bool) -> Labels {
        let dims = [6, 5, 4];
        let grid = Grid::axis_aligned(dims, DVec3::ONE, DVec3::ZERO);
        let voxels = (0..120_u32).map(|i| (i.wrapping_mul(2_654_435_761) >> 29) as u8 % 3);
        let volume = Volume::new("labels", grid, Voxels::U8(voxels.collect())).unwrap();
        let (low, high) = grid.box_index();
        Labels {
            field: Field::new(&volume).placed(DAffine3::IDENTITY),
            low,
            high,
            is_blocky,
            looks: vec![0; LABELS],
            is_visible: vec![true; LABELS],
        }
    }

    /// The label that has most at a place, by looking; `None` where two have nearly as much.
    fn looked_up(labels: &Labels, at: DVec3) -> Option<usize> {
        if labels.is_blocky {
            let near_face = ((at + 0.5) - (at + 0.5).round()).abs().min_element() < 1e-4;
            return (!near_face).then(|| labels.label_at((at + 0.5).floor()));
        }
        let mut leads: Vec<_> = (0..3)
            .map(|label| (labels.lead(at, label, 99), label))
            .collect();
        leads.sort_by(|a, b| b.0.total_cmp(&a.0));
        (leads[0].0 > leads[1].0 + 1e-3).then_some(leads[0].1)
    }

    #[test]
    fn stretches_are_what_one_finds_by_looking() {
        for is_blocky in [false, true] {
            let labels = labels(is_blocky);
            let (mut looked, mut changes) = (0, 0);
            for turn in 0..40 {
                let angle = f64::from(turn) * 0.37;
                let direction =
                    DVec3::new(angle.cos(), angle.sin(), 0.3 * (2.0 * angle).sin()).normalize();
                let ray = Ray {
                    origin: DVec3::new(2.4, 2.1, 1.6) - 5.0 * direction,
                    direction,
                };
                let stretches = labels.stretches(&ray, (0.0, 10.0));
                assert_eq!(stretches.last().unwrap().far, 10.0);
                assert!(stretches.windows(2).all(|pair| pair[0].far < pair[1].far
                    && pair[0].label != pair[1].label
                    && (pair[0].normal.length() - 1.0).abs() < 1e-9
                    && pair[0].normal.dot(direction) <= 1e-9));
                changes += stretches.len() - 1;
                for step in 0..2000 {
                    let distance = 0.005 * f64::from(step);
                    let at = ray.at(distance);
                    let is_out = at.cmplt(labels.low).any() || at.cmpgt(labels.high).any();
                    let face = (at - labels.low).abs().min((at - labels.high).abs());
                    if face.min_element() < 1e-6 {
                        continue;
                    }
                    let expected = if is_out {
                        Some(0)
                    } else {
                        looked_up(&labels, at)
                    };
                    let found = stretches.iter().find(|one| distance < one.far).unwrap();
                    if let Some(expected) = expected {
                        looked += 1;
                        assert_eq!(found.label, expected, "{is_blocky} {turn} {distance}");
                    }
                }
            }
            assert!(looked > 60_000 && changes > 150, "{looked} {changes}");
        }
    }
}
