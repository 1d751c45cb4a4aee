//! What lies in the repository, as it lies there: a new graph or choice is in every list as soon as it is there.

use std::path::{Path, PathBuf};

use crate::root;

/// The names of a folder's files with this extension, sorted, without it.
///
/// # Panics
/// Where the folder cannot be read.
#[must_use]
pub fn names(folder: impl AsRef<Path>, extension: &str) -> Vec<String> {
    let entries = std::fs::read_dir(root().join(folder)).unwrap();
    let files = entries.map(|entry| entry.unwrap().path());
    let mut names: Vec<String> = files
        .filter(|path| path.extension().is_some_and(|it| it == extension))
        .map(|path| path.file_stem().unwrap().to_str().unwrap().to_owned())
        .collect();
    names.sort();
    names
}

/// volgraph's own choices of a slot.
#[must_use]
pub fn choices(slot: &str) -> Vec<String> {
    names(Path::new("shaders/slot").join(slot), "wgsl")
}

/// The ready graphs that need no file from outside, by name.
#[must_use]
pub fn graphs() -> Vec<String> {
    names("graphs", "ron")
}

/// The ready graphs that draw a scan, by name.
#[must_use]
pub fn scans() -> Vec<String> {
    names("graphs/scans", "ron")
}

/// The file of a ready graph.
///
/// # Panics
/// Where there is none.
#[must_use]
pub fn graph_file(name: &str) -> PathBuf {
    let files =
        ["graphs", "graphs/scans"].map(|folder| root().join(format!("{folder}/{name}.ron")));
    let file = files.into_iter().find(|file| file.is_file());
    file.unwrap_or_else(|| panic!("no ready graph is named {name}"))
}

/// Ready graphs that need no file, by what they show; tests of each group run side by side.
pub const GROUPS: [(&str, &[&str]); 6] = [
    ("solids", SOLIDS),
    ("volumes", VOLUMES),
    ("parts and projections", PARTS_AND_PROJECTIONS),
    ("comparisons", COMPARISONS),
    ("software", SOFTWARE),
    ("renderers", RENDERERS),
];

/// Surfaces, and what is within one.
pub const SOLIDS: &[&str] = &[
    "environment",
    "isosurface",
    "isosurfaces_translucent",
    "matcap",
    "refraction",
    "refraction_surface",
    "shadow",
    "translucency",
    "tricubic",
];

/// Emission and absorption.
pub const VOLUMES: &[&str] = &[
    "comparison",
    "gyroid",
    "hydrogen",
    "image_background",
    "inside",
    "isosurface_dvr",
    "marschner_lobb",
    "materials",
    "orthographic",
    "quickstart",
    "ring_free",
    "volume_shadow",
];

/// Cuts, labels, and what is one number of a ray.
pub const PARTS_AND_PROJECTIONS: &[&str] = &[
    "adaptive",
    "average",
    "clip_box",
    "clip_naive",
    "clip_planes",
    "clip_sphere",
    "clip_volume",
    "minip",
    "mip",
    "samples",
    "segments",
    "xray",
];

/// Pictures of graphs above, held against another.
pub const COMPARISONS: &[&str] = &["difference", "error"];

/// Drawn on the processor: they have no stages.
pub const SOFTWARE: &[&str] = &["shear_warp", "software"];

/// Emission and absorption by other renderers than the raycast, and the limit that it is measured against.
pub const RENDERERS: &[&str] = &["fetch_only", "multipass", "multivolume", "slices"];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_ready_graph_is_in_one_group() {
        let mut known: Vec<&str> = GROUPS
            .iter()
            .flat_map(|(_, names)| names.iter().copied())
            .collect();
        known.sort_unstable();
        assert_eq!(known, graphs(), "add new graphs to a group of this file");
    }
}
