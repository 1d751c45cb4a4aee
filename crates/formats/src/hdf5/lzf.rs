//! LZF, the fast packing of h5py. Source: <https://github.com/h5py/h5py/tree/master/lzf>, LibLZF's format.

use hdf5_reader::error::{Error, Result};
use hdf5_reader::messages::filter_pipeline::FilterDescription;

/// Its registered number.
pub(super) const FILTER: u16 = 32000;

/// What `packed` was made of. A byte below 32 says how many plain bytes follow (one more than it says); others say to
/// repeat bytes that are there already. Three bytes become at most 264, so no stream can make much of itself.
pub(super) fn undo(
    _filter: &FilterDescription,
    packed: &[u8],
    _element_size: usize,
) -> Result<Vec<u8>> {
    unpack(packed).ok_or_else(|| Error::DecompressionError("the LZF stream is broken".into()))
}

fn unpack(packed: &[u8]) -> Option<Vec<u8>> {
    let mut out: Vec<u8> = Vec::new();
    let mut rest = packed;
    while let Some((&control, behind)) = rest.split_first() {
        let control = usize::from(control);
        rest = behind;
        if control < 32 {
            let (plain, behind) = rest.split_at_checked(control + 1)?;
            out.extend_from_slice(plain);
            rest = behind;
            continue;
        }
        let mut next = || {
            let (&byte, behind) = rest.split_first()?;
            rest = behind;
            Some(usize::from(byte))
        };
        let mut count = control >> 5;
        if count == 7 {
            count += next()?;
        }
        let back = (control & 0x1f) << 8 | next()?;
        let from = out.len().checked_sub(back + 1)?;
        // What is repeated may reach into what is being written.
        for at in from..from + count + 2 {
            out.push(out[at]);
        }
    }
    Some(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn repeats_may_overlap_and_must_lie_behind() {
        assert_eq!(unpack(&[0, 7, 0xe0, 1, 0]).unwrap(), vec![7; 11]);
        assert_eq!(unpack(&[1, 1, 2, 0x20, 1]).unwrap(), [1, 2, 1, 2, 1]);
        for broken in [&[0x20, 0][..], &[3, 1], &[0, 7, 0xe0], &[0, 7, 0x20, 1]] {
            assert_eq!(unpack(broken), None);
        }
    }
}
