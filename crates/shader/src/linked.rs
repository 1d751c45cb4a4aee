//! A linked text, and the way back from each of its bytes to the author's file.

use std::collections::{BTreeMap, HashMap};
use std::fmt::Write as _;
use std::ops::Range;
use std::path::{Path, PathBuf};

use volgraph_report::{Finding, Findings, Place, line_column};

/// One file that went into a linked text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LinkedFile {
    /// The file as its author would name it.
    pub path: PathBuf,
    /// The one path of this file, however it was reached; what a watcher watches.
    pub resolved: PathBuf,
    /// BLAKE3 of its text.
    pub digest: [u8; 32],
    /// Its text, as read.
    pub text: String,
    /// The import that it came in by, the first one; `None` for the root.
    pub imported: Option<Place>,
}

/// How a file came in: its import, the import of that one's file, and so on to the root.
pub(crate) fn import_chain<'f>(
    files: &(impl Iterator<Item = &'f LinkedFile> + Clone),
    path: &Path,
) -> Vec<Place> {
    let importer = |path: &Path| {
        let file = files.clone().find(|file| file.path == path)?;
        file.imported.clone()
    };
    std::iter::successors(importer(path), |place| importer(&place.file)).collect()
}

/// A stretch of linked text that comes from one stretch of one file.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Segment {
    /// Where it starts in the linked text; it ends where the next one starts.
    start: usize,
    file: usize,
    source: Range<usize>,
    /// Whether it is the author's text byte for byte; else the linker made it because of `source`.
    is_verbatim: bool,
}

/// Which file and bytes each byte of a linked text comes from.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SegmentMap(Vec<Segment>);

impl SegmentMap {
    /// The index of the file that byte `offset` of the linked text comes from and the bytes there; the end of
    /// the last file for an offset past the end. `None` only for a text that comes from no file.
    fn source(&self, offset: usize, len: usize) -> Option<(usize, Range<usize>)> {
        let at = self.0.partition_point(|segment| segment.start <= offset);
        let segment = self.0.get(at.saturating_sub(1))?;
        if !segment.is_verbatim {
            return Some((segment.file, segment.source.clone()));
        }
        let start =
            (segment.source.start + offset.saturating_sub(segment.start)).min(segment.source.end);
        let end = start.saturating_add(len).min(segment.source.end);
        Some((segment.file, start..end))
    }
}

/// A name declared at module scope.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Declared {
    pub name: String,
    pub file: usize,
    pub range: Range<usize>,
    pub docs: Vec<Range<usize>>,
    /// The names of a struct's members.
    pub members: Vec<Range<usize>>,
    /// Whether the linker declares it, for `struct Params`.
    pub is_made: bool,
}

/// A member of the merged `struct Params`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct MergedParam {
    pub name: String,
    pub file: usize,
    pub range: Range<usize>,
    pub docs: Vec<Range<usize>>,
}

/// Everything that a file imports, as one WGSL text.
#[derive(Clone, Debug, PartialEq)]
pub struct Linked {
    /// Plain WGSL, no `#import` left.
    pub text: String,
    /// The files in it, in the order of their text; the last is the root.
    pub files: Vec<LinkedFile>,
    /// The slots in it → the display path of the file that fills each.
    pub slots_used: BTreeMap<String, PathBuf>,
    /// The slots that its files import → the places of these imports.
    pub slots_asked: BTreeMap<String, Vec<Place>>,
    /// BLAKE3 of `text`.
    pub digest: [u8; 32],
    pub(crate) map: SegmentMap,
    pub(crate) declared: Vec<Declared>,
    pub(crate) params: Vec<MergedParam>,
    /// Of each file, the bytes that are not WGSL's or stand elsewhere: imports, directives, byte order mark.
    pub(crate) blanked: Vec<Vec<Range<usize>>>,
    /// The length of the hoisted directives at the start of `text`.
    pub(crate) directives_len: usize,
}

impl Linked {
    /// The author's place of the bytes `offset..offset + len` of [`Self::text`]. What the linker itself wrote
    /// has the place of the `struct Params` that made it do so.
    #[must_use]
    pub fn place(&self, offset: usize, len: usize) -> Place {
        match self.map.source(offset, len) {
            Some((file, range)) => self.place_in(file, &range),
            None => self.files.last().map_or_else(
                || Place::whole_file(PathBuf::new()),
                |file| Place::whole_file(&file.path),
            ),
        }
    }

    /// Which file each byte comes from.
    #[must_use]
    pub fn map(&self) -> &SegmentMap {
        &self.map
    }

    /// The linked text with a comment wherever it goes on with another file or another part of it:
    /// `// from lib/ray.wgsl:12`.
    #[must_use]
    pub fn annotated(&self) -> String {
        let mut annotated = String::with_capacity(self.text.len() + 64 * self.files.len());
        let mut before: Option<(usize, usize)> = None;
        for (at, segment) in self.map.0.iter().enumerate() {
            let end = self
                .map
                .0
                .get(at + 1)
                .map_or(self.text.len(), |next| next.start);
            let text = &self.text[segment.start..end];
            let follows = before.is_some_and(|(file, end)| {
                let between = self.files[file].text.get(end..segment.source.start);
                file == segment.file && between.is_some_and(|text| text.trim().is_empty())
            });
            if segment.is_verbatim && !text.trim().is_empty() {
                if !follows {
                    if !annotated.is_empty() && !annotated.ends_with('\n') {
                        annotated.push('\n');
                    }
                    let file = &self.files[segment.file];
                    let blank = text.len() - text.trim_start().len();
                    let (line, _) = line_column(&file.text, segment.source.start + blank);
                    // Writing to a String cannot fail.
                    let _ = writeln!(annotated, "// from {}:{line}", file.path.display());
                }
                before = Some((segment.file, segment.source.end));
            }
            annotated.push_str(text);
        }
        annotated
    }

