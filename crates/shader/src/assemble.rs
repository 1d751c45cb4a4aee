//! Puts scanned files together into one WGSL text.
//!
//! The order: the directives of all files, each once; one `struct Params` with the members of all, and its
//! binding; the files without what was taken out of them. Each piece is noted with where it comes from.
//!
//! Parameters are a uniform. Where a file calls `params_select(row)` they are a table of rows instead, and `params` is a
//! variable that the call fills: whoever reads `params` reads those of the row that was selected last.

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::PathBuf;

use volgraph_report::{Finding, Findings, Place};

use crate::linked::{Builder, Declared, MergedParam, import_chain};
use crate::scan::{PARAMS_SELECT, Scan};
use crate::{Linked, LinkedFile};

/// What follows the members of `struct Params` where rows of a table are selected. The table is a uniform, which has to
/// have a size: as many rows as fit into what devices allow. (A storage buffer has no such bound, but llvmpipe of Mesa
/// 22.3 reads zeros from one in fragment shaders.)
fn params_table(members: usize) -> String {
    // A member takes 16 bytes at most, and structs in uniforms are aligned to as many.
    let rows = (MAX_UNIFORM_BYTES / (16 * members.max(1))).clamp(1, MAX_PARAM_ROWS);
    format!(
        "}}
struct ParamsRow {{
    @align(16) params: Params,
}}
struct ParamsTable {{
    rows: array<ParamsRow, {rows}>,
}}
@group(3) @binding(0) var<uniform> params_table: ParamsTable;
var<private> params: Params;
fn params_select(row: u32) {{
    params = params_table.rows[row].params;
}}
"
    )
}

/// What WebGPU guarantees for a uniform.
const MAX_UNIFORM_BYTES: usize = 64 << 10;

/// The node's own and one for each of 256 labels would be 257; one that differs from no other is not needed.
const MAX_PARAM_ROWS: usize = 256;

/// Where no file has parameters, there is nothing to select.
const NO_PARAMS_TO_SELECT: &str = "fn params_select(row: u32) {}\n";

/// The largest linked text, in bytes; it bounds what naga works on.
const MAX_LINKED_BYTES: usize = 1 << 20;

/// Links `files`, which stand in the order of their text, the root last.
pub(crate) fn assemble(
    files: Vec<(LinkedFile, Scan)>,
    slots_used: BTreeMap<String, PathBuf>,
    slots_asked: BTreeMap<String, Vec<Place>>,
    findings: Findings,
) -> Result<Linked, Findings> {
    Assembler { files, findings }.finish(slots_used, slots_asked)
}

struct Assembler {
    files: Vec<(LinkedFile, Scan)>,
    findings: Findings,
}

impl Assembler {
    fn finish(
        mut self,
        slots_used: BTreeMap<String, PathBuf>,
        slots_asked: BTreeMap<String, Vec<Place>>,
    ) -> Result<Linked, Findings> {
        let size: usize = self.files.iter().map(|(file, _)| file.text.len()).sum();
        if size > MAX_LINKED_BYTES {
            let root = self.files.last().map(|(file, _)| file.path.clone());
            let message =
                format!("the files linked have {size} bytes, more than {MAX_LINKED_BYTES}");
            let finding = Finding::error("too-large", message)
                .at(Place::whole_file(root.unwrap_or_default()));
            self.findings.push(finding.help("import less"));
        }
        let params = self.merge_params();
        if self.findings.has_errors() {
            return Err(self.findings);
        }
        let mut builder = Builder::default();
        let directives_len = self.put_directives(&mut builder);
        self.put_params(&mut builder);
        for (at, (file, scan)) in self.files.iter().enumerate() {
            let mut start = 0;
            for cut in cuts(scan, true) {
                builder.copy(at, &file.text, start..cut.start);
                start = cut.end;
            }
            builder.copy(at, &file.text, start..file.text.len());
            if !file.text.ends_with('\n') {
                builder.make("\n", at, file.text.len()..file.text.len());
            }
        }
        let (text, map) = builder.finish();
        let declared = self.declared();
        let (files, scans): (Vec<_>, Vec<_>) = self.files.into_iter().unzip();
        Ok(Linked {
            digest: *blake3::hash(text.as_bytes()).as_bytes(),
            text,
            map,
            declared,
            params,
            blanked: scans.iter().map(|scan| cuts(scan, false)).collect(),
            directives_len,
            files,
            slots_used,
            slots_asked,
        })
    }

