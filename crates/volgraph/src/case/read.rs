//! Reads and checks case files.

use std::fs;
use std::path::Path;

use volgraph_graph::{GraphDesc, is_embedded, read};
use volgraph_report::ron_text::{Document, Entry, Fields, Value};
use volgraph_report::{Finding, Findings, Place, did_you_mean};

use super::{Case, Expectation, ExpectationKind, GraphName, Other, Param, Set, graph_path};
use crate::{ParamOverride, embedded, scene};

/// Longest text that is read.
const MAX_TEXT_BYTES: u64 = 64 << 10;

/// Most expectations of a case: each costs pictures.
const MAX_EXPECTATIONS: usize = 64;

/// Most halvings: steps beyond them are lost in f32.
const MAX_HALVINGS: u32 = 8;

const KINDS: [&str; 5] = ["finite", "stages_agree", "halving", "equals", "differs"];

impl Case {
    /// Reads a case file.
    ///
    /// # Errors
    /// `io`, or everything wrong with its form, each finding at its place.
    pub fn load(file: &Path) -> Result<Self, Findings> {
        let unreadable = |error: std::io::Error| {
            Finding::error("io", format!("the case cannot be read: {error}"))
                .at(Place::whole_file(file))
                .help("check that the path names a UTF-8 text file that you may read")
        };
        let metadata = fs::metadata(file).map_err(unreadable)?;
        if metadata.is_dir() || metadata.len() > MAX_TEXT_BYTES {
            return Err(
                Finding::error("not-a-case", "a case is a RON file of at most 64 KiB")
                    .at(Place::whole_file(file))
                    .help("name a case file, or a folder that holds some")
                    .into(),
            );
        }
        Self::parse(file, &fs::read_to_string(file).map_err(unreadable)?)
    }

    /// Reads a case's text; `file` is its name for findings, and graphs are named from its folder.
    ///
    /// # Errors
    /// Everything wrong with its form, each finding at its place.
    pub fn parse(file: &Path, text: &str) -> Result<Self, Findings> {
        let document = Document::parse(file, text)?;
        let mut findings = Findings::new();
        let mut fields = Fields::new(document.fields()?);
        let reader = Reader { file };
        let version = fields.read(&mut findings, "test", |value| match value.u32()? {
            1 => Ok(()),
            other => Err(value
                .error(
                    "case-version",
                    format!("version {other} of test cases is not known"),
                )
                .help("write `test: 1`, or use a newer volgraph")),
        });
        if version.is_none() && !findings.has_errors() {
            findings.push(missing(
                &document,
                "test",
                "add `test: 1`, the version of the format",
            ));
        }
        let size = fields.read(&mut findings, "size", |value| {
            let sides = value.items()?;
            let sides: Vec<u32> = sides.iter().map(Value::u32).collect::<Result<_, _>>()?;
            match sides.as_slice() {
                &[width, height] if width > 0 && height > 0 => Ok([width, height]),
                _ => Err(value
                    .error("bad-value", "a size is two numbers of pixels of at least 1")
                    .help("write it as `size: (64, 64)`")),
            }
        });
        let graph = fields.read(&mut findings, "graph", |value| reader.graph(value));
        let set = fields
            .take("set")
            .map(|value| reader.sets(&value, &mut findings))
            .unwrap_or_default();
        let expect = fields
            .take("expect")
            .map(|value| reader.expectations(&value, &mut findings));
        if graph.is_none() && !findings.has_errors() {
            findings.push(missing(
                &document,
                "graph",
                "add `graph: \"../name.ron\"`, from the case's folder",
            ));
        }
        if expect.as_ref().is_none_or(Vec::is_empty) && !findings.has_errors() {
            findings.push(missing(
                &document,
                "expect",
                "add `expect: [finite]`: a case that expects nothing cannot fail",
            ));
        }
        fields.finish(&mut findings);
        match graph {
            Some(graph) => findings.into_result(Self {
                file: file.to_path_buf(),
                graph,
                size: size.unwrap_or([64, 64]),
                set,
                expect: expect.unwrap_or_default(),
            }),
            None => Err(findings),
        }
    }

