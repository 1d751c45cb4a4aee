//! The transfer function file: its grammar, its reader and its writer.
//!
//! The way of the data: the text is checked as RON, then each field is read by itself; whatever does not fit
//! becomes a finding and reading goes on, so that one run names everything. Then range and colour map are laid
//! out, which needs all fields. The writer gives the canonical form of the same grammar.
//!
//! # Grammar
//!
//! ```ron
//! (
//!     domain: normalised,              // positions are 0..1 over the stored type's range (the default), or
//!                                      //   data                        in data units, or
//!                                      //   data(from: -1000, to: 3000) in data units, tables span from..to
//!     reference_length: (voxels: 1),   // the length opacity holds for: voxels of the smallest spacing (the
//!                                      //   default, 1), or (world: 0.5) in world units
//!
//!     // Either control points that carry both,
//!     points: [
//!         (at: 0.00, color: (0, 0, 0), opacity: 0),
//!         (at: 0.15, color: "#1a2699", opacity: 0.2),
//!     ],
//!
//!     // or colour and opacity apart:
//!     color: map(name: "viridis", from: 0.2, to: 0.9, reversed: false),
//!     opacity: [(0.0, 0.0), (1.0, 0.8)],
//!
//!     refraction: [(0.0, 1.0), (1.0, 1.5)],   // with either form: the refractive index, 1 where it is left out
//!     // What a scalar makes of light, if it is not the same everywhere:
//!     material: [
//!         (at: 0.2, ambient: 0.3, diffuse: 0.7, specular: 0.0),
//!         (at: 0.8, ambient: 0.1, diffuse: 0.5, specular: 0.9, shininess: 80),
//!     ],
//! )
//! ```
//!
//! - A **colour** is `(r, g, b)` in linear light (0 and more) or `"#rrggbb"` in sRGB. Between control points
//!   it is linear in linear light.
//! - `color:` is one colour, or a list `[(at, colour), …]`, or `map(name, from, to, reversed)` with one of
//!   [`crate::color_map_names`]; `from` and `to` default to the range of the tables, `reversed` to false.
//! - `opacity:` is a list `[(at, opacity), …]` with opacities of 0 to 1, interpolated linearly **in opacity**
//!   and then converted; `extinction:` in its place is a list `[(at, extinction per reference length), …]`
//!   interpolated linearly **in extinction**. In `points`, all points give the same one of the two.
//! - `refraction:` is a list `[(at, refractive index), …]` with indices of 1 to 4, interpolated linearly. Only
//!   techniques that bend rays look at it.
//! - `material:` is a list of control points with any of `ambient`, `diffuse` and `specular` (0 to 1) and
//!   `shininess` (1 to 256). Each of the four is linear between the points that give it; one that no point gives is
//!   left to who draws.
//! - Positions do not decrease. Two points at one position make a step, and the later one holds there. Beyond
//!   the first and last point their values hold. One point alone is a constant.
//! - `domain: normalised`, which is the default, counts positions 0 to 1 over the range of the volume's stored type;
//!   `range` over the values that it has; `data` in its own values.
//! - With `domain: data` the tables span the first to the last position given, those of a map's `from` and
//!   `to` and of the material included; with `data(from, to)` no control point may lie outside. Where something
//!   steps right at their start, they start a little before it.
//! - A list has at most 4096 points, the text at most 256 KiB.
//!
//! # Codes of findings
//! `ron-syntax`, `wrong-type`, `duplicate`, `unknown-field`, `missing-field`, `exclusive-fields`,
//! `unknown-domain`, `unknown-color-map`, `bad-color`, `bad-range`, `empty-range`, `out-of-range`,
//! `decreasing`, `no-points`, `too-large`, and `io` from [`TransferFunction::load`].

use std::path::Path;

use volgraph_report::ron_text::{Document, Fields, Value};
use volgraph_report::{Finding, Findings, Place};

use crate::curve::Curve;
use crate::material::MaterialField;
use crate::transfer::{Absorption, Domain, ReferenceLength, TransferFunction};

mod color_field;
mod head;
mod material;
mod points;
mod write;

use color_field::{ColorField, lay_out, read_color_field};
use head::{read_domain, read_reference_length};
use material::read_material;
use points::{read_extinction, read_index, read_opacity, read_pairs, read_points};
pub(crate) use write::write;

/// Longest text that is read.
pub(crate) const MAX_TEXT_BYTES: usize = 256 << 10;

/// Magnitudes above this would overflow when positions are subtracted or go to the GPU as f32.
const MAX_MAGNITUDE: f64 = 1e30;

