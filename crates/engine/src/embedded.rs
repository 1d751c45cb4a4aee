//! What volgraph carries within itself: its shaders, and the ready graphs with their transfer functions and images.
//!
//! The way of the data: a user names a graph; [`locate`] makes a path of it, the file on disk where there is one, else
//! `embedded:/graphs/NAME.ron`. [`text`] reads such a path for the scene, and for excerpts of findings; [`folders`]
//! gives the sources the same files. The disk always wins, and a graph on disk never reads embedded files unless it
//! names them so. [`ready_graphs`] lists what there is, each with the files that it needs.

use std::fs;
use std::io::ErrorKind;
use std::path::{Component, Path, PathBuf};

use include_dir::{Dir, include_dir};
use volgraph_graph::{
    EMBEDDED_GRAPHS as ROOT, Folders, GraphDesc, Source, SourceDesc, is_embedded, read,
};
use volgraph_nodes::source::segments;
use volgraph_report::did_you_mean;
use volgraph_shader::ParamValue;

use crate::alone;
use crate::shaders::EMBEDDED_SHADERS;

/// volgraph's ready graphs, their transfer functions and images as they were when it was built.
pub static EMBEDDED_GRAPHS: Dir<'static> = include_dir!("$CARGO_MANIFEST_DIR/../../graphs");

/// The folders of the ready graphs: those that need no file from outside, and those that draw scanned volumes.
const FOLDERS: [&str; 2] = ["graphs", "graphs/scans"];

/// The file that a user means by a graph's name; of a volume the path that stands for a graph of it ([`alone`]).
///
/// `quickstart` and `quickstart.ron` stand for `graphs/quickstart.ron` as
/// well, and `engine` for `graphs/scans/engine.ron`. Each of these is looked for on the disk first, then among the ready graphs. What is nowhere stays as it is.
#[must_use]
pub fn locate(name: &Path) -> PathBuf {
    if is_embedded(name) {
        return name.to_path_buf();
    }
    let candidates = candidates(name);
    let on_disk = candidates.iter().find(|path| is_on_disk(path)).cloned();
    let embedded = || {
        candidates
            .iter()
            .filter(|path| {
                FOLDERS
                    .iter()
                    .any(|folder| path.parent() == Some(Path::new(folder)))
            })
            .map(|path| Path::new("embedded:").join(path))
            .find(|path| text(path).is_some())
    };
    if let Some(volume) = on_disk.as_ref().filter(|path| alone::is_volume(path)) {
        return alone::path_for(volume);
    }
    on_disk.or_else(embedded).unwrap_or_else(|| {
        // Nothing else is meant by it: a folder of slices, or a pattern that names them.
        if alone::is_volume(name) {
            alone::path_for(name)
        } else {
            name.to_path_buf()
        }
    })
}

/// A path, the same with the extension, and for a bare name both in the folders of ready graphs.
fn candidates(name: &Path) -> Vec<PathBuf> {
    let mut candidates = vec![name.to_path_buf()];
    if name.extension().is_none() {
        candidates.push(name.with_extension("ron"));
    }
    let parts: Vec<Component<'_>> = name.components().collect();
    if matches!(parts.as_slice(), [Component::Normal(_)]) {
        let named = candidates.clone();
        candidates.extend(
            FOLDERS
                .iter()
                .flat_map(|folder| named.iter().map(|path| Path::new(folder).join(path))),
        );
    }
    candidates
}

/// Whether there is anything but a folder: a file that may not be read is there, and so is a link that leads nowhere.
fn is_on_disk(path: &Path) -> bool {
    match fs::metadata(path) {
        Ok(metadata) => !metadata.is_dir(),
        Err(_) => match fs::symlink_metadata(path) {
            Ok(_) => true,
            Err(error) => !matches!(
                error.kind(),
                ErrorKind::NotFound | ErrorKind::NotADirectory | ErrorKind::InvalidInput
            ),
        },
    }
}

/// The text of an embedded shader, graph or transfer function; `None` for any other path.
#[must_use]
pub fn text(path: &Path) -> Option<&'static str> {
    let below = path.strip_prefix("embedded:").ok()?;
    let below = below.strip_prefix("/").unwrap_or(below);
    let file = match below.strip_prefix("graphs") {
        Ok(graph) => EMBEDDED_GRAPHS.get_file(graph),
        Err(_) => EMBEDDED_SHADERS.get_file(below),
    };
    file?.contents_utf8()
}

/// Whether volgraph carries a file of this path, text or not.
pub(crate) fn is_carried(path: &Path) -> bool {
    let below = path.strip_prefix(ROOT);
    below.is_ok_and(|below| EMBEDDED_GRAPHS.get_file(below).is_some())
}

/// Where the sources of a graph are looked for: its own folder, then those of data; embedded files as [`Folders`] says.
#[must_use]
pub fn folders(graph: &Path, data: &[PathBuf]) -> Folders {
    // Not `.` for a bare name: findings tell paths as users write them.
    let folder = graph.parent().unwrap_or(Path::new(""));
    Folders::new(folder, data).embedded(&EMBEDDED_GRAPHS)
}

/// A graph that volgraph carries.
#[derive(Clone, Debug)]
pub struct ReadyGraph {
    /// Its name, such as `quickstart`.
    pub name: String,
    /// Its path, such as `embedded:/graphs/quickstart.ron`.
    pub path: PathBuf,
    /// Its text.
    pub text: &'static str,
    desc: GraphDesc,
}

impl ReadyGraph {
    /// The volume files that it draws and that volgraph does not carry, as the graph names them.
    #[must_use]
    pub fn volumes(&self) -> Vec<String> {
        let volumes = self.desc.sources.values();
        volumes
            .filter(|source| source.kind == "volume")
            .filter_map(path_of)
            .collect()
    }

