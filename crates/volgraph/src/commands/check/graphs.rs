//! Checks a graph as far as a plan goes, with its data or without.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::DVec3;
use indexmap::IndexMap;
use naga::valid::Capabilities;
use volgraph::{
    Finding, Findings, Limits, Overrides, Registry, Scene, ShaderFolders, SourceProgress, embedded,
};
use volgraph_graph::{EMBEDDED_GRAPHS, Folders, Source, SourceDesc, read, resolve, sources};
use volgraph_nodes::source::volume::VolumeSource;
use volgraph_shader::ParamValue;
use volgraph_volume::{Grid, Volume};

use crate::progress::Bars;

/// What WebGPU guarantees, and floats that nearly every device can filter; a plan for a device that cannot tells.
pub fn limits() -> Limits {
    Limits {
        float32_filterable: true,
        ..Limits::default()
    }
}

/// What all graphs are checked with.
pub struct Checker<'a> {
    pub registry: &'a Registry,
    pub folders: &'a ShaderFolders,
    /// Folders of data.
    pub data: &'a [PathBuf],
}

impl Checker<'_> {
    /// Everything wrong with a graph, with and without depth and opacity.
    pub fn check(&self, path: &Path, text: String) -> Findings {
        let mut findings = Findings::new();
        let Some(scene) = self.scene(path, text, Overrides::default(), &mut findings) else {
            return findings;
        };
        findings.take(scene.check_color_output());
        let shaders = scene.shader_library(Capabilities::default());
        let limits = limits();
        for with_layers in [false, true] {
            if let Err(more) = scene.plan(&shaders, &limits, [512, 512], with_layers) {
                findings.extend(more);
                break;
            }
        }
        findings
    }

    /// A graph with its data, or with what stands in for it; `None` where there are errors.
    pub fn scene(
        &self,
        path: &Path,
        text: String,
        overrides: Overrides,
        findings: &mut Findings,
    ) -> Option<Scene> {
        let mut desc = findings.take_all(read::graph(path, &text))?;
        findings.take_all(overrides.apply(&mut desc))?;
        let folders = embedded::folders(path, self.data);
        let mut loaded = IndexMap::new();
        let bars = Bars::new();
        for (name, source) in &desc.sources {
            if let Some(source) = self.source(name, source, &folders, &bars, findings) {
                loaded.insert(name.clone(), source);
            }
        }
        bars.clear();
        // Names can be looked up even where a source is broken: all findings at once.
        if let Err(more) = resolve::resolve(&desc, &loaded, self.registry) {
            findings.extend(more);
        }
        (!findings.has_errors()).then(|| Scene {
            path: path.to_path_buf(),
            text,
            desc,
            overrides,
            sources: loaded,
            registry: self.registry.clone(),
            shader_folders: self.folders.clone(),
            data: Default::default(),
        })
    }

    fn source(
        &self,
        name: &str,
        desc: &SourceDesc,
        folders: &Folders,
        bars: &Bars,
        findings: &mut Findings,
    ) -> Option<Arc<dyn Source>> {
        let progress = |done, total| bars.progress(name, done, total);
        match sources::load_one(desc, self.registry, folders, &progress) {
            Ok(source) => Some(source),
            Err(found) => {
                // Whatever else is wrong with the source is found before its file is looked for.
                let missing = missing_volume(desc, folders).filter(|_| {
                    (&found)
                        .into_iter()
                        .all(|finding| finding.code == "data-missing")
                });
                let stand_in = missing.and_then(|file| Some((file, stand_in(name)?)));
                let Some(((path, file), stand_in)) = stand_in else {
                    findings.extend(found);
                    return None;
                };
                let message = format!(
                    "the volume `{}` is not here; the rest is checked without it",
                    file.display()
                );
                findings.push(
                    Finding::warning("data-missing", message)
                        .at(path.place.clone())
                        .help("name the folder that has it with `--data FOLDER`"),
                );
                Some(stand_in)
            }
        }
    }
}

/// The field and the file of a volume that is not there.
fn missing_volume<'d>(
    desc: &'d SourceDesc,
    folders: &Folders,
) -> Option<(&'d volgraph_graph::ParamDesc, PathBuf)> {
    let path = desc.params.get("path").filter(|_| desc.kind == "volume")?;
    let ParamValue::Text(text) = &path.value else {
        return None;
    };
    let file = folders.find(text);
    let shown = file.strip_prefix(EMBEDDED_GRAPHS).map(Path::to_path_buf);
    (!volgraph_graph::is_there(&file)).then(|| (path, shown.unwrap_or(file)))
}

/// Eight voxels over the whole range of their type.
fn stand_in(name: &str) -> Option<Arc<dyn Source>> {
    let grid = Grid::axis_aligned([2; 3], DVec3::ONE, DVec3::ZERO);
    let voxels: Vec<u8> = vec![0, 36, 72, 108, 144, 180, 216, 255];
    let volume = Volume::new(name, grid, voxels.into()).ok()?;
    Some(Arc::new(VolumeSource::new(Arc::new(volume))))
}