    /// Whether the graphs that it names are there and have the nodes and sources that it sets. What is wrong within a
    /// graph is told where that is checked or rendered.
    #[must_use]
    pub fn check(&self) -> Findings {
        let mut findings = Findings::new();
        let own = known_names(&self.graph, &mut findings);
        let mut settings: Vec<(&Option<GraphDesc>, &Set)> =
            self.set.iter().map(|set| (&own, set)).collect();
        let mut others = Vec::new();
        for expectation in &self.expect {
            match &expectation.kind {
                ExpectationKind::Equals { other, .. } | ExpectationKind::Differs { other, .. } => {
                    let desc = other
                        .graph
                        .as_ref()
                        .map(|graph| known_names(graph, &mut findings));
                    others.push((desc, &other.set));
                }
                ExpectationKind::Halving { param, .. } => {
                    if let Some(desc) = &own {
                        findings.extend(unknown_target(desc, &param.node, false, &param.place));
                    }
                }
                ExpectationKind::Finite | ExpectationKind::StagesAgree { .. } => {}
            }
        }
        for (desc, sets) in &others {
            settings.extend(sets.iter().map(|set| (desc.as_ref().unwrap_or(&own), set)));
        }
        for (desc, set) in settings {
            if let Some(desc) = desc {
                let (target, is_slot) = (&set.value.target, set.value.is_slot);
                findings.extend(unknown_target(desc, target, !is_slot, &set.place));
            }
        }
        findings
    }
}

/// A graph's nodes and sources; `None` where it is not there (a finding) or cannot be read (told elsewhere).
fn known_names(graph: &GraphName, findings: &mut Findings) -> Option<GraphDesc> {
    if let Err(finding) = graph_is_there(graph) {
        findings.push(finding);
        return None;
    }
    let text = scene::read_text(&graph.path).ok()?;
    read::graph(&graph.path, &text).ok()
}

/// A case's graph is a file: a name alone does not stand for a ready graph here, so that a missing file is told.
pub(super) fn graph_is_there(graph: &GraphName) -> Result<(), Finding> {
    let is_there = if is_embedded(&graph.path) {
        embedded::text(&graph.path).is_some()
    } else {
        graph.path.is_file()
    };
    if is_there {
        return Ok(());
    }
    let message = format!("there is no graph {}", graph.path.display());
    Err(Finding::error("missing-graph", message)
        .at(graph.place.clone())
        .help("name it from the case's own folder, or as `embedded:/graphs/NAME.ron`"))
}

fn unknown_target(
    desc: &GraphDesc,
    name: &str,
    may_be_source: bool,
    place: &Place,
) -> Option<Finding> {
    let is_known =
        desc.nodes.contains_key(name) || may_be_source && desc.sources.contains_key(name);
    let known = desc.nodes.keys().chain(desc.sources.keys());
    (!is_known).then(|| {
        Finding::error(
            "unknown-node",
            format!("the graph has nothing named `{name}`"),
        )
        .at(place.clone())
        .help_opt(did_you_mean(name, known.map(String::as_str)))
    })
}

fn missing(value: &Value<'_>, name: &str, help: &str) -> Finding {
    let place = Place {
        length: 1,
        ..value.place()
    };
    Finding::error(
        "missing-field",
        format!("the field `{name}` is missing or empty"),
    )
    .at(place)
    .help(help)
}

struct Reader<'f> {
    file: &'f Path,
}

