//! Colours as people write them, turned into linear RGB.

use volgraph_report::Finding;
use volgraph_report::ron_text::Value;

/// Largest linear colour component that a file may ask for: emission above 1 is allowed, f32 overflow is not.
const MAX_COMPONENT: f64 = 1e6;

/// Decodes one sRGB component in 0..=1 to linear light (IEC 61966-2-1).
pub(crate) fn linear_from_srgb(encoded: f64) -> f64 {
    if encoded <= 0.04045 {
        encoded / 12.92
    } else {
        ((encoded + 0.055) / 1.055).powf(2.4)
    }
}

/// Reads `"#rrggbb"` (sRGB) or `(r, g, b)` (linear).
pub(crate) fn read_color(value: &Value<'_>) -> Result<[f64; 3], Finding> {
    let is_text = value.text().starts_with('"');
    if is_text {
        let text = value.string()?;
        return parse_hex(&text).ok_or_else(|| {
            value
                .error("bad-color", format!("`{text}` is not a colour"))
                .help("write \"#rrggbb\" in sRGB, or (r, g, b) in linear light")
        });
    }
    let rgb = value.f64s::<3>().map_err(|finding| {
        finding.help("a colour is \"#rrggbb\" in sRGB or (r, g, b) in linear light")
    })?;
    if rgb.iter().all(|c| (0.0..=MAX_COMPONENT).contains(c)) {
        Ok(rgb)
    } else {
        Err(value
            .error("bad-color", "a colour component is below 0 or above 1e6")
            .help("give linear components of 0 to 1; above 1 is brighter than white"))
    }
}

fn parse_hex(text: &str) -> Option<[f64; 3]> {
    let digits = text.strip_prefix('#')?;
    if digits.len() != 6 || !digits.bytes().all(|b| b.is_ascii_hexdigit()) {
        return None;
    }
    let code = u32::from_str_radix(digits, 16).ok()?;
    Some([16, 8, 0].map(|shift| linear_from_srgb(f64::from((code >> shift) & 0xff) / 255.0)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_srgb_curve_has_its_known_values() {
        assert_eq!(linear_from_srgb(0.0), 0.0);
        assert_eq!(linear_from_srgb(1.0), 1.0);
        // sRGB mid grey 188/255 is very nearly linear one half.
        assert!((linear_from_srgb(188.0 / 255.0) - 0.502_886).abs() < 1e-6);
        assert!((linear_from_srgb(0.04045) - 0.003_130_8).abs() < 1e-7);
    }

    #[test]
    fn only_six_digits_are_a_colour() {
        assert_eq!(parse_hex("#ff0000"), Some([1.0, 0.0, 0.0]));
        for wrong in [
            "ff0000", "#ff000", "#ff00000", "#+f0000", "#ggg000", "#é0000", "",
        ] {
            assert_eq!(parse_hex(wrong), None, "{wrong}");
        }
    }
}
