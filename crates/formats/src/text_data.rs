//! Voxels written as text: numbers between blanks or commas, and hexadecimal bytes.

use std::io::{self, BufRead, Read};

use volgraph_volume::Element;

/// Longest number: a float64 written out in full has some 1080 digits.
const LONGEST_NUMBER: usize = 2048;

pub(crate) enum TextError {
    Io(io::Error),
    BadNumber(String),
    TooMany,
}

impl From<io::Error> for TextError {
    fn from(error: io::Error) -> Self {
        Self::Io(error)
    }
}

/// Appends up to `want` numbers to `values`; gives how many there were.
pub(crate) fn read_numbers<T: Element>(
    mut reader: impl BufRead,
    want: usize,
    values: &mut Vec<T>,
) -> Result<usize, TextError> {
    let mut token: Vec<u8> = Vec::new();
    let mut got = 0;
    let mut finish = |token: &mut Vec<u8>| -> Result<(), TextError> {
        if token.is_empty() {
            return Ok(());
        }
        let text = String::from_utf8_lossy(token);
        let number = T::parse(&text);
        let number = number.ok_or_else(|| TextError::BadNumber(text.chars().take(40).collect()))?;
        if got == want {
            return Err(TextError::TooMany);
        }
        values.push(number);
        got += 1;
        token.clear();
        Ok(())
    };
    loop {
        let buffer = reader.fill_buf()?;
        if buffer.is_empty() {
            finish(&mut token)?;
            return Ok(got);
        }
        for &byte in buffer {
            if byte.is_ascii_whitespace() || byte == b',' {
                finish(&mut token)?;
            } else {
                token.push(byte);
                if token.len() > LONGEST_NUMBER {
                    let start = String::from_utf8_lossy(&token[..40]).into_owned();
                    return Err(TextError::BadNumber(start));
                }
            }
        }
        let used = buffer.len();
        reader.consume(used);
    }
}

/// Bytes from pairs of hexadecimal digits.
pub(crate) struct HexReader<R> {
    inner: R,
}

impl<R: BufRead> HexReader<R> {
    pub fn new(inner: R) -> Self {
        Self { inner }
    }

    fn digit(&mut self) -> io::Result<Option<u8>> {
        loop {
            let buffer = self.inner.fill_buf()?;
            let Some(at) = buffer.iter().position(|byte| !byte.is_ascii_whitespace()) else {
                let used = buffer.len();
                self.inner.consume(used);
                if used == 0 {
                    return Ok(None);
                }
                continue;
            };
            let byte = buffer[at];
            self.inner.consume(at + 1);
            let digit = char::from(byte).to_digit(16).ok_or_else(|| {
                let message = format!("{:?} is no hexadecimal digit", char::from(byte));
                io::Error::new(io::ErrorKind::InvalidData, message)
            })?;
            return Ok(Some(digit as u8));
        }
    }
}

impl<R: BufRead> Read for HexReader<R> {
    fn read(&mut self, out: &mut [u8]) -> io::Result<usize> {
        for (done, slot) in out.iter_mut().enumerate() {
            let Some(high) = self.digit()? else {
                return Ok(done);
            };
            let Some(low) = self.digit()? else {
                return Err(io::ErrorKind::UnexpectedEof.into());
            };
            *slot = high << 4 | low;
        }
        Ok(out.len())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_end_at_blanks_commas_and_the_end() {
        let mut values: Vec<i16> = Vec::new();
        let got = read_numbers(&b" 1,-2\r\n3\t4e1"[..], 9, &mut values);
        assert!(matches!(got, Ok(4)));
        assert_eq!(values, [1, -2, 3, 40]);
        assert!(matches!(
            read_numbers(&b"1 2 3"[..], 2, &mut values),
            Err(TextError::TooMany)
        ));
        let long = vec![b'1'; 3000];
        assert!(matches!(
            read_numbers(&long[..], 2, &mut values),
            Err(TextError::BadNumber(_))
        ));
    }

    #[test]
    fn hex_digits_come_in_pairs() {
        let read = |text: &[u8]| {
            let mut out = Vec::new();
            HexReader::new(text).read_to_end(&mut out).map(|_| out)
        };
        assert_eq!(read(b"00 fF\n1 0").unwrap(), [0, 255, 16]);
        assert_eq!(read(b"0").unwrap_err().kind(), io::ErrorKind::UnexpectedEof);
        assert_eq!(read(b"0g").unwrap_err().kind(), io::ErrorKind::InvalidData);
    }
}
