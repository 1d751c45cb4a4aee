//! Volumes whose slices are decoded each on its own: pictures, pages of TIFF, frames of DICOM.
//!
//! A format says how one slice is decoded ([`Frames`]) and which slices make a time step ([`Slices`]). Slices are
//! decoded in parallel, a few per thread at a time, so that little more than the volume itself is in memory.
//! [`plausible`] holds what a compressed slice promises against the bytes that it is made of: no codec makes more
//! than so many bytes of one, and a forged size is refused before anything is allocated for it.

use bytemuck::Zeroable as _;
use rayon::prelude::*;
use volgraph_volume::{
    Element, ScalarType, Trouble, VolumeError, Voxels, for_scalar_type, for_voxels,
};

use crate::contents::Data;
use crate::load::Limits;

/// How one slice is decoded.
pub(crate) trait Frames: Send + Sync {
    /// Values of a slice, components fastest, then x, then y; their type and number are checked by the caller.
    fn decode(&self, frame: usize) -> Result<Voxels, VolumeError>;
}

/// Slices in the order of the volume.
pub(crate) struct Slices<F> {
    pub frames: F,
    /// The frames of one time step after the other.
    pub order: Vec<usize>,
    /// Frames of a time step.
    pub per_step: usize,
    /// Values of a frame.
    pub values: u64,
    pub scalar_type: ScalarType,
    /// What a time step is, for messages: `512×512×93 int16`.
    pub what: String,
}

impl<F: Frames> Data for Slices<F> {
    fn read(&self, step: u32, limits: &Limits) -> Result<Voxels, VolumeError> {
        let from = step as usize * self.per_step;
        let order = self.order.get(from..from + self.per_step).unwrap_or(&[]);
        let bytes = u128::from(self.values) * order.len() as u128 * self.scalar_type.size() as u128;
        if bytes > u128::from(limits.max_bytes) || usize::try_from(bytes).is_err() {
            return Err(VolumeError::TooLarge(Trouble::new(
                format!(
                    "{} are {bytes} bytes, more than the limit of {} bytes",
                    self.what, limits.max_bytes
                ),
                "give fewer slices, or raise the limit (max_bytes)",
            )));
        }
        for_scalar_type!(self.scalar_type, T => self.read_typed::<T>(order, limits).map(T::wrap))
    }
}

impl<F: Frames> Slices<F> {
    fn read_typed<T: Element>(
        &self,
        order: &[usize],
        limits: &Limits,
    ) -> Result<Vec<T>, VolumeError> {
        let each = self.values as usize;
        let total = each * order.len();
        let mut values: Vec<T> = Vec::new();
        for batch in order.chunks(2 * rayon::current_num_threads()) {
            let decoded: Vec<Voxels> = batch
                .par_iter()
                .map(|&frame| self.frames.decode(frame))
                .collect::<Result<_, _>>()?;
            if values.capacity() == 0 && values.try_reserve_exact(total).is_err() {
                return Err(VolumeError::TooLarge(Trouble::new(
                    format!("memory does not hold {}", self.what),
                    "free memory, or use a smaller volume",
                )));
            }
            for slice in decoded {
                if slice.scalar_type() != T::TYPE || slice.len() != each {
                    return Err(VolumeError::DataCorrupt(Trouble::new(
                        format!(
                            "a slice was decoded to {} values of {}, {each} of {} were promised",
                            slice.len(),
                            slice.scalar_type(),
                            T::TYPE
                        ),
                        "fetch the file again, or save it anew",
                    )));
                }
                for_voxels!(&slice, slice => values.extend_from_slice(bytemuck::cast_slice(slice)));
            }
            let size = size_of::<T>() as u64;
            limits.report(values.len() as u64 * size, total as u64 * size);
        }
        Ok(values)
    }
}

/// Runs a decoder of another crate on bytes that nobody vouches for. The decoders behind this refuse what they can tell
/// is wrong; where one of them stops at an assertion of its own instead, that too is a broken file and no reason to end
/// the program. Nothing of the decoder is used after that.
pub(crate) fn guarded<T>(
    what: &str,
    decode: impl FnOnce() -> Result<T, VolumeError>,
) -> Result<T, VolumeError> {
    std::panic::catch_unwind(std::panic::AssertUnwindSafe(decode)).unwrap_or_else(|_| {
        Err(VolumeError::DataCorrupt(Trouble::new(
            format!("the {what} decoder fails on this file"),
            "fetch the file again, or save it without compression",
        )))
    })
}

/// Bytes as values of a type; `big_endian` says how they lie. A rest that makes no value is left out.
pub(crate) fn values_of(bytes: &[u8], scalar_type: ScalarType, big_endian: bool) -> Voxels {
    for_scalar_type!(scalar_type, T => {
        let count = bytes.len() / size_of::<T>();
        let mut values: Vec<T> = vec![T::zeroed(); count];
        bytemuck::cast_slice_mut(&mut values).copy_from_slice(&bytes[..count * size_of::<T>()]);
        if big_endian != cfg!(target_endian = "big") {
            values.iter_mut().for_each(|value| *value = value.swapped());
        }
        T::wrap(values)
    })
}

/// Most bytes that a codec makes of one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Codec {
    /// The bytes themselves.
    Stored,
    /// Runs of at most 128 bytes in two.
    Runs,
    /// 1032, as the format's makers say.
    Deflate,
    /// A code of at most 12 bits for strings of at most 4096 bytes.
    Lzw,
    /// A bit per block of 64 samples at the least, of two bytes each.
    Jpeg,
    /// Whole blocks of a wavelet may be left out, and so may lines of a fax: small pictures of nothing are small files.
    Sparse,
}

/// Refuses a slice that promises more bytes than its codec can make of those that are there.
pub(crate) fn plausible(codec: Codec, encoded: u64, decoded: u64) -> Result<(), VolumeError> {
    let ratio = match codec {
        Codec::Stored => 1,
        Codec::Runs => 64,
        Codec::Deflate => 1032,
        Codec::Lzw => 2731,
        Codec::Jpeg => 2048,
        Codec::Sparse => 1 << 14,
    };
    // Rounding of the last code.
    let slack = if codec == Codec::Stored { 0 } else { 4096 };
    if decoded > encoded.saturating_mul(ratio).saturating_add(slack) {
        return Err(VolumeError::DataTooShort(Trouble::new(
            format!("{encoded} bytes of a slice cannot hold the {decoded} that it promises"),
            "the file is cut off or its sizes are forged: fetch it again",
        )));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn promises_are_held_against_the_bytes_there_are() {
        assert!(plausible(Codec::Stored, 100, 100).is_ok());
        assert_eq!(
            plausible(Codec::Stored, 100, 101).unwrap_err().code(),
            "volume-data-too-short"
        );
        assert!(plausible(Codec::Deflate, 1000, 1_000_000).is_ok());
        assert!(plausible(Codec::Deflate, 1000, 1_100_000).is_err());
        assert!(plausible(Codec::Sparse, u64::MAX, u64::MAX).is_ok());
    }

    #[test]
    fn bytes_become_values_in_either_order() {
        assert_eq!(
            values_of(&[1, 2, 3], ScalarType::U16, false),
            vec![0x0201_u16].into()
        );
        assert_eq!(
            values_of(&[1, 2, 255, 254], ScalarType::I16, true),
            vec![258_i16, -2].into()
        );
    }
}