pub(crate) fn parse(file: &Path, text: &str) -> Result<TransferFunction, Findings> {
    if text.len() > MAX_TEXT_BYTES {
        return Err(Finding::error(
            "too-large",
            "a transfer function of more than 256 KiB is refused",
        )
        .at(Place::whole_file(file))
        .help("give fewer control points")
        .into());
    }
    let document = Document::parse(file, text)?;
    let whole = Place {
        length: 1,
        ..document.place()
    };
    let mut findings = Findings::new();
    let mut fields = Fields::new(document.fields()?);
    let domain = fields
        .take("domain")
        .map(|value| findings.take_all(read_domain(&value)));
    // A domain that could not be read must not condemn the positions too.
    let (domain, explicit_range) = match domain {
        None => (Domain::Normalised, Some((0.0, 1.0))),
        Some(None) => (Domain::Data, None),
        Some(Some(read)) => read,
    };
    let reference_length = fields
        .take("reference_length")
        .and_then(|value| findings.take_all(read_reference_length(&value)))
        .unwrap_or(ReferenceLength::Voxels(1.0));

    let points = fields.take("points");
    let color = fields.take("color");
    let opacity = fields.take("opacity");
    let extinction = fields.take("extinction");
    let refraction = fields.take("refraction");
    let material = fields.take("material");
    fields.finish(&mut findings);
    let material = match material {
        Some(value) => read_material(&mut findings, &value, explicit_range),
        None => Some(MaterialField::default()),
    };
    let conflict = |value: &Value<'_>, message: &str| {
        value
            .error("exclusive-fields", message)
            .help("give `points`, or `color` with `opacity` or `extinction`")
    };
    let refraction = refraction
        .and_then(|value| read_pairs(&mut findings, &value, explicit_range, read_index))
        .map(Curve::new);
    let (colors, absorption) = if let Some(points) = &points {
        for other in [&color, &opacity, &extinction].into_iter().flatten() {
            findings.push(conflict(other, "`points` already gives colour and opacity"));
        }
        let (colors, absorption) = read_points(&mut findings, points, explicit_range).unzip();
        (colors.map(ColorField::Curve), absorption)
    } else {
        if let (Some(_), Some(extinction)) = (&opacity, &extinction) {
            findings.push(conflict(
                extinction,
                "`opacity` and `extinction` say the same thing twice",
            ));
        }
        if color.is_none() {
            findings.push(missing(
                &whole,
                "color",
                "write `color: map(name: \"viridis\")`, say",
            ));
        }
        if opacity.is_none() && extinction.is_none() {
            findings.push(missing(
                &whole,
                "opacity",
                "write `opacity: [(0.0, 0.0), (1.0, 0.8)]`, say",
            ));
        }
        let colors =
            color.and_then(|value| read_color_field(&mut findings, &value, explicit_range));
        let opacity = opacity
            .and_then(|value| read_pairs(&mut findings, &value, explicit_range, read_opacity));
        let extinction = extinction
            .and_then(|value| read_pairs(&mut findings, &value, explicit_range, read_extinction));
        let absorption = opacity
            .map(|points| Absorption::Opacity(Curve::new(points)))
            .or_else(|| extinction.map(|points| Absorption::Extinction(Curve::new(points))));
        (colors, absorption)
    };
    let (Some(colors), Some(absorption), Some(material)) = (colors, absorption, material) else {
        return Err(findings);
    };
    let range = explicit_range
        .unwrap_or_else(|| spanned(&colors, absorption.curve(), refraction.as_ref(), &material));
    if !is_wide_enough(range) {
        // A range that the file states has been judged where it stands.
        if explicit_range.is_none() && !findings.has_errors() {
            let message = "all positions are one, or too near to each other to be told apart";
            findings.push(
                Finding::error("empty-range", message)
                    .at(whole)
                    .help("write `domain: data(from: …, to: …)`, or give positions further apart"),
            );
        }
        return Err(findings);
    }
    let color = lay_out(&mut findings, colors, range);
    let Some(color) = color else {
        return Err(findings);
    };
    let starts_with_a_step = begins_with_a_step(&color.curve, range.0)
        || begins_with_a_step(absorption.curve(), range.0)
        || refraction
            .as_ref()
            .is_some_and(|curve| begins_with_a_step(curve, range.0))
        || material
            .curves()
            .any(|curve| begins_with_a_step(curve, range.0));
    let range = if starts_with_a_step && domain == Domain::Data {
        (range.0 - STEP_MARGIN * (range.1 - range.0), range.1)
    } else {
        range
    };
    findings.into_result(TransferFunction {
        domain,
        range,
        reference_length,
        color,
        absorption,
        refraction,
        material,
    })
}

/// So much of the range tables start before a step at its very start: their first entry, which stands for all that is
/// below, is then what is before the step. An entry of the smallest table over one scalar.
const STEP_MARGIN: f64 = 1.0 / 1024.0;

fn begins_with_a_step<const N: usize>(curve: &Curve<N>, start: f64) -> bool {
    matches!(curve.points(), [(first, _), (second, _), ..] if *first == start && *second == start)
}

fn missing(whole: &Place, name: &str, help: &str) -> Finding {
    Finding::error("missing-field", format!("`{name}` is missing"))
        .at(whole.clone())
        .help(help)
}

/// First and last position of all that is given.
fn spanned(
    colors: &ColorField,
    absorption: &Curve<1>,
    refraction: Option<&Curve<1>>,
    material: &MaterialField,
) -> (f64, f64) {
    let of_colors: Vec<f64> = match colors {
        // One colour for all scalars has no place of its own.
        ColorField::Curve(points) if points.len() == 1 => Vec::new(),
        ColorField::Curve(points) => points.iter().map(|(at, _)| *at).collect(),
        ColorField::Map { from, to, .. } => from.iter().chain(to).copied().collect(),
    };
    absorption
        .points()
        .iter()
        .chain(refraction.into_iter().flat_map(Curve::points))
        .map(|(at, _)| *at)
        .chain(of_colors)
        .chain(material.points().iter().map(|(at, _)| *at))
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), at| {
            (lo.min(at), hi.max(at))
        })
}

/// A number that a position can be.
fn read_position(value: &Value<'_>) -> Result<f64, Finding> {
    let at = value.f64()?;
    if at.abs() <= MAX_MAGNITUDE {
        Ok(at)
    } else {
        Err(value.error(
            "out-of-range",
            format!("the position {at:?} is beyond ±1e30"),
        ))
    }
}

/// Whether f32 on the GPU can tell the range's two ends, and some hundred values between, apart.
fn is_wide_enough((lo, hi): (f64, f64)) -> bool {
    hi - lo >= (1e-5 * lo.abs().max(hi.abs())).max(MAX_MAGNITUDE.recip())
}
