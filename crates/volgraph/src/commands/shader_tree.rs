//! The tree that a shader lies in, and how the node kinds link what is in it.
//!
//! A tree is the folder above `lib`, `node` or `slot`. It is searched first, so that a copy of volgraph's shaders is
//! checked against itself. A slot's choice means something only where its slot is imported: from a node kind's own
//! shader down, where other slots' choices may be needed to get there.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use volgraph::{Registry, ShaderFolders};
use volgraph_graph::NodeKind;
use volgraph_shader::{LinkRequest, ShaderRoots, link};

/// A tree of shaders, and what is known of it.
pub struct Tree<'a> {
    /// Where its files are looked up.
    pub roots: ShaderRoots,
    pub registry: &'a Registry,
    /// The default choices of all slots.
    pub slots: BTreeMap<String, String>,
}

impl<'a> Tree<'a> {
    /// The tree of `folder`, with the user's own folders behind it.
    pub fn new(folder: &Path, registry: &'a Registry, folders: &ShaderFolders) -> Self {
        let own = std::iter::once(folder.to_path_buf())
            .chain(folders.own.iter().cloned())
            .collect();
        Self {
            roots: ShaderFolders { own }.roots(None),
            registry,
            slots: registry.default_slots(),
        }
    }

    /// A kind's own shader, with the default choices of its slots; `None` for a kind that has no shader.
    pub fn of_kind(&self, kind: &dyn NodeKind) -> Option<LinkRequest> {
        let program = self.registry.default_program(kind.name())?;
        let mut request = LinkRequest::new(program.root);
        request.slots = kind
            .slots()
            .iter()
            .map(|s| (s.name.to_owned(), s.default.to_owned()))
            .collect();
        request.slots.extend(program.fixed_slots);
        Some(request)
    }

    /// A kind's own shader, linked so that it imports this slot; other slots' choices may be needed for that. `None`
    /// where the kind has no such slot, or never imports it.
    pub fn importing(&self, kind: &dyn NodeKind, slot: &str) -> Option<LinkRequest> {
        let request = self.of_kind(kind)?;
        if !request.slots.contains_key(slot) {
            return None;
        }
        let imports = |request: &LinkRequest| {
            link(&self.roots, request).is_ok_and(|linked| linked.slots_used.contains_key(slot))
        };
        if imports(&request) {
            return Some(request);
        }
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
    }
}

/// The folder above the nearest `lib`, `node` or `slot`; where there is none, the file's own.
pub fn tree_of(path: &Path) -> PathBuf {
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
pub fn slot_of(path: &Path) -> Option<(String, String)> {
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
