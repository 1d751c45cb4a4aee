//! The harness of volgraph's tests: scenes in a temporary folder, devices, closed forms to compare with.
//!
//! A case writes its files into a [`Stage`], opens a session on each of the [`adapters`] of this machine (Vulkan and GL
//! are both test targets) and compares pixels with a closed form, computed along the ray that [`ray`] gives in f64.
//! With no adapter at all a case fails and says what to install; nothing is skipped in silence.

#![expect(clippy::unwrap_used, reason = "a harness fails by panicking")]

pub mod kinds;
pub mod layers;
pub mod repository;
pub mod slabs;
pub mod trilinear;
pub mod truth;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use glam::DVec3;
use volgraph::{
    Findings, Overrides, ParamOverride, Picture, Registry, Scene, Session, SessionOptions, View,
};
use volgraph_gpu::{AdapterChoice, Gpu, list_adapters};

/// The repository's root.
#[must_use]
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .parent()
        .unwrap()
        .to_path_buf()
}

/// The backends to test on: one adapter of each backend that this machine has.
///
/// # Panics
/// Where there is none.
#[must_use]
pub fn adapters() -> Vec<String> {
    static BACKENDS: OnceLock<Vec<String>> = OnceLock::new();
    let backends = BACKENDS.get_or_init(|| {
        let mut backends: Vec<String> = list_adapters()
            .into_iter()
            .map(|adapter| adapter.backend)
            .collect();
        backends.dedup();
        backends
    });
    assert!(
        !backends.is_empty(),
        "no adapter: `cargo xtask setup` installs a software driver; by hand: apt-get install mesa-vulkan-drivers"
    );
    backends.clone()
}

/// The graph's two stages.
pub const STAGES: [&str; 2] = ["fragment", "compute"];

/// A folder with the files of one scene.
pub struct Stage {
    folder: tempfile::TempDir,
}

impl Default for Stage {
    fn default() -> Self {
        Self::new()
    }
}

impl Stage {
    /// An empty folder.
    #[must_use]
    pub fn new() -> Self {
        Self {
            folder: tempfile::tempdir().unwrap(),
        }
    }

    /// Its path.
    #[must_use]
    pub fn path(&self) -> &Path {
        self.folder.path()
    }

    /// Writes a file.
    #[must_use]
    pub fn with(self, name: &str, content: impl AsRef<[u8]>) -> Self {
        self.write(name, content);
        self
    }

    /// Writes a file, as an edit while a session is open.
    pub fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        let path = self.folder.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, content).unwrap();
    }

    /// Writes a raw float volume of which each voxel is `value(x, y, z)`; its name carries dimensions and type.
    #[must_use]
    pub fn with_floats(
        self,
        name: &str,
        dims: [u32; 3],
        value: impl Fn(u32, u32, u32) -> f32,
    ) -> Self {
        let mut bytes = Vec::new();
        for z in 0..dims[2] {
            for y in 0..dims[1] {
                for x in 0..dims[0] {
                    bytes.extend(value(x, y, z).to_le_bytes());
                }
            }
        }
        let name = format!("{name}_{}x{}x{}_float32.raw", dims[0], dims[1], dims[2]);
        self.with(&name, bytes)
    }

    /// Opens a session for the graph file of that name, with `--set`s, on a backend.
    ///
    /// # Errors
    /// What is wrong with the scene.
    pub fn open(
        &self,
        graph: &str,
        sets: &[&str],
        backend: &str,
        size: [u32; 2],
    ) -> Result<Session, Findings> {
        open(&self.path().join(graph), sets, backend, size)
    }

    /// The same on a device of its own, which may be lost.
    ///
    /// # Errors
    /// What is wrong with the scene.
    pub fn open_alone(
        &self,
        graph: &str,
        backend: &str,
        size: [u32; 2],
    ) -> Result<Session, Findings> {
        Session::open(self.path().join(graph), &options(&[], backend, size))
    }

    /// The same with these options, kinds and device.
    ///
    /// # Errors
    /// What is wrong with the scene.
    pub fn open_with(
        &self,
        graph: &str,
        options: &SessionOptions,
        registry: Registry,
        gpu: Arc<Gpu>,
    ) -> Result<Session, Findings> {
        let scene = Scene::load(
            &self.path().join(graph),
            &options.overrides,
            &options.shader_folders,
            registry,
            &volgraph::NoProgress,
        )?;
        Session::start(scene, gpu, options)
    }
}

/// Opens a session for a graph file.
///
/// # Errors
/// What is wrong with the scene.
pub fn open(
    graph: &Path,
    sets: &[&str],
    backend: &str,
    size: [u32; 2],
) -> Result<Session, Findings> {
    start(load(graph, sets)?, backend, size)
}

/// Loads a graph file with `--set`s.
///
/// # Errors
/// What is wrong with the scene.
pub fn load(graph: &Path, sets: &[&str]) -> Result<Scene, Findings> {
    // Neither is the scene's.
    let options = options(sets, "", [1, 1]);
    Scene::load(
        graph,
        &options.overrides,
        &options.shader_folders,
        volgraph::registry(),
        &volgraph::NoProgress,
    )
}