    /// The files that it consists of: the graph, its transfer functions and images, by their paths from its folder.
    #[must_use]
    pub fn files(&self) -> Vec<(PathBuf, &'static [u8])> {
        let mut paths = vec![format!("{}.ron", self.name)];
        paths.extend(self.desc.sources.values().filter_map(path_of));
        let segments = self
            .desc
            .sources
            .values()
            .filter(|it| it.kind == "segments");
        paths.extend(
            segments
                .filter_map(path_of)
                .flat_map(|path| transfers_of(&path)),
        );
        let below = self.path.strip_prefix(ROOT).unwrap_or(&self.path);
        let folder = below.parent().unwrap_or(Path::new(""));
        paths
            .into_iter()
            .filter_map(|path| {
                let content = EMBEDDED_GRAPHS.get_file(folder.join(&path))?.contents();
                Some((PathBuf::from(path), content))
            })
            .collect()
    }
}

/// The files of transfer functions that a file of segments names.
fn transfers_of(segments: &str) -> Vec<String> {
    let path = Path::new(ROOT).join(segments);
    let folders = folders(&path, &[]);
    let read = text(&path).and_then(|text| segments::parse(&path, text, &folders).ok());
    let files = read.map(|segments| segments.files()).unwrap_or_default();
    let below = files.iter().filter(|file| **file != path);
    below
        .filter_map(|file| Some(file.strip_prefix(ROOT).ok()?.to_str()?.to_owned()))
        .collect()
}

fn path_of(source: &SourceDesc) -> Option<String> {
    match &source.params.get("path")?.value {
        ParamValue::Text(path) => Some(path.clone()),
        _ => None,
    }
}

/// The ready graphs, by name.
#[must_use]
pub fn ready_graphs() -> Vec<ReadyGraph> {
    let scans = EMBEDDED_GRAPHS.get_dir("scans");
    let mut graphs: Vec<ReadyGraph> = EMBEDDED_GRAPHS
        .files()
        .chain(scans.into_iter().flat_map(Dir::files))
        .filter_map(|file| {
            let name = file.path().file_name()?.to_str()?.strip_suffix(".ron")?;
            let path = Path::new(ROOT).join(file.path());
            let text = file.contents_utf8()?;
            Some(ReadyGraph {
                name: name.to_owned(),
                desc: read::graph(&path, text).ok()?,
                path,
                text,
            })
        })
        .collect();
    graphs.sort_by(|a, b| a.name.cmp(&b.name));
    graphs
}

/// A remedy for a graph that is nowhere.
#[must_use]
pub(crate) fn missing_graph_help(path: &Path) -> String {
    let graphs = ready_graphs();
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    did_you_mean(&stem, graphs.iter().map(|graph| graph.name.as_str()))
        .filter(|near| near.starts_with("did"))
        .unwrap_or_else(|| {
            "check that the path names a graph file in RON that you may read; `volgraph graphs` lists the ready graphs"
                .to_owned()
        })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_stands_for_a_ready_graph_where_the_disk_has_none() {
        // The tests run in the crate's folder, where no graph lies.
        let embedded = Path::new("embedded:/graphs/quickstart.ron");
        for name in [
            "quickstart",
            "quickstart.ron",
            "graphs/quickstart.ron",
            "graphs/quickstart",
        ] {
            assert_eq!(locate(Path::new(name)), embedded, "{name}");
        }
        for name in [
            "no",
            "./quickstart.ron",
            "a/graphs/quickstart.ron",
            "/quickstart",
            "transfer/molecule.ron",
            "",
            "src",
        ] {
            assert_eq!(locate(Path::new(name)), Path::new(name), "{name}");
        }
        // Any file on the disk wins, whatever it holds.
        assert_eq!(locate(Path::new("Cargo.toml")), Path::new("Cargo.toml"));
    }

    #[test]
    fn every_ready_graph_has_its_transfer_functions_and_images() {
        let graphs = ready_graphs();
        let scans = EMBEDDED_GRAPHS.get_dir("scans").unwrap().files();
        let files = EMBEDDED_GRAPHS.files().count() + scans.count();
        assert_eq!(graphs.len(), files, "a graph in the folder cannot be read");
        let mut names: Vec<&str> = graphs.iter().map(|graph| graph.name.as_str()).collect();
        names.dedup();
        assert_eq!(
            names.len(),
            graphs.len(),
            "two graphs have one name: {names:?}"
        );
        for graph in &graphs {
            assert_eq!(text(&graph.path), Some(graph.text));
            let sources = graph.desc.sources.values();
            let with_path = sources.clone().filter_map(path_of).count();
            let segments = sources.filter(|source| source.kind == "segments");
            let named = segments
                .filter_map(path_of)
                .flat_map(|path| transfers_of(&path));
            assert_eq!(
                graph.files().len() + graph.volumes().len(),
                1 + with_path + named.count(),
                "{}",
                graph.name
            );
        }
    }

    #[test]
    fn texts_are_found_by_the_paths_that_findings_name() {
        assert!(
            text(Path::new("embedded:/lib/ray.wgsl")).is_some_and(|t| t.contains("struct Ray"))
        );
        assert!(text(Path::new("embedded:/graphs/transfer/molecule.ron")).is_some());
        for none in [
            "lib/ray.wgsl",
            "embedded:/lib/no.wgsl",
            "embedded:/graphs",
            "embedded:",
        ] {
            assert_eq!(text(Path::new(none)), None, "{none}");
        }
    }
}
