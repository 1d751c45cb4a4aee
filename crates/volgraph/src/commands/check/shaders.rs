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
use volgraph_shader::{LinkRequest, Module, ShaderRoots, check_file, link};

/// Slot → choice.
type Slots = BTreeMap<String, String>;

/// Everything wrong with these shaders.
pub fn check(files: &[&Path], registry: &Registry, folders: &ShaderFolders) -> Findings {
    let mut findings = Findings::new();
    let mut trees: BTreeMap<PathBuf, Tree<'_>> = BTreeMap::new();
    let mut choices = Vec::new();
    for &path in files {
        let folder = tree_of(path);
        let tree = trees
            .entry(folder.clone())
            .or_insert_with(|| Tree::new(&folder, registry, folders));
        match check_file(&tree.roots, path, &tree.slots, Capabilities::default()) {
            Ok(module) => {
                findings.extend(tree.missing_entries(path, &folder, &module));
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
        if let Some(tree) = trees.get_mut(folder) {
            findings.extend(tree.check_choice(choice));
        }
    }
    without_repeats(findings)
}

/// What a choice lacks is told at the choice, and not once more at each place that calls for it.
fn without_repeats(findings: Findings) -> Findings {
    let told: Vec<Place> = (&findings)
        .into_iter()
        .filter(|finding| finding.code == SLOT_FUNCTION)
        .flat_map(|finding| finding.related.iter().map(|(place, _)| place.clone()))
        .collect();
    let is_repeat = |finding: &Finding| {
        finding.code == "wgsl-type"
            && finding
                .place
                .as_ref()
                .is_some_and(|place| told.contains(place))
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

/// The folder above `lib`, `node` or `slot`, and what is known of the shaders in it.
struct Tree<'a> {
    roots: ShaderRoots,
    registry: &'a Registry,
    /// The default choices of all slots.
    slots: Slots,
    /// Slot → the shaders of node kinds, and the other slots' choices, with which it is imported.
    contexts: BTreeMap<String, Vec<LinkRequest>>,
}

impl<'a> Tree<'a> {
    fn new(folder: &Path, registry: &'a Registry, folders: &ShaderFolders) -> Self {
        let own = std::iter::once(folder.to_path_buf())
            .chain(folders.own.iter().cloned())
            .collect();
        let roots = ShaderFolders { own }.roots(None);
        Self {
            roots,
            registry,
            slots: registry.default_slots(),
            contexts: BTreeMap::new(),
        }
    }

    /// A node kind's own shader must have the entry points that the kind runs.
    fn missing_entries(&self, path: &Path, folder: &Path, module: &Module) -> Findings {
        let entries = module.entry_points();
        self.registry
            .nodes()
            .filter_map(|kind| self.registry.default_program(kind.name()))
            .filter(|program| folder.join(program.root) == path)
            .flat_map(|program| program.entries)
            .filter(|entry| entries.iter().all(|known| known.name != *entry))
            .map(|entry| {
                let message = format!("there is no entry point `{entry}`, which its node runs");
                Finding::error("missing-entry", message).at(Place::whole_file(path))
            })
            .collect()
    }

    /// What is wrong with a choice where its slot is imported.
    fn check_choice(&mut self, choice: &Choice) -> Findings {
        if !self.contexts.contains_key(&choice.slot) {
            let contexts = self.contexts(&choice.slot);
            self.contexts.insert(choice.slot.clone(), contexts);
        }
        let mut findings = Findings::new();
        for context in self.contexts.get(&choice.slot).into_iter().flatten() {
            let request = context.clone().slot(&choice.slot, &choice.name);
            let checked = link(&self.roots, &request)
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

    /// The ways to link each kind's shader so that it imports a slot; other slots' choices may be needed for that.
    fn contexts(&self, slot: &str) -> Vec<LinkRequest> {
        let mut contexts = Vec::new();
        for kind in self.registry.nodes() {
            let Some(program) = self.registry.default_program(kind.name()) else {
                continue;
            };
            let mut request = LinkRequest::new(program.root);
            request.slots = kind
                .slots()
                .iter()
                .map(|s| (s.name.to_owned(), s.default.to_owned()))
                .collect();
            request.slots.extend(program.fixed_slots);
            if !request.slots.contains_key(slot) {
                continue;
            }
            let imports = |request: &LinkRequest| {
                link(&self.roots, request).is_ok_and(|linked| linked.slots_used.contains_key(slot))
            };
            let with_another = || {
                let others = request.slots.keys().filter(|other| *other != slot);
                others
                    .flat_map(|other| {
                        self.roots
                            .choices(other)
                            .into_iter()
                            .map(move |choice| (other, choice))
                    })
                    .map(|(other, choice)| request.clone().slot(other, choice))
                    .find(imports)
            };
            contexts.extend(if imports(&request) {
                Some(request)
            } else {
                with_another()
            });
        }
        contexts
    }

    /// A finding about a choice in its slot names the choice.
    fn at_choice(&self, finding: Finding, choice: &Choice) -> Finding {
        let note = || format!("in the slot `{}`", choice.slot);
        let unknown = finding
            .message
            .strip_prefix("no definition in scope for identifier: `")
            .and_then(|rest| rest.split('`').next());
        match (&finding.place, unknown) {
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
            .roots
            .choices(&choice.slot)
            .into_iter()
            .filter(|other| *other != choice.name);
        others.into_iter().any(|other| {
            let path = Path::new("slot")
                .join(&choice.slot)
                .join(format!("{other}.wgsl"));
            check_file(&self.roots, &path, &self.slots, Capabilities::default()).is_ok_and(
                |module| {
                    module
                        .naga
                        .functions
                        .iter()
                        .any(|(_, function)| function.name.as_deref() == Some(name))
                },
            )
        })
    }
}

/// The folder above the nearest `lib`, `node` or `slot`; where there is none, the file's own.
fn tree_of(path: &Path) -> PathBuf {
    let own = path.parent().unwrap_or(Path::new(""));
    let is_part = |folder: &&Path| {
        folder
            .file_name()
            .is_some_and(|name| ["lib", "node", "slot"].iter().any(|part| name == *part))
    };
    let above = own
        .ancestors()
        .find(is_part)
        .and_then(Path::parent)
        .unwrap_or(own);
    if above.as_os_str().is_empty() {
        PathBuf::from(".")
    } else {
        above.to_path_buf()
    }
}

/// Slot and choice of a file `…/slot/<slot>/<choice>.wgsl`.
fn slot_of(path: &Path) -> Option<(String, String)> {
    let slot = path.parent()?;
    if slot.parent()?.file_name()? != "slot" {
        return None;
    }
    Some((
        slot.file_name()?.to_str()?.to_owned(),
        path.file_stem()?.to_str()?.to_owned(),
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_files_tree_and_slot_are_read_from_its_path() {
        let tree = |path: &str| tree_of(Path::new(path)).display().to_string();
        assert_eq!(tree("shaders/slot/light/phong.wgsl"), "shaders");
        assert_eq!(tree("a/lib/deep/ray.wgsl"), "a");
        assert_eq!(tree("node/raycast.wgsl"), ".");
        assert_eq!(tree("loose.wgsl"), ".");
        assert_eq!(tree("a/loose.wgsl"), "a");
        let slot =
            |path: &str| slot_of(Path::new(path)).map(|(slot, choice)| format!("{slot}={choice}"));
        assert_eq!(
            slot("x/slot/light/phong.wgsl").as_deref(),
            Some("light=phong")
        );
        assert_eq!(slot("x/lib/light/phong.wgsl"), None);
        assert_eq!(slot("phong.wgsl"), None);
    }
}
