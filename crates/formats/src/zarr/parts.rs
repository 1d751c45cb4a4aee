//! What there is in a Zarr folder to be read: images of OME-Zarr with their labels, and arrays.

use std::path::Path;

use serde_json::{Map, Value};
use volgraph_volume::{Trouble, VolumeError};

use super::metadata::{Node, inside, node};
use super::ome;
use super::store::Store;
use crate::choice::{Candidate, choose};

/// Deepest level of groups that are looked into, and most folders that are looked at.
const DEEPEST: usize = 4;
const MOST_FOLDERS: usize = 4096;

/// Something that can be read.
#[derive(Clone, Debug)]
pub(super) struct Part {
    /// From the folder on; empty for the folder itself.
    pub path: String,
    /// The attributes of an image; `None` for a plain array.
    pub image: Option<Map<String, Value>>,
    pub is_label: bool,
}

/// The part that is named, or the one that is meant where nothing is: the only one, or the image that is no label.
pub(super) fn find(store: &Store, folder: &Path, name: Option<&str>) -> Result<Part, VolumeError> {
    let mut parts = Vec::new();
    let mut looked = 0;
    collect(store, folder, "", 0, &mut looked, &mut parts)?;
    if parts.is_empty() {
        return Err(VolumeError::MissingField(Trouble::new(
            "this Zarr group has no array and no image",
            "give a folder with arrays in it, or fetch the whole folder again",
        )));
    }
    let candidates: Vec<Candidate<'_>> = parts
        .iter()
        .map(|part| Candidate {
            path: &part.path,
            main: !part.is_label,
        })
        .collect();
    let chosen = choose(&candidates, name, "arrays or images in this Zarr group")?;
    Ok(parts.swap_remove(chosen))
}

fn collect(
    store: &Store,
    root: &Path,
    path: &str,
    depth: usize,
    looked: &mut usize,
    parts: &mut Vec<Part>,
) -> Result<(), VolumeError> {
    *looked += 1;
    let part = |image| Part {
        path: path.to_owned(),
        image,
        is_label: path.split('/').any(|name| name == "labels"),
    };
    let below = |name: &str| {
        if path.is_empty() {
            name.to_owned()
        } else {
            format!("{path}/{name}")
        }
    };
    let folder = inside(root, path)?;
    let found = match node(store, &folder) {
        // One array that is not read (of text, of dates) does not spoil its neighbours: who names it is told why.
        Err(_) if depth > 0 => {
            parts.push(part(None));
            return Ok(());
        }
        found => found?,
    };
    let attributes = match found {
        Some(Node::Array(_)) => {
            parts.push(part(None));
            return Ok(());
        }
        Some(Node::Group { attributes, .. }) => attributes,
        None => return Ok(()),
    };
    if ome::is_image(&attributes) {
        parts.push(part(Some(attributes)));
        // Its arrays are levels; labels are images of their own.
        let labels = below("labels");
        if let Ok(Some(Node::Group { attributes, .. })) = node(store, &inside(root, &labels)?) {
            for name in ome::listed_labels(&attributes) {
                let path = format!("{labels}/{name}");
                if let Ok(folder) = inside(root, &path)
                    && let Ok(Some(Node::Group { attributes, .. })) = node(store, &folder)
                    && ome::is_image(&attributes)
                {
                    parts.push(Part {
                        path,
                        image: Some(attributes),
                        is_label: true,
                    });
                }
            }
        }
        return Ok(());
    }
    if depth >= DEEPEST {
        return Ok(());
    }
    let mut names = store.folders(&folder, MOST_FOLDERS)?;
    alphanumeric_sort::sort_str_slice(&mut names);
    for name in names {
        if *looked >= MOST_FOLDERS {
            break;
        }
        collect(store, root, &below(&name), depth + 1, looked, parts)?;
    }
    Ok(())
}
