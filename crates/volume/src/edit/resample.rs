//! A volume on a grid of other dimensions over the same box.
//!
//! Each axis of the new grid is a list of taps: which old samples a new one takes, with weights that sum to 1.
//! Between samples the field is linear, as it is drawn; a new sample takes its value there, or, where samples get
//! fewer, its mean over the length that the new sample stands for. So a trilinear field keeps its values inside, and
//! a cell-centred volume its mean. Labels are not mixed: the most frequent one of that length's box is taken.

use glam::{DAffine3, DMat3, DVec3};
use rayon::prelude::*;

use super::{Parts, Watch, like, reserve};
use crate::error::Trouble;
use crate::{Element, Grid, Values, Volume, VolumeError, for_scalar_type, for_voxels};

/// The grid that is wanted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Target {
    /// As many samples along each axis, over the same box.
    Dims([u32; 3]),
    /// These distances between samples, from the same lowest corner of the box on; its far end moves by less than
    /// half a sample.
    Spacing(DVec3),
}

/// What a new sample takes of the old ones.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Filter {
    /// Linear between samples; the mean over a new sample's length where samples get fewer. Samples that are no
    /// numbers make all that touch them none. 64-bit integers are rounded to the digits of float64.
    Linear,
    /// The nearest sample.
    Nearest,
    /// The most frequent value in a new sample's box (the smallest one of several): for labels.
    Mode,
}

impl Filter {
    /// [`Filter::Mode`] for labels, [`Filter::Linear`] for all other values.
    #[must_use]
    pub fn for_values(values: &Values) -> Self {
        match values {
            Values::Labels(_) => Self::Mode,
            _ => Self::Linear,
        }
    }
}

/// The volume with other dimensions. Its type stays; integers are rounded to the nearest.
///
/// # Errors
/// [`VolumeError::Option`] where the target has no samples or too many; [`VolumeError::TooLarge`] where memory does
/// not hold them; [`VolumeError::Interrupted`].
pub fn resample(
    volume: &Volume,
    target: Target,
    filter: Filter,
    watch: &Watch,
) -> Result<Volume, VolumeError> {
    let old = *volume.grid();
    let axes = lines(&old, target)?;
    let dims = axes.map(|line| line.count);
    let count = dims
        .iter()
        .try_fold(1_usize, |product, &n| product.checked_mul(n as usize));
    let count =
        count.ok_or_else(|| wrong(format!("{dims:?} are more samples than memory can have")))?;
    let grid = Grid {
        dims,
        world_from_index: old.world_from_index
            * DAffine3 {
                matrix3: DMat3::from_diagonal(DVec3::from_array(axes.map(|line| line.step))),
                translation: DVec3::from_array(axes.map(|line| line.start)),
            },
        node_centred: old.node_centred,
    };
    let taps = [0, 1, 2].map(|axis| axes[axis].taps(old.dims[axis], filter, old.node_centred));
    let ty = volume.voxels().scalar_type();
    let colors = volume.colors();
    let each = ty.size() + colors.map_or(0, |_| 4);
    let parts = Parts::new(watch, count.saturating_mul(each));
    let job = Job {
        old: old.dims.map(|n| n as usize),
        new: dims.map(|n| n as usize),
        taps: &taps,
        filter,
        parts: &parts,
    };
    let voxels = for_voxels!(volume.voxels(), values => Element::wrap(job.run(values)?));
    let made = Volume::new(volume.name(), grid, voxels)?.with_about(volume.about().clone());
    let made = match colors {
        Some(colors) => {
            let mut mixed: Vec<[u8; 4]> = reserve(count)?;
            for channel in 0..4 {
                let one: Vec<u8> = colors.par_iter().map(|color| color[channel]).collect();
                let one = job.run(&one)?;
                mixed
                    .par_iter_mut()
                    .zip(one)
                    .for_each(|(color, value)| color[channel] = value);
            }
            made.with_colors(mixed)?
        }
        None => made,
    };
    Ok(like(made, volume))
}

fn wrong(cause: String) -> VolumeError {
    VolumeError::Option(Trouble::new(
        cause,
        "ask for at least one sample along each axis and a distance greater than 0",
    ))
}

