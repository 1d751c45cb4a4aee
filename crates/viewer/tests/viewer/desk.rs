//! A folder with a small scene, the interface over it, and a drawing thread on a real device.

use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};
use std::time::{Duration, Instant};

use egui::accesskit::Role;
use egui::{Event, Modifiers, PointerButton, Pos2, Rect, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::{By, NodeT, Queryable};
use volgraph_engine::{
    Camera, NoProgress, Overrides, ParamOverride, Picture, Scene, Session, SessionOptions,
    ShaderFolders,
};
use volgraph_gpu::{AdapterChoice, list_adapters};
use volgraph_graph::{PlannedResource, ResourceKind};
use volgraph_viewer::{Request, Settings, Told, Viewer, Worker, WorkerOptions};

/// How long anything may take on a machine that has other things to do.
const LONGEST: Duration = Duration::from_secs(60);

/// A technique of which each parameter is a channel of every pixel that meets the volume.
pub const FLAT: &str = "\
// A colour of parameters wherever a ray meets the volume.
#import \"lib/ray.wgsl\"

struct Params {
    /// Red. @default 0.25 @range 0 1
    bright: f32,
    /// Green. @default 0.5
    free: f32,
    /// Blue, in eighths. @default 2 @range 0 8
    eighths: u32,
    /// Which way round. @default forwards @choices forwards backwards
    turn: u32,
    /// What all of it is multiplied by. @default 1 1 1
    gain: vec3f,
}

struct TechniqueState {
    has_met: bool,
}

fn technique_begin(ray: Ray) -> TechniqueState {
    return TechniqueState(false);
}

fn technique_segment(state: ptr<function, TechniqueState>, ray: ptr<function, Ray>, segment: Segment) -> bool {
    (*state).has_met = true;
    return true;
}

fn technique_finish(state: TechniqueState, ray: Ray) -> RayResult {
    if !state.has_met {
        return ray_nothing();
    }
    let color = vec3f(params.bright, params.free, f32(params.eighths) / 8.0) * params.gain;
    return RayResult(vec4f(select(color, color.zyx, params.turn == 1u), 1.0), RAY_NO_DEPTH);
}
";

/// Where it lies.
pub const FLAT_FILE: &str = "shaders/slot/technique/flat.wgsl";

/// Blue at the smallest, red at the largest value, and ever more of it.
pub const TRANSFER: &str = "(domain: range, points: [(at: 0, color: (0, 0, 1), opacity: 0), (at: 0.5, color: (0, 1, 0), opacity: 0.2), (at: 1, color: (1, 0, 0), opacity: 0.5)])";

/// The value of a voxel: each has its own.
pub fn value(x: u32, y: u32, z: u32) -> f32 {
    (x + 16 * y + 256 * z) as f32
}

/// A graph with one raycast; slots and parameters as RON.
pub fn graph(slots: &str, params: &str) -> String {
    format!(
        r#"(
    sources: {{ "volume": volume(path: "v_16x16x16_float32.raw"), "colors": transfer(path: "transfer.ron") }},
    camera: orbit(azimuth: 30, elevation: 20),
    nodes: {{
        "background": (kind: "background", params: {{ "pattern": "uniform", "color": [0, 0, 0.125, 1] }}),
        "box": (kind: "proxy_box", in: {{ "volume": "volume" }}),
        "image": (kind: "raycast",
                  in: {{ "volume": "volume", "transfer": "colors", "rays": "box", "behind": "background" }},
                  slots: {slots}, params: {params}),
    }},
    outputs: {{ "color": "image.color" }},
)"#
    )
}

