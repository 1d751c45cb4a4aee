//! Changes of a graph written back into its file.
//!
//! The way of the data: [`Overrides::edits`] turns what the command line, or a viewer, has set into [`Edit`]s of the
//! graph's text, [`apply_edits`] makes them there, and [`save_text`] puts the new text in the place of the old one.
//! [`moved`] is what else changes where the text goes to another folder: paths start at the folder of their graph.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use volgraph_graph::{Edit, GraphDesc, apply_edits, is_embedded, read};
use volgraph_report::{Finding, Findings, Place};
use volgraph_shader::ParamValue;

use crate::embedded;
use crate::overrides::{Overrides, ParamOverride, TIME, VOLUME, volume_source};
use crate::renderer::RENDERER;
use crate::scene::{folder_of, read_text};

impl From<&ParamOverride> for Edit {
    fn from(set: &ParamOverride) -> Self {
        let (target, name, value) = (set.target.clone(), set.name.clone(), set.value.clone());
        if set.is_slot {
            return Self::Slot {
                node: target,
                slot: name,
                choice: Some(value),
            };
        }
        Self::Param {
            target,
            name,
            value: Some(value),
        }
    }
}

impl Overrides {
    /// What they change in the text of a graph. Volumes are named from the graph's folder where they lie below it.
    ///
    /// # Errors
    /// `ambiguous-volume`; `bad-edit` for `renderer`, which is no parameter that a graph holds.
    pub fn edits(&self, graph: &Path, desc: &GraphDesc) -> Result<Vec<Edit>, Findings> {
        let mut findings = Findings::new();
        let mut edits = Vec::new();
        for (name, file) in &self.volumes {
            let place = Place::whole_file(format!("--volume {}", file.display()));
            if let Some(source) = findings.take(volume_source(desc, name, &place)) {
                let path = from_folder(&folder_of(graph), file);
                edits.push(Edit::Volume { source, path });
            }
        }
        if let Some(time) = self.time {
            let volumes = desc
                .sources
                .iter()
                .filter(|(_, source)| source.kind == VOLUME);
            edits.extend(volumes.map(|(name, _)| Edit::Param {
                target: name.clone(),
                name: TIME.to_owned(),
                value: Some(ParamValue::Int(time.into())),
            }));
        }
        for set in &self.params {
            let is_renderer = set.name == RENDERER && !set.is_slot;
            if is_renderer && desc.nodes.contains_key(&set.target) {
                let message = "`renderer` is a word of the command line, not a parameter of a node";
                findings.push(
                    Finding::error("bad-edit", message)
                        .at(set.place())
                        .help("change the node's `kind` in the graph to `software_raycast`"),
                );
                continue;
            }
            edits.push(set.into());
        }
        edits.extend(
            self.camera
                .iter()
                .map(|camera| Edit::Camera(Some(camera.to_ron()))),
        );
        findings.into_result(edits)
    }
}

/// A file's path as a graph in a folder names it.
fn from_folder(folder: &Path, file: &Path) -> String {
    let absolute = std::path::absolute(file).unwrap_or_else(|_| file.to_path_buf());
    let folder = std::path::absolute(folder).unwrap_or_else(|_| folder.to_path_buf());
    let below = absolute.strip_prefix(folder).unwrap_or(&absolute);
    below.display().to_string()
}

/// What a graph's text must change so that it draws the same from another file: paths of sources and shaders that are found
/// beside the graph, and not beside the other.
///
/// # Errors
/// What is wrong with the text.
pub fn moved(text: &str, from: &Path, to: &Path) -> Result<Vec<Edit>, Findings> {
    let desc = read::graph(from, text)?;
    let (from, to) = (from.parent().unwrap_or(Path::new("")), folder_of(to));
    let real = |path: &Path| path.canonicalize().ok();
    let there = |path: &str| -> Option<String> {
        let file = from.join(path);
        if is_embedded(Path::new(path)) || Path::new(path).is_absolute() {
            return None;
        }
        if is_embedded(&file) {
            return embedded::is_carried(&file).then(|| file.display().to_string());
        }
        let is_same = real(&file) == real(&to.join(path));
        (file.exists() && !is_same).then(|| from_folder(&to, &file))
    };
    let mut edits = Vec::new();
    for (name, source) in &desc.sources {
        let Some(ParamValue::Text(path)) = source.params.get("path").map(|param| &param.value)
        else {
            continue;
        };
        edits.extend(there(path).map(|path| Edit::Param {
            target: name.clone(),
            name: "path".to_owned(),
            value: Some(ParamValue::Text(path)),
        }));
    }
    for (name, node) in &desc.nodes {
        for (slot, choice) in &node.slots {
            let ParamValue::Text(path) = &choice.value else {
                continue;
            };
            let path = path.ends_with(".wgsl").then(|| there(path)).flatten();
            edits.extend(path.map(|path| Edit::Slot {
                node: name.clone(),
                slot: slot.clone(),
                choice: Some(ParamValue::Text(path)),
            }));
        }
    }
    Ok(edits)
}

/// The text of a graph with edits made in it, as it is to stand in `to`, another file or its own.
///
/// # Errors
/// `embedded-graph` where `to` is no file on a disk; else as [`apply_edits`].
pub fn edited(text: &str, graph: &Path, edits: &[Edit], to: &Path) -> Result<String, Findings> {
    if is_embedded(to) {
        let name = to.file_stem().unwrap_or_default().to_string_lossy();
        let message =
            format!("`{name}` is volgraph's own graph, which is no file that can be written");
        return Err(Finding::error("embedded-graph", message)
            .at(Place::whole_file(to))
            .help(format!(
                "write it to a file of your own with `-o FILE.ron`, or copy it first: `volgraph graphs {name} --write`"
            ))
            .into());
    }
    let text = apply_edits(text, graph, edits)?;
    if graph == to {
        return Ok(text);
    }
    let moved = moved(&text, graph, to)?;
    apply_edits(&text, graph, &moved)
}