/// Where the new samples of an axis lie among the indices of the old ones.
#[derive(Clone, Copy, Debug)]
struct Line {
    start: f64,
    step: f64,
    count: u32,
}

fn lines(grid: &Grid, target: Target) -> Result<[Line; 3], VolumeError> {
    let spacing = grid.spacing();
    let mut lines = [Line {
        start: 0.0,
        step: 1.0,
        count: 1,
    }; 3];
    for axis in 0..3 {
        let n = f64::from(grid.dims[axis]);
        // A node-centred axis of one sample has the box of a cell.
        let nodes = grid.node_centred && grid.dims[axis] > 1;
        let (low, length) = if nodes { (0.0, n - 1.0) } else { (-0.5, n) };
        let line = match target {
            Target::Dims(dims) if dims[axis] > 0 => {
                let count = dims[axis];
                let m = f64::from(count);
                if grid.node_centred && count > 1 {
                    Line {
                        start: low,
                        step: length / (m - 1.0),
                        count,
                    }
                } else {
                    let step = length / m;
                    Line {
                        start: low + step / 2.0,
                        step,
                        count,
                    }
                }
            }
            Target::Spacing(wanted) if wanted[axis].is_finite() && wanted[axis] > 0.0 => {
                let step = wanted[axis] / spacing[axis];
                let cells = (length / step).round();
                let count = if nodes { cells + 1.0 } else { cells.max(1.0) };
                if count > f64::from(u32::MAX) {
                    return Err(wrong(format!(
                        "a spacing of {wanted} makes {count} samples"
                    )));
                }
                let start = if nodes { 0.0 } else { low + step / 2.0 };
                Line {
                    start,
                    step,
                    count: count as u32,
                }
            }
            _ => return Err(wrong(format!("{target:?} is no grid"))),
        };
        lines[axis] = line;
    }
    Ok(lines)
}

/// Old samples and their weights.
type Taps = Vec<(usize, f64)>;

impl Line {
    fn taps(&self, old: u32, filter: Filter, node_centred: bool) -> Vec<Taps> {
        let last = f64::from(old) - 1.0;
        let (low, high) = if node_centred {
            (0.0, last)
        } else {
            (-0.5, last + 0.5)
        };
        (0..self.count)
            .map(|i| {
                let at = self.start + f64::from(i) * self.step;
                // The mean is taken over a length around the sample, within the box.
                let half = (self.step / 2.0).min(at - low).min(high - at);
                match filter {
                    Filter::Linear if self.step > 1.0 && half > 0.0 => mean(at, half, old),
                    Filter::Linear => linear(at.clamp(0.0, last)),
                    Filter::Mode if self.step > 1.0 && half > 0.5 => {
                        // Samples whose centres are in the length; half open, so that each is in one.
                        let first = (at - half).ceil().max(0.0);
                        let end = (at + half).ceil().min(last + 1.0).max(first + 1.0);
                        (first as usize..end as usize).map(|i| (i, 1.0)).collect()
                    }
                    _ => vec![((at - 0.5).ceil().clamp(0.0, last) as usize, 1.0)],
                }
            })
            .collect()
    }
}

fn linear(at: f64) -> Taps {
    let (low, t) = (at.floor(), at.fract());
    let mut taps = vec![(low as usize, 1.0 - t)];
    if t > 0.0 {
        taps.push((low as usize + 1, t));
    }
    taps
}

/// The mean over `at ± half` of the field that is linear between samples and constant past the outer ones.
fn mean(at: f64, half: f64, old: u32) -> Taps {
    let (a, b) = (at - half, at + half);
    let last = f64::from(old) - 1.0;
    let first = a.floor().clamp(0.0, last);
    let end = b.ceil().clamp(0.0, last);
    let mut taps = Vec::new();
    let mut i = first;
    while i <= end {
        let mut weight = hat(b - i) - hat(a - i);
        // Past the outer samples the whole weight is theirs: what their own hats miss there.
        if i == 0.0 && a < 0.0 {
            weight += beyond(-a) - beyond(-b);
        }
        if i == last && b > last {
            weight += beyond(b - last) - beyond(a - last);
        }
        if weight > 0.0 {
            taps.push((i as usize, weight / (b - a)));
        }
        i += 1.0;
    }
    taps
}

