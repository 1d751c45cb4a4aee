//! Reads what a case expects: the kinds, here, and the [`fields`] that they have.

mod fields;

use volgraph_report::ron_text::{Entry, Fields, Value};
use volgraph_report::{Finding, Findings, Place, did_you_mean};

use super::kinds::{Axis, OrderAgainst, Other, PictureBound};
use super::read::{Reader, missing};
use super::{Expectation, ExpectationKind, beside, one_line};
use fields::{bound, required};

/// Most expectations of a case: each costs pictures.
const MAX_EXPECTATIONS: usize = 64;

/// Most pairs of frames that are timed.
const MAX_FRAMES: u32 = 1000;

const KINDS: [&str; 16] = [
    "finite",
    "seen",
    "pixel",
    "uniform",
    "stages_agree",
    "adapters_agree",
    "mirrored",
    "rolled",
    "stored_alike",
    "halving",
    "order",
    "equals",
    "differs",
    "reference",
    "not_slower",
    "picture",
];

impl Reader<'_> {
    pub(super) fn expectations(
        &self,
        value: &Value<'_>,
        findings: &mut Findings,
    ) -> Vec<Expectation> {
        let items = findings.take(value.items()).unwrap_or_default();
        if items.len() > MAX_EXPECTATIONS {
            let message = format!("more than {MAX_EXPECTATIONS} expectations are refused");
            let place = Place {
                length: 1,
                ..value.place()
            };
            findings.push(
                Finding::error("too-large", message)
                    .at(place)
                    .help("write several cases"),
            );
            return Vec::new();
        }
        items
            .iter()
            .filter_map(|item| findings.take_all(self.expectation(item)))
            .collect()
    }

    fn expectation(&self, value: &Value<'_>) -> Result<Expectation, Findings> {
        let (name, entries) = value.variant()?;
        let mut findings = Findings::new();
        let kind = self.kind(&name, value, entries, &mut findings);
        let expectation = kind.map(|kind| Expectation {
            kind,
            text: one_line(value.text()),
            place: value.place(),
        });
        match expectation {
            Some(expectation) => findings.into_result(expectation),
            None => Err(findings),
        }
    }

    /// `None` only with a finding.
    fn kind(
        &self,
        name: &str,
        value: &Value<'_>,
        entries: Vec<Entry<'_>>,
        findings: &mut Findings,
    ) -> Option<ExpectationKind> {
        let mut fields = Fields::new(entries);
        let kind = self.kind_of(name, value, &mut fields, findings);
        if KINDS.contains(&name) {
            fields.finish(findings);
        }
        kind
    }

    fn kind_of(
        &self,
        name: &str,
        value: &Value<'_>,
        fields: &mut Fields<'_>,
        findings: &mut Findings,
    ) -> Option<ExpectationKind> {
        Some(match name {
            "finite" => ExpectationKind::Finite,
            "seen" => {
                let at_least = fields.read(findings, "at_least", fields::least_share);
                ExpectationKind::Seen {
                    at_least: at_least.unwrap_or(0.01),
                }
            }
            "pixel" => pixel(fields, findings, value)?,
            "uniform" => {
                let within = fields.read(findings, "within", fields::area);
                let values = fields::values(fields, findings);
                let max = bound(fields, findings, "max", value)?;
                ExpectationKind::Uniform {
                    within,
                    values,
                    max,
                }
            }
            "stages_agree" => ExpectationKind::StagesAgree {
                max: bound(fields, findings, "max", value)?,
            },
            "adapters_agree" => ExpectationKind::AdaptersAgree {
                max: bound(fields, findings, "max", value)?,
            },
            "mirrored" => {
                let axis = fields.read(findings, "axis", fields::axis);
                let (max, except) = max_except(fields, findings, value)?;
                ExpectationKind::Mirrored {
                    axis: axis.unwrap_or(Axis::X),
                    max,
                    except,
                }
            }
            "rolled" => {
                let quarters = fields.read(findings, "quarters", |value| match value.u32()? {
                    quarters @ 1..=3 => Ok(quarters),
                    _ => Err(value.error("bad-value", "roll by 1 to 3 quarters")),
                });
                let (max, except) = max_except(fields, findings, value)?;
                ExpectationKind::Rolled {
                    quarters: quarters.unwrap_or(1),
                    max,
                    except,
                }
            }
            "stored_alike" => ExpectationKind::StoredAlike {
                max: bound(fields, findings, "max", value)?,
            },
            "halving" => halving(fields, findings, value)?,
            "order" => order(fields, findings, value)?,
            "equals" => {
                let other = self.other(fields, findings, value, "set");
                ExpectationKind::Equals {
                    other,
                    max: bound(fields, findings, "max", value)?,
                }
            }
            "differs" => {
                let other = self.other(fields, findings, value, "set");
                let rmse = required(fields, findings, "rmse", value, "0.01", fields::least_error);
                ExpectationKind::Differs { other, rmse: rmse? }
            }
            "reference" => {
                let rmse = fields.read(findings, "rmse", fields::positive);
                let max = fields.read(findings, "max", fields::positive);
                if rmse.is_none() && max.is_none() && !findings.has_errors() {
                    findings.push(missing(
                        value,
                        "rmse",
                        "add `rmse: 1e-4`, `max: 1e-3` or both",
                    ));
                }
                ExpectationKind::Reference { rmse, max }
            }
            "not_slower" => {
                let than = self.other(fields, findings, value, "than");
                let ratio = required(fields, findings, "ratio", value, "1.5", fields::positive);
                let frames = fields.read(findings, "frames", |value| match value.u32()? {
                    frames @ 3..=MAX_FRAMES => Ok(frames),
                    _ => Err(value.error(
                        "bad-value",
                        format!("time 3 to {MAX_FRAMES} pairs of frames"),
                    )),
                });
                ExpectationKind::NotSlower {
                    than,
                    ratio: ratio?,
                    frames: frames.unwrap_or(9),
                }
            }
            "picture" => self.picture(fields, findings, value)?,
            _ => {
                findings.push(
                    value
                        .error(
                            "unknown-expectation",
                            format!("nothing is known of `{name}`"),
                        )
                        .help_opt(did_you_mean(name, KINDS)),
                );
                return None;
            }
        })
    }

    /// Another picture; its settings are in the field `sets`.
    fn other(
        &self,
        fields: &mut Fields<'_>,
        findings: &mut Findings,
        value: &Value<'_>,
        sets: &'static str,
    ) -> Other {
        let graph = fields.take("graph");
        let set = fields.take(sets);
        let is_own = |set: &Value<'_>| set.items().is_ok_and(|items| items.is_empty());
        if graph.is_none() && set.as_ref().is_none_or(is_own) {
            let help =
                format!("give `graph: \"other.ron\"`, `{sets}: [\"node.param=value\"]` or both");
            findings.push(missing(value, sets, &help));
        }
        Other {
            graph: graph.and_then(|graph| findings.take(self.graph(&graph))),
            set: set.map(|set| self.sets(&set, findings)).unwrap_or_default(),
        }
    }

    fn picture(
        &self,
        fields: &mut Fields<'_>,
        findings: &mut Findings,
        value: &Value<'_>,
    ) -> Option<ExpectationKind> {
        let file = fields.read(findings, "file", |value| {
            let name = value.string()?;
            if name.ends_with(".png") || name.ends_with(".exr") {
                return Ok(beside(self.file, &name));
            }
            Err(value
                .error("bad-value", "a picture's name ends in .png or .exr")
                .help("write `file: \"refs/name.png\"`"))
        });
        if file.is_none() && !findings.has_errors() {
            findings.push(missing(value, "file", "add `file: \"refs/name.png\"`"));
        }
        let mut bounds = Vec::new();
        let flip = fields.read(findings, "flip", fields::flip);
        bounds.extend(flip.map(PictureBound::Flip));
        let rmse = fields.read(findings, "rmse", fields::positive);
        bounds.extend(rmse.map(PictureBound::Rmse));
        let max = fields.read(findings, "max", fields::positive);
        bounds.extend(max.map(PictureBound::Max));
        if bounds.len() != 1 && !findings.has_errors() {
            findings.push(missing(
                value,
                "flip",
                "give one of `flip: 0.01`, `rmse: 0.005` and `max: 0.02`",
            ));
        }
        let bound = bounds.first().copied()?;
        Some(ExpectationKind::Picture { file: file?, bound })
    }
}

