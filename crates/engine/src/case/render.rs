//! Renders the pictures that expectations ask for, each once.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use indexmap::IndexMap;
use volgraph_gpu::{AdapterChoice, Gpu};
use volgraph_graph::{Source, SourceDesc, read, resolve, sources};
use volgraph_report::{Finding, Findings};
use volgraph_volume::ScalarType;

use super::invariance::{mirrored, rolled, stored};
use super::outcome::Shown;
use super::settings::{fixed_stages, in_case, last_of_each};
use super::{Axis, Case, CaseOptions, GraphName, Other, Point, Set};
use crate::overrides::volume_source;
use crate::{
    Overrides, Picture, Scene, Session, SessionOptions, ShaderFolders, embedded, registry, scene,
};

/// Open devices, by what was asked for: one set for each job.
#[derive(Default)]
pub(super) struct Devices(BTreeMap<Option<String>, Arc<Gpu>>);

impl Devices {
    /// The device of an adapter, `None` for that of the options; opened once, and again where it is lost.
    pub fn get(
        &mut self,
        options: &CaseOptions,
        adapter: Option<&str>,
    ) -> Result<Arc<Gpu>, Findings> {
        let key = adapter.map(str::to_owned);
        match self.0.get(&key).filter(|gpu| gpu.lost().is_none()) {
            Some(gpu) => Ok(Arc::clone(gpu)),
            None => {
                let choice = adapter.map_or_else(
                    || options.adapter.clone(),
                    |words| AdapterChoice::new(Some(words)),
                );
                let gpu = Arc::new(Gpu::open(&choice)?);
                self.0.insert(key, Arc::clone(&gpu));
                Ok(gpu)
            }
        }
    }
}

/// What is done to a scene to see whether the picture follows.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) enum Treatment {
    #[default]
    None,
    /// Volumes and camera are in a mirror.
    Mirrored(Axis),
    /// The camera is rolled by so many quarters.
    Rolled(u32),
    /// Volumes of 256 values are stored so.
    Stored(ScalarType),
}

/// A picture to render.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Request {
    pub graph: PathBuf,
    pub set: Vec<Set>,
    pub volume: Option<usize>,
    pub camera: Option<usize>,
    pub adapter: Option<String>,
    pub treatment: Treatment,
}

/// A picture, what it is, and what its shaders ran into.
#[derive(Clone, Debug)]
pub(super) struct Rendered {
    pub picture: Arc<Picture>,
    pub name: String,
    pub hazards: Findings,
}

impl Rendered {
    pub fn shown(&self) -> Shown {
        Shown {
            name: self.name.clone(),
            picture: Arc::clone(&self.picture),
        }
    }
}

pub(super) struct Renderer<'c> {
    pub case: &'c Case,
    pub options: &'c CaseOptions,
    pub devices: &'c mut Devices,
    folders: ShaderFolders,
    sources: Vec<(PathBuf, SourceDesc, Arc<dyn Source>)>,
    pictures: Vec<(Request, Result<Rendered, Findings>)>,
}

impl<'c> Renderer<'c> {
    pub fn new(case: &'c Case, options: &'c CaseOptions, devices: &'c mut Devices) -> Self {
        Self {
            case,
            options,
            devices,
            folders: case.shader_folders(options),
            sources: Vec::new(),
            pictures: Vec::new(),
        }
    }

    /// The case's graph with its own settings, the point's and these.
    pub fn own(&self, point: &Point, more: &[Set]) -> Result<Request, Findings> {
        let slots = self.case.slot_sets()?;
        let set = slots
            .iter()
            .chain(&self.case.set)
            .chain(&point.set)
            .chain(more);
        self.request(&self.case.graph.path, point, set.cloned().collect())
    }

    /// Another graph, or the case's own with other settings.
    pub fn other(&self, point: &Point, other: &Other) -> Result<Request, Findings> {
        match &other.graph {
            None => self.own(point, &other.set),
            Some(GraphName { path, .. }) => self.request(path, point, other.set.clone()),
        }
    }

    fn request(&self, graph: &Path, point: &Point, set: Vec<Set>) -> Result<Request, Findings> {
        Ok(Request {
            graph: graph.to_path_buf(),
            set: last_of_each(fixed_stages(graph)?.into_iter().chain(set)),
            volume: point.volume,
            camera: point.camera,
            adapter: None,
            treatment: Treatment::None,
        })
    }

    /// The picture, rendered once.
    pub fn render(&mut self, request: &Request) -> Result<Rendered, Findings> {
        let known = self.pictures.iter().find(|(known, _)| known == request);
        if let Some((_, rendered)) = known {
            return rendered.clone();
        }
        let rendered = self.draw(request);
        self.pictures.push((request.clone(), rendered.clone()));
        rendered
    }

    fn draw(&mut self, request: &Request) -> Result<Rendered, Findings> {
        let (mut session, name) = self.session(request)?;
        let (picture, report) = session
            .render()
            .map_err(|findings| self.at_settings(findings, request))?;
        Ok(Rendered {
            picture: Arc::new(picture),
            name,
            hazards: report.hazards,
        })
    }

    /// A session that draws it, and the picture's name.
    pub fn session(&mut self, request: &Request) -> Result<(Session, String), Findings> {
        let opened = self.open(request);
        let session = opened.map_err(|findings| self.at_settings(findings, request))?;
        Ok((session, self.name(request)))
    }