/// The integral of the hat function from the far left to `t`.
fn hat(t: f64) -> f64 {
    let t = t.clamp(-1.0, 1.0);
    if t < 0.0 {
        (t + 1.0).powi(2) / 2.0
    } else {
        0.5 + t - t * t / 2.0
    }
}

/// The integral of one minus the hat from its centre to `t`; 0 before the centre.
fn beyond(t: f64) -> f64 {
    let t = t.max(0.0);
    t - (hat(t) - 0.5)
}

struct Job<'a> {
    old: [usize; 3],
    new: [usize; 3],
    taps: &'a [Vec<Taps>; 3],
    filter: Filter,
    parts: &'a Parts<'a>,
}

impl Job<'_> {
    fn run<T: Element>(&self, values: &[T]) -> Result<Vec<T>, VolumeError> {
        let [mx, my, mz] = self.new;
        let mut out: Vec<T> = reserve(mx * my * mz)?;
        out.par_chunks_mut(mx * my)
            .enumerate()
            .try_for_each(|(z, slice)| {
                match self.filter {
                    Filter::Linear => self.mix(values, z, slice),
                    Filter::Nearest | Filter::Mode => self.choose(values, z, slice),
                }
                self.parts.step(size_of_val(slice))
            })?;
        Ok(out)
    }

    /// Old slices into one, then its rows, then its columns.
    fn mix<T: Element>(&self, values: &[T], z: usize, slice: &mut [T]) {
        let [nx, ny, _] = self.old;
        let mut plane = vec![0.0_f64; nx * ny];
        for &(k, weight) in &self.taps[2][z] {
            let old = &values[k * nx * ny..(k + 1) * nx * ny];
            plane
                .iter_mut()
                .zip(old)
                .for_each(|(sum, value)| *sum += weight * value.to_f64());
        }
        let mut row = vec![0.0_f64; nx];
        for (taps, out) in self.taps[1].iter().zip(slice.chunks_exact_mut(self.new[0])) {
            row.fill(0.0);
            for &(j, weight) in taps {
                let old = &plane[j * nx..(j + 1) * nx];
                row.iter_mut()
                    .zip(old)
                    .for_each(|(sum, value)| *sum += weight * value);
            }
            for (taps, out) in self.taps[0].iter().zip(out) {
                *out = nearest(taps.iter().map(|&(i, weight)| weight * row[i]).sum());
            }
        }
    }

    fn choose<T: Element>(&self, values: &[T], z: usize, slice: &mut [T]) {
        let [nx, ny, _] = self.old;
        let mut found: Vec<T> = Vec::new();
        for (rows, out) in self.taps[1].iter().zip(slice.chunks_exact_mut(self.new[0])) {
            for (columns, out) in self.taps[0].iter().zip(out) {
                found.clear();
                for &(k, _) in &self.taps[2][z] {
                    for &(j, _) in rows {
                        let row = (k * ny + j) * nx;
                        found.extend(columns.iter().map(|&(i, _)| values[row + i]));
                    }
                }
                *out = most_frequent(&mut found);
            }
        }
    }
}

/// The value that is there most often, the smallest of several.
fn most_frequent<T: Element>(found: &mut [T]) -> T {
    if let [one] = found {
        return *one;
    }
    found.sort_unstable_by(|a, b| a.partial_cmp(b).unwrap_or(std::cmp::Ordering::Equal));
    let mut best = (T::zeroed(), 0);
    for run in found.chunk_by(|a, b| a == b) {
        if run.len() > best.1 {
            best = (run[0], run.len());
        }
    }
    best.0
}

/// Integers are rounded; a sum of weights that passes the range by a hair saturates.
fn nearest<T: Element>(value: f64) -> T {
    for_scalar_type!(T::TYPE, U => {
        let value = if U::TYPE.is_float() { value } else { value.round() };
        // T is U here, which the types cannot say.
        bytemuck::pod_read_unaligned(bytemuck::bytes_of(&(value as U)))
    })
}

#[cfg(test)]
#[path = "resample_tests.rs"]
mod tests;