/// A graph's text, from the disk or from within the program.
///
/// # Errors
/// `io`, or `not-a-graph`.
pub fn graph_text(path: &Path) -> Result<String, Findings> {
    read_text(path)
}

/// Puts a text in the place of a file, as a whole: an interrupt leaves the old text or the new one. Links stay links,
/// permissions stay as they are. `before` is what the file was read as; where somebody else has written it since, it stays.
///
/// # Errors
/// `io`, or `changed-meanwhile`.
pub fn save_text(path: &Path, before: Option<&str>, text: &str) -> Result<(), Findings> {
    let failed = |error: std::io::Error| {
        Finding::error("io", format!("it cannot be written: {error}"))
            .at(Place::whole_file(path))
            .help("check the folder and your permissions")
    };
    // The file that a link leads to, not the link.
    let target: PathBuf = path.canonicalize().unwrap_or_else(|_| path.to_path_buf());
    let metadata = fs::metadata(&target).ok();
    if metadata
        .as_ref()
        .is_some_and(|metadata| !metadata.is_file())
    {
        return Err(failed(std::io::Error::other("it is no plain file")).into());
    }
    if let Some(before) = before
        && fs::read(&target).map_err(failed)? != before.as_bytes()
    {
        let message = "the file has changed since it was read, and is left as it is";
        return Err(Finding::error("changed-meanwhile", message)
            .at(Place::whole_file(path))
            .help("look at what changed, and try again")
            .into());
    }
    if metadata
        .as_ref()
        .is_some_and(|metadata| metadata.permissions().readonly())
    {
        return Err(failed(std::io::ErrorKind::PermissionDenied.into()).into());
    }
    let write = || {
        let mut builder = tempfile::Builder::new();
        // As any new file: what the user's mask leaves of this.
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        let mut part = builder
            .prefix(".volgraph-")
            .tempfile_in(folder_of(&target))?;
        part.write_all(text.as_bytes())?;
        if let Some(metadata) = &metadata {
            part.as_file().set_permissions(metadata.permissions())?;
        }
        part.as_file().sync_all()?;
        part.persist(&target)?;
        Ok(())
    };
    Ok(write().map_err(failed)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_replaced_behind_its_link_with_its_permissions() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("a.ron");
        fs::write(&file, "old").unwrap();
        let link = folder.path().join("link.ron");
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            fs::set_permissions(&file, fs::Permissions::from_mode(0o640)).unwrap();
            std::os::unix::fs::symlink(&file, &link).unwrap();
        }
        #[cfg(not(unix))]
        fs::copy(&file, &link).unwrap();
        save_text(&link, Some("old"), "new").unwrap();
        assert_eq!(fs::read_to_string(&link).unwrap(), "new");
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            assert_eq!(fs::read_to_string(&file).unwrap(), "new");
            assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
            assert_eq!(
                fs::metadata(&file).unwrap().permissions().mode() & 0o777,
                0o640
            );
        }
        let stale = save_text(&link, Some("old"), "newer").unwrap_err();
        assert_eq!(stale.sorted()[0].code, "changed-meanwhile");
        assert_eq!(fs::read_to_string(&link).unwrap(), "new");
        assert_eq!(
            save_text(folder.path(), None, "x").unwrap_err().sorted()[0].code,
            "io"
        );
    }

    #[test]
    fn a_ready_graph_is_written_elsewhere_alone_and_finds_its_files_there() {
        let graph = Path::new("embedded:/graphs/quickstart.ron");
        let text = embedded::text(graph).unwrap();
        let set = ParamOverride::parse("image.step=0.5").unwrap();
        let edits = [Edit::from(&set)];
        let refused = edited(text, graph, &edits, graph).unwrap_err();
        assert_eq!(refused.sorted()[0].code, "embedded-graph");
        let written = edited(text, graph, &edits, Path::new("mine/q.ron")).unwrap();
        let wanted = text
            .replace("\"step\": 1.0", "\"step\": 0.5")
            .replace("\"transfer/mol", "\"embedded:/graphs/transfer/mol");
        assert_eq!(written, wanted);
    }

    #[test]
    fn edits_mean_what_overrides_mean() {
        let graph = Path::new("embedded:/graphs/quickstart.ron");
        let text = embedded::text(graph).unwrap();
        let sets = [
            "image.step=2",
            "image.slots.light=unlit",
            "molecule.type=uint16",
        ];
        let overrides = Overrides {
            params: sets.map(|set| ParamOverride::parse(set).unwrap()).into(),
            camera: Some(read::camera_text(graph, "orbit(azimuth: 7)").unwrap()),
            ..Overrides::default()
        };
        let mut desc = read::graph(graph, text).unwrap();
        let edits = overrides.edits(graph, &desc).unwrap();
        overrides.apply(&mut desc).unwrap();
        let after = read::graph(graph, &apply_edits(text, graph, &edits).unwrap()).unwrap();
        assert_eq!(after.camera, desc.camera);
        let values = |desc: &GraphDesc| {
            let image = &desc.nodes["image"];
            let all = image.params.iter().chain(&image.slots);
            let all = all.chain(&desc.sources["molecule"].params);
            let all = all.map(|(name, param)| format!("{name} {}", param.value));
            all.collect::<Vec<_>>()
        };
        assert_eq!(values(&after), values(&desc));
    }
}
