//! A session: one graph on one device, rendered as often as wanted.

use std::path::Path;
use std::sync::Arc;

use volgraph_gpu::{AdapterChoice, AdapterSummary, FrameReport, Gpu, Runner, Texels};
use volgraph_graph::demand::ShaderLibrary;
use volgraph_graph::{Camera, CameraDesc, Plan, Registry, View};
use volgraph_nodes::raycast::NO_DEPTH;
use volgraph_picture::Picture;
use volgraph_report::{Finding, Findings};

use crate::metadata;
use crate::overrides::Overrides;
use crate::scene::{NoProgress, Scene, SourceProgress};
use crate::shaders::ShaderFolders;

/// How a session is opened.
#[derive(Clone, Debug)]
pub struct SessionOptions {
    /// Which adapter.
    pub adapter: AdapterChoice,
    /// Width and height of the picture in pixels.
    pub size: [u32; 2],
    /// Changes to the graph.
    pub overrides: Overrides,
    /// Where shaders are.
    pub shader_folders: ShaderFolders,
    /// Whether pictures carry depth and opacity.
    pub with_layers: bool,
}

impl Default for SessionOptions {
    fn default() -> Self {
        Self {
            adapter: AdapterChoice::default(),
            size: [512, 512],
            overrides: Overrides::default(),
            shader_folders: ShaderFolders::default(),
            with_layers: false,
        }
    }
}

/// A graph on a device.
pub struct Session {
    scene: Scene,
    shaders: ShaderLibrary,
    runner: Runner,
    plan: Arc<Plan>,
    view: View,
    with_layers: bool,
}

impl Session {
    /// Loads a graph with volgraph's own kinds and opens a device for it.
    ///
    /// # Errors
    /// Everything wrong with the graph, its sources and shaders, or why there is no device.
    pub fn open(graph: impl AsRef<Path>, options: &SessionOptions) -> Result<Self, Findings> {
        Self::open_with(
            graph.as_ref(),
            options,
            volgraph_nodes::registry(),
            &NoProgress,
        )
    }

    /// The same with kinds of one's own, and progress.
    ///
    /// # Errors
    /// As [`Self::open`].
    pub fn open_with(
        graph: &Path,
        options: &SessionOptions,
        registry: Registry,
        progress: &dyn SourceProgress,
    ) -> Result<Self, Findings> {
        let scene = Scene::load(
            graph,
            &options.overrides,
            &options.shader_folders,
            registry,
            progress,
        )?;
        let gpu = Arc::new(Gpu::open(&options.adapter)?);
        Self::start(scene, gpu, options)
    }

    /// A session for a loaded scene on an open device.
    ///
    /// # Errors
    /// As [`Self::open`].
    pub fn start(scene: Scene, gpu: Arc<Gpu>, options: &SessionOptions) -> Result<Self, Findings> {
        scene.check_color_output()?;
        let shaders = scene.shader_library(gpu.capabilities());
        let plan =
            Arc::new(scene.plan(&shaders, &gpu.limits(), options.size, options.with_layers)?);
        let view = plan.view();
        let mut runner = Runner::new(gpu);
        runner.install(Arc::clone(&plan))?;
        Ok(Self {
            scene,
            shaders,
            runner,
            plan,
            view,
            with_layers: options.with_layers,
        })
    }

    /// The scene.
    #[must_use]
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The plan that runs.
    #[must_use]
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// The adapter that it runs on.
    #[must_use]
    pub fn adapter(&self) -> &AdapterSummary {
        self.runner.gpu().adapter()
    }

    /// The current view.
    #[must_use]
    pub fn view(&self) -> &View {
        &self.view
    }

    /// Moves the camera; what stays open in `camera` is fitted to the volumes.
    pub fn set_camera(&mut self, camera: &CameraDesc) {
        self.view.camera = self.plan.fit(camera);
    }

    /// Moves the camera to exactly there.
    pub fn place_camera(&mut self, camera: Camera) {
        self.view.camera = camera;
    }

    /// Changes the size of the picture. The camera stays where it is.
    ///
    /// # Errors
    /// Where the size is over the device's limits; the session is then as before.
    pub fn set_size(&mut self, size: [u32; 2]) -> Result<(), Findings> {
        let plan = self.scene.plan(
            &self.shaders,
            &self.runner.gpu().limits(),
            size,
            self.with_layers,
        )?;
        let plan = Arc::new(plan);
        self.runner.install(Arc::clone(&plan))?;
        self.view.size = size;
        self.plan = plan;
        Ok(())
    }

    /// Draws a frame without reading it back.
    ///
    /// # Errors
    /// What a node or the device refused.
    pub fn draw(&mut self) -> Result<FrameReport, Findings> {
        Ok(self.runner.frame(&self.view)?)
    }

    /// Draws the frame and reads the output `color` back, with depth and opacity where the session has them.
    ///
    /// # Errors
    /// What a node or the device refused.
    pub fn render(&mut self) -> Result<(Picture, FrameReport), Findings> {
        let report = self.draw()?;
        let mut picture = self.read("color")?;
        let layer = |name: &str| -> Result<Option<Vec<f32>>, Findings> {
            if self.plan.graph.outputs.contains_key(name) {
                Ok(Some(self.runner.read(name)?.to_f32()))
            } else {
                Ok(None)
            }
        };
        picture.opacity = layer("opacity")?;
        picture.depth = layer("depth")?;
        for depth in picture.depth.iter_mut().flatten() {
            if *depth >= NO_DEPTH {
                *depth = f32::INFINITY;
            }
        }
        picture.metadata = metadata::of(&self.scene, &self.plan, &self.view, self.adapter());
        Ok((picture, report))
    }

    /// Reads any 2D colour output of the last frame.
    ///
    /// # Errors
    /// Where there is no such output, or it is no colour.
    pub fn read(&self, output: &str) -> Result<Picture, Findings> {
        let texels: Texels = self.runner.read(output)?;
        let numbers = texels.to_f32();
        let [width, height, _] = texels.extent;
        let pixels = width as usize * height as usize;
        let color: Vec<[f32; 4]> = if numbers.len() == 4 * pixels {
            numbers
                .chunks_exact(4)
                .map(|p| [p[0], p[1], p[2], p[3]])
                .collect()
        } else if numbers.len() == pixels {
            numbers
                .iter()
                .map(|&value| [value, value, value, 1.0])
                .collect()
        } else {
            return Err(Finding::error(
                "output",
                format!("output `{output}` is no picture but {:?}", texels.format),
            )
            .help("name an output of a port of type color or scalar_2d")
            .into());
        };
        Picture::from_color(width, height, color)
            .map_err(|error| Finding::error("picture", error.to_string()).into())
    }
}
