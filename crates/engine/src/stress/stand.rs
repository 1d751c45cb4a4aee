//! One device and one session, on which cases are drawn one after the other.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use volgraph_gpu::Gpu;
use volgraph_graph::View;
use volgraph_nodes::source::volume::VolumeSource;
use volgraph_picture::{LayerValues, Picture};
use volgraph_report::{Finding, Findings};
use volgraph_volume::Volume;

use super::case::{Case, Method, Point, Quantity};
use super::judge::{Measured, Pixels, judge};
use super::report::{CaseReport, MethodReport};
use super::scene_text::SceneText;
use super::truth;
use crate::overrides::Overrides;
use crate::scene::{NoProgress, Scene};
use crate::session::{Change, Outcome, Session, SessionOptions};
use crate::shaders::ShaderFolders;

/// A device, a session and a folder for the files of scenes.
pub struct Stand {
    gpu: Arc<Gpu>,
    folder: tempfile::TempDir,
    options: SessionOptions,
    session: Option<Session>,
    /// Digests of the files in the folder.
    written: BTreeMap<PathBuf, blake3::Hash>,
}

/// A picture with what is needed to read it.
pub(super) struct Drawing {
    pub picture: Picture,
    pub voxel: f64,
}

impl Stand {
    /// A stand on an adapter.
    ///
    /// # Errors
    /// Where there is no such adapter, or no folder for temporary files.
    pub fn open(
        adapter: &crate::AdapterChoice,
        shader_folders: &ShaderFolders,
    ) -> Result<Self, Findings> {
        let folder = tempfile::tempdir().map_err(|error| unwritable(&error))?;
        Ok(Self {
            gpu: Arc::new(Gpu::open(adapter)?),
            folder,
            options: SessionOptions {
                adapter: adapter.clone(),
                shader_folders: shader_folders.clone(),
                with_layers: true,
                ..SessionOptions::default()
            },
            session: None,
            written: BTreeMap::new(),
        })
    }

    /// The adapter.
    #[must_use]
    pub fn adapter(&self) -> String {
        self.gpu.adapter().to_string()
    }

    /// Draws all methods of a case at all of its points, and judges them.
    ///
    /// # Errors
    /// Where there is no truth, or no file could be written. What a method is refused for is told in its report.
    pub fn run(&mut self, case: &Case) -> Result<CaseReport, Findings> {
        let start = Instant::now();
        let mut report = CaseReport::new(case);
        for point in &case.points {
            let truth = truth::of(self, case, point)
                .map_err(|findings| told(&findings, case.name, &point.label))?;
            report.truth.push(truth);
        }
        for method in &case.methods {
            let mut all = Vec::new();
            let mut pixels = Vec::new();
            for (point, truth) in case.points.iter().zip(&report.truth) {
                let bound = (method.bound.of)(point.at);
                let drawn = self.drawn(case, point, method)?;
                all.push(match &drawn {
                    Ok(drawn) => judge(drawn, truth, case.quantity, bound),
                    Err(why) => Measured {
                        bound,
                        refused: Some(why.clone()),
                        ..Measured::default()
                    },
                });
                pixels.push(drawn.ok());
            }
            report.graphs.extend(
                case.points
                    .last()
                    .map(|point| point.scene.clone().with(&method.sets).graph()),
            );
            report.methods.push(MethodReport::new(method, all, pixels));
        }
        report.seconds = start.elapsed().as_secs_f64();
        Ok(report)
    }

    /// The pixels of a method at a point, or why there are none.
    fn drawn(
        &mut self,
        case: &Case,
        point: &Point,
        method: &Method,
    ) -> Result<Result<Pixels, String>, Findings> {
        let scene = point.scene.clone().with(&method.sets);
        let changed = self.write(&scene)?;
        Ok(match self.draw_written(changed, case.size) {
            Ok(drawing) => drawing.pixels(case.quantity).map_err(|error| first(&error)),
            Err(findings) => Err(first(&findings)),
        })
    }

    /// Writes a scene's files; gives those that are new.
    fn write(&mut self, scene: &SceneText) -> Result<BTreeSet<PathBuf>, Findings> {
        let mut changed = BTreeSet::new();
        let graph = ("graph.ron".to_owned(), scene.graph().into_bytes());
        for (name, content) in scene.files().into_iter().chain([graph]) {
            let path = self.folder.path().join(name);
            let digest = blake3::hash(&content);
            if self.written.get(&path) == Some(&digest) {
                continue;
            }
            fs::write(&path, content).map_err(|error| unwritable(&error))?;
            self.written.insert(path.clone(), digest);
            changed.insert(path);
        }
        Ok(changed)
    }

