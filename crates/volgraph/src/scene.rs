//! A graph and its sources, loaded: all that a plan is made of, without a GPU.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use indexmap::IndexMap;
use naga::valid::Capabilities;
use volgraph_graph::demand::ShaderLibrary;
use volgraph_graph::{
    GraphDesc, Limits, Plan, PlanRequest, Registry, Source, is_embedded, read, sources,
};
use volgraph_report::{Finding, Findings, Place};

use crate::embedded;
use crate::overrides::Overrides;
use crate::shaders::ShaderFolders;

/// Graph files are at most this long.
const MAX_GRAPH_BYTES: u64 = 4 << 20;

/// Told how much of a source is read: its name, bytes so far, bytes in all (0 where unknown).
pub trait SourceProgress: Sync {
    /// Called while sources are read.
    fn progress(&self, source: &str, done: u64, total: u64);
}

/// Tells nobody.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoProgress;

impl SourceProgress for NoProgress {
    fn progress(&self, _source: &str, _done: u64, _total: u64) {}
}

/// A loaded graph.
pub struct Scene {
    /// The graph file; `embedded:/graphs/…` for one of volgraph's own.
    pub path: PathBuf,
    /// Its text.
    pub text: String,
    /// The graph, with the overrides in it.
    pub desc: GraphDesc,
    /// What was overridden.
    pub overrides: Overrides,
    /// Its sources.
    pub sources: IndexMap<String, Arc<dyn Source>>,
    /// The kinds it may use.
    pub registry: Registry,
    /// Where its shaders are.
    pub shader_folders: ShaderFolders,
}

impl Scene {
    /// Reads a graph file and all of its sources. Where there is no such file, the name may be that of a ready graph
    /// ([`embedded::locate`]).
    ///
    /// # Errors
    /// Everything wrong with the file and the sources, together.
    pub fn load(
        path: &Path,
        overrides: &Overrides,
        shader_folders: &ShaderFolders,
        registry: Registry,
        progress: &dyn SourceProgress,
    ) -> Result<Self, Findings> {
        let path = &*embedded::locate(path);
        let text = read_text(path)?;
        let mut desc = read::graph(path, &text)?;
        overrides.apply(&mut desc)?;
        let report = |source: &str, done: u64, total: u64| progress.progress(source, done, total);
        let folders = embedded::folders(path, &overrides.data);
        let (sources, mut findings) = sources::load(&desc, &registry, &folders, &report);
        // Names can be looked up even where a source is broken: all findings at once.
        if let Err(more) = volgraph_graph::resolve::resolve(&desc, &sources, &registry) {
            findings.extend(more);
        }
        let scene = Self {
            path: path.to_path_buf(),
            text,
            desc,
            overrides: overrides.clone(),
            sources,
            registry,
            shader_folders: shader_folders.clone(),
        };
        findings.into_result(scene)
    }

    /// The shaders, for a device with these capabilities.
    #[must_use]
    pub fn shader_library(&self, capabilities: Capabilities) -> ShaderLibrary {
        // An embedded graph has no folder to find shaders in; paths of shaders then start at the current one.
        let folder = (!is_embedded(&self.path)).then(|| folder_of(&self.path));
        ShaderLibrary::new(
            self.shader_folders.roots(folder.as_deref()),
            capabilities,
            Some(folder.unwrap_or_else(|| PathBuf::from("."))),
        )
    }

    /// Decides everything for a device with these limits and a picture of this size. `with_layers` asks for the
    /// depth and opacity of the output `color` as well, where its node has them.
    ///
    /// # Errors
    /// All findings of the first phase that has any.
    pub fn plan(
        &self,
        shaders: &ShaderLibrary,
        limits: &Limits,
        size: [u32; 2],
        with_layers: bool,
    ) -> Result<Plan, Findings> {
        let layers = [("depth", "color", "depth"), ("opacity", "color", "opacity")];
        Plan::build(PlanRequest {
            desc: &self.desc,
            sources: &self.sources,
            registry: &self.registry,
            shaders,
            limits,
            size,
            extra_outputs: if with_layers { &layers } else { &[] },
        })
    }

    /// Whether there is a picture: an output named `color`.
    ///
    /// # Errors
    /// `no-color-output`, at the place of the outputs that there are.
    pub fn check_color_output(&self) -> Result<(), Finding> {
        let outputs = &self.desc.outputs;
        if outputs.contains_key("color") {
            return Ok(());
        }
        let finding = Finding::error(
            "no-color-output",
            "the graph names no output `color`, which is the picture",
        )
        .help(
            "add `\"color\": \"image.color\"` to its outputs, with the name of a node and its port",
        );
        Err(match outputs.values().next() {
            Some(edge) => finding.at(edge.name_place.clone()),
            None => finding.at(Place::whole_file(&self.path)),
        })
    }

    /// What the user should know of the sources: (source, warning).
    #[must_use]
    pub fn warnings(&self) -> Vec<(String, String)> {
        self.sources
            .iter()
            .flat_map(|(name, source)| {
                source
                    .warnings()
                    .into_iter()
                    .map(|warning| (name.clone(), warning))
            })
            .collect()
    }
}

/// Reads a text file of at most 4 MiB.
pub(crate) fn read_text(path: &Path) -> Result<String, Findings> {
    if let Some(text) = embedded::text(path) {
        return Ok(text.to_owned());
    }
    let unreadable = |error: std::io::Error| {
        Finding::error("io", format!("the graph cannot be read: {error}"))
            .at(Place::whole_file(path))
            .help(embedded::missing_graph_help(path))
    };
    let metadata = fs::metadata(path).map_err(unreadable)?;
    if metadata.is_dir() || metadata.len() > MAX_GRAPH_BYTES {
        let what = if metadata.is_dir() {
            "a folder"
        } else {
            "over 4 MiB long"
        };
        return Err(Finding::error(
            "not-a-graph",
            format!("a graph is a RON file, and this is {what}"),
        )
        .at(Place::whole_file(path))
        .help("name a graph file, such as graphs/quickstart.ron")
        .into());
    }
    Ok(fs::read_to_string(path).map_err(unreadable)?)
}

/// The folder of a file; the current one for a bare name.
pub(crate) fn folder_of(path: &Path) -> PathBuf {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder.to_path_buf(),
        _ => PathBuf::from("."),
    }
}
