//! Reads what a case expects.

use volgraph_report::ron_text::{Entry, Fields, Value};
use volgraph_report::{Finding, Findings, Place, did_you_mean};

use super::kinds::{Area, Axis, OrderAgainst, Other, Param, PictureBound, Values};
use super::read::{Reader, missing};
use super::{Expectation, ExpectationKind, beside, one_line};

/// Most expectations of a case: each costs pictures.
const MAX_EXPECTATIONS: usize = 64;

/// Most halvings: steps beyond them are lost in f32.
const MAX_HALVINGS: u32 = 8;

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
                let at_least = fields.read(findings, "at_least", share);
                ExpectationKind::Seen {
                    at_least: at_least.unwrap_or(0.01),
                }
            }
            "pixel" => pixel(fields, findings, value)?,
            "uniform" => {
                let within = fields.read(findings, "within", area);
                let values = values(fields, findings);
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
                let axis = fields.read(findings, "axis", axis);
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
                let rmse = bound(fields, findings, "rmse", value);
                if rmse == Some(0.0) {
                    let finding = value.error("bad-value", "a least error of 0 cannot fail");
                    findings
                        .push(finding.help("give the least error that can be seen, such as 0.01"));
                }
                ExpectationKind::Differs { other, rmse: rmse? }
            }
            "reference" => {
                let rmse = fields.read(findings, "rmse", positive);
                let max = fields.read(findings, "max", positive);
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
                let ratio = bound(fields, findings, "ratio", value);
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
        for (name, make) in [
            ("flip", PictureBound::Flip as fn(f64) -> PictureBound),
            ("rmse", PictureBound::Rmse),
            ("max", PictureBound::Max),
        ] {
            bounds.extend(fields.read(findings, name, positive).map(make));
        }
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
        Some(value) if value.text() != "centre" => findings.take(corner(value)),
        _ => None,
    };
    let values = values(fields, findings);
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

fn values(fields: &mut Fields<'_>, findings: &mut Findings) -> Values {
    Values {
        color: fields.read(findings, "color", Value::f64s::<4>),
        opacity: fields.read(findings, "opacity", Value::f64),
        depth: fields.read(findings, "depth", Value::f64),
    }
}

/// A pixel, `(x, y)`.
fn corner(value: &Value<'_>) -> Result<[u32; 2], Finding> {
    let numbers: Vec<u32> = value
        .items()?
        .iter()
        .map(Value::u32)
        .collect::<Result<_, _>>()?;
    <[u32; 2]>::try_from(numbers).map_err(|_| {
        value
            .error(
                "bad-value",
                "a pixel is a column and a row, from the top left",
            )
            .help("write it as `(x, y)`, or `centre`")
    })
}

/// Two corners, `((x, y), (x, y))`.
fn area(value: &Value<'_>) -> Result<Area, Finding> {
    let corners: Vec<[u32; 2]> = value
        .items()?
        .iter()
        .map(corner)
        .collect::<Result<_, _>>()?;
    match corners.as_slice() {
        &[first, last] if first[0] <= last[0] && first[1] <= last[1] => Ok(Area { first, last }),
        _ => Err(value
            .error(
                "bad-value",
                "an area is its top left and its bottom right pixel",
            )
            .help("write it as `((8, 8), (55, 55))`")),
    }
}

fn axis(value: &Value<'_>) -> Result<Axis, Finding> {
    match value.string()?.as_str() {
        "x" => Ok(Axis::X),
        "y" => Ok(Axis::Y),
        "z" => Ok(Axis::Z),
        _ => Err(value
            .error("bad-value", "a mirror stands across an axis of the world")
            .help("write \"x\", \"y\" or \"z\"")),
    }
}

fn share(value: &Value<'_>) -> Result<f64, Finding> {
    match value.f64()? {
        share if (0.0..=1.0).contains(&share) => Ok(share),
        _ => Err(value.error("bad-value", "a share of the pixels is 0 to 1")),
    }
}

