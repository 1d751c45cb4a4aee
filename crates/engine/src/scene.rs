//! A graph and its sources, loaded: all that a plan is made of, without a GPU.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::SystemTime;

use indexmap::IndexMap;
use naga::valid::Capabilities;
use volgraph_graph::demand::ShaderLibrary;
use volgraph_graph::{
    GraphDesc, Limits, Plan, PlanRequest, Registry, Source, SourceDesc, is_embedded, read, sources,
};
use volgraph_nodes::source::volume::VolumeSource;
use volgraph_report::{Finding, Findings, Place};
use volgraph_shader::{ParamValue, ShaderFiles, ShaderRoots};
use volgraph_watch::Seen;

use crate::dependencies::{Dependencies, as_it_is, data_since};
use crate::overrides::{Overrides, ParamOverride};
use crate::shaders::ShaderFolders;
use crate::{alone, embedded};

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
#[derive(Clone)]
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
    /// The files of its sources, with what was used of each.
    pub data: BTreeMap<PathBuf, Seen>,
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
        let mut dependencies = Dependencies::default();
        Self::load_noting(
            path,
            overrides,
            shader_folders,
            registry,
            progress,
            &mut dependencies,
        )
    }

    /// The same, and what was looked at is noted, also where it fails.
    pub(crate) fn load_noting(
        path: &Path,
        overrides: &Overrides,
        shader_folders: &ShaderFolders,
        registry: Registry,
        progress: &dyn SourceProgress,
        dependencies: &mut Dependencies,
    ) -> Result<Self, Findings> {
        let path = &*embedded::locate(path);
        let text = read_text(path);
        dependencies.note_graph(path, text.as_ref().ok());
        let scene = Self {
            path: path.to_path_buf(),
            text: text?,
            desc: GraphDesc::default(),
            overrides: overrides.clone(),
            sources: IndexMap::new(),
            registry,
            shader_folders: shader_folders.clone(),
            data: BTreeMap::new(),
        };
        scene.read(&|_, _| None, progress, dependencies)
    }

    /// A graph of a known text, as if it were read from a path, and all of its sources.
    ///
    /// # Errors
    /// As [`Self::load`].
    pub fn of_text(
        path: &Path,
        text: String,
        overrides: &Overrides,
        shader_folders: &ShaderFolders,
        registry: Registry,
        progress: &dyn SourceProgress,
    ) -> Result<Self, Findings> {
        let scene = Self {
            path: path.to_path_buf(),
            text,
            desc: GraphDesc::default(),
            overrides: overrides.clone(),
            sources: IndexMap::new(),
            registry,
            shader_folders: shader_folders.clone(),
            data: BTreeMap::new(),
        };
        scene.read(&|_, _| None, progress, &mut Dependencies::default())
    }

    /// The graph with another text, and its sources: those that it now asks for differently or whose files are among
    /// `changed` are read, the others are shared with this scene.
    ///
    /// # Errors
    /// As [`Self::load`].
    pub(crate) fn reload(
        &self,
        text: String,
        changed: &BTreeSet<PathBuf>,
        overrides: &Overrides,
        progress: &dyn SourceProgress,
        dependencies: &mut Dependencies,
    ) -> Result<Self, Findings> {
        let loaded = |name: &str, desc: &SourceDesc| {
            let source = self.sources.get(name)?;
            let is_same = self.desc.sources.get(name)?.asks_the_same(desc)
                && !source.files().iter().any(|file| changed.contains(file));
            is_same.then(|| Arc::clone(source))
        };
        let scene = Self {
            path: self.path.clone(),
            text,
            desc: GraphDesc::default(),
            overrides: overrides.clone(),
            sources: IndexMap::new(),
            registry: self.registry.clone(),
            shader_folders: self.shader_folders.clone(),
            data: self.data.clone(),
        };
        scene.read(&loaded, progress, dependencies)
    }

    /// The same graph, as it was read, with other overrides.
    ///
    /// # Errors
    /// As [`Self::load`].
    pub fn with_overrides(
        &self,
        overrides: &Overrides,
        progress: &dyn SourceProgress,
    ) -> Result<Self, Findings> {
        let mut dependencies = Dependencies::default();
        let text = self.text.clone();
        self.reload(
            text,
            &BTreeSet::new(),
            overrides,
            progress,
            &mut dependencies,
        )
    }

    /// This very graph, with whatever was changed in it since its text was read, and parameters and slots of its nodes set
    /// over all that is set. Sources stay as they are, unless their own fields are set: then the graph is read again.
    ///
    /// # Errors
    /// `unknown-node` for a name that is no node.
    pub fn with_sets(&self, sets: &[ParamOverride]) -> Result<Self, Findings> {
        if sets
            .iter()
            .any(|set| self.desc.sources.contains_key(&set.target))
        {
            let mut overrides = self.overrides.clone();
            overrides.params.extend(sets.to_vec());
            return self.with_overrides(&overrides, &NoProgress);
        }
        let mut scene = self.clone();
        let set = Overrides {
            params: sets.to_vec(),
            ..Overrides::default()
        };
        set.apply(&mut scene.desc)?;
        scene.overrides.params.extend(set.params);
        Ok(scene)
    }

    /// Takes those sources of another scene that are the same, so that they are held once.
    pub(crate) fn share_sources(&mut self, other: &Self) {
        for (name, source) in &mut self.sources {
            let there = other.sources.get(name).filter(|there| {
                there.digest() == source.digest() && there.files() == source.files()
            });
            if let Some(there) = there {
                *source = Arc::clone(there);
            }
        }
    }

    /// From the text to the graph and its sources.
    fn read(
        mut self,
        loaded: &sources::Loaded<'_>,
        progress: &dyn SourceProgress,
        dependencies: &mut Dependencies,
    ) -> Result<Self, Findings> {
        self.desc = read::graph(&self.path, &self.text)?;
        self.overrides.apply(&mut self.desc)?;
        let report = |source: &str, done: u64, total: u64| progress.progress(source, done, total);
        let folders = embedded::folders(&self.path, &self.overrides.data);
        let began = SystemTime::now();
        let before = std::mem::take(&mut self.data);
        let named = self.desc.sources.values().filter_map(|source| {
            let ParamValue::Text(path) = &source.params.get("path")?.value else {
                return None;
            };
            Some(folders.find(path))
        });
        let stamps: BTreeMap<PathBuf, Seen> = named
            .chain(before.keys().cloned())
            .map(|file| (file.clone(), as_it_is(&file)))
            .collect();
        let (sources, mut findings) =
            sources::reload(&self.desc, &self.registry, &folders, loaded, &report);
        for (name, source) in &sources {
            let desc = self.desc.sources.get(name);
            let is_shared = desc.is_some_and(|desc| loaded(name, desc).is_some());
            let on_disk = |file: &PathBuf| !is_embedded(file);
            for file in source.files().into_iter().filter(on_disk) {
                let seen = match (before.get(&file), stamps.get(&file)) {
                    (Some(seen), _) if is_shared => seen.clone(),
                    (_, Some(stamp @ Seen::Stamp(_))) => stamp.clone(),
                    _ => data_since(&file, began),
                };
                self.data.insert(file, seen);
            }
        }
        if sources.len() < self.desc.sources.len() {
            dependencies.note_failed_source(&folders.asked(), began);
        }
        self.sources = sources;
        if let Some(finding) = self.time_without_steps().filter(|_| findings.is_empty()) {
            findings.push(finding);
        }
        // Names can be looked up even where a source is broken: all findings at once.
        if let Err(more) =
            volgraph_graph::resolve::resolve(&self.desc, &self.sources, &self.registry)
        {
            findings.extend(more);
        }
        findings.into_result(self)
    }

    /// The volumes that have several time steps: the source's name, the step that is drawn, and how many there are.
    #[must_use]
    pub fn series(&self) -> Vec<(&str, u32, u32)> {
        let steps = self.sources.iter().filter_map(|(name, source)| {
            let source = source.as_any().downcast_ref::<VolumeSource>()?;
            let step = source.volume.about().step.as_ref()?;
            Some((name.as_str(), step.index, step.count))
        });
        steps.collect()
    }

    fn time_without_steps(&self) -> Option<Finding> {
        let time = self.overrides.time.filter(|_| self.series().is_empty())?;
        Some(
            Finding::error(
                "no-time",
                "no volume of the graph has several time steps",
            )
            .at(Place::whole_file(format!("--time {time}")))
            .help("leave `--time` out, or give a volume with time: a 4D file, or a folder or pattern of one file per step"),
        )
    }

    /// The shaders, for a device with these capabilities.
    #[must_use]
    pub fn shader_library(&self, capabilities: Capabilities) -> ShaderLibrary {
        let folder = self.graph_folder();
        ShaderLibrary::new(
            self.shader_folders.roots(folder.as_deref()),
            capabilities,
            Some(folder.unwrap_or_else(|| PathBuf::from("."))),
        )
    }

    /// Where its shaders are looked for, with the files from this store.
    #[must_use]
    pub fn shader_roots(&self, files: Arc<dyn ShaderFiles>) -> ShaderRoots {
        self.shader_folders
            .roots_in(files, self.graph_folder().as_deref())
    }

    /// The folder of the graph; none for an embedded one, whose paths of shaders start at the current folder.
    fn graph_folder(&self) -> Option<PathBuf> {
        (!is_embedded(&self.path)).then(|| folder_of(&self.path))
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
        if size.contains(&0) {
            let [width, height] = size;
            let message = format!("a picture of {width}x{height} has no pixels");
            return Err(Finding::error("picture-size", message)
                .help("give both sides at least one pixel")
                .into());
        }
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
    if let Some(volume) = alone::volume_of(path) {
        return Ok(alone::graph_for(&volume)?.graph);
    }
    let unreadable = |error: std::io::Error| {
        Finding::error("io", format!("the graph cannot be read: {error}"))
            .at(Place::whole_file(path))
            .help(embedded::missing_graph_help(path))
    };
    let metadata = fs::metadata(path).map_err(unreadable)?;
    let refused = if metadata.is_dir() {
        Some("a folder")
    } else if !metadata.is_file() {
        // Reading a pipe or a device might never end.
        Some("a pipe or a device")
    } else if metadata.len() > MAX_GRAPH_BYTES {
        Some("over 4 MiB long")
    } else {
        None
    };
    if let Some(what) = refused {
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
