//! The linker: follows `#import` lines into one WGSL text.
//!
//! Files are visited depth first, each once, imports before the importer; each is scanned for what the linker
//! takes out of it: imports, directives, and every `struct Params`. What a path or a slot's choice leads to is
//! [`crate::lookup`]'s matter, putting the texts together [`crate::assemble`]'s. Findings are collected on the way.

use std::collections::{BTreeMap, HashMap};
use std::path::{Path, PathBuf};

use volgraph_report::{Finding, Findings, Place};

use crate::assemble::assemble;
use crate::lookup::{find_choice, lookup_error, suggest};
use crate::roots::Found;
use crate::scan::{Import, Scan, Target, scan};
use crate::{Linked, LinkedFile, ShaderRoots};

/// The deepest chain of imports.
const MAX_IMPORT_DEPTH: usize = 100;

/// What to link.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct LinkRequest {
    /// The file with the entry points: absolute, or tried under `base`, then in the roots.
    pub root: PathBuf,
    /// Slot → choice: a name, found as `slot/<slot>/<name>.wgsl` in the roots, or a path that ends in `.wgsl`,
    /// tried under `base`, then in the roots.
    pub slots: BTreeMap<String, String>,
    /// The folder that relative paths start from (the graph file's; empty for the current folder).
    pub base: Option<PathBuf>,
}

impl LinkRequest {
    /// Links `root`, found in the roots, with no slots set.
    #[must_use]
    pub fn new(root: impl Into<PathBuf>) -> Self {
        Self {
            root: root.into(),
            ..Self::default()
        }
    }

    /// Sets a slot's choice.
    #[must_use]
    pub fn slot(mut self, slot: impl Into<String>, choice: impl Into<String>) -> Self {
        self.slots.insert(slot.into(), choice.into());
        self
    }

    /// Sets the folder that relative paths start from.
    #[must_use]
    pub fn base(mut self, folder: impl Into<PathBuf>) -> Self {
        self.base = Some(folder.into());
        self
    }
}

/// Links a file with everything it imports.
///
/// # Errors
/// `missing-shader` (the root file), `missing-import`, `import-cycle`, `import-syntax`, `import-depth`,
/// `slot-unset`, `unknown-choice`, `params-clash`, `shader-read`, `too-large`: all there are, each at the
/// author's place.
pub fn link(roots: &ShaderRoots, request: &LinkRequest) -> Result<Linked, Findings> {
    let mut linker = Linker {
        roots,
        request,
        findings: Findings::new(),
        files: Vec::new(),
        seen: HashMap::new(),
        path: Vec::new(),
        slots_used: BTreeMap::new(),
        slots_asked: BTreeMap::new(),
    };
    let folders = roots.folders(request.base.as_deref());
    match roots.find(&folders, &request.root) {
        Ok(found) => linker.visit(found, None),
        Err(not_found) => {
            let finding = lookup_error(
                "missing-shader",
                "the shader",
                &request.root,
                not_found,
                || suggest(roots, &folders, &request.root),
            );
            linker
                .findings
                .push(finding.at(Place::whole_file(&request.root)));
        }
    }
    assemble(
        linker.files,
        linker.slots_used,
        linker.slots_asked,
        linker.findings,
    )
}

/// A file that is being visited.
struct Open {
    canonical: PathBuf,
    display: PathBuf,
    /// Where it is imported; `None` for the root.
    imported: Option<Place>,
}

struct Linker<'a> {
    roots: &'a ShaderRoots,
    request: &'a LinkRequest,
    findings: Findings,
    /// In the order of their text.
    files: Vec<(LinkedFile, Scan)>,
    /// Canonical path → whether its visit is over.
    seen: HashMap<PathBuf, bool>,
    /// From the root to the file being visited.
    path: Vec<Open>,
    slots_used: BTreeMap<String, PathBuf>,
    slots_asked: BTreeMap<String, Vec<Place>>,
}

impl Linker<'_> {
    fn visit(&mut self, found: Found, imported: Option<Place>) {
        let Found {
            canonical,
            display,
            text,
        } = found;
        match self.seen.get(&canonical) {
            Some(true) => return,
            Some(false) => return self.cycle(&canonical, &display, imported),
            None => {}
        }
        if self.path.len() >= MAX_IMPORT_DEPTH {
            let message = format!("imports go more than {MAX_IMPORT_DEPTH} files deep");
            let place = imported.unwrap_or_else(|| Place::whole_file(&display));
            self.tell(Finding::error("import-depth", message).at(place));
            return;
        }
        self.seen.insert(canonical.clone(), false);
        self.path.push(Open {
            canonical: canonical.clone(),
            display: display.clone(),
            imported: imported.clone(),
        });
        let scan = scan(&text);
        for (range, message) in &scan.bad_imports {
            let place = Place::in_text(&display, &text, range.start, range.len());
            self.tell(Finding::error("import-syntax", message).at(place));
        }
        for import in &scan.imports {
            let place = Place::in_text(&display, &text, import.range.start, import.range.len());
            self.import(import, place, &display);
        }
        self.path.pop();
        let digest = *blake3::hash(text.as_bytes()).as_bytes();
        let file = LinkedFile {
            path: display,
            resolved: canonical.clone(),
            digest,
            text,
            imported,
        };
        self.files.push((file, scan));
        self.seen.insert(canonical, true);
    }

    fn import(&mut self, import: &Import, place: Place, importer: &Path) {
        let found = match &import.target {
            Target::File(path) => {
                let path = Path::new(path);
                let folders = self.roots.folders(importer.parent());
                self.roots.find(&folders, path).map_err(|not_found| {
                    let help = || suggest(self.roots, &folders, path);
                    Box::new(lookup_error(
                        "missing-import",
                        "the import",
                        path,
                        not_found,
                        help,
                    ))
                })
            }
            Target::Slot(slot) => {
                self.slots_asked
                    .entry(slot.clone())
                    .or_default()
                    .push(place.clone());
                find_choice(self.roots, self.request, slot).inspect(|found| {
                    self.slots_used.insert(slot.clone(), found.display.clone());
                })
            }
        };
        match found {
            Ok(found) => self.visit(found, Some(place)),
            Err(finding) => self.tell(finding.at(place)),
        }
    }

    /// Keeps a finding about the file being visited.
    fn tell(&mut self, finding: Finding) {
        let open = self.path.iter().rev();
        let chain = open.filter_map(|open| open.imported.clone()).collect();
        self.findings.push(finding.imported_by(chain));
    }

    fn cycle(&mut self, canonical: &Path, display: &Path, imported: Option<Place>) {
        let start = self
            .path
            .iter()
            .position(|open| open.canonical == canonical);
        let cycle = &self.path[start.unwrap_or(0)..];
        let names: Vec<String> = cycle
            .iter()
            .map(|open| open.display.as_path())
            .chain([display])
            .map(|path| format!("`{}`", path.display()))
            .collect();
        let mut finding = Finding::error(
            "import-cycle",
            format!("cyclic import: {}", names.join(" → ")),
        )
        .help("move what both need into a file that imports neither");
        for pair in cycle.windows(2) {
            if let Some(place) = &pair[1].imported {
                let note = format!("imports `{}` here", pair[1].display.display());
                finding = finding.related(place.clone(), note);
            }
        }
        self.findings
            .push(finding.or_at(|| imported.unwrap_or_else(|| Place::whole_file(display))));
    }
}
