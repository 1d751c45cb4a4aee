//! `segments(path: "segments/bones.ron")`: what the labels of a volume mean.
//!
//! ```ron
//! (
//!     segments: [
//!         (label: 1, name: "bone", transfer: "bone.ron", params: { "specular": 0.6 }),
//!         (label: 2, name: "skin", visible: false),
//!     ],
//!     // What the labels mean that are not listed; without it they are drawn as the node itself says.
//!     others: (transfer: "rest.ron"),
//! )
//! ```
//!
//! A label is a whole number of 0 to 255. Transfer functions are looked for beside this file, then as all files of the
//! graph are. `params` are parameters of the node's shader; those that are not given are the node's own.
//!
//! Codes of findings: those of `ron_text`, `out-of-range`, `missing-field`, `duplicate`, `too-large`, `io`, and those of
//! transfer functions.

use std::any::Any;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use volgraph_graph::{Digest, Folders, ParamDesc, ParamRow, PortType, Source, SourceKind, read};
use volgraph_optics::TransferFunction;
use volgraph_report::ron_text::{Document, Fields, Value};
use volgraph_report::{Finding, Findings, Place};
use volgraph_shader::{ParamSpec, ParamValue};

use super::{Given, path_param};

/// The source kind `segments`.
pub struct SegmentsKind;

/// Longest text that is read.
const MAX_TEXT_BYTES: usize = 256 << 10;

/// Labels there are.
pub const LABELS: usize = 256;

/// What one label means.
#[derive(Clone, Debug, PartialEq)]
pub struct Segment {
    /// What people call it; empty where the file does not say.
    pub name: String,
    /// Whether it is drawn.
    pub is_visible: bool,
    /// Index of its transfer function in [`SegmentsSource::transfers`]; the node's own where `None`.
    pub transfer: Option<usize>,
    /// Parameters that differ from the node's own.
    pub params: ParamRow,
}

/// What the labels of a volume mean.
#[derive(Debug)]
pub struct SegmentsSource {
    /// The transfer functions that the file names, each once.
    pub transfers: Vec<Arc<TransferFunction>>,
    listed: BTreeMap<u8, Segment>,
    others: Option<Segment>,
    files: Vec<PathBuf>,
    digest: Digest,
}

impl SegmentsSource {
    /// What a label means; `None` for one that is as the node itself says.
    #[must_use]
    pub fn segment(&self, label: u8) -> Option<&Segment> {
        self.listed.get(&label).or(self.others.as_ref())
    }

    /// The parameters of those that have some of their own, each once.
    #[must_use]
    pub fn param_rows(&self) -> Vec<&ParamRow> {
        let mut rows: Vec<&ParamRow> = Vec::new();
        for segment in self.listed.values().chain(&self.others) {
            let is_new = !rows.iter().any(|row| sets_the_same(row, &segment.params));
            if is_new && !segment.params.is_empty() {
                rows.push(&segment.params);
            }
        }
        rows
    }

    /// The row of each label's parameters, after the node's own in row 0.
    #[must_use]
    pub fn row_of_params(&self) -> [usize; LABELS] {
        let rows = self.param_rows();
        std::array::from_fn(|label| {
            let label = u8::try_from(label).unwrap_or(u8::MAX);
            self.segment(label)
                .and_then(|segment| {
                    rows.iter()
                        .position(|row| sets_the_same(row, &segment.params))
                })
                .map_or(0, |at| at + 1)
        })
    }
}

/// Whether two rows have the same values, wherever they are written.
fn sets_the_same(a: &ParamRow, b: &ParamRow) -> bool {
    let same = |(name, given): (&String, &ParamDesc)| {
        b.get(name).is_some_and(|other| other.value == given.value)
    };
    a.len() == b.len() && a.iter().all(same)
}

