//! Values that a file stores with a slope and an intercept (NIfTI, DICOM, NRRD-like headers).

use rayon::prelude::*;
use volgraph_volume::{Element, ScalarType, Voxels, for_voxels};

/// `value * slope + intercept`, as a file says it. A slope of 0 or one that is not finite means none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Rescale {
    slope: f64,
    intercept: f64,
    stored: ScalarType,
    /// The type of what comes out.
    pub scalar_type: ScalarType,
}

impl Rescale {
    /// The type of the result keeps every digit: the stored type where nothing changes; else the smallest signed or
    /// stored integer type that holds all results where slope and intercept are whole numbers; else float32, and
    /// float64 for stored types of 32 bits or more.
    /// `range` is that of the stored values where the file says it (DICOM's stored bits), or the type's own.
    pub fn new(stored: ScalarType, range: Option<(f64, f64)>, slope: f64, intercept: f64) -> Self {
        let (slope, intercept) = if slope == 0.0 || !slope.is_finite() || !intercept.is_finite() {
            (1.0, 0.0)
        } else {
            (slope, intercept)
        };
        let scalar_type = if (slope, intercept) == (1.0, 0.0) {
            stored
        } else {
            whole(stored, range.or(stored.range()), slope, intercept).unwrap_or(match stored {
                _ if stored.size() >= 4 && stored != ScalarType::F32 => ScalarType::F64,
                _ => ScalarType::F32,
            })
        };
        Self {
            slope,
            intercept,
            stored,
            scalar_type,
        }
    }

    /// With results of another type, for slices whose slopes differ.
    pub fn with_type(mut self, scalar_type: ScalarType) -> Self {
        self.scalar_type = scalar_type;
        self
    }

    /// Whether the values stay as they are.
    pub fn is_identity(&self) -> bool {
        (self.slope, self.intercept) == (1.0, 0.0) && self.scalar_type == self.stored
    }

    /// The rescaled values.
    pub fn apply(&self, values: Voxels) -> Voxels {
        debug_assert_eq!(values.scalar_type(), self.stored);
        if self.is_identity() {
            return values;
        }
        for_voxels!(&values, values => match self.scalar_type {
            ScalarType::U8 => self.map(values, |value| value as u8),
            ScalarType::I16 => self.map(values, |value| value as i16),
            ScalarType::U16 => self.map(values, |value| value as u16),
            ScalarType::I32 => self.map(values, |value| value as i32),
            ScalarType::F64 => self.map(values, |value| value),
            _ => self.map(values, |value| value as f32),
        })
    }

    fn map<T: Element, U: Element>(&self, values: &[T], to: impl Fn(f64) -> U + Sync) -> Voxels {
        let mapped = values
            .par_iter()
            .map(|value| to(value.to_f64() * self.slope + self.intercept));
        U::wrap(mapped.collect())
    }
}

/// An integer type for whole slopes and intercepts of stored integers of up to 16 bits.
fn whole(
    stored: ScalarType,
    range: Option<(f64, f64)>,
    slope: f64,
    intercept: f64,
) -> Option<ScalarType> {
    let (low, high) = range.filter(|_| stored.size() <= 2 && !stored.is_float())?;
    if slope.fract() != 0.0 || intercept.fract() != 0.0 {
        return None;
    }
    let ends = [low * slope + intercept, high * slope + intercept];
    let (low, high) = (ends[0].min(ends[1]), ends[0].max(ends[1]));
    [stored, ScalarType::I16, ScalarType::U16, ScalarType::I32]
        .into_iter()
        .filter(|ty| *ty != ScalarType::I8)
        .find(|ty| {
            ty.range()
                .is_some_and(|(least, most)| low >= least && high <= most)
        })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_result_has_the_smallest_type_that_loses_nothing() {
        use ScalarType::*;
        for (stored, slope, intercept, want) in [
            (U16, 1.0, 0.0, U16),
            (U8, 1.0, -1024.0, I16),
            (U16, 1.0, -1024.0, I32),
            (I16, 1.0, -1024.0, I32),
            (I8, 2.0, 0.0, I16),
            (U8, 0.5, 0.0, F32),
            (I16, 1e9, 0.0, F32),
            (I32, 2.0, 0.0, F64),
            (F32, 2.0, 1.0, F32),
            (F64, 2.0, 1.0, F64),
            (U8, 0.0, 5.0, U8),
            (U8, f64::NAN, 5.0, U8),
        ] {
            let rescale = Rescale::new(stored, None, slope, intercept);
            assert_eq!(rescale.scalar_type, want, "{stored} {slope} {intercept}");
        }
    }

    #[test]
    fn values_are_rescaled_without_wrapping() {
        let rescale = Rescale::new(ScalarType::U16, None, 1.0, -1024.0);
        assert_eq!(
            rescale.apply(vec![0_u16, 65535].into()),
            vec![-1024_i32, 64511].into()
        );
        let twelve_bits = Rescale::new(ScalarType::I16, Some((0.0, 4095.0)), 1.0, -1024.0);
        assert_eq!(twelve_bits.scalar_type, ScalarType::I16);
        let half = Rescale::new(ScalarType::U8, None, 0.5, 0.25);
        assert_eq!(half.apply(vec![3_u8].into()), vec![1.75_f32].into());
        let same = Rescale::new(ScalarType::U8, None, 0.0, 5.0);
        assert_eq!(same.apply(vec![3_u8].into()), vec![3_u8].into());
    }
}