    fn open(&mut self, request: &Request) -> Result<Session, Findings> {
        let gpu = self.devices.get(self.options, request.adapter.as_deref())?;
        let scene = self.scene(request)?;
        let options = SessionOptions {
            adapter: self.options.adapter.clone(),
            size: self.case.size,
            overrides: scene.overrides.clone(),
            shader_folders: self.folders.clone(),
            with_layers: true,
            // A case says itself what it draws.
            is_as_written: true,
            ..SessionOptions::default()
        };
        let middle = scene_middle(&scene);
        let mut session = Session::start(scene, gpu, &options)?;
        match request.treatment {
            Treatment::Mirrored(axis) => {
                // What a camera leaves open is fitted to the volumes, and these are elsewhere now.
                let plain = Request {
                    treatment: Treatment::None,
                    ..request.clone()
                };
                let camera = self.open(&plain)?.view().camera;
                session.place_camera(mirrored::camera(&camera, axis, middle));
            }
            Treatment::Rolled(quarters) => {
                let camera = session.view().camera;
                session.place_camera(rolled::camera(&camera, quarters));
            }
            Treatment::None | Treatment::Stored(_) => {}
        }
        Ok(session)
    }

    /// The scene, with what the request changes in it.
    pub fn scene(&mut self, request: &Request) -> Result<Scene, Findings> {
        let text = scene::read_text(&request.graph)?;
        let mut desc = read::graph(&request.graph, &text)?;
        if let Some(volume) = request.volume.and_then(|at| self.case.volumes.get(at)) {
            let name = volume_source(&desc, "", &volume.source.place)?;
            if desc.sources.contains_key(&name) {
                desc.sources.insert(name, volume.source.clone());
            }
        }
        let overrides = Overrides {
            params: request.set.iter().map(|set| set.value.clone()).collect(),
            data: self.options.data.clone(),
            ..Overrides::default()
        };
        overrides.apply(&mut desc)?;
        if let Some(stand) = request.camera.and_then(|at| self.case.cameras.get(at)) {
            desc.camera = Some(stand.camera.clone());
        }
        let registry = registry();
        let folders = embedded::folders(&request.graph, &self.options.data);
        let known = |_: &str, desc: &SourceDesc| {
            let is_it = |(graph, known, _): &&(PathBuf, SourceDesc, Arc<dyn Source>)| {
                *graph == request.graph && known.asks_the_same(desc)
            };
            let (.., source) = self.sources.iter().find(is_it)?;
            Some(Arc::clone(source))
        };
        let (loaded, mut findings) =
            sources::reload(&desc, &registry, &folders, &known, &|_, _, _| {});
        if let Err(more) = resolve::resolve(&desc, &loaded, &registry) {
            findings.extend(more);
        }
        findings.into_result(())?;
        let new: Vec<_> = desc
            .sources
            .iter()
            .filter(|(name, desc)| known(name, desc).is_none())
            .filter_map(|(name, desc)| {
                let source = loaded.get(name)?;
                Some((request.graph.clone(), desc.clone(), Arc::clone(source)))
            })
            .collect();
        self.sources.extend(new);
        let scene = Scene {
            path: request.graph.clone(),
            text,
            desc,
            overrides,
            sources: loaded,
            registry,
            shader_folders: self.folders.clone(),
            data: BTreeMap::new(),
        };
        treated(scene, request.treatment)
    }

    /// What was set for it, besides the stage that every picture has.
    fn name(&self, request: &Request) -> String {
        let mut parts: Vec<String> = Vec::new();
        if request.graph != self.case.graph.path {
            parts.push(request.graph.display().to_string());
        }
        parts.extend(request.set.iter().map(|set| set.value.typed.clone()));
        if let (Some(at), true) = (request.volume, self.case.volumes.len() > 1) {
            parts.push(self.case.volumes[at].text.clone());
        }
        if let (Some(at), true) = (request.camera, self.case.cameras.len() > 1) {
            parts.push(self.case.cameras[at].text.clone());
        }
        parts.extend(request.adapter.clone());
        match request.treatment {
            Treatment::None => {}
            Treatment::Mirrored(_) => parts.push("in the mirror".to_owned()),
            Treatment::Rolled(quarters) => {
                parts.push(format!("rolled by {} degrees", quarters * 90));
            }
            Treatment::Stored(scalar) => parts.push(format!("stored as {}", scalar.name())),
        }
        parts.join(", ")
    }

    /// A finding about a setting stands where the case has it.
    fn at_settings(&self, findings: Findings, request: &Request) -> Findings {
        findings
            .into_iter()
            .map(|finding| in_case(finding, &request.set))
            .collect()
    }
}

/// The middle of the volumes' boxes: the mirror goes through it.
fn scene_middle(scene: &Scene) -> glam::DVec3 {
    let corners: Vec<glam::DVec3> = scene.sources.values().flat_map(|s| s.corners()).collect();
    let low = corners.iter().copied().reduce(glam::DVec3::min);
    let high = corners.iter().copied().reduce(glam::DVec3::max);
    0.5 * (low.unwrap_or_default() + high.unwrap_or_default())
}

/// The scene after its treatment.
fn treated(mut scene: Scene, treatment: Treatment) -> Result<Scene, Findings> {
    let middle = scene_middle(&scene);
    let treat = |source: &Arc<dyn Source>| match treatment {
        Treatment::Mirrored(axis) => mirrored::source(source, axis, middle),
        Treatment::Stored(scalar) => stored::source(source, scalar),
        Treatment::None | Treatment::Rolled(_) => Ok(Arc::clone(source)),
    };
    let mut sources = IndexMap::new();
    for (name, source) in &scene.sources {
        sources.insert(name.clone(), treat(source).map_err(Finding::from)?);
    }
    scene.sources = sources;
    Ok(scene)
}
