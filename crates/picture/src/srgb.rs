//! The sRGB transfer curve (IEC 61966-2-1), piecewise and exact, in float64; and its 8-bit codes by table, as exact.

use std::sync::OnceLock;

/// Linear light of an encoded component; 0 to 1 each.
#[must_use]
pub fn linear_from_srgb(encoded: f64) -> f64 {
    if encoded <= 0.04045 {
        encoded / 12.92
    } else {
        ((encoded + 0.055) / 1.055).powf(2.4)
    }
}

/// Encoded component of linear light; 0 to 1 each.
#[must_use]
pub fn srgb_from_linear(linear: f64) -> f64 {
    if linear <= 0.003_130_8 {
        linear * 12.92
    } else {
        1.055 * linear.powf(1.0 / 2.4) - 0.055
    }
}

/// The 8-bit code of linear light from 0 to 1: `round(255 · srgb_from_linear(linear))`, without its power.
#[must_use]
pub(crate) fn code_from_linear(linear: f64) -> u8 {
    static CODES: OnceLock<Codes> = OnceLock::new();
    CODES.get_or_init(Codes::new).of(linear)
}

/// Bins of linear light: so many that few of them hold the start of more than one code.
const BINS: usize = 4096;

/// Where each code starts, and the code at the start of each bin.
struct Codes {
    starts: [f64; 256],
    at_bin: [u8; BINS + 1],
}

impl Codes {
    fn new() -> Self {
        let exact = |linear: f64| (srgb_from_linear(linear) * 255.0).round();
        let mut starts = [0.0; 256];
        for (code, start) in starts.iter_mut().enumerate().skip(1) {
            // The curve is monotonic: halve the interval until its ends are neighbours.
            let (mut below, mut at) = (0.0_f64, 1.0_f64);
            loop {
                let middle = 0.5 * (below + at);
                if middle <= below || middle >= at {
                    break;
                }
                if exact(middle) >= code as f64 {
                    at = middle;
                } else {
                    below = middle;
                }
            }
            *start = at;
        }
        let mut at_bin = [0; BINS + 1];
        for (bin, code) in at_bin.iter_mut().enumerate() {
            *code = exact(bin as f64 / BINS as f64) as u8;
        }
        Self { starts, at_bin }
    }

    fn of(&self, linear: f64) -> u8 {
        let mut code = self.at_bin[(linear * BINS as f64) as usize];
        while code < 255 && self.starts[usize::from(code) + 1] <= linear {
            code += 1;
        }
        code
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_by_table_are_those_of_the_curve() {
        let exact = |linear: f64| (srgb_from_linear(linear) * 255.0).round() as u8;
        for i in 0..=2_000_000 {
            let linear = f64::from(i) / 2_000_000.0;
            assert_eq!(code_from_linear(linear), exact(linear), "{linear}");
        }
        for start in Codes::new().starts {
            for linear in [start.next_down().max(0.0), start, start.next_up().min(1.0)] {
                assert_eq!(code_from_linear(linear), exact(linear), "{linear}");
            }
        }
    }

    #[test]
    fn the_curve_and_its_inverse_meet() {
        for code in 0..=65_535 {
            let encoded = f64::from(code) / 65_535.0;
            let back = srgb_from_linear(linear_from_srgb(encoded));
            // The standard's rounded constants leave a seam of some 1e-8 where the pieces meet.
            assert!((back - encoded).abs() < 1e-7, "{code}");
        }
        assert_eq!((srgb_from_linear(0.0), linear_from_srgb(1.0)), (0.0, 1.0));
        assert!((srgb_from_linear(0.5) - 0.735_356_98).abs() < 1e-7);
        assert!((linear_from_srgb(0.5) - 0.214_041_14).abs() < 1e-7);
    }
}
