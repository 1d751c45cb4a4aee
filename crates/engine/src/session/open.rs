//! Opening a session: a graph is loaded, a device opened, and the plan for it made and installed.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use volgraph_gpu::{AdapterChoice, Gpu};
use volgraph_graph::{Limits, Registry};
use volgraph_report::Findings;
use volgraph_shader::{DiskFiles, SnapshotFiles};

use super::{Session, Stance, State, apply, runner};
use crate::dependencies::Dependencies;
use crate::overrides::Overrides;
use crate::quality;
use crate::scene::{NoProgress, Scene, SourceProgress};
use crate::shaders::ShaderFolders;
use crate::truth::default_cache;

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
    /// Whether pictures carry depth and opacity, and the graph's other outputs as layers.
    pub with_layers: bool,
    /// Most bytes of one texture or buffer; [`Limits::max_resource_bytes`] by default. More is refused before it is
    /// allocated. For devices with large memories.
    pub max_resource_bytes: Option<u64>,
    /// Whether the graph's settings stand as they are written, whatever budget it states.
    pub is_as_written: bool,
    /// Where what is chosen for a budget is kept, and what makes the next start faster; nowhere where it is `None`.
    pub cache: Option<PathBuf>,
}

impl Default for SessionOptions {
    fn default() -> Self {
        Self {
            adapter: AdapterChoice::default(),
            size: [512, 512],
            overrides: Overrides::default(),
            shader_folders: ShaderFolders::default(),
            with_layers: false,
            max_resource_bytes: None,
            is_as_written: false,
            cache: default_cache(),
        }
    }
}

impl SessionOptions {
    /// What plans for a device may ask for.
    #[must_use]
    pub fn limits(&self, gpu: &Gpu) -> Limits {
        let limits = gpu.limits();
        Limits {
            max_resource_bytes: self.max_resource_bytes.unwrap_or(limits.max_resource_bytes),
            ..limits
        }
    }
}

/// Why there is no session.
#[derive(Clone, Debug)]
pub struct Unopened {
    /// Everything wrong.
    pub findings: Findings,
    /// The files that were looked at.
    pub dependencies: Dependencies,
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
        Self::begin(graph, options, registry, progress).map_err(|unopened| unopened.findings)
    }

    /// The same; where it fails, it says which files to watch for a remedy.
    ///
    /// # Errors
    /// As [`Self::open`].
    pub fn begin(
        graph: &Path,
        options: &SessionOptions,
        registry: Registry,
        progress: &dyn SourceProgress,
    ) -> Result<Self, Unopened> {
        Self::begin_on(graph, options, registry, progress, None)
    }

    /// The same on a device that is open already, where there is one.
    ///
    /// # Errors
    /// As [`Self::begin`].
    pub fn begin_on(
        graph: &Path,
        options: &SessionOptions,
        registry: Registry,
        progress: &dyn SourceProgress,
        gpu: Option<Arc<Gpu>>,
    ) -> Result<Self, Unopened> {
        let mut dependencies = Dependencies::default();
        let loaded = Scene::load_noting(
            graph,
            &options.overrides,
            &options.shader_folders,
            registry,
            progress,
            &mut dependencies,
        );
        let started = loaded.and_then(|scene| {
            // Where there is no device, what the sources were read from is all that is known.
            dependencies = Dependencies::of(&scene, &SnapshotFiles::new(Arc::new(DiskFiles)));
            let gpu = match gpu {
                Some(gpu) => gpu,
                None => Arc::new(Gpu::open(&options.adapter)?),
            };
            Self::start_noting(scene, gpu, options, &mut dependencies)
        });
        started.map_err(|findings| Unopened {
            findings,
            dependencies,
        })
    }

    /// A session for a loaded scene on an open device.
    ///
    /// # Errors
    /// As [`Self::open`].
    pub fn start(scene: Scene, gpu: Arc<Gpu>, options: &SessionOptions) -> Result<Self, Findings> {
        Self::start_noting(scene, gpu, options, &mut Dependencies::default())
    }

    fn start_noting(
        scene: Scene,
        gpu: Arc<Gpu>,
        options: &SessionOptions,
        dependencies: &mut Dependencies,
    ) -> Result<Self, Findings> {
        scene.check_color_output()?;
        let wanted = scene.overrides.clone();
        let (shaders, snapshot) = apply::library(&scene, &gpu);
        let limits = options.limits(&gpu);
        let plan_of =
            |scene: &Scene| scene.plan(&shaders, &limits, options.size, options.with_layers);
        let settled = quality::settle(scene.clone(), &gpu, options, None);
        let (scene, chosen) = match settled {
            Ok((scene, chosen)) => (scene, Ok(chosen)),
            Err(findings) => (scene, Err(findings)),
        };
        // Also where nothing can be chosen for a budget it is known which files may mend that.
        let plan = plan_of(&scene);
        *dependencies = Dependencies::of(&scene, &snapshot);
        let chosen = chosen?;
        let plan = plan?;
        let stance = Stance::Graph;
        let view = stance.view(&plan);
        let mut runner = runner(gpu, options);
        let installation = runner.prepare(Arc::new(plan), &view, None)?;
        Ok(Self {
            options: options.clone(),
            runner,
            wanted,
            dependencies: dependencies.clone(),
            state: State {
                scene,
                shaders,
                snapshot,
                installation,
                stance,
                view,
                chosen,
                is_proven: false,
            },
            pending: BTreeSet::new(),
            refused_files: None,
            refused: None,
            remade: None,
        })
    }
}