    /// The text of a file by its display path; what [`volgraph_report::excerpt::render`] asks for.
    #[must_use]
    pub fn file_text(&self, path: &Path) -> Option<&str> {
        let file = self.files.iter().find(|file| file.path == path)?;
        Some(&file.text)
    }

    /// The place of these bytes of a file.
    pub(crate) fn place_in(&self, file: usize, range: &Range<usize>) -> Place {
        let file = &self.files[file];
        Place::in_text(&file.path, &file.text, range.start, range.len())
    }

    /// The finding, with the imports on the way to its file.
    pub(crate) fn with_imports(&self, finding: Finding) -> Finding {
        let chain = finding
            .place
            .as_ref()
            .map(|place| import_chain(&self.files.iter(), &place.file))
            .unwrap_or_default();
        finding.imported_by(chain)
    }

    /// The root file as a whole.
    #[must_use]
    pub fn root_place(&self) -> Place {
        let root = self.files.last().map(|file| file.path.clone());
        Place::whole_file(root.unwrap_or_default())
    }

    /// The declaration of a module-scope name.
    pub(crate) fn declaration(&self, name: &str) -> Option<&Declared> {
        self.declared.iter().find(|declared| declared.name == name)
    }

    /// The place of a module-scope name's declaration.
    pub(crate) fn declaration_place(&self, name: &str) -> Option<Place> {
        let declared = self.declaration(name)?;
        Some(self.place_in(declared.file, &declared.range))
    }

    /// The place of a struct's member; the struct's, or the root file, where that is not known.
    pub(crate) fn member_place(&self, of: &str, member: &str) -> Place {
        let param = self
            .params
            .iter()
            .find(|param| of == "Params" && param.name == member);
        if let Some(param) = param {
            return self.place_in(param.file, &param.range);
        }
        let Some(declared) = self.declaration(of) else {
            return self.root_place();
        };
        let text = &self.files[declared.file].text;
        let range = declared
            .members
            .iter()
            .find(|range| &text[(*range).clone()] == member);
        self.place_in(declared.file, range.unwrap_or(&declared.range))
    }

    /// The doc comments, without their slashes, joined by spaces.
    pub(crate) fn doc(&self, file: usize, docs: &[Range<usize>]) -> String {
        let text = &self.files[file].text;
        let lines = docs
            .iter()
            .map(|doc| text[doc.clone()].trim_start_matches('/').trim());
        lines
            .filter(|line| !line.is_empty())
            .collect::<Vec<_>>()
            .join(" ")
    }

    /// All names that are declared twice at module scope.
    pub(crate) fn name_clashes(&self) -> Findings {
        let mut first = HashMap::new();
        let mut findings = Findings::new();
        for declared in &self.declared {
            let Some(before) = first.insert(&declared.name, declared) else {
                continue;
            };
            first.insert(&declared.name, before);
            // The linker's own declaration is never the one to blame.
            let (blamed, other) = if declared.is_made {
                (before, declared)
            } else {
                (declared, before)
            };
            let name = &declared.name;
            let mut finding = Finding::error(
                "name-clash",
                format!("`{name}` is declared twice; names are global"),
            )
            .at(self.place_in(blamed.file, &blamed.range));
            let other_place = self.place_in(other.file, &other.range);
            finding = if other.is_made {
                finding
                    .related(
                        other_place,
                        format!("the linker declares `{name}` because of this struct"),
                    )
                    .help("take another name, or remove this declaration: the linker adds it")
            } else {
                finding
                    .related(other_place, "first here")
                    .help("rename one of them; a library's names carry its file's prefix")
            };
            findings.push(finding);
        }
        findings
    }

    /// One file's text, to be parsed without the others: its bytes stand where they stand in the file, moved by
    /// [`Self::directives_len`].
    pub(crate) fn alone(&self, file: usize) -> String {
        let mut text = self.text[..self.directives_len].to_owned();
        let source = &self.files[file].text;
        let mut at = 0;
        for blank in &self.blanked[file] {
            text.push_str(&source[at..blank.start]);
            text.extend(std::iter::repeat_n(' ', blank.len()));
            at = blank.end;
        }
        text.push_str(&source[at..]);
        text
    }
}

/// Puts a linked text together, keeping the way back.
#[derive(Default)]
pub(crate) struct Builder {
    pub text: String,
    map: Vec<Segment>,
}

impl Builder {
    /// Adds bytes of a file.
    pub fn copy(&mut self, file: usize, text: &str, range: Range<usize>) {
        if !range.is_empty() {
            self.map.push(Segment {
                start: self.text.len(),
                file,
                source: range.clone(),
                is_verbatim: true,
            });
            self.text.push_str(&text[range]);
        }
    }

    /// Adds text that is there because of these bytes of a file.
    pub fn make(&mut self, made: &str, file: usize, because: Range<usize>) {
        self.map.push(Segment {
            start: self.text.len(),
            file,
            source: because,
            is_verbatim: false,
        });
        self.text.push_str(made);
    }

    pub fn finish(self) -> (String, SegmentMap) {
        (self.text, SegmentMap(self.map))
    }
}
