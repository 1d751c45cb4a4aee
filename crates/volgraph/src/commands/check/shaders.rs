//! Checks shaders: each alone, and each choice of a slot where that slot is imported.
//!
//! Alone, a file is linked with the default choices of the slots that it imports. That does not show whether a
//! choice has the functions that its slot asks for, so each is linked a second time, from the node kinds' own
//! shaders down, with other slots chosen so that its slot is really imported. Files are looked up first in the tree
//! that they lie in (the folder above `lib`, `node` or `slot`), so that a copy is checked against itself.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use naga::valid::Capabilities;
use volgraph::{Finding, Findings, Place, Registry, ShaderFolders};
use volgraph_shader::{DECLARED_HERE, LinkRequest, Module, check_file, link};

use crate::commands::shader_tree::{Tree, slot_of, tree_of};

/// Everything wrong with these shaders.
pub fn check(files: &[&Path], registry: &Registry, folders: &ShaderFolders) -> Findings {
    let mut findings = Findings::new();
    let mut checkers: BTreeMap<PathBuf, Checker<'_>> = BTreeMap::new();
    let mut choices = Vec::new();
    for &path in files {
        let folder = tree_of(path);
        let checker = checkers
            .entry(folder.clone())
            .or_insert_with(|| Checker::new(&folder, registry, folders));
        let tree = &checker.tree;
        match check_file(&tree.roots, path, &tree.slots, Capabilities::default()) {
            Ok(module) => {
                findings.extend(checker.missing_entries(path, &folder, &module));
                if let (Some((slot, choice)), Some(file)) =
                    (slot_of(path), module.linked.files.last())
                {
                    let place = Place::in_text(&file.path, &file.text, 0, file.text.len());
                    choices.push((
                        folder,
                        Choice {
                            slot,
                            name: choice,
                            place,
                        },
                    ));
                }
            }
            Err(found) => findings.extend(found),
        }
    }
    for (folder, choice) in &choices {
        if let Some(checker) = checkers.get_mut(folder) {
            findings.extend(checker.check_choice(choice));
        }
    }
    findings
}

/// What a choice lacks is told at the choice, and not once more at each place that calls for it.
pub fn without_repeats(findings: Findings) -> Findings {
    let told: Vec<Place> = (&findings)
        .into_iter()
        .filter(|finding| finding.code == SLOT_FUNCTION)
        .flat_map(|finding| {
            // Where it is called, and where it is declared: others call it as wrongly.
            let called = finding.related.iter().map(|(place, _)| place.clone());
            called.chain(finding.place.clone())
        })
        .collect();
    let is_told = |place: &Place| told.contains(place);
    let is_repeat = |finding: &Finding| {
        ["wgsl-type", "wgsl-validation"].contains(&finding.code)
            && (finding.place.as_ref().is_some_and(is_told)
                || finding.related.iter().any(|(place, _)| is_told(place)))
    };
    findings
        .into_iter()
        .filter(|finding| !is_repeat(finding))
        .collect()
}

const SLOT_FUNCTION: &str = "slot-function";

/// A file that fills a slot, and its first line.
struct Choice {
    slot: String,
    name: String,
    place: Place,
}

/// A tree, and how its slots are imported.
struct Checker<'a> {
    tree: Tree<'a>,
    /// Slot → the ways to link each kind's shader so that it imports the slot.
    contexts: BTreeMap<String, Vec<LinkRequest>>,
}

impl<'a> Checker<'a> {
    fn new(folder: &Path, registry: &'a Registry, folders: &ShaderFolders) -> Self {
        Self {
            tree: Tree::new(folder, registry, folders),
            contexts: BTreeMap::new(),
        }
    }

    /// A node kind's own shader must have the entry points that the kind runs.
    fn missing_entries(&self, path: &Path, folder: &Path, module: &Module) -> Findings {
        let entries = module.entry_points();
        let registry = self.tree.registry;
        registry
            .nodes()
            .filter_map(|kind| registry.default_program(kind.name()))
            .filter(|program| folder.join(program.root) == path)
            .flat_map(|program| program.entries)
            .filter(|entry| entries.iter().all(|known| known.name != *entry))
            .map(|entry| module.missing_entry(entry))
            .collect()
    }

    /// What is wrong with a choice where its slot is imported.
    fn check_choice(&mut self, choice: &Choice) -> Findings {
        if !self.contexts.contains_key(&choice.slot) {
            let kinds = self.tree.registry.nodes();
            let contexts = kinds
                .filter_map(|kind| self.tree.importing(kind.as_ref(), &choice.slot))
                .collect();
            self.contexts.insert(choice.slot.clone(), contexts);
        }
        let mut findings = Findings::new();
        for context in self.contexts.get(&choice.slot).into_iter().flatten() {
            let request = context.clone().slot(&choice.slot, &choice.name);
            let checked = link(&self.tree.roots, &request)
                .and_then(|linked| volgraph_shader::check(linked, Capabilities::default()));
            let Err(found) = checked else { continue };
            findings.extend(
                found
                    .into_iter()
                    .map(|finding| self.at_choice(finding, choice)),
            );
        }
        findings
    }

    /// A finding about a choice in its slot names the choice.
    fn at_choice(&self, finding: Finding, choice: &Choice) -> Finding {
        let note = || format!("in the slot `{}`", choice.slot);
        let unknown = finding
            .message
            .strip_prefix("no definition in scope for identifier: `")
            .and_then(|rest| rest.split('`').next());
        let declared = finding
            .related
            .iter()
            .find(|(place, note)| note == DECLARED_HERE && place.file == choice.place.file);
        match (&finding.place, unknown) {
            (Some(place), None) if place.file != choice.place.file && declared.is_some() => {
                let message = format!(
                    "the slot `{}` calls it otherwise than it is declared: {}",
                    choice.slot, finding.message
                );
                let declared = declared.map(|(place, _)| place.clone());
                Finding::error(SLOT_FUNCTION, message)
                    .at(declared.unwrap_or_else(|| choice.place.clone()))
                    .related(place.clone(), "called here")
                    .help(format!(
                        "declare it as the other choices in `slot/{}` do",
                        choice.slot
                    ))
            }
            (Some(place), Some(name))
                if place.file != choice.place.file && self.others_declare(choice, name) =>
            {
                let message = format!(
                    "the slot `{}` asks for `{name}`, which is not declared here",
                    choice.slot
                );
                Finding::error(SLOT_FUNCTION, message)
                    .at(choice.place.clone())
                    .related(place.clone(), "called here")
                    .help(format!(
                        "declare it as the other choices in `slot/{}` do",
                        choice.slot
                    ))
            }
            (Some(place), _) if place.file != choice.place.file => {
                finding.related(choice.place.clone(), note())
            }
            _ => finding,
        }
    }

    /// Whether another choice of the same slot declares a function of this name.
    fn others_declare(&self, choice: &Choice, name: &str) -> bool {
        let others = self
            .tree
            .roots
            .choices(&choice.slot)
            .into_iter()
            .filter(|other| *other != choice.name);
        others.into_iter().any(|other| {
            let path = Path::new("slot")
                .join(&choice.slot)
                .join(format!("{other}.wgsl"));
            check_file(
                &self.tree.roots,
                &path,
                &self.tree.slots,
                Capabilities::default(),
            )
            .is_ok_and(|module| {
                module
                    .naga
                    .functions
                    .iter()
                    .any(|(_, function)| function.name.as_deref() == Some(name))
            })
        })
    }
}
