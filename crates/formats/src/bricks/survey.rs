//! What there is in bricks: ranges with their aprons, a histogram, and how far coarser levels are from level 0.
//!
//! A block is some bricks of a level, read once with one more voxel on every side. Of level 0 each sample is compared
//! with what every coarser level shows in its place, trilinear between that level's samples: so the errors are exact,
//! not bounds. What is not finite counts as what is drawn for it.

use std::ops::Range;

use volgraph_volume::{VolumeError, Voxels, for_voxels};

use super::field::Field;
use super::halve::Cell;
use super::levels::{BrickLevel, between, first_in};
use super::side::BINS;

/// All levels, and what is known of their values.
pub(super) struct Survey<'a> {
    pub fields: Vec<&'a Field>,
    pub levels: &'a [BrickLevel],
    pub edge: u32,
    /// Of the finite values.
    pub range: (f64, f64),
    pub mean: f64,
}

/// What a block has.
#[derive(Default)]
pub(super) struct Found {
    /// Number of a brick within its level, and its range.
    pub ranges: Vec<(usize, f64, f64)>,
    pub bins: Vec<u64>,
    /// Sum of the squared differences to the mean.
    pub squares: f64,
    /// Level, number of a brick, sum of squared errors, largest error.
    pub errors: Vec<(usize, usize, f64, f64)>,
}

/// Number of a brick.
pub(super) fn number(bricks: [u32; 3], [x, y, z]: [u32; 3]) -> usize {
    (z as usize * bricks[1] as usize + y as usize) * bricks[0] as usize + x as usize
}

impl Survey<'_> {
    /// What is in some bricks of a level.
    pub fn block(&self, level: usize, bricks: &[Range<u32>; 3]) -> Result<Found, VolumeError> {
        let dims = self.levels[level].grid.dims;
        let core = [0, 1, 2].map(|i| {
            let Range { start, end } = bricks[i];
            start * self.edge..end.saturating_mul(self.edge).min(dims[i])
        });
        let origin = [0, 1, 2].map(|i| core[i].start.saturating_sub(1));
        let size = [0, 1, 2].map(|i| core[i].end.saturating_add(1).min(dims[i]) - origin[i]);
        let voxels = self.fields[level].read(origin, size)?;
        let block = Block {
            survey: self,
            level,
            bricks,
            core,
            origin,
            size,
        };
        for_voxels!(voxels, values => block.look(values))
    }

    fn drawn(&self, value: f64) -> f64 {
        if value.is_finite() {
            value
        } else if value == f64::INFINITY {
            self.range.1
        } else {
            self.range.0
        }
    }
}

/// Bricks whose voxels are there.
struct Block<'a> {
    survey: &'a Survey<'a>,
    level: usize,
    bricks: &'a [Range<u32>; 3],
    /// Voxels of the bricks without their apron.
    core: [Range<u32>; 3],
    origin: [u32; 3],
    size: [u32; 3],
}

