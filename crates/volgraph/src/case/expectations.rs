//! Reads what a case expects.

use volgraph_report::ron_text::{Entry, Fields, Value};
use volgraph_report::{Finding, Findings, Place, did_you_mean};

use super::read::{Reader, missing};
use super::{Expectation, ExpectationKind, Other, Param};

/// Most expectations of a case: each costs pictures.
const MAX_EXPECTATIONS: usize = 64;

/// Most halvings: steps beyond them are lost in f32.
const MAX_HALVINGS: u32 = 8;

const KINDS: [&str; 5] = ["finite", "stages_agree", "halving", "equals", "differs"];

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
            text: value
                .text()
                .split_whitespace()
                .collect::<Vec<_>>()
                .join(" "),
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
        let kind = match name {
            "finite" => Some(ExpectationKind::Finite),
            "stages_agree" => bound(&mut fields, findings, "max", value)
                .map(|max| ExpectationKind::StagesAgree { max }),
            "halving" => halving(&mut fields, findings, value),
            "equals" => {
                let other = self.other(&mut fields, findings, value);
                bound(&mut fields, findings, "max", value)
                    .map(|max| ExpectationKind::Equals { other, max })
            }
            "differs" => {
                let other = self.other(&mut fields, findings, value);
                let rmse = bound(&mut fields, findings, "rmse", value);
                if rmse == Some(0.0) {
                    let finding = value.error("bad-value", "a least error of 0 cannot fail");
                    findings
                        .push(finding.help("give the least error that can be seen, such as 0.01"));
                }
                rmse.map(|rmse| ExpectationKind::Differs { other, rmse })
            }
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
        };
        fields.finish(findings);
        kind
    }

    fn other(&self, fields: &mut Fields<'_>, findings: &mut Findings, value: &Value<'_>) -> Other {
        let graph = fields.take("graph");
        let set = fields.take("set");
        let is_own = |set: &Value<'_>| set.items().is_ok_and(|items| items.is_empty());
        if graph.is_none() && set.as_ref().is_none_or(is_own) {
            findings.push(missing(
                value,
                "set",
                "give `graph: \"other.ron\"`, `set: [\"node.param=value\"]` or both",
            ));
        }
        Other {
            graph: graph.and_then(|graph| findings.take(self.graph(&graph))),
            set: set.map(|set| self.sets(&set, findings)).unwrap_or_default(),
        }
    }
}

fn halving(
    fields: &mut Fields<'_>,
    findings: &mut Findings,
    value: &Value<'_>,
) -> Option<ExpectationKind> {
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
    let from = fields.read(findings, "from", |value| match value.f64()? {
        from if from > 0.0 => Ok(from),
        _ => Err(value.error("bad-value", "what is halved is above 0")),
    });
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

/// A number of at least 0, which must be there.
fn bound(
    fields: &mut Fields<'_>,
    findings: &mut Findings,
    name: &'static str,
    value: &Value<'_>,
) -> Option<f64> {
    let Some(given) = fields.take(name) else {
        let help = format!("add `{name}: 1e-4` or another bound");
        findings.push(missing(value, name, &help));
        return None;
    };
    let number = findings.take(given.f64())?;
    if number < 0.0 {
        findings.push(given.error("bad-value", "a bound is at least 0"));
    }
    Some(number)
}