    fn graph(&self) -> PathBuf {
        self.folder.path().join("graph.ron")
    }

    /// The scene as a graph file would be loaded.
    pub(super) fn load(&mut self, scene: &SceneText) -> Result<Scene, Findings> {
        let changed = self.write(scene)?;
        // The session has not seen them.
        for file in changed {
            self.written.remove(&file);
        }
        Scene::load(
            &self.graph(),
            &Overrides::default(),
            &self.options.shader_folders,
            volgraph_nodes::registry(),
            &NoProgress,
        )
    }

    /// Draws a scene.
    pub(super) fn draw(&mut self, scene: &SceneText, size: [u32; 2]) -> Result<Drawing, Findings> {
        let changed = self.write(scene)?;
        self.draw_written(changed, size)
    }

    fn draw_written(
        &mut self,
        changed: BTreeSet<PathBuf>,
        size: [u32; 2],
    ) -> Result<Drawing, Findings> {
        let picture = match &mut self.session {
            Some(session) if session.view().size == size => {
                match session.apply(&Change::Files(changed)) {
                    Ok(Outcome::Drawn(drawn)) => drawn.picture,
                    Ok(Outcome::Unchanged) => session.render()?.0,
                    Err(refused) => {
                        // What was refused would be told again with the next scene.
                        self.session = None;
                        return Err(refused.findings);
                    }
                }
            }
            _ => {
                let options = SessionOptions {
                    size,
                    ..self.options.clone()
                };
                let scene = Scene::load(
                    &self.graph(),
                    &options.overrides,
                    &options.shader_folders,
                    volgraph_nodes::registry(),
                    &NoProgress,
                )?;
                let mut session = Session::start(scene, Arc::clone(&self.gpu), &options)?;
                let picture = session.render()?.0;
                self.session = Some(session);
                picture
            }
        };
        let voxel = self
            .session
            .as_ref()
            .and_then(|session| volume(session.scene()))
            .map_or(1.0, |volume| volume.grid().min_spacing());
        Ok(Drawing { picture, voxel })
    }
}

impl Drawing {
    /// What is looked at.
    pub fn pixels(&self, quantity: Quantity) -> Result<Pixels, Findings> {
        let picture = &self.picture;
        let missing = |what: &str| -> Findings {
            Finding::error("internal", format!("the picture has no {what}")).into()
        };
        let values = match quantity {
            Quantity::Color => picture
                .color
                .iter()
                .map(|color| Some(color.map(f64::from)))
                .collect(),
            Quantity::Depth => picture
                .depth
                .as_ref()
                .ok_or_else(|| missing("depth"))?
                .iter()
                .map(|depth| Some([f64::from(*depth) / self.voxel, 0.0, 0.0, 0.0]))
                .collect(),
            Quantity::Normal => match picture.layer("normal") {
                Some(LayerValues::Vector(normals)) => normals
                    .iter()
                    .map(|normal| Some(normal.map(f64::from)))
                    .collect(),
                _ => return Err(missing("normals")),
            },
        };
        Ok(Pixels {
            size: [picture.width, picture.height],
            values,
        })
    }
}

/// The volume that a scene draws.
pub(super) fn volume(scene: &Scene) -> Option<&Arc<Volume>> {
    let source = scene.sources.get("volume")?;
    let source = source.as_any().downcast_ref::<VolumeSource>()?;
    Some(&source.volume)
}

/// The view of a scene's picture.
pub(super) fn view(scene: &Scene, size: [u32; 2]) -> Result<View, Findings> {
    Ok(crate::truth::plan_without_device(scene, size)?.view())
}

fn first(findings: &Findings) -> String {
    findings
        .sorted()
        .first()
        .map_or_else(String::new, |finding| {
            format!("{} ({})", finding.message, finding.code)
        })
}

/// The same findings, with the scene that they are of.
fn told(findings: &Findings, case: &str, point: &str) -> Findings {
    findings
        .sorted()
        .into_iter()
        .map(|finding| {
            let mut finding = finding.clone();
            finding.message = format!("{case}, {point}: {}", finding.message);
            finding
        })
        .collect()
}

fn unwritable(error: &std::io::Error) -> Findings {
    Finding::error("io", format!("a scene cannot be written: {error}"))
        .help("give a folder for temporary files with room, in TMPDIR")
        .into()
}