    /// Puts each directive once; the length of them all.
    fn put_directives(&self, builder: &mut Builder) -> usize {
        let mut known = Vec::new();
        for (at, (file, scan)) in self.files.iter().enumerate() {
            for range in &scan.directives {
                let words: String = file.text[range.clone()].split_whitespace().collect();
                if !known.contains(&words) {
                    known.push(words);
                    builder.copy(at, &file.text, range.clone());
                    builder.make("\n", at, range.clone());
                }
            }
        }
        builder.text.len()
    }

    fn put_params(&self, builder: &mut Builder) {
        let structs = || {
            let files = self.files.iter().enumerate();
            files.flat_map(|(at, (file, scan))| {
                scan.params
                    .iter()
                    .map(move |params| (at, &file.text, params))
            })
        };
        let Some((first_file, _, first)) = structs().next() else {
            let caller = self.files.iter().position(|(_, scan)| scan.selects_params);
            if let Some(caller) = caller {
                builder.make(NO_PARAMS_TO_SELECT, caller, 0..0);
            }
            return;
        };
        builder.make("struct Params {\n", first_file, first.name.clone());
        for (at, text, params) in structs() {
            for member in &params.members {
                builder.copy(at, text, member.range.clone());
                builder.make(",\n", at, member.range.end..member.range.end);
            }
        }
        let tail = if self.selects_params() {
            params_table(structs().map(|(.., params)| params.members.len()).sum())
        } else {
            "}\n@group(3) @binding(0) var<uniform> params: Params;\n".to_owned()
        };
        builder.make(&tail, first_file, first.name.clone());
    }

    fn selects_params(&self) -> bool {
        self.files.iter().any(|(_, scan)| scan.selects_params)
    }

    /// The members of all `struct Params`; a finding for each name that is there twice.
    fn merge_params(&mut self) -> Vec<MergedParam> {
        let mut merged: Vec<MergedParam> = Vec::new();
        let place = |files: &[(LinkedFile, Scan)], file: usize, range: &Range<usize>| {
            let file = &files[file].0;
            Place::in_text(&file.path, &file.text, range.start, range.len())
        };
        for (at, (file, scan)) in self.files.iter().enumerate() {
            for member in scan.params.iter().flat_map(|params| &params.members) {
                let Some(range) = member.name.clone() else {
                    continue;
                };
                let name = file.text[range.clone()].to_owned();
                if let Some(first) = merged.iter().find(|param| param.name == name) {
                    let files = self.files.iter().map(|(file, _)| file);
                    self.findings.push(
                        Finding::error("params-clash", format!("the parameter `{name}` is declared twice"))
                            .at(place(&self.files, at, &range))
                            .imported_by(import_chain(&files, &file.path))
                            .related(place(&self.files, first.file, &first.range), "first here")
                            .help("the members of all `struct Params` are merged: rename one, or move it to a file that both import"),
                    );
                    continue;
                }
                merged.push(MergedParam {
                    name,
                    file: at,
                    range,
                    docs: member.docs.clone(),
                });
            }
        }
        merged
    }

    fn declared(&self) -> Vec<Declared> {
        let mut declared = Vec::new();
        for (at, (file, scan)) in self.files.iter().enumerate() {
            declared.extend(scan.declarations.iter().map(|declaration| Declared {
                name: file.text[declaration.name.clone()].to_owned(),
                file: at,
                range: declaration.name.clone(),
                docs: declaration.docs.clone(),
                members: declaration.members.clone(),
                is_made: false,
            }));
        }
        let files = self.files.iter().enumerate();
        let first = files
            .flat_map(|(at, (_, scan))| scan.params.iter().map(move |params| (at, params)))
            .next();
        if let Some((file, params)) = first {
            let of_table = ["ParamsRow", "ParamsTable", "params_table", PARAMS_SELECT];
            let of_table = of_table.iter().filter(|_| self.selects_params());
            let names = ["Params", "params"].iter().chain(of_table);
            declared.extend(names.map(|name| Declared {
                name: (*name).to_owned(),
                file,
                range: params.name.clone(),
                docs: Vec::new(),
                members: Vec::new(),
                is_made: true,
            }));
        }
        declared
    }
}

/// What does not stay where it stands in a file, in order.
fn cuts(scan: &Scan, with_params: bool) -> Vec<Range<usize>> {
    let params = scan
        .params
        .iter()
        .filter(|_| with_params)
        .map(|params| &params.range);
    let mut cuts: Vec<Range<usize>> = std::iter::once(&scan.mark)
        .chain(scan.imports.iter().map(|import| &import.range))
        .chain(&scan.directives)
        .chain(params)
        .cloned()
        .collect();
    cuts.sort_by_key(|cut| cut.start);
    cuts
}
