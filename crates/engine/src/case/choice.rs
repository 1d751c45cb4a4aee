//! The slot's choice that a case tests: where its shader is, and what it declares itself.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use volgraph_report::{Finding, Findings, Place, did_you_mean};
use volgraph_shader::{Linked, ShaderRoots};

use super::{Case, CaseOptions, SlotUnderTest};
use crate::ShaderFolders;

/// Folders above the case's that are looked at for a shader.
const MAX_ABOVE: usize = 16;

impl Case {
    /// The folders of shaders: those of the options, then the nearest folder at or above the case's own that holds a
    /// slot under test.
    pub(super) fn shader_folders(&self, options: &CaseOptions) -> ShaderFolders {
        let mut folders = options.shader_folders.clone();
        let own = std::path::absolute(&self.file).unwrap_or_else(|_| self.file.clone());
        for slot in &self.slots {
            let file = slot.file();
            let holds = |folder: &&Path| folder.join(&file).is_file();
            let above = own.ancestors().skip(1).take(MAX_ABOVE).find(holds);
            let above = above.map(|folder| shortest(folder, &self.file));
            let is_new = |folder: &PathBuf| !folders.own.contains(folder);
            let new = above.filter(is_new);
            folders.own.extend(new);
        }
        folders
    }

    /// Where its shaders are looked for.
    pub(super) fn shader_roots(&self, options: &CaseOptions) -> ShaderRoots {
        let is_carried = volgraph_graph::is_embedded(&self.graph.path);
        let folder = self.graph.path.parent().filter(|_| !is_carried);
        self.shader_folders(options).roots(folder)
    }

    /// Whether the slots under test and their choices are there.
    pub(super) fn check_slots(&self, kind: Option<&str>, options: &CaseOptions) -> Findings {
        let registry = crate::registry();
        let mut findings = Findings::new();
        let Some(kind) = kind.and_then(|kind| registry.node(kind)) else {
            return findings;
        };
        let roots = self.shader_roots(options);
        for slot in &self.slots {
            let names: Vec<&str> = kind.slots().iter().map(|spec| spec.name).collect();
            if !names.contains(&slot.slot.as_str()) {
                let message = format!("`{}` has no slot `{}`", kind.name(), slot.slot);
                findings.push(
                    Finding::error("unknown-slot", message)
                        .at(slot.place.clone())
                        .help_opt(did_you_mean(&slot.slot, names)),
                );
                continue;
            }
            let choices = roots.choices(&slot.slot);
            // A path names its own file.
            if !slot.choice.ends_with(".wgsl") && !choices.contains(&slot.choice) {
                let message = format!("there is no {}", slot.file().display());
                let near = did_you_mean(&slot.choice, choices.iter().map(String::as_str));
                findings.push(
                    Finding::error("unknown-choice", message)
                        .at(slot.place.clone())
                        .help_opt(near),
                );
            }
        }
        findings
    }
}

impl SlotUnderTest {
    /// Its shader, from a folder of shaders.
    fn file(&self) -> PathBuf {
        PathBuf::from(format!("slot/{}/{}.wgsl", self.slot, self.choice))
    }
}

/// The folder as one would name it from where the case is named: findings tell paths as users write them.
fn shortest(folder: &Path, case: &Path) -> PathBuf {
    let near = case.ancestors().skip(1).find(|above| {
        std::path::absolute(if above.as_os_str().is_empty() {
            Path::new(".")
        } else {
            above
        })
        .is_ok_and(|above| above == folder)
    });
    match near {
        Some(near) if near.as_os_str().is_empty() => PathBuf::from("."),
        Some(near) => near.to_path_buf(),
        None => folder.to_path_buf(),
    }
}

/// The file that a link is about, which comes last, and the libraries that it imports by itself: not by way of slots.
pub(super) fn own_files(linked: &Linked) -> Vec<&Path> {
    let Some(root) = linked.files.last() else {
        return Vec::new();
    };
    let mut own = vec![root];
    let mut next = 0;
    while next < own.len() {
        let imports = own[next].text.lines().filter_map(imported);
        for import in imports {
            let found = linked.files.iter().find(|file| file.path.ends_with(import));
            // Paths of one file are equal, however it was reached.
            own.extend(found.filter(|found| own.iter().all(|file| file.path != found.path)));
        }
        next += 1;
    }
    own.into_iter().map(|file| file.path.as_path()).collect()
}

/// The file that a line imports by its name.
fn imported(line: &str) -> Option<&str> {
    let rest = line.trim().strip_prefix("#import \"")?;
    rest.split('"').next()
}

pub(super) fn unknown_param(
    name: &str,
    known: &BTreeSet<&str>,
    slot: &SlotUnderTest,
    place: &Place,
) -> Finding {
    let message = format!("{} has no parameter `{name}`", slot.file().display());
    Finding::error("unknown-param", message)
        .at(place.clone())
        .help_opt(did_you_mean(name, known.iter().copied()))
}
