//! Reads case files.

use std::fs;
use std::path::Path;

use volgraph_graph::read;
use volgraph_report::ron_text::{Document, Entry, Fields, Value};
use volgraph_report::{Finding, Findings, Place, did_you_mean};

use super::scenes::{STOCK_SCENES, StockScene};
use super::{Case, Drawn, GraphName, Set, SlotUnderTest, Stand, Sweep, beside, one_line};
use crate::ParamOverride;

/// Longest text that is read.
const MAX_TEXT_BYTES: u64 = 64 << 10;

/// Most volumes, and most cameras.
const MAX_STANDS: usize = 64;

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
        // A pipe or a device could block for ever.
        if !metadata.is_file() || metadata.len() > MAX_TEXT_BYTES {
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
        let size = fields.read(&mut findings, "size", size);
        let node = fields.read(&mut findings, "node", Value::string);
        let node = node.unwrap_or_else(|| "image".to_owned());
        let slots = fields
            .take("slot")
            .map(|value| slots(&value, &mut findings));
        let graph = fields.read(&mut findings, "graph", |value| reader.graph(value));
        let graph = reader.scene(
            &mut fields,
            graph,
            slots.is_some(),
            &document,
            &mut findings,
        );
        let set = fields
            .take("set")
            .map(|value| reader.sets(&value, &mut findings));
        let volumes = fields
            .take("volumes")
            .map(|value| many(&value, &mut findings, volume));
        let cameras = fields
            .take("cameras")
            .map(|value| many(&value, &mut findings, camera));
        let sweep = fields
            .take("sweep")
            .and_then(|value| findings.take_all(super::points::read(&value, slots.is_some())));
        let mut expectations = |name, findings: &mut Findings| {
            let value = fields.take(name)?;
            Some(reader.expectations(&value, findings))
        };
        let expect = expectations("expect", &mut findings).unwrap_or_default();
        let once = expectations("once", &mut findings).unwrap_or_default();
        if graph.is_none() && !findings.has_errors() {
            findings.push(missing(
                &document,
                "graph",
                "add `graph: \"../name.ron\"`, from the case's folder, or `slot: (technique: \"name\")`",
            ));
        }
        if expect.is_empty() && once.is_empty() && !findings.has_errors() {
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
                slots: slots.unwrap_or_default(),
                node,
                size: size.unwrap_or([64, 64]),
                set: set.unwrap_or_default(),
                volumes: volumes.unwrap_or_default(),
                cameras: cameras.unwrap_or_default(),
                sweep: sweep.unwrap_or(Sweep::None),
                expect,
                once,
            }),
            None => Err(findings),
        }
    }
}

fn size(value: &Value<'_>) -> Result<[u32; 2], Finding> {
    let sides = value.items()?;
    let sides: Vec<u32> = sides.iter().map(Value::u32).collect::<Result<_, _>>()?;
    match sides.as_slice() {
        &[width, height] if width > 0 && height > 0 => Ok([width, height]),
        _ => Err(value
            .error("bad-value", "a size is two numbers of pixels of at least 1")
            .help("write it as `size: (64, 64)`")),
    }
}

/// The slots under test: `(technique: "glow", light: "phong")`.
fn slots(value: &Value<'_>, findings: &mut Findings) -> Vec<SlotUnderTest> {
    let entries = findings.take_all(value.fields()).unwrap_or_default();
    if entries.is_empty() && !findings.has_errors() {
        findings.push(missing(
            value,
            "slot",
            "name a slot and its choice: `slot: (technique: \"glow\")`",
        ));
    }
    entries
        .into_iter()
        .filter_map(|entry| {
            Some(SlotUnderTest {
                choice: findings.take(entry.value.string())?,
                slot: entry.name,
                place: entry.value.place(),
            })
        })
        .collect()
}

/// The items of a list.
fn many<T>(
    value: &Value<'_>,
    findings: &mut Findings,
    read: impl Fn(&Value<'_>) -> Result<T, Findings>,
) -> Vec<T> {
    let items = findings.take(value.items()).unwrap_or_default();
    if items.len() > MAX_STANDS {
        let message = format!("more than {MAX_STANDS} of them are refused");
        findings.push(
            value
                .error("too-large", message)
                .help("write several cases"),
        );
        return Vec::new();
    }
    items
        .iter()
        .filter_map(|item| findings.take_all(read(item)))
        .collect()
}

/// The name of a scene, whose volume is meant, or a source as graphs have them.
fn volume(value: &Value<'_>) -> Result<Drawn, Findings> {
    let text = one_line(value.text());
    if text.starts_with('"') {
        let name = value.string()?;
        let source = scene_named(&name, value)?
            .volume()
            .ok_or_else(|| value.error("internal", "the scene has no volume"))?;
        return Ok(Drawn { text: name, source });
    }
    let source = read::source(&Entry {
        name: "volume".to_owned(),
        name_place: value.place(),
        value: *value,
    })?;
    Ok(Drawn { text, source })
}

fn camera(value: &Value<'_>) -> Result<Stand, Findings> {
    Ok(Stand {
        text: one_line(value.text()),
        camera: read::camera(value)?,
    })
}

fn scene_named(name: &str, value: &Value<'_>) -> Result<&'static StockScene, Finding> {
    StockScene::named(name).ok_or_else(|| {
        value
            .error("unknown-scene", format!("no scene is named `{name}`"))
            .help_opt(did_you_mean(
                name,
                STOCK_SCENES.iter().map(|scene| scene.name),
            ))
    })
}

pub(super) fn missing(value: &Value<'_>, name: &str, help: &str) -> Finding {
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

pub(super) struct Reader<'f> {
    pub(super) file: &'f Path,
}

impl Reader<'_> {
    pub(super) fn graph(&self, value: &Value<'_>) -> Result<GraphName, Finding> {
        Ok(GraphName {
            path: beside(self.file, &value.string()?),
            place: value.place(),
        })
    }

    /// The graph that is named, or else the scene, which a case with a slot under test need not name.
    fn scene(
        &self,
        fields: &mut Fields<'_>,
        graph: Option<GraphName>,
        has_slot: bool,
        document: &Value<'_>,
        findings: &mut Findings,
    ) -> Option<GraphName> {
        let Some(value) = fields.take("scene") else {
            let own = STOCK_SCENES[0].path();
            let place = Place {
                length: 1,
                ..document.place()
            };
            return graph.or(has_slot.then_some(GraphName { path: own, place }));
        };
        let name = findings.take(value.string())?;
        let scene = findings.take(scene_named(&name, &value))?;
        if let Some(graph) = graph {
            findings.push(
                value
                    .error("exclusive-fields", "a case has a graph or a scene")
                    .related(graph.place.clone(), "the graph")
                    .help("leave out one of the two"),
            );
            return Some(graph);
        }
        Some(GraphName {
            path: scene.path(),
            place: value.place(),
        })
    }

    pub(super) fn sets(&self, value: &Value<'_>, findings: &mut Findings) -> Vec<Set> {
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
}

#[cfg(test)]
mod tests {
    use super::super::ExpectationKind;
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
}