impl SourceKind for SegmentsKind {
    fn name(&self) -> &'static str {
        "segments"
    }

    fn doc(&self) -> &'static str {
        "What the labels of a volume mean, from a RON file: transfer functions and parameters of their own."
    }

    fn ty(&self) -> PortType {
        PortType::Segments
    }

    fn params(&self) -> Vec<ParamSpec> {
        vec![path_param()]
    }

    fn load(
        &self,
        params: &BTreeMap<String, ParamValue>,
        folders: &Folders,
        _progress: volgraph_graph::Progress<'_>,
    ) -> Result<Arc<dyn Source>, Findings> {
        let given = Given(params);
        let path = given.path("path", folders)?;
        let text = match folders.embedded_bytes(&path) {
            Some(bytes) => String::from_utf8_lossy(bytes).into_owned(),
            None => text(&path)
                .map_err(|finding| given.with_twin(finding.into(), "path", &path, folders))?,
        };
        Ok(Arc::new(parse(&path, &text, folders)?))
    }
}

fn text(path: &Path) -> Result<String, Finding> {
    let unreadable = |error: std::io::Error| {
        Finding::error("io", format!("the segments cannot be read: {error}"))
            .at(Place::whole_file(path))
            .help("check that the path names a UTF-8 text file that you may read")
    };
    if !fs::metadata(path).map_err(unreadable)?.is_file() {
        // Reading a pipe or a device might never end.
        return Err(unreadable(std::io::Error::other("it is no plain file")));
    }
    let mut text = String::new();
    fs::File::open(path)
        .and_then(|file| {
            file.take(MAX_TEXT_BYTES as u64 + 1)
                .read_to_string(&mut text)
        })
        .map_err(unreadable)?;
    Ok(text)
}

/// Reads a text in the grammar above; `file` is the name that findings carry, and its folder the first in which transfer
/// functions are looked for.
///
/// # Errors
/// Everything wrong in it and in the transfer functions, each with its place.
pub fn parse(file: &Path, text: &str, folders: &Folders) -> Result<SegmentsSource, Findings> {
    if text.len() > MAX_TEXT_BYTES {
        let finding = Finding::error("too-large", "segments of more than 256 KiB are refused");
        return Err(finding.at(Place::whole_file(file)).into());
    }
    let document = Document::parse(file, text)?;
    let mut reader = Reader {
        folders: folders.beside(file),
        findings: Findings::new(),
        transfers: Transfers::default(),
    };
    let mut listed: BTreeMap<u8, Segment> = BTreeMap::new();
    let mut first: BTreeMap<u8, Place> = BTreeMap::new();
    let mut fields = Fields::new(document.fields()?);
    let others = fields.take("others");
    match fields.take("segments") {
        None => reader.findings.push(
            Finding::error("missing-field", "`segments` is missing")
                .at(Place {
                    length: 1,
                    ..document.place()
                })
                .help("write `segments: [(label: 1, transfer: \"…\")]`, say"),
        ),
        Some(list) => {
            let items = reader.findings.take(list.items()).unwrap_or_default();
            for item in items {
                let Some((label, place, segment)) = reader.listed(&item) else {
                    continue;
                };
                if let Some(first) = first.get(&label) {
                    reader.findings.push(
                        Finding::error("duplicate", format!("label {label} is listed twice"))
                            .at(place)
                            .related(first.clone(), "first here"),
                    );
                    continue;
                }
                first.insert(label, place);
                listed.insert(label, segment);
            }
        }
    }
    let others = others.and_then(|value| {
        let fields = reader.findings.take_all(value.fields())?;
        Some(reader.segment(Fields::new(fields)))
    });
    fields.finish(&mut reader.findings);
    let Reader {
        findings,
        transfers,
        ..
    } = reader;
    let Transfers {
        functions, files, ..
    } = transfers;
    let digest = digest(&listed, others.as_ref(), &functions);
    findings.into_result(SegmentsSource {
        transfers: functions,
        listed,
        others,
        files: std::iter::once(file.to_path_buf()).chain(files).collect(),
        digest,
    })
}

/// Transfer functions as they are read, each once.
#[derive(Default)]
struct Transfers {
    functions: Vec<Arc<TransferFunction>>,
    digests: Vec<Digest>,
    files: BTreeSet<PathBuf>,
    /// By file; `None` for one that could not be read.
    read: BTreeMap<PathBuf, Option<usize>>,
}

struct Reader {
    folders: Folders,
    findings: Findings,
    transfers: Transfers,
}

