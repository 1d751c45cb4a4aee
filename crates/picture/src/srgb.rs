//! The sRGB transfer curve (IEC 61966-2-1), piecewise and exact, in float64.

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

#[cfg(test)]
mod tests {
    use super::*;

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
