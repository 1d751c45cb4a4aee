//! The voxels of one time step, in slabs of whole chunks.

use std::path::PathBuf;

use half::f16;
use hdf5_reader::{Dataset, SliceInfo, SliceInfoElem};
use rayon::prelude::*;
use volgraph_volume::{Element, ScalarType, Trouble, VolumeError, Voxels, for_scalar_type};

use super::element::{Bits, Stored};
use super::{guarded, told};
use crate::axes::Axes;
use crate::contents::Data;
use crate::load::Limits;
use crate::rescale::Rescale;
use crate::stored::FileRun;

/// Bytes of a slab, about.
const SLAB_BYTES: u64 = 1 << 25;

/// An array whose elements lie together.
pub(super) struct PlainRun {
    pub file: PathBuf,
    pub offset: u64,
}

/// The way to the voxels of an array.
pub(super) struct Source {
    pub dataset: Dataset,
    pub element: Stored,
    pub axes: Axes,
    /// Place of time among the array's axes.
    pub time: Option<usize>,
    pub rescale: Rescale,
    /// Stored values that mean none; they become not-a-number.
    pub missing: Vec<f64>,
    pub run: Option<PlainRun>,
}

impl Data for Source {
    fn read(&self, step: u32, limits: &Limits) -> Result<Voxels, VolumeError> {
        let stored = if self.element.is_half {
            ScalarType::U16
        } else {
            self.element.scalar_type
        };
        let voxels = for_scalar_type!(stored, T => {
            guarded(|| self.read_typed::<T>(step, limits))?
        });
        let voxels = match voxels {
            Voxels::U16(bits) if self.element.is_half => {
                let wide = bits.par_iter().map(|&bits| f16::from_bits(bits).to_f32());
                Voxels::F32(wide.collect())
            }
            other => other,
        };
        Ok(self.marked(voxels))
    }

    fn run(&self, step: u32, _limits: &Limits) -> Result<Option<FileRun>, VolumeError> {
        let (Some((from, count)), true, Some(run)) =
            (self.axes.run_of_step(step), self.axes.is_plain(), &self.run)
        else {
            return Ok(None);
        };
        Ok(Some(FileRun {
            file: run.file.clone(),
            offset: run.offset + from * self.element.size as u64,
            count,
            scalar_type: self.element.scalar_type,
            big_endian: self.element.big_endian,
            rescale: Some(self.rescale),
        }))
    }
}

impl Source {
    fn read_typed<T: Element>(&self, step: u32, limits: &Limits) -> Result<Voxels, VolumeError> {
        let shape = self.dataset.shape();
        let whole: Vec<(u64, u64)> = (0..shape.len())
            .map(|axis| match self.time {
                Some(time) if time == axis => (step.into(), u64::from(step) + 1),
                _ => (0, shape[axis]),
            })
            .collect();
        let count = whole.iter().map(|(from, end)| end - from);
        let count = count.fold(1_u64, u64::saturating_mul);
        let bytes = count.saturating_mul(size_of::<T>() as u64);
        let what = self.axes.describe(self.element.scalar_type);
        let too_large =
            |cause: String, remedy: &str| Err(VolumeError::TooLarge(Trouble::new(cause, remedy)));
        let Ok(len) = usize::try_from(count) else {
            return too_large(format!("{what} are {count} voxels"), "correct the shape");
        };
        if bytes > limits.max_bytes {
            return too_large(
                format!(
                    "{what} are {bytes} bytes for a step, more than the limit of {} bytes",
                    limits.max_bytes
                ),
                "raise the limit (max_bytes) if the shape is right",
            );
        }
        // The slowest axis that is not one step alone.
        let slowest = (0..shape.len()).find(|&axis| self.time != Some(axis));
        let slowest = slowest.unwrap_or(0);
        let chunk = self.dataset.chunks();
        let chunk = chunk.and_then(|chunk| chunk.get(slowest).copied());
        let chunk = u64::from(chunk.unwrap_or(1)).max(1);
        let row_bytes = bytes / (whole[slowest].1 - whole[slowest].0).max(1);
        let rows = (SLAB_BYTES / row_bytes.max(1) / chunk)
            .max(1)
            .saturating_mul(chunk);

        let mut values: Vec<T> = Vec::new();
        let (mut from, end) = whole[slowest];
        while from < end {
            let to = from.saturating_add(rows).min(end);
            let mut slab = whole.clone();
            slab[slowest] = (from, to);
            self.append(&slab, &mut values)?;
            // The first slab was there: the others may be as well.
            if values
                .try_reserve_exact(len.saturating_sub(values.len()))
                .is_err()
            {
                return too_large(format!("memory does not hold {what}"), "free memory");
            }
            from = to;
            limits.report((values.len() * size_of::<T>()) as u64, bytes);
        }
        Ok(T::wrap(values))
    }

    fn append<T: Element>(
        &self,
        slab: &[(u64, u64)],
        values: &mut Vec<T>,
    ) -> Result<(), VolumeError> {
        let ranges = slab.iter().map(|&(start, end)| SliceInfoElem::Slice {
            start,
            end,
            step: 1,
        });
        let selection = SliceInfo {
            selections: ranges.collect(),
        };
        let read = self.dataset.read_slice_parallel::<Bits<T>>(&selection);
        let array = read.map_err(|error| told(&error))?;
        let want: u64 = slab.iter().map(|(from, end)| end - from).product();
        if array.len() as u64 != want {
            return Err(VolumeError::DataTooShort(Trouble::new(
                format!("{} of {want} voxels are there", array.len()),
                "fetch the file again",
            )));
        }
        match array.as_slice() {
            Some(slice) => values.extend(slice.iter().map(|bits| bits.0)),
            None => values.extend(array.iter().map(|bits| bits.0)),
        }
        Ok(())
    }

    /// The rescaled values, with not-a-number where there is none.
    fn marked(&self, voxels: Voxels) -> Voxels {
        if self.missing.is_empty() {
            return self.rescale.apply(voxels);
        }
        let none: Vec<bool> = volgraph_volume::for_voxels!(&voxels, values => {
            values
                .par_iter()
                .map(|value| self.missing.contains(&value.to_f64()))
                .collect()
        });
        let mut voxels = self.rescale.apply(voxels);
        match &mut voxels {
            Voxels::F32(values) => mark(values, &none, f32::NAN),
            Voxels::F64(values) => mark(values, &none, f64::NAN),
            _ => {}
        }
        voxels
    }
}

fn mark<T: Copy + Send + Sync>(values: &mut [T], none: &[bool], nan: T) {
    values
        .par_iter_mut()
        .zip(none)
        .filter(|(_, none)| **none)
        .for_each(|(value, _)| *value = nan);
}