fn positive(value: &Value<'_>) -> Result<f64, Finding> {
    match value.f64()? {
        number if number >= 0.0 => Ok(number),
        _ => Err(value.error("bad-value", "a bound is at least 0")),
    }
}

/// `max`, and the share of pixels that it does not hold for.
fn max_except(
    fields: &mut Fields<'_>,
    findings: &mut Findings,
    value: &Value<'_>,
) -> Option<(f64, f64)> {
    let except = fields.read(findings, "except", share);
    Some((
        bound(fields, findings, "max", value)?,
        except.unwrap_or(0.0),
    ))
}

/// Node and parameter, `"image.step"`.
fn param(fields: &mut Fields<'_>, findings: &mut Findings, value: &Value<'_>) -> Option<Param> {
    let param = fields.read(findings, "param", |value| {
        let text = value.string()?;
        match text.split_once('.') {
            Some((node, name)) if !node.is_empty() && !name.is_empty() => Ok(Param {
                node: node.to_owned(),
                name: name.to_owned(),
                place: value.place(),
            }),
            _ => Err(value.error(
                "bad-value",
                "name a node and its parameter: `\"image.step\"`",
            )),
        }
    });
    if param.is_none() && !findings.has_errors() {
        findings.push(missing(value, "param", "add `param: \"image.step\"`"));
    }
    param
}

fn start(fields: &mut Fields<'_>, findings: &mut Findings) -> Option<f64> {
    fields.read(findings, "from", |value| match value.f64()? {
        from if from > 0.0 => Ok(from),
        _ => Err(value.error("bad-value", "what is halved is above 0")),
    })
}

fn halving(
    fields: &mut Fields<'_>,
    findings: &mut Findings,
    value: &Value<'_>,
) -> Option<ExpectationKind> {
    let param = param(fields, findings, value);
    let from = start(fields, findings);
    let times = fields.read(findings, "times", |value| match value.u32()? {
        times @ 1..=MAX_HALVINGS => Ok(times),
        _ => Err(value.error("bad-value", format!("halve 1 to {MAX_HALVINGS} times"))),
    });
    let times = times.unwrap_or(2);
    let rmse = bound(fields, findings, "rmse", value);
    let order = fields.read(findings, "order", |value| match value.f64()? {
        order if order <= 0.0 => Err(value.error("bad-value", "an order is above 0")),
        _ if times < 2 => Err(value
            .error("bad-value", "an order takes two halvings")
            .help("write `times: 2` or more")),
        order => Ok(order),
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
    let param = param(fields, findings, value);
    let from = start(fields, findings);
    let halvings = fields.read(findings, "halvings", |value| match value.u32()? {
        halvings @ 2..=MAX_HALVINGS => Ok(halvings),
        _ => Err(value.error("bad-value", format!("halve 2 to {MAX_HALVINGS} times"))),
    });
    let against = fields.read(findings, "against", |value| match value.text() {
        "successive" => Ok(OrderAgainst::Successive),
        "reference" => Ok(OrderAgainst::Reference),
        text => Err(value
            .error("bad-value", format!("nothing is known of `{text}`"))
            .help_opt(did_you_mean(text, ["successive", "reference"]))),
    });
    let at_least = bound(fields, findings, "at_least", value)?;
    Some(ExpectationKind::Order {
        param: param?,
        from,
        halvings: halvings.unwrap_or(4),
        against: against.unwrap_or(OrderAgainst::Successive),
        at_least,
    })
}

/// A number of at least 0, which must be there.
fn bound(
    fields: &mut Fields<'_>,
    findings: &mut Findings,
    name: &'static str,
    value: &Value<'_>,
) -> Option<f64> {
    let Some(given) = fields.take(name) else {
        let number = if name == "ratio" || name == "at_least" {
            "1.5"
        } else {
            "1e-4"
        };
        let help = format!("add `{name}: {number}` or another bound");
        findings.push(missing(value, name, &help));
        return None;
    };
    let number = findings.take(given.f64())?;
    if number < 0.0 {
        findings.push(given.error("bad-value", "a bound is at least 0"));
    }
    Some(number)
}