impl Reader<'_> {
    fn graph(&self, value: &Value<'_>) -> Result<GraphName, Finding> {
        Ok(GraphName {
            path: graph_path(self.file, &value.string()?),
            place: value.place(),
        })
    }

    fn sets(&self, value: &Value<'_>, findings: &mut Findings) -> Vec<Set> {
        let items = findings.take(value.items()).unwrap_or_default();
        let read = |item: &Value<'_>| {
            let typed = item.string()?;
            let value = ParamOverride::parse(&typed).map_err(|message| {
                item.error("bad-set", message)
                    .help("write it as `\"image.step=0.5\"`")
            })?;
            Ok(Set {
                value,
                place: item.place(),
            })
        };
        items
            .iter()
            .filter_map(|item| findings.take(read(item)))
            .collect()
    }

    fn expectations(&self, value: &Value<'_>, findings: &mut Findings) -> Vec<Expectation> {
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

#[cfg(test)]
mod tests {
    use super::*;

    const CASE: &str = "(\n test: 1, graph: \"../g.ron\", size: (32, 16), set: [\"image.step=0.5\"],\n expect: [\n  finite,\n  \
        stages_agree(max: 1e-4),\n  halving(param: \"image.step\", times: 3,\n    rmse: 0.01, order: 1.5),\n  \
        equals(graph: \"embedded:/graphs/quickstart.ron\", max: 0),\n  differs(set: [\"image.b=0\"], rmse: 0.1),\n ])";

    fn parse(text: &str) -> Result<Case, Findings> {
        Case::parse(Path::new("tests/c.ron"), text)
    }

    #[test]
    fn a_case_is_read_with_its_places() {
        let case = parse(CASE).unwrap();
        assert_eq!(case.graph.path, Path::new("tests/../g.ron"));
        assert_eq!(
            (case.size, case.set.len(), case.expect.len()),
            ([32, 16], 1, 5)
        );
        assert_eq!(
            case.expect[1].kind,
            ExpectationKind::StagesAgree { max: 1e-4 }
        );
        assert_eq!(
            (case.expect[2].place.line, case.expect[2].place.column),
            (6, 3)
        );
        assert_eq!(
            case.expect[2].text,
            "halving(param: \"image.step\", times: 3, rmse: 0.01, order: 1.5)"
        );
        let ExpectationKind::Equals { other, max } = &case.expect[3].kind else {
            panic!("{:?}", case.expect[3]);
        };
        assert_eq!(*max, 0.0);
        assert_eq!(
            other.graph.as_ref().unwrap().path,
            Path::new("embedded:/graphs/quickstart.ron")
        );
    }

    #[test]
    fn everything_wrong_is_told_at_its_place() {
        let whole = |fields: &str| format!("({fields})");
        let with = |field: &str| {
            whole(&format!(
                "test: 1, graph: \"g.ron\", {field}, expect: [finite]"
            ))
        };
        let all = |expect: &str| whole(&format!("test: 1, graph: \"g.ron\",\nexpect: [{expect}]"));
        for (text, code, needle) in [
            (
                whole("test: 2, graph: \"g.ron\", expect: [finite]"),
                "case-version",
                "2,",
            ),
            (whole("test: 1, expect: [finite]"), "missing-field", "("),
            (whole("test: 1, graph: \"g.ron\""), "missing-field", "("),
            (
                whole("graph: \"g.ron\", expect: [finite]"),
                "missing-field",
                "(",
            ),
            (all(""), "missing-field", "("),
            (with("size: (0, 3)"), "bad-value", "(0, 3)"),
            (with("set: [\"step\"]"), "bad-set", "\"step\""),
            (with("sizes: (1, 3)"), "unknown-field", "sizes"),
            (all("finit"), "unknown-expectation", "finit"),
            (all("finite(max: 1)"), "unknown-field", "max"),
            (all("stages_agree"), "missing-field", "stages"),
            (all("stages_agree(max: -1)"), "bad-value", "-1"),
            (all("stages_agree(max: \"a\")"), "wrong-type", "\"a\""),
            (all("halving(rmse: 0.1)"), "missing-field", "halving"),
            (
                all("halving(param: \"image\", rmse: 0.1)"),
                "bad-value",
                "\"image\"",
            ),
            (all("halving(param: \"a.b\")"), "missing-field", "halving"),
            (
                all("halving(param: \"a.b\", times: 9, rmse: 1)"),
                "bad-value",
                "9",
            ),
            (
                all("halving(param: \"a.b\", from: 0, rmse: 1)"),
                "bad-value",
                "0,",
            ),
            (
                all("halving(param: \"a.b\", times: 1, rmse: 1, order: 2)"),
                "bad-value",
                "2)",
            ),
            (all("equals(max: 1)"), "missing-field", "equals"),
            (all("equals(set: [], max: 1)"), "missing-field", "equals"),
            (
                all("differs(set: [\"a.b=1\"], rmse: 0)"),
                "bad-value",
                "differs",
            ),
        ] {
            let findings = parse(&text).unwrap_err();
            let told: Vec<_> = findings
                .sorted()
                .iter()
                .map(|finding| {
                    let place = finding.place.as_ref().unwrap();
                    (finding.code, (place.line, place.column))
                })
                .collect();
            let place = volgraph_report::line_column(&text, text.find(needle).unwrap());
            assert_eq!(told, [(code, place)], "{text}\n{findings}");
        }
        // All at once.
        let findings =
            parse(&all("finit, stages_agree(max: -1), halving(rmse: \"x\")")).unwrap_err();
        assert_eq!(findings.len(), 4, "{findings}");
    }

    #[test]
    fn graphs_and_names_that_are_not_there_are_told() {
        let folder = tempfile::tempdir().unwrap();
        let graph = embedded::text(Path::new("embedded:/graphs/quickstart.ron")).unwrap();
        fs::write(folder.path().join("g.ron"), graph).unwrap();
        let text = "(test: 1, graph: \"g.ron\", set: [\"imag.step=1\", \"colors.path=\\\"x\\\"\"], expect: [\n\
            equals(graph: \"no.ron\", max: 1),\nequals(graph: \"quickstart\", max: 1),\n\
            equals(graph: \"embedded:/graphs/hydrogen.ron\", set: [\"molecule.n=1\", \"glow.path=1\"], max: 1),\n\
            halving(param: \"colors.step\", rmse: 1),\n])";
        let case = Case::parse(&folder.path().join("c.ron"), text).unwrap();
        let findings = case.check();
        let told: Vec<_> = findings
            .sorted()
            .iter()
            .map(|finding| (finding.code, finding.place.as_ref().unwrap().line))
            .collect();
        assert_eq!(
            told,
            [
                ("unknown-node", 1),
                ("missing-graph", 2),
                ("missing-graph", 3),
                ("unknown-node", 4),
                ("unknown-node", 5)
            ],
            "{findings}"
        );
    }
}
