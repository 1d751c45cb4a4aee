//! The field `color`: one colour, a list, or a named map.

use volgraph_report::ron_text::{Fields, Value};
use volgraph_report::{Finding, Findings, Place, did_you_mean};

use super::points::read_pairs;
use super::{is_wide_enough, read_position};
use crate::color::read_color;
use crate::color_map::{self, color_map_names};
use crate::curve::Curve;
use crate::transfer::{ColorSource, MapUse};

/// What `color:` says, before the range is known.
pub(super) enum ColorField {
    Curve(Vec<(f64, [f64; 3])>),
    Map {
        name: String,
        from: Option<f64>,
        to: Option<f64>,
        is_reversed: bool,
        at: Place,
    },
}

pub(super) fn read_color_field(
    findings: &mut Findings,
    value: &Value<'_>,
    bounds: Option<(f64, f64)>,
) -> Option<ColorField> {
    if value.text().starts_with(['(', '"']) {
        return findings
            .take(read_color(value))
            .map(|color| ColorField::Curve(vec![(0.0, color)]));
    }
    if value.text().starts_with('[') {
        return read_pairs(findings, value, bounds, read_color).map(ColorField::Curve);
    }
    let (name, entries) = findings.take_all(value.variant())?;
    if name != "map" {
        findings.push(
            value
                .error("wrong-type", format!("`{name}` is no way to give colours"))
                .help("write map(name: \"viridis\"), a list [(at, colour), …], or one colour"),
        );
        return None;
    }
    let mut fields = Fields::new(entries);
    let read_name = |value: &Value<'_>| {
        let name = value.string()?;
        if color_map_names().any(|known| known == name) {
            return Ok(name);
        }
        Err(value
            .error("unknown-color-map", format!("unknown colour map `{name}`"))
            .help_opt(did_you_mean(&name, color_map_names())))
    };
    let name_value = fields.take("name");
    if name_value.is_none() {
        let message = "the colour map's `name` is missing";
        findings.push(
            value
                .error("missing-field", message)
                .help("write map(name: \"viridis\"), say"),
        );
    }
    let name = name_value.and_then(|value| findings.take(read_name(&value)));
    let from = fields.read(findings, "from", read_position);
    let to = fields.read(findings, "to", read_position);
    let is_reversed = fields
        .read(findings, "reversed", Value::bool)
        .unwrap_or(false);
    fields.finish(findings);
    let at = value.place();
    Some(ColorField::Map {
        name: name?,
        from,
        to,
        is_reversed,
        at,
    })
}

/// The curve that the field stands for, where the tables span `range`.
pub(super) fn lay_out(
    findings: &mut Findings,
    colors: ColorField,
    range: (f64, f64),
) -> Option<ColorSource> {
    let (name, from, to, is_reversed, at) = match colors {
        ColorField::Curve(mut points) => {
            if let [(at, _)] = points.as_mut_slice() {
                // One colour for all scalars has no place of its own, so it is written without one.
                *at = 0.0;
            }
            return Some(ColorSource {
                curve: Curve::new(points),
                map: None,
            });
        }
        ColorField::Map {
            name,
            from,
            to,
            is_reversed,
            at,
        } => (name, from, to, is_reversed, at),
    };
    let (from, to) = (from.unwrap_or(range.0), to.unwrap_or(range.1));
    if !is_wide_enough((from, to)) {
        findings.push(
            Finding::error(
                "bad-range",
                format!("the colour map runs from {from:?} to {to:?}"),
            )
            .at(at)
            .help("give from < to, and `reversed: true` to turn the map round"),
        );
        return None;
    }
    let mut samples = color_map::sample(&name)?;
    if is_reversed {
        samples.reverse();
    }
    let last = samples.len() - 1;
    let position = |i: usize| {
        if i == last {
            to
        } else {
            from + i as f64 / last as f64 * (to - from)
        }
    };
    let points = samples
        .into_iter()
        .enumerate()
        .map(|(i, color)| (position(i), color))
        .collect();
    let map = Some(MapUse {
        name,
        from,
        to,
        is_reversed,
    });
    Some(ColorSource {
        curve: Curve::new(points),
        map,
    })
}
