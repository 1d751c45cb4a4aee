//! The same voxels in another type.

use std::sync::atomic::{AtomicU64, Ordering};

use rayon::prelude::*;

use super::{Parts, Watch, like, reserve};
use crate::error::Trouble;
use crate::{
    Element, ScalarType, Values, Volume, VolumeError, Voxels, for_scalar_type, for_voxels,
};

/// Voxels converted by one task.
const BLOCK: usize = 1 << 16;

/// What a conversion did to the values.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Converted {
    /// Values outside the new type's range (or the window), which became its nearest end.
    pub clamped: u64,
    /// Values that lost digits and lie within the range.
    pub rounded: u64,
    /// Values that are no numbers, which became 0 in an integer type.
    pub not_numbers: u64,
}

#[derive(Default)]
struct Counts {
    clamped: AtomicU64,
    rounded: AtomicU64,
    not_numbers: AtomicU64,
}

impl Counts {
    fn add(&self, block: Converted) {
        self.clamped.fetch_add(block.clamped, Ordering::Relaxed);
        self.rounded.fetch_add(block.rounded, Ordering::Relaxed);
        self.not_numbers
            .fetch_add(block.not_numbers, Ordering::Relaxed);
    }

    fn into_inner(self) -> Converted {
        Converted {
            clamped: self.clamped.into_inner(),
            rounded: self.rounded.into_inner(),
            not_numbers: self.not_numbers.into_inner(),
        }
    }
}

/// The voxels in another type, and what that did to them. Integers are rounded to the nearest and clamped to the
/// type's range. With a `window` its low end becomes the smallest value of the type and its high end the largest one
/// (0 and 1 for floats); what lies outside is clamped. Between integers without a window nothing passes through
/// floating point.
///
/// # Errors
/// [`VolumeError::Option`] where the window is not finite or its ends are equal; [`VolumeError::Interrupted`].
pub fn convert(
    volume: &Volume,
    to: ScalarType,
    window: Option<(f64, f64)>,
    watch: &Watch,
) -> Result<(Volume, Converted), VolumeError> {
    if let Some((low, high)) = window
        && !(low.is_finite() && high.is_finite() && (high - low).is_finite() && high != low)
    {
        return Err(VolumeError::Option(Trouble::new(
            format!("the window {low}..{high} cannot be mapped"),
            "give two finite values that differ",
        )));
    }
    let from = volume.voxels();
    let counts = Counts::default();
    let whole = window.is_none() && !to.is_float() && !from.scalar_type().is_float();
    let voxels = for_scalar_type!(to, T => {
        let parts = Parts::new(watch, from.len() * size_of::<T>());
        let mut out: Vec<T> = reserve(from.len())?;
        out.par_chunks_mut(BLOCK).enumerate().try_for_each(|(i, block)| {
            let (at, count) = (i * BLOCK, block.len());
            let mut did = Converted::default();
            if whole {
                let (least, most) = (T::MIN as i128, T::MAX as i128);
                for (out, value) in block.iter_mut().zip(whole_numbers(from, at, count)) {
                    let clamped = value.clamp(least, most);
                    did.clamped += u64::from(clamped != value);
                    *out = clamped as T;
                }
            } else {
                let map = Map::new(to, window);
                for (out, value) in block.iter_mut().zip(numbers(from, at, count)) {
                    // Float to integer saturates, and what is no number becomes 0.
                    let mapped = map.apply(value, &mut did);
                    *out = mapped as T;
                    let lost = (*out).to_f64() != mapped && mapped.is_finite();
                    did.rounded += u64::from(to.is_float() && lost);
                }
            }
            counts.add(did);
            parts.step(size_of_val(block))
        })?;
        Element::wrap(out)
    });
    let mut about = volume.about().clone();
    if window.is_some() {
        about.values = Values::Unknown;
        about.value_unit = None;
    }
    let made = Volume::new(volume.name(), *volume.grid(), voxels)?.with_about(about);
    let made = match volume.colors() {
        Some(colors) => made.with_colors(colors.to_vec())?,
        None => made,
    };
    Ok((like(made, volume), counts.into_inner()))
}

/// What becomes of a value before it is cast.
struct Map {
    /// `None` for floats without a window: they take every value.
    range: Option<(f64, f64)>,
    window: Option<(f64, f64)>,
    round: bool,
}

impl Map {
    fn new(to: ScalarType, window: Option<(f64, f64)>) -> Self {
        Self {
            range: to.range().or(window.map(|_| (0.0, 1.0))),
            window,
            round: !to.is_float(),
        }
    }