impl Block<'_> {
    fn look<T: Cell>(&self, mut values: Vec<T>) -> Result<Found, VolumeError> {
        let mut found = Found::default();
        if self.level == 0 {
            self.count(&values, &mut found);
        }
        if T::TYPE.is_float() {
            for value in &mut values {
                if !value.real().is_finite() {
                    *value = T::nearest(self.survey.drawn(value.real()));
                }
            }
        }
        let all = self.survey.levels[self.level].bricks;
        let edge = self.survey.edge;
        for z in self.bricks[2].clone() {
            for y in self.bricks[1].clone() {
                for x in self.bricks[0].clone() {
                    let brick = [x, y, z];
                    let reach = [0, 1, 2].map(|i| {
                        let low = (brick[i] * edge).saturating_sub(1) - self.origin[i];
                        let high = brick[i]
                            .saturating_add(1)
                            .saturating_mul(edge)
                            .saturating_add(1);
                        low..(high - self.origin[i]).min(self.size[i])
                    });
                    let (min, max) = self.range(&values, &reach);
                    found.ranges.push((number(all, brick), min, max));
                }
            }
        }
        if self.level == 0 {
            for level in 1..self.survey.levels.len() {
                self.compare(&values, level, &mut found)?;
            }
        }
        Ok(found)
    }

    /// A row of the voxels that were read, by indices of the level.
    fn row<'v, T>(&self, values: &'v [T], xs: &Range<u32>, y: u32, z: u32) -> &'v [T] {
        let [nx, ny, _] = self.size.map(|n| n as usize);
        let (y, z) = ((y - self.origin[1]) as usize, (z - self.origin[2]) as usize);
        let at = (z * ny + y) * nx;
        let [from, to] = [xs.start, xs.end].map(|x| (x - self.origin[0]) as usize);
        &values[at + from..at + to]
    }

    fn range<T: Cell>(&self, values: &[T], reach: &[Range<u32>; 3]) -> (f64, f64) {
        let [nx, ny, _] = self.size.map(|n| n as usize);
        let [xs, ys, zs] = reach.clone().map(|r| r.start as usize..r.end as usize);
        let first = values[(zs.start * ny + ys.start) * nx + xs.start];
        let (mut min, mut max) = (first, first);
        for z in zs {
            for y in ys.clone() {
                let at = (z * ny + y) * nx;
                for &value in &values[at + xs.start..at + xs.end] {
                    min = if value < min { value } else { min };
                    max = if value > max { value } else { max };
                }
            }
        }
        (min.real(), max.real())
    }

    fn count<T: Cell>(&self, values: &[T], found: &mut Found) {
        let (lo, hi) = self.survey.range;
        // Halves, because the width of a range of float64 can pass the largest float64.
        let width = hi / 2.0 - lo / 2.0;
        let scale = if width > 0.0 {
            BINS as f64 / width
        } else {
            0.0
        };
        found.bins = vec![0; BINS];
        for z in self.core[2].clone() {
            for y in self.core[1].clone() {
                for value in self.row(values, &self.core[0], y, z) {
                    let value = value.real();
                    if value.is_finite() {
                        let bin = (value / 2.0 - lo / 2.0) * scale;
                        found.bins[(bin as usize).min(BINS - 1)] += 1;
                        found.squares += (value - self.survey.mean).powi(2);
                    }
                }
            }
        }
    }

    /// The errors of a coarser level over the block.
    fn compare<T: Cell>(
        &self,
        values: &[T],
        level: usize,
        found: &mut Found,
    ) -> Result<(), VolumeError> {
        let fine = self.survey.levels[0].grid.dims;
        let coarse = self.survey.levels[level].grid.dims;
        let axes =
            [0, 1, 2].map(|i| Axis::new(&self.core[i], fine[i], coarse[i], self.survey.edge));
        let read = self.survey.fields[level].read(
            axes.each_ref().map(|axis| axis.low),
            axes.each_ref().map(Axis::size),
        )?;
        let shown = self.doubles(&read);
        let [ax, ay, az] = &axes;
        let [nx, ny, nz] = axes.each_ref().map(|axis| axis.size() as usize);
        let mut sums = vec![(0.0_f64, 0.0_f64); ax.runs.len() * ay.runs.len() * az.runs.len()];
        let mut plane = vec![0.0; nx * ny];
        // One more, so that there is always a next one.
        let mut row = vec![0.0; nx + 1];
        let mut errors = vec![0.0; ax.places.len()];
        for (bz, run) in az.runs.iter().enumerate() {
            for z in run.clone() {
                let (k, t) = az.place(z);
                let planes =
                    [k, (k + 1).min(nz - 1)].map(|k| &shown[k * nx * ny..(k + 1) * nx * ny]);
                mix(planes, t, &mut plane);
                for (by, run) in ay.runs.iter().enumerate() {
                    for y in run.clone() {
                        let (j, t) = ay.place(y);
                        let rows = [j, (j + 1).min(ny - 1)].map(|j| &plane[j * nx..(j + 1) * nx]);
                        mix(rows, t, &mut row[..nx]);
                        row[nx] = row[nx - 1];
                        let own = self.row(values, &self.core[0], y, z);
                        for ((error, own), &(i, t)) in errors.iter_mut().zip(own).zip(&ax.places) {
                            let [a, b] = [row[i as usize], row[i as usize + 1]];
                            *error = a + (b - a) * t - own.real();
                        }
                        for (bx, run) in ax.runs.iter().enumerate() {
                            let [from, to] =
                                [run.start, run.end].map(|x| (x - self.core[0].start) as usize);
                            let (sum, most) = reduce(&errors[from..to]);
                            let all = &mut sums[(bz * ay.runs.len() + by) * ax.runs.len() + bx];
                            *all = (all.0 + sum, all.1.max(most));
                        }
                    }
                }
            }
        }
        let bricks = self.survey.levels[level].bricks;
        for (i, (sum, most)) in sums.into_iter().enumerate() {
            let (x, rest) = (i % ax.runs.len(), i / ax.runs.len());
            let (y, z) = (rest % ay.runs.len(), rest / ay.runs.len());
            let at = [
                ax.first + x as u32,
                ay.first + y as u32,
                az.first + z as u32,
            ];
            found.errors.push((level, number(bricks, at), sum, most));
        }
        Ok(())
    }

    fn doubles(&self, voxels: &Voxels) -> Vec<f64> {
        for_voxels!(voxels, values => {
            values.iter().map(|value| self.survey.drawn(value.real())).collect()
        })
    }
}