/// Opens a session for a scene that is loaded.
///
/// # Errors
/// What the device refuses.
pub fn start(scene: Scene, backend: &str, size: [u32; 2]) -> Result<Session, Findings> {
    let options = SessionOptions {
        overrides: scene.overrides.clone(),
        ..options(&[], backend, size)
    };
    Session::start(scene, gpu(backend), &options)
}

/// Options of a session with `--set`s on a backend; pictures carry depth and opacity.
///
/// # Panics
/// Where a set cannot be read.
#[must_use]
pub fn options(sets: &[&str], backend: &str, size: [u32; 2]) -> SessionOptions {
    let overrides = Overrides {
        params: sets
            .iter()
            .map(|set| ParamOverride::parse(set).unwrap())
            .collect(),
        data: data_folders(),
        ..Overrides::default()
    };
    SessionOptions {
        adapter: AdapterChoice::new(Some(backend)),
        size,
        overrides,
        with_layers: true,
        // Each test measures for itself.
        cache: None,
        ..SessionOptions::default()
    }
}

/// A device of its own, which may be lost.
///
/// # Panics
/// Where it cannot be opened.
#[must_use]
pub fn gpu_alone(backend: &str) -> Arc<Gpu> {
    Arc::new(
        Gpu::open(&AdapterChoice::new(Some(backend))).unwrap_or_else(|error| panic!("{error}")),
    )
}

/// The device of a backend, opened once.
fn gpu(backend: &str) -> Arc<Gpu> {
    static OPEN: Mutex<BTreeMap<String, Arc<Gpu>>> = Mutex::new(BTreeMap::new());
    let mut open = OPEN.lock().unwrap_or_else(PoisonError::into_inner);
    let gpu = open.entry(backend.to_owned()).or_insert_with(|| {
        Arc::new(
            Gpu::open(&AdapterChoice::new(Some(backend))).unwrap_or_else(|error| panic!("{error}")),
        )
    });
    Arc::clone(gpu)
}

/// Renders the graph file of a stage once.
///
/// # Panics
/// Where it cannot be rendered.
#[must_use]
pub fn render(stage: &Stage, sets: &[&str], backend: &str, size: [u32; 2]) -> (Picture, View) {
    let mut session = match stage.open("graph.ron", sets, backend, size) {
        Ok(session) => session,
        Err(findings) => panic!("{backend}: {findings}"),
    };
    let (picture, _) = session
        .render()
        .unwrap_or_else(|findings| panic!("{backend}: {findings}"));
    (picture, *session.view())
}

/// Folders of real volumes, where they are: `VOLGRAPH_DATA`, else the folder of shared data beside the repository.
#[must_use]
pub fn data_folders() -> Vec<PathBuf> {
    match std::env::var_os("VOLGRAPH_DATA") {
        Some(folders) => std::env::split_paths(&folders).collect(),
        None => ["classic", "formats/nrrd", "formats/mhd"]
            .iter()
            .map(|folder| root().join("../shared/data").join(folder))
            .filter(|folder| folder.is_dir())
            .collect(),
    }
}

/// The ray through the centre of a pixel: origin and unit direction, in f64.
#[must_use]
pub fn ray(view: &View, x: u32, y: u32) -> (DVec3, DVec3) {
    let lens = view.lens();
    let plane = [
        ((f64::from(x) + 0.5) / f64::from(view.size[0]) * 2.0 - 1.0) * lens.half_extent[0],
        (1.0 - (f64::from(y) + 0.5) / f64::from(view.size[1]) * 2.0) * lens.half_extent[1],
    ];
    let camera = &view.camera;
    let aside = camera.right * plane[0] + camera.up * plane[1];
    if lens.is_orthographic {
        (camera.eye + aside, camera.forward)
    } else {
        (camera.eye, (camera.forward + aside).normalize())
    }
}

/// The distances at which a ray enters and leaves an axis-aligned box, in front of its origin; `None` where it misses.
#[must_use]
pub fn box_interval(
    (origin, direction): (DVec3, DVec3),
    low: DVec3,
    high: DVec3,
) -> Option<(f64, f64)> {
    let a = (low - origin) / direction;
    let b = (high - origin) / direction;
    let near = a.min(b).max_element().max(0.0);
    let far = a.max(b).min_element();
    (far > near).then_some((near, far))
}

/// A graph with one raycast of the volume file `path`; `background` and the `raycast` node's slots and params are given
/// as RON.
#[must_use]
pub fn graph(volume: &str, camera: &str, background: &str, slots: &str, params: &str) -> String {
    format!(
        r#"(
    sources: {{ "volume": volume({volume}), "colors": transfer(path: "transfer.ron") }},
    camera: {camera},
    nodes: {{
        "background": (kind: "background", params: {background}),
        "box": (kind: "proxy_box", in: {{ "volume": "volume" }}),
        "image": (kind: "raycast",
                  in: {{ "volume": "volume", "transfer": "colors", "rays": "box", "behind": "background" }},
                  slots: {slots}, params: {params}),
    }},
    outputs: {{ "color": "image.color" }},
)"#
    )
}
