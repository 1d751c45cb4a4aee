//! Base64 text in a file: its letters without the blanks around them.

use std::io::{self, BufRead, Read};

use base64::alphabet::STANDARD;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};

/// Base64 whose padding may be missing where a part of a text is decoded.
pub(super) const BASE64: GeneralPurpose = GeneralPurpose::new(
    &STANDARD,
    GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent),
);

/// Letters of base64, padding with them, that so many bytes take.
pub(super) fn letters(bytes: u64) -> u64 {
    bytes.div_ceil(3).saturating_mul(4)
}

/// The letters of a text, without the blanks and line ends around them.
pub(super) struct Letters<R> {
    pub reader: R,
    /// Letters that are still to come.
    pub left: u64,
}

impl<R: BufRead> Read for Letters<R> {
    fn read(&mut self, out: &mut [u8]) -> io::Result<usize> {
        let mut done = 0;
        while done < out.len() && self.left > 0 {
            let buffer = self.reader.fill_buf()?;
            if buffer.is_empty() {
                break;
            }
            let mut used = 0;
            for &byte in buffer {
                if done == out.len() || self.left == 0 {
                    break;
                }
                used += 1;
                if !byte.is_ascii_whitespace() {
                    out[done] = byte;
                    done += 1;
                    self.left -= 1;
                }
            }
            self.reader.consume(used);
        }
        Ok(done)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn letters_are_counted_without_blanks() {
        let mut text: &[u8] = b"\n  QUJD\n RA== <tail";
        let mut out = Vec::new();
        let letters = Letters {
            reader: &mut text,
            left: letters(4),
        };
        { letters }.read_to_end(&mut out).unwrap();
        assert_eq!((out.as_slice(), text), (&b"QUJDRA=="[..], &b" <tail"[..]));
    }
}
