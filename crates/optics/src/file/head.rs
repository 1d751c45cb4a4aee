//! The fields that say what positions and opacities mean: `domain` and `reference_length`.

use volgraph_report::ron_text::{Fields, Value};
use volgraph_report::{Findings, did_you_mean};

use super::{MAX_MAGNITUDE, is_wide_enough, read_position};
use crate::transfer::{Domain, ReferenceLength};

/// The domain, and the range where it is stated.
pub(super) type DomainField = (Domain, Option<(f64, f64)>);

pub(super) fn read_domain(value: &Value<'_>) -> Result<DomainField, Findings> {
    let (name, entries) = value.variant()?;
    let mut findings = Findings::new();
    let mut fields = Fields::new(entries);
    let read = match name.as_str() {
        "normalised" => (Domain::Normalised, Some((0.0, 1.0))),
        "range" => (Domain::Range, Some((0.0, 1.0))),
        "data" => {
            let from = fields.read(&mut findings, "from", read_position);
            let to = fields.read(&mut findings, "to", read_position);
            match (from, to) {
                (Some(from), Some(to)) => {
                    if !is_wide_enough((from, to)) {
                        let message = "`from` is not below `to`, or too near to it";
                        findings.push(value.error("bad-range", message).help("give from < to"));
                    }
                }
                (None, None) => {}
                _ => findings.push(
                    value
                        .error("missing-field", "only one of `from` and `to` is given")
                        .help("give both, or neither"),
                ),
            }
            (Domain::Data, from.zip(to))
        }
        _ => {
            return Err(value
                .error("unknown-domain", format!("unknown domain `{name}`"))
                .help_opt(did_you_mean(&name, ["normalised", "range", "data"]))
                .into());
        }
    };
    fields.finish(&mut findings);
    findings.into_result(read)
}

pub(super) fn read_reference_length(value: &Value<'_>) -> Result<ReferenceLength, Findings> {
    const HELP: &str = "write (voxels: 1.0) or (world: 0.5)";
    let fields = value.fields().map_err(|findings| {
        findings
            .into_iter()
            .map(|finding| finding.help(HELP))
            .collect::<Findings>()
    })?;
    let mut findings = Findings::new();
    let mut fields = Fields::new(fields);
    let read = |value: &Value<'_>| {
        let length = value.f64()?;
        if (MAX_MAGNITUDE.recip()..=MAX_MAGNITUDE).contains(&length) {
            Ok(length)
        } else {
            Err(value
                .error(
                    "out-of-range",
                    "a reference length is above 0 (1e-30 to 1e30)",
                )
                .help(HELP))
        }
    };
    let (had_voxels, had_world) = (fields.take("voxels"), fields.take("world"));
    fields.finish(&mut findings);
    let length = match (&had_voxels, &had_world) {
        (Some(voxels), None) => findings.take(read(voxels)).map(ReferenceLength::Voxels),
        (None, Some(world)) => findings.take(read(world)).map(ReferenceLength::World),
        (Some(_), Some(world)) => {
            let message = "`voxels` and `world` are both given";
            findings.push(world.error("exclusive-fields", message).help(HELP));
            None
        }
        (None, None) => {
            findings.push(
                value
                    .error("missing-field", "the length is missing")
                    .help(HELP),
            );
            None
        }
    };
    findings.into_result(length.unwrap_or(ReferenceLength::Voxels(1.0)))
}
