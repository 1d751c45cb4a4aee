//! `volgraph check`: shaders, graphs and transfer functions, without a GPU.
//!
//! The way of the data: paths become files, folders searched for `.wgsl` and `.ron`, each file once; every shader is
//! linked and checked alone with the default choices of the slots it imports, every choice of a slot in its slot as
//! well ([`shaders`]); a `.ron` file is what its fields say, a graph ([`graphs`]), a transfer function or a test case
//! (whose graphs and names must be there). A graph is loaded and planned for what WebGPU guarantees (with filtered floats). Where a volume file is not there, a volume
//! of 2×2×2 voxels stands in for it, and the finding `data-missing` is a warning: shaders and ports are checked
//! wherever the data is. All findings come at once, in the order of their places; errors alone give exit code 1.

pub(super) mod format;
pub mod graphs;
mod shaders;

pub use format::json;

use std::collections::HashSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use volgraph::folders::{search, unreadable};
use volgraph::{Case, Finding, Findings, Place, case, embedded, registry};
use volgraph_nodes::source::segments;
use volgraph_optics::TransferFunction;
use volgraph_report::ron_text::Document;

use crate::args::{CheckArgs, FindingFormat};
use crate::output;

/// A `.ron` file is at most this long.
const MAX_RON_BYTES: u64 = 4 << 20;

pub fn run(args: &CheckArgs) -> anyhow::Result<ExitCode> {
    let mut findings = Findings::new();
    let files = files(&args.paths, &mut findings);
    let registry = registry();
    let folders = args.shaders.folders();
    let is_wgsl = |path: &&PathBuf| {
        path.extension()
            .is_some_and(|extension| extension == "wgsl")
    };
    let wgsl: Vec<&Path> = files.iter().filter(is_wgsl).map(PathBuf::as_path).collect();
    findings.extend(shaders::check(&wgsl, &registry, &folders));
    let graphs = graphs::Checker {
        registry: &registry,
        folders: &folders,
        data: &args.data.data,
    };
    for path in files.iter().filter(|path| !is_wgsl(path)) {
        findings.extend(check_ron(path, &graphs));
    }
    let findings = each_once(shaders::without_repeats(findings));
    match args.format {
        FindingFormat::Human if findings.is_empty() => {}
        FindingFormat::Human => output::report(&findings),
        FindingFormat::Json => output::print_json(&format::json(&findings)),
        FindingFormat::Github if findings.is_empty() => {}
        FindingFormat::Github => output::print(&format::github(&findings)),
    }
    if args.format != FindingFormat::Json {
        output::print(&format::summary(files.len(), &findings));
    }
    Ok(ExitCode::from(u8::from(findings.has_errors())))
}

/// All files that these paths name, sorted, each once.
pub(super) fn files(paths: &[PathBuf], findings: &mut Findings) -> Vec<PathBuf> {
    let mut files = Vec::new();
    for path in paths {
        match fs::metadata(path) {
            Ok(metadata) if metadata.is_dir() => search(
                path,
                &|path| Ok(is_checked(path) && path.is_file()),
                &mut files,
                findings,
            ),
            Ok(_) if is_checked(path) => files.push(path.clone()),
            Ok(_) => findings.push(
                Finding::error(
                    "unknown-file",
                    "only files that end in .wgsl or .ron are checked",
                )
                .at(Place::whole_file(path))
                .help("name a shader, a graph, a transfer function, or a folder of these"),
            ),
            Err(error) => {
                // A graph or transfer function that volgraph carries.
                let embedded = embedded::locate(path);
                if embedded::text(&embedded).is_some() {
                    files.push(embedded);
                } else {
                    findings.push(unreadable(path, &error));
                }
            }
        }
    }
    // As the linker names them: `a.wgsl`, not `./a.wgsl`.
    let mut files: Vec<PathBuf> = files
        .iter()
        .map(|path| path.strip_prefix(".").unwrap_or(path).to_path_buf())
        .collect();
    files.sort();
    let mut seen = HashSet::new();
    files.retain(|path| seen.insert(fs::canonicalize(path).unwrap_or_else(|_| path.clone())));
    files
}

fn is_checked(path: &Path) -> bool {
    path.extension()
        .is_some_and(|extension| extension == "wgsl" || extension == "ron")
}

/// A test case, a graph or a transfer function, by its fields.
fn check_ron(path: &Path, graphs: &graphs::Checker<'_>) -> Findings {
    let text = match read(path) {
        Ok(text) => text,
        Err(finding) => return finding.into(),
    };
    let entries = match Document::parse(path, &text)
        .map_err(Findings::from)
        .and_then(|document| document.fields())
    {
        Ok(entries) => entries,
        Err(findings) => return findings,
    };
    let has = |names: &[&str]| {
        entries
            .iter()
            .any(|entry| names.contains(&entry.name.as_str()))
    };
    if case::is_case(entries.iter().map(|entry| entry.name.as_str())) {
        match Case::parse(path, &text) {
            Ok(case) => case.check(),
            Err(findings) => findings,
        }
    } else if has(&["nodes", "sources", "outputs"]) {
        graphs.check(path, text)
    } else if has(&["points", "color", "opacity", "extinction", "domain"]) {
        TransferFunction::parse(path, &text)
            .err()
            .unwrap_or_default()
    } else if has(&["segments", "others"]) {
        let folders = embedded::folders(path, graphs.data);
        segments::parse(path, &text, &folders)
            .err()
            .unwrap_or_default()
    } else {
        Finding::error("unknown-file", "this is neither a graph, nor a transfer function, nor segments, nor a test case")
            .at(Place::whole_file(path))
            .help("a graph has `nodes` and `outputs`; segments have `segments`; a transfer function has `points`, or `color` and `opacity`; a test case has `test: 1`")
            .into()
    }
}

/// The text of a RON file of bearable length.
pub fn read(path: &Path) -> Result<String, Finding> {
    if let Some(text) = embedded::text(path) {
        return Ok(text.to_owned());
    }
    let metadata = fs::metadata(path).map_err(|error| unreadable(path, &error))?;
    if !metadata.is_file() {
        // Reading a pipe or a device might never end.
        let error = std::io::Error::other("it is no plain file");
        return Err(unreadable(path, &error));
    }
    if metadata.len() > MAX_RON_BYTES {
        return Err(
            Finding::error("too-large", "a RON file of more than 4 MiB is refused")
                .at(Place::whole_file(path)),
        );
    }
    fs::read_to_string(path).map_err(|error| unreadable(path, &error))
}

/// A library's fault is found again with each file that imports it, in words that differ by the folders searched.
fn each_once(findings: Findings) -> Findings {
    let mut seen = HashSet::new();
    let mut is_new = |finding: &Finding| {
        let is_exact = finding.place.as_ref().is_some_and(|place| place.line > 0);
        let message = if is_exact {
            String::new()
        } else {
            finding.message.clone()
        };
        seen.insert((finding.code, message, finding.place.clone()))
    };
    findings
        .into_iter()
        .filter(|finding| is_new(finding))
        .collect()
}
