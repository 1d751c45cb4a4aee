//! Reads case files.

#[cfg(test)]
mod tests;

use std::fs;
use std::path::Path;

use volgraph_graph::read;
use volgraph_report::ron_text::{Document, Entry, Fields, Value};
use volgraph_report::{Finding, Findings, Place, did_you_mean};

use super::scenes::{STOCK_SCENES, StockScene};
use super::{Case, Drawn, GraphName, Set, SlotUnderTest, Stand, Sweep, beside, one_line};
use crate::ParamOverride;

/// Longest text that is read.
pub(super) const MAX_TEXT_BYTES: u64 = 64 << 10;

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
        let document = Document::parse(file, text).map_err(|finding| {
            finding.help(
                "a bracket, a quote or a comma is missing or too many, here or before; a case is `(test: 1, …, expect: [finite])`",
            )
        })?;
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