/// Sum of squares and largest size; in eight lanes, for one sum would wait for itself.
fn reduce(errors: &[f64]) -> (f64, f64) {
    let (mut sums, mut most) = ([0.0_f64; 8], [0.0_f64; 8]);
    let (eights, rest) = errors.as_chunks::<8>();
    for eight in eights {
        for lane in 0..8 {
            let error = eight[lane].abs();
            sums[lane] += error * error;
            most[lane] = if error > most[lane] {
                error
            } else {
                most[lane]
            };
        }
    }
    for error in rest {
        sums[0] += error * error;
        most[0] = most[0].max(error.abs());
    }
    (sums.iter().sum(), most.iter().copied().fold(0.0, f64::max))
}

fn mix([a, b]: [&[f64]; 2], t: f64, out: &mut [f64]) {
    for ((out, a), b) in out.iter_mut().zip(a).zip(b) {
        *out = a + (b - a) * t;
    }
}

/// How fine samples lie in a coarser level along an axis.
struct Axis {
    start: u32,
    /// First coarse sample that is needed.
    low: u32,
    high: u32,
    /// Of each fine sample: the coarse one below it (from `low` on), and how far it is to the next.
    places: Vec<(u32, f64)>,
    /// The first coarse brick, and the fine samples of this and the following ones.
    first: u32,
    runs: Vec<Range<u32>>,
}

impl Axis {
    fn new(core: &Range<u32>, fine: u32, coarse: u32, edge: u32) -> Self {
        let at = |k: u32| between(k, fine, coarse);
        let low = at(core.start).0;
        let high = (at(core.end - 1).0 + 1).min(coarse - 1);
        let places = core.clone().map(|k| (at(k).0 - low, at(k).1)).collect();
        // The coarse cell that a centre lies in.
        let cell = |k: u32| {
            let twice = (2 * u128::from(k) + 1) * u128::from(coarse) / (2 * u128::from(fine));
            u32::try_from(twice).unwrap_or(u32::MAX)
        };
        let (first, last) = (cell(core.start) / edge, cell(core.end - 1) / edge);
        let runs = (first..=last).map(|brick| {
            let end = (brick + 1).saturating_mul(edge).min(coarse);
            let range = first_in(brick * edge, fine, coarse)..first_in(end, fine, coarse);
            range.start.max(core.start)..range.end.min(core.end)
        });
        Self {
            start: core.start,
            low,
            high,
            places,
            first,
            runs: runs.collect(),
        }
    }

    fn size(&self) -> u32 {
        self.high - self.low + 1
    }

    fn place(&self, k: u32) -> (usize, f64) {
        let (i, t) = self.places[(k - self.start) as usize];
        (i as usize, t)
    }
}