impl Reader {
    /// An entry of the list: its label, where that stands, and what it means.
    fn listed(&mut self, item: &Value<'_>) -> Option<(u8, Place, Segment)> {
        let mut fields = Fields::new(self.findings.take_all(item.fields())?);
        let value = fields.take("label");
        let segment = self.segment(fields);
        let Some(value) = value else {
            let finding = Finding::error("missing-field", "`label` is missing").at(Place {
                length: 1,
                ..item.place()
            });
            self.findings
                .push(finding.help("write `label: 1`, the number that its voxels have"));
            return None;
        };
        let number = self.findings.take(value.i64())?;
        let label = u8::try_from(number).map_err(|_| {
            value.error(
                "out-of-range",
                format!("a label is a whole number of 0 to 255, not {number}"),
            )
        });
        Some((self.findings.take(label)?, value.place(), segment))
    }

    /// What a label means, from its fields but `label`.
    fn segment(&mut self, mut fields: Fields<'_>) -> Segment {
        let findings = &mut self.findings;
        let name = fields.read(findings, "name", Value::string);
        let is_visible = fields.read(findings, "visible", Value::bool);
        let transfer = fields.take("transfer");
        let params = fields.take("params").map(|value| {
            let entries = findings.take_all(value.entries()).unwrap_or_default();
            read::params(entries, findings)
        });
        fields.finish(findings);
        Segment {
            name: name.unwrap_or_default(),
            is_visible: is_visible.unwrap_or(true),
            transfer: transfer.and_then(|value| self.transfer(&value)),
            params: params.unwrap_or_default(),
        }
    }

    fn transfer(&mut self, value: &Value<'_>) -> Option<usize> {
        let path = self.folders.find(&self.findings.take(value.string())?);
        if let Some(read) = self.transfers.read.get(&path) {
            return *read;
        }
        self.transfers.files.insert(path.clone());
        let loaded = match self.folders.embedded_bytes(&path) {
            Some(bytes) => TransferFunction::parse(&path, &String::from_utf8_lossy(bytes)),
            None => TransferFunction::load(&path),
        };
        let named = loaded.map_err(|findings| -> Findings {
            let named = |finding: Finding| finding.related(value.place(), "named here");
            findings.into_iter().map(named).collect()
        });
        let transfers = &mut self.transfers;
        let at = self.findings.take_all(named).map(|function| {
            let digest = function.digest();
            let known = transfers.digests.iter().position(|known| *known == digest);
            known.unwrap_or_else(|| {
                transfers.digests.push(digest);
                transfers.functions.push(Arc::new(function));
                transfers.functions.len() - 1
            })
        });
        transfers.read.insert(path, at);
        at
    }
}

/// Of everything but the places.
fn digest(
    listed: &BTreeMap<u8, Segment>,
    others: Option<&Segment>,
    functions: &[Arc<TransferFunction>],
) -> Digest {
    let mut hasher = volgraph_graph::fingerprint::Hasher::new();
    let labelled = listed
        .iter()
        .map(|(label, segment)| (Some(*label), segment));
    for (label, segment) in labelled.chain(others.map(|segment| (None, segment))) {
        let of_all = (label, &segment.name, segment.is_visible, segment.transfer);
        hasher.part(format!("{of_all:?}").as_bytes());
        for (name, given) in &segment.params {
            hasher.part(format!("{:?}", (name, &given.value)).as_bytes());
        }
        hasher.part(b"");
    }
    for function in functions {
        hasher.part(&function.digest());
    }
    hasher.finish()
}

impl Source for SegmentsSource {
    fn ty(&self) -> PortType {
        PortType::Segments
    }

    fn digest(&self) -> Digest {
        self.digest
    }

    fn summary(&self) -> String {
        let names: Vec<&str> = self
            .listed
            .values()
            .map(|segment| segment.name.as_str())
            .filter(|name| !name.is_empty())
            .collect();
        format!(
            "{}: {} labels, {} transfer functions; {}",
            self.files[0].display(),
            self.listed.len(),
            self.transfers.len(),
            names.join(", ")
        )
    }

    fn files(&self) -> Vec<PathBuf> {
        self.files.clone()
    }

    fn as_any(&self) -> &dyn Any {
        self
    }
}
