//! Pixels against values: those that a case gives, or those of the first of them.

use volgraph_report::{Finding, Findings};

use super::Expectation;
use super::kinds::{Area, Values};
use super::outcome::Measured;
use super::render::Rendered;
use super::run::Run;

impl Run<'_> {
    /// The largest error of an area's pixels against values that are given, or against its first pixel.
    pub(super) fn values(
        &self,
        own: &Rendered,
        area: Area,
        values: &Values,
        max: f64,
        expectation: &Expectation,
    ) -> Result<Measured, Findings> {
        let picture = &own.picture;
        let mut values = *values;
        if values.is_empty() {
            let first = picture.pixel(area.first[0], area.first[1]);
            values.color = first.map(|color| color.map(f64::from));
        }
        let layer = |layer: Option<&Vec<f32>>, name: &str| {
            layer.cloned().ok_or_else(|| {
                let message = format!("the picture has no {name}");
                Finding::error("no-layer", message)
                    .at(expectation.place.clone())
                    .help("the node of the output `color` has to have it: a raycast does")
            })
        };
        let opacity = match values.opacity {
            Some(expected) => Some((expected, layer(picture.opacity.as_ref(), "opacity")?)),
            None => None,
        };
        let depth = match values.depth {
            Some(expected) => Some((expected, layer(picture.depth.as_ref(), "depth")?)),
            None => None,
        };
        let mut worst = (0.0_f64, String::new());
        let mut look = |what: &str, x: u32, y: u32, seen: f32, expected: f64| {
            let error = (f64::from(seen) - expected).abs();
            // What is no number is worse than anything.
            let error = if error.is_nan() { f64::INFINITY } else { error };
            if error > worst.0 || worst.1.is_empty() {
                worst = (error, format!("{what} {seen} for {expected} at ({x}, {y})"));
            }
        };
        for y in area.first[1]..=area.last[1] {
            for x in area.first[0]..=area.last[0] {
                let at = y as usize * picture.width as usize + x as usize;
                if let (Some(expected), Some(color)) = (values.color, picture.pixel(x, y)) {
                    for (at, what) in ["red", "green", "blue", "alpha"].iter().enumerate() {
                        look(what, x, y, color[at], expected[at]);
                    }
                }
                for (what, values) in [("opacity", &opacity), ("depth", &depth)] {
                    if let Some((expected, seen)) = values {
                        let seen = seen.get(at).copied().unwrap_or(f32::NAN);
                        look(what, x, y, seen, *expected);
                    }
                }
            }
        }
        let mut measured = Measured::at_most("max", worst.0, max);
        measured.detail += &format!("; {}", worst.1);
        Ok(measured.with([own.shown()]))
    }
}
