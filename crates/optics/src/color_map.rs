//! Named colour maps, from the `colorgrad` presets, and `gray`.
//!
//! A preset gives sRGB; it is sampled at 257 even places and decoded to linear RGB, and the map is linear in
//! between. So a map is a curve like any other: its knots are known, and tables of it can be exact.

use colorgrad::{Gradient, preset};

use crate::color::linear_from_srgb;

/// Intervals that a sampled map has.
const INTERVALS: u32 = 256;

type Sampler = fn(f32) -> [f32; 4];

macro_rules! presets {
    ($($name:ident),* $(,)?) => {
        &[$((stringify!($name), |t| preset::$name().at(t).to_array())),*]
    };
}

const PRESETS: &[(&str, Sampler)] = presets![
    blues,
    br_bg,
    bu_gn,
    bu_pu,
    cividis,
    cool,
    cubehelix_default,
    gn_bu,
    greens,
    greys,
    inferno,
    magma,
    or_rd,
    oranges,
    pi_yg,
    plasma,
    pr_gn,
    pu_bu,
    pu_bu_gn,
    pu_or,
    pu_rd,
    purples,
    rainbow,
    rd_bu,
    rd_gy,
    rd_pu,
    rd_yl_bu,
    rd_yl_gn,
    reds,
    sinebow,
    spectral,
    turbo,
    viridis,
    warm,
    yl_gn,
    yl_gn_bu,
    yl_or_br,
    yl_or_rd,
];

/// The names that `color: map(name: …)` knows.
pub fn color_map_names() -> impl Iterator<Item = &'static str> {
    std::iter::once("gray").chain(PRESETS.iter().map(|(name, _)| *name))
}

/// Colours of the map at even places from 0 to 1, in linear RGB; `None` where there is no map of that name.
pub(crate) fn sample(name: &str) -> Option<Vec<[f64; 3]>> {
    if name == "gray" {
        return Some(vec![[0.0; 3], [1.0; 3]]);
    }
    let (_, sampler) = PRESETS.iter().find(|(known, _)| *known == name)?;
    let color = |i: u32| {
        let [r, g, b, _] = sampler(i as f32 / INTERVALS as f32);
        [r, g, b].map(|c| linear_from_srgb(f64::from(c).clamp(0.0, 1.0)))
    };
    Some((0..=INTERVALS).map(color).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_gives_colours_in_range() {
        for name in color_map_names() {
            let colors = sample(name).unwrap();
            assert!(colors.len() >= 2, "{name}");
            assert!(
                colors.iter().flatten().all(|c| (0.0..=1.0).contains(c)),
                "{name}"
            );
        }
        assert_eq!(sample("virids"), None);
    }

    #[test]
    fn viridis_starts_dark_violet_and_ends_yellow() {
        let colors = sample("viridis").unwrap();
        let srgb = |code: u32| linear_from_srgb(f64::from(code) / 255.0);
        for (color, code) in [
            (colors[0], [0x44, 0x01, 0x54]),
            (colors[256], [0xfe, 0xe8, 0x25]),
        ] {
            for (c, code) in color.into_iter().zip(code) {
                assert!((c - srgb(code)).abs() < 1e-5, "{c} is not {code:#x}");
            }
        }
    }
}