fn pixel(
    fields: &mut Fields<'_>,
    findings: &mut Findings,
    value: &Value<'_>,
) -> Option<ExpectationKind> {
    let at = fields.take("at");
    let at = match &at {
        Some(value) if value.text() != "centre" => findings.take(fields::corner(value)),
        _ => None,
    };
    let values = fields::values(fields, findings);
    if values.is_empty() && !findings.has_errors() {
        findings.push(missing(
            value,
            "color",
            "give `color: (r, g, b, a)`, `opacity: …`, `depth: …` or several of these",
        ));
    }
    let max = bound(fields, findings, "max", value)?;
    Some(ExpectationKind::Pixel { at, values, max })
}

/// `max`, and the share of pixels that it does not hold for.
fn max_except(
    fields: &mut Fields<'_>,
    findings: &mut Findings,
    value: &Value<'_>,
) -> Option<(f64, f64)> {
    let except = fields.read(findings, "except", fields::excepted_share);
    Some((
        bound(fields, findings, "max", value)?,
        except.unwrap_or(0.0),
    ))
}

fn halving(
    fields: &mut Fields<'_>,
    findings: &mut Findings,
    value: &Value<'_>,
) -> Option<ExpectationKind> {
    let param = fields::param(fields, findings, value);
    let from = fields::start(fields, findings);
    let times = fields.read(findings, "times", |value| fields::halvings(value, 1));
    let times = times.unwrap_or(2);
    let rmse = bound(fields, findings, "rmse", value);
    let order = fields.read(findings, "order", |value| {
        match fields::least_order(value)? {
            _ if times < 2 => Err(value
                .error("bad-value", "an order takes two halvings")
                .help("write `times: 2` or more")),
            order => Ok(order),
        }
    });
    Some(ExpectationKind::Halving {
        param: param?,
        from,
        times,
        rmse: rmse?,
        order,
    })
}

fn order(
    fields: &mut Fields<'_>,
    findings: &mut Findings,
    value: &Value<'_>,
) -> Option<ExpectationKind> {
    let param = fields::param(fields, findings, value);
    let from = fields::start(fields, findings);
    let halvings = fields.read(findings, "halvings", |value| fields::halvings(value, 2));
    let against = fields.read(findings, "against", |value| match value.text() {
        "successive" => Ok(OrderAgainst::Successive),
        "reference" => Ok(OrderAgainst::Reference),
        text => Err(value
            .error("bad-value", format!("nothing is known of `{text}`"))
            .help_opt(did_you_mean(text, ["successive", "reference"]))),
    });
    let at_least = required(
        fields,
        findings,
        "at_least",
        value,
        "1.5",
        fields::least_order,
    )?;
    Some(ExpectationKind::Order {
        param: param?,
        from,
        halvings: halvings.unwrap_or(4),
        against: against.unwrap_or(OrderAgainst::Successive),
        at_least,
    })
}