/// The graph of [`FLAT`].
pub fn flat() -> String {
    graph(r#"{ "technique": "flat" }"#, "{}")
}

/// The interface and its folder.
pub struct Desk {
    // Ends before the folder is gone.
    pub harness: Harness<'static, Viewer>,
    folder: tempfile::TempDir,
}

impl Desk {
    /// Opens a folder whose graph is this, and waits for its picture.
    pub fn open(graph: &str) -> Self {
        let mut desk = Self::begin(graph, "graph.ron");
        desk.settle("the first picture");
        desk
    }

    /// Opens a file of such a folder, whatever comes of it.
    pub fn begin(graph: &str, file: &str) -> Self {
        Self::begin_with(graph, file, Duration::from_secs(100))
    }

    /// The same with a budget for frames while the camera moves.
    pub fn begin_with(graph: &str, file: &str, budget: Duration) -> Self {
        let folder = tempfile::tempdir().unwrap();
        write(folder.path(), "graph.ron", graph);
        write(folder.path(), "transfer.ron", TRANSFER);
        write(folder.path(), FLAT_FILE, FLAT);
        let voxels =
            (0..16).flat_map(|z| (0..16).flat_map(move |y| (0..16).map(move |x| (x, y, z))));
        let bytes: Vec<u8> = voxels
            .flat_map(|(x, y, z)| value(x, y, z).to_le_bytes())
            .collect();
        write(folder.path(), "v_16x16x16_float32.raw", bytes);
        let worker = Worker::start(WorkerOptions {
            graph: folder.path().join(file),
            session: options(folder.path(), &[], [64, 48]),
            budget: Some(budget),
        });
        // A tenth of the screen's pixels: pictures of a software device are slow.
        let settings = Settings {
            resolution: 0.1,
            budget_ms: budget.as_secs_f64() * 1e3,
            ..Settings::default()
        };
        let viewer = Viewer::new(worker.unwrap(), settings);
        let harness = Harness::builder()
            .with_size(vec2(1400.0, 1000.0))
            // As fast as a screen, so that two clicks are a double click.
            .with_step_dt(1.0 / 60.0)
            .build_ui_state(|ui, viewer: &mut Viewer| viewer.show(ui, None), viewer);
        Self { harness, folder }
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Writes a file as an editor does.
    pub fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        write(self.folder.path(), name, content);
    }

    pub fn ask(&self, request: Request) {
        self.harness.state().worker().ask(request);
    }

    /// What was told, for as long as nothing else asks for it.
    pub fn told<T>(&self, look: impl FnOnce(&Told) -> T) -> T {
        look(&self.harness.state().worker().told())
    }

    /// Steps the interface until what is told is so.
    #[track_caller]
    pub fn wait_until(&mut self, what: &str, holds: impl Fn(&Told) -> bool) {
        let start = Instant::now();
        loop {
            self.harness.step();
            let told = self.harness.state().worker().told();
            if holds(&told) {
                break;
            }
            let has_ended = self.harness.state().worker().has_ended();
            assert!(
                start.elapsed() < LONGEST && !has_ended,
                "{what} did not come; {}",
                summary(&told)
            );
            drop(told);
            std::thread::sleep(Duration::from_millis(4));
        }
        // What was told last is shown as well.
        self.harness.run_steps(2);
    }

    /// Width and height of the picture that the view asks for.
    pub fn view_size(&self) -> [u32; 2] {
        let rect = self.view_rect();
        [rect.width(), rect.height()].map(|side| (side * 0.1).round().max(1.0) as u32)
    }

    /// Where the picture is on the screen.
    pub fn view_rect(&self) -> Rect {
        let by = By::new().role(Role::Image).predicate(|node| {
            node.label()
                .is_some_and(|label| label == "View" || label.starts_with("View, "))
        });
        self.harness.get(by).rect()
    }

    /// Waits for the picture of a camera that stands still, in the view's full size.
    #[track_caller]
    pub fn settle(&mut self, what: &str) -> Arc<Picture> {
        loop {
            self.harness.run_steps(2);
            let size = self.view_size();
            self.wait_until(what, |told| is_settled(told, size));
            // What comes with the picture may have moved the view.
            if self.view_size() == size {
                return self.told(|told| told.refined.clone().unwrap());
            }
        }
    }

    /// Waits until everything that was asked for is answered: what is asked after the answer to something else was told
    /// comes in a turn of its own.
    #[track_caller]
    pub fn answered(&mut self) {
        self.harness.run_steps(2);
        for is_paused in [true, false] {
            self.ask(Request::Pause(is_paused));
            self.wait_until("an answer", |told| told.is_paused == is_paused);
        }
    }

    /// Waits for another one than this.
    #[track_caller]
    pub fn next(&mut self, what: &str, before: &Arc<Picture>) -> Arc<Picture> {
        self.harness.step();
        let size = self.view_size();
        self.wait_until(what, |told| {
            let is_other = |now: &Arc<Picture>| !Arc::ptr_eq(now, before);
            is_settled(told, size) && told.refined.as_ref().is_some_and(is_other)
        });
        self.told(|told| told.refined.clone().unwrap())
    }

    /// What a session of its own draws of the folder's graph as it is on disk, seen as now, with `--set`s.
    pub fn rendered(&self, sets: &[&str], size: [u32; 2]) -> Picture {
        let camera = self.told(|told| told.camera.unwrap());
        render(self.folder.path(), "graph.ron", sets, size, Some(camera))
    }

    /// The only widget of a role with that name.
    #[track_caller]
    pub fn named(&self, role: Role, label: &'static str) -> egui_kittest::Node<'_> {
        self.harness.get_by_role_and_label(role, label)
    }

    /// The textures that nodes write, as `node.port`.
    pub fn ports(&self) -> Vec<String> {
        self.told(|told| {
            let plan = told.plan.as_ref().unwrap();
            let nodes = plan.nodes();
            let ports = nodes.iter().flat_map(|node| {
                let is_texture = |output: &&PlannedResource| {
                    matches!(output.resource, ResourceKind::Texture { .. })
                };
                let outputs = node.outputs.iter().filter(is_texture);
                outputs.map(|output| format!("{}.{}", node.name, output.port))
            });
            ports.collect()
        })
    }

    /// All of them.
    pub fn all(&self, role: Role, label: &'static str) -> Vec<egui_kittest::Node<'_>> {
        self.harness
            .query_all_by_role_and_label(role, label)
            .collect()
    }

    /// Whether a text of many words is shown.
    pub fn shows(&self, part: &str) -> bool {
        let nodes = self.harness.root().children_recursive();
        nodes.into_iter().any(|node| {
            let node = node.accesskit_node();
            [node.label(), node.value()]
                .into_iter()
                .flatten()
                .any(|text| text.contains(part))
        })
    }

    /// What a button puts on the clipboard.
    #[track_caller]
    pub fn copied_by(&mut self, label: &'static str) -> String {
        self.harness.get_by_label(label).click_accesskit();
        self.harness.step();
        let commands = &self.harness.output().platform_output.commands;
        let copied = commands.iter().find_map(|command| match command {
            egui::OutputCommand::CopyText(text) => Some(text.clone()),
            _ => None,
        });
        copied.unwrap_or_else(|| panic!("{label} copies nothing: {commands:?}"))
    }

    pub fn has(&self, label: &'static str) -> bool {
        self.harness.query_all_by_label(label).next().is_some()
    }

    pub fn has_text(&self, part: &'static str) -> bool {
        let mut found = self.harness.query_all_by_label_contains(part);
        found.next().is_some()
    }

    /// Clicks a widget, as assistive technologies do.
    #[track_caller]
    pub fn click(&mut self, label: &'static str) {
        self.harness.get_by_label(label).click_accesskit();
        self.harness.run_steps(3);
    }

    /// Picks an entry of the menu or combo box with that name.
    #[track_caller]
    pub fn pick(&mut self, menu: &'static str, entry: &'static str) {
        self.harness.get_by_label(menu).click();
        self.harness.run_steps(3);
        // Not what the box itself shows.
        let is_entry = By::new().label(entry).role(Role::Button);
        self.harness.get(is_entry.clone()).scroll_to_me();
        self.harness.run_steps(3);
        self.harness.get(is_entry).click();
        self.harness.run_steps(3);
        self.harness.remove_cursor();
        self.harness.run_steps(2);
    }

    /// Opens a menu of the bar on top.
    #[track_caller]
    pub fn menu(&mut self, menu: &'static str) {
        let named = self.harness.query_all_by_label(menu);
        let top = named.min_by(|a, b| a.rect().top().total_cmp(&b.rect().top()));
        top.unwrap().click();
        self.harness.run_steps(3);
    }

    /// Picks one of many in a menu, and closes it.
    #[track_caller]
    pub fn radio(&mut self, menu: &'static str, entry: &'static str) {
        self.menu(menu);
        self.named(Role::RadioButton, entry).click();
        self.harness.run_steps(3);
        self.harness.key_press(egui::Key::Escape);
        self.harness.run_steps(3);
    }

    /// Brings the panel to the front whose tab begins so.
    #[track_caller]
    pub fn tab(&mut self, pane: volgraph_viewer::Pane) {
        self.harness.state_mut().bring(pane);
        self.harness.run_steps(3);
    }

    pub fn press(&mut self, at: Pos2, button: PointerButton, pressed: bool, modifiers: Modifiers) {
        self.harness.event(Event::PointerButton {
            pos: at,
            button,
            pressed,
            modifiers,
        });
        self.harness.step();
    }

    /// Drags from one place to another by a button, with keys held.
    pub fn drag(&mut self, [from, to]: [Pos2; 2], button: PointerButton, modifiers: Modifiers) {
        self.harness.event(Event::ModifiersChanged(modifiers));
        self.harness.hover_at(from);
        self.harness.step();
        self.press(from, button, true, modifiers);
        for step in 1..=4 {
            self.harness
                .hover_at(from + (to - from) * (step as f32 / 4.0));
            self.harness.step();
        }
        self.press(to, button, false, modifiers);
        self.harness.event(Event::ModifiersChanged(Modifiers::NONE));
        self.harness.step();
    }

    /// Turns the wheel over a place, by points of the screen.
    pub fn wheel(&mut self, at: Pos2, turned: f32) {
        self.harness.hover_at(at);
        self.harness.step();
        self.harness.event(Event::MouseWheel {
            unit: egui::MouseWheelUnit::Point,
            delta: vec2(0.0, turned),
            phase: egui::TouchPhase::Move,
            source: egui::MouseWheelSource::Wheel,
            modifiers: Modifiers::NONE,
        });
        // The wheel's way is smoothed over a few frames.
        self.harness.run_steps(20);
    }

    /// Clicks a place.
    pub fn click_at(&mut self, at: Pos2, button: PointerButton) {
        self.harness.hover_at(at);
        self.harness.step();
        self.press(at, button, true, Modifiers::NONE);
        self.press(at, button, false, Modifiers::NONE);
        self.harness.run_steps(2);
    }
}

/// Holds pictures to be the same bit for bit.
#[track_caller]
pub fn assert_same(a: &Picture, b: &Picture) {
    assert_eq!([a.width, a.height], [b.width, b.height]);
    let pairs = a.color.iter().zip(&b.color).enumerate();
    let mut other = pairs.filter(|(_, (a, b))| a != b);
    if let Some((at, (a, b))) = other.next() {
        panic!(
            "{} pixels differ, first {at}: {a:?} {b:?}",
            other.count() + 1
        );
    }
}

/// The colour in the middle.
pub fn middle(picture: &Picture) -> [f32; 4] {
    picture
        .pixel(picture.width / 2, picture.height / 2)
        .unwrap()
}

fn is_settled(told: &Told, size: [u32; 2]) -> bool {
    let is_full = |picture: &Arc<Picture>| [picture.width, picture.height] == size;
    !told.is_busy && told.is_refined && told.refined.as_ref().is_some_and(is_full)
}

/// What was told, in a few lines.
fn summary(told: &Told) -> String {
    let size = told
        .refined
        .as_ref()
        .map(|picture| [picture.width, picture.height]);
    let notes: Vec<&str> = told.notes.iter().map(|note| note.text.as_str()).collect();
    format!(
        "told: picture {} of {size:?}, refined {}, busy {}, paused {}, comparing {}\n{}\n{notes:#?}",
        told.serial,
        told.is_refined,
        told.is_busy,
        told.is_paused,
        told.is_comparing,
        told.findings
    )
}

fn write(folder: &Path, name: &str, content: impl AsRef<[u8]>) {
    let path = folder.join(name);
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    std::fs::write(path, content).unwrap();
}

/// Options of a session over the files of a folder.
pub fn options(folder: &Path, sets: &[&str], size: [u32; 2]) -> SessionOptions {
    let params = sets.iter().map(|set| ParamOverride::parse(set).unwrap());
    SessionOptions {
        adapter: AdapterChoice::new(Some(backend())),
        size,
        overrides: Overrides {
            params: params.collect(),
            ..Overrides::default()
        },
        shader_folders: ShaderFolders {
            own: vec![folder.join("shaders")],
        },
        // Each test measures for itself.
        cache: None,
        ..SessionOptions::default()
    }
}

/// What a session of its own draws of a graph.
pub fn render(
    folder: &Path,
    graph: &str,
    sets: &[&str],
    size: [u32; 2],
    camera: Option<Camera>,
) -> Picture {
    let options = options(folder, sets, size);
    let scene = Scene::load(
        &folder.join(graph),
        &options.overrides,
        &options.shader_folders,
        volgraph_engine::registry(),
        &NoProgress,
    );
    let gpu = volgraph_gpu::Gpu::open(&options.adapter);
    let gpu = Arc::new(gpu.unwrap_or_else(|error| panic!("{error}")));
    let mut session = scene
        .and_then(|scene| Session::start(scene, gpu, &options))
        .unwrap_or_else(|findings| panic!("{findings}"));
    if let Some(camera) = camera {
        session.place_camera(camera);
    }
    session
        .render()
        .unwrap_or_else(|findings| panic!("{findings}"))
        .0
}

/// The backend to test on: the first of this machine, Vulkan where there is one.
fn backend() -> &'static str {
    static BACKEND: OnceLock<String> = OnceLock::new();
    BACKEND.get_or_init(|| {
        let first = list_adapters().into_iter().next();
        first.map(|adapter| adapter.backend).expect(
            "no adapter: `cargo xtask setup` installs a software driver; by hand: apt-get install mesa-vulkan-drivers",
        )
    })
}