    fn apply(&self, value: f64, did: &mut Converted) -> f64 {
        if value.is_nan() {
            did.not_numbers += u64::from(self.round);
            return value;
        }
        let Some((least, most)) = self.range else {
            return value;
        };
        let value = match self.window {
            Some((low, high)) => {
                let part = (value - low) / (high - low);
                if !(0.0..=1.0).contains(&part) {
                    did.clamped += 1;
                    return if part < 0.0 { least } else { most };
                }
                least + part * (most - least)
            }
            None => value,
        };
        let round = if self.round { value.round() } else { value };
        if round < least || round > most {
            did.clamped += 1;
            return round.clamp(least, most);
        }
        did.rounded += u64::from(round != value);
        round
    }
}

fn numbers(voxels: &Voxels, at: usize, count: usize) -> Vec<f64> {
    for_voxels!(voxels, values => values[at..at + count].iter().map(|value| value.to_f64()).collect())
}

fn whole_numbers(voxels: &Voxels, at: usize, count: usize) -> Vec<i128> {
    for_voxels!(voxels, values => values[at..at + count].iter().map(|&value| value as i128).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Grid;
    use glam::DVec3;

    fn volume(voxels: impl Into<Voxels>) -> Volume {
        let voxels = voxels.into();
        let dims = [u32::try_from(voxels.len()).unwrap(), 1, 1];
        Volume::new(
            "v",
            Grid::axis_aligned(dims, DVec3::ONE, DVec3::ZERO),
            voxels,
        )
        .unwrap()
    }

    fn to(
        voxels: impl Into<Voxels>,
        ty: ScalarType,
        window: Option<(f64, f64)>,
    ) -> (Voxels, Converted) {
        let (made, did) = convert(&volume(voxels), ty, window, &Watch::default()).unwrap();
        (made.voxels().clone(), did)
    }

    #[test]
    fn what_does_not_fit_is_clamped_rounded_and_counted() {
        let floats = vec![-1.0_f32, 0.4, 0.6, 255.4, 255.6, f32::NAN, f32::INFINITY];
        let (voxels, did) = to(floats, ScalarType::U8, None);
        assert_eq!(voxels, vec![0_u8, 0, 1, 255, 255, 0, 255].into());
        let want = Converted {
            clamped: 3,
            rounded: 3,
            not_numbers: 1,
        };
        assert_eq!(did, want);
        let (voxels, did) = to(vec![0.1_f64, 0.5], ScalarType::F32, None);
        assert_eq!(voxels, vec![0.1_f32, 0.5].into());
        assert_eq!(did.rounded, 1);
    }

    #[test]
    fn integers_stay_exact_at_64_bits() {
        let (voxels, did) = to(vec![i64::MAX, i64::MAX - 1, -1], ScalarType::U64, None);
        assert_eq!(voxels, vec![i64::MAX as u64, i64::MAX as u64 - 1, 0].into());
        assert_eq!((did.clamped, did.rounded), (1, 0));
        let (voxels, did) = to(vec![u64::MAX, 5], ScalarType::I64, None);
        assert_eq!(voxels, vec![i64::MAX, 5].into());
        assert_eq!(did.clamped, 1);
    }

    #[test]
    fn a_window_fills_the_range_of_the_type() {
        let (voxels, did) = to(
            vec![-1000_i16, -500, 0, 500, 1500],
            ScalarType::U8,
            Some((-500.0, 500.0)),
        );
        assert_eq!(voxels, vec![0_u8, 0, 128, 255, 255].into());
        assert_eq!((did.clamped, did.rounded), (2, 1));
        let (voxels, _) = to(vec![0.0_f64, 0.5, 1.0], ScalarType::I8, Some((0.0, 1.0)));
        assert_eq!(voxels, vec![-128_i8, -1, 127].into());
        let (voxels, _) = to(vec![0_u8, 128, 255], ScalarType::F64, Some((255.0, 0.0)));
        assert_eq!(voxels, vec![1.0, 127.0 / 255.0, 0.0].into());
        for window in [(1.0, 1.0), (f64::NAN, 1.0), (f64::MIN, f64::MAX)] {
            let error = convert(
                &volume(vec![1_u8]),
                ScalarType::U8,
                Some(window),
                &Watch::default(),
            );
            assert_eq!(error.unwrap_err().code(), "volume-option");
        }
    }

    #[test]
    fn every_pair_of_types_keeps_small_numbers() {
        let small = vec![0_u8, 1, 2, 100];
        for first in ScalarType::ALL {
            for second in ScalarType::ALL {
                let (once, _) = to(small.clone(), first, None);
                let (twice, did) = to(once, second, None);
                let (back, _) = to(twice, ScalarType::U8, None);
                assert_eq!(back, small.clone().into(), "{first} {second}");
                assert_eq!(did, Converted::default());
            }
        }
    }
}
