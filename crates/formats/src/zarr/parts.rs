//! What there is in a Zarr folder to be read: images of OME-Zarr with their labels, and arrays.

use std::path::Path;

use serde_json::{Map, Value};
use volgraph_volume::{Trouble, VolumeError};

use super::metadata::{Node, inside, node};
use super::ome;

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
pub(super) fn find(folder: &Path, name: Option<&str>) -> Result<Part, VolumeError> {
    let mut parts = Vec::new();
    let mut looked = 0;
    collect(folder, "", 0, &mut looked, &mut parts)?;
    let choice = |cause: String, of: &[Part]| {
        let names: Vec<&str> = of
            .iter()
            .map(|part| part.path.as_str())
            .filter(|path| !path.is_empty())
            .collect();
        let some = names
            .iter()
            .take(20)
            .copied()
            .collect::<Vec<_>>()
            .join(", ");
        let more = if names.len() > 20 { " and more" } else { "" };
        VolumeError::Option(Trouble::new(
            cause,
            if names.is_empty() {
                "leave the option out".to_owned()
            } else {
                format!("name one with the option `part`: {some}{more}")
            },
        ))
    };
    if parts.is_empty() {
        return Err(VolumeError::MissingField(Trouble::new(
            "this Zarr group has no array and no image",
            "give a folder with arrays in it, or fetch the whole folder again",
        )));
    }
    let Some(name) = name else {
        let main: Vec<&Part> = parts.iter().filter(|part| !part.is_label).collect();
        return match (main.as_slice(), parts.as_slice()) {
            ([one], _) => Ok((*one).clone()),
            ([], [one]) => Ok(one.clone()),
            _ => Err(choice(
                format!("this Zarr group has {} arrays or images", parts.len()),
                &parts,
            )),
        };
    };
    let name = name.trim_matches('/');
    if let Some(part) = parts.iter().find(|part| part.path == name) {
        return Ok(part.clone());
    }
    let having: Vec<Part> = parts
        .iter()
        .filter(|part| part.path.contains(name))
        .cloned()
        .collect();
    match having.as_slice() {
        [one] => Ok(one.clone()),
        [] => Err(choice(format!("there is no part {name:?}"), &parts)),
        several => Err(choice(
            format!("{} parts have {name:?} in their names", several.len()),
            several,
        )),
    }
}

fn collect(
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
    let found = match node(&folder) {
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
        if let Ok(Some(Node::Group { attributes, .. })) = node(&inside(root, &labels)?) {
            for name in ome::listed_labels(&attributes) {
                let path = format!("{labels}/{name}");
                if let Ok(folder) = inside(root, &path)
                    && let Ok(Some(Node::Group { attributes, .. })) = node(&folder)
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
    let unreadable = |error: std::io::Error| {
        VolumeError::Unreadable(Trouble::new(
            format!("cannot be listed: {error}"),
            "check its permissions",
        ))
        .in_file(&folder)
    };
    let mut names = Vec::new();
    for entry in std::fs::read_dir(&folder).map_err(unreadable)? {
        let entry = entry.map_err(unreadable)?;
        if entry.path().is_dir()
            && let Some(name) = entry.file_name().to_str()
        {
            names.push(name.to_owned());
        }
        if names.len() > MOST_FOLDERS {
            break;
        }
    }
    alphanumeric_sort::sort_str_slice(&mut names);
    for name in names {
        if *looked >= MOST_FOLDERS {
            break;
        }
        collect(root, &below(&name), depth + 1, looked, parts)?;
    }
    Ok(())
}
