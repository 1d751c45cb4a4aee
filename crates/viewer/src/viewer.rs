//! The interface: menus, keys, panels, and the requests that come of them.

use std::path::Path;

use egui::{Key, KeyboardShortcut, Modifiers, Ui};
use egui_tiles::{Behavior, SimplificationOptions, TileId, Tiles, Tree, UiResponse};

use crate::blit::Shot;
use crate::export::Export;
use crate::histogram::{Histograms, first_volume};
use crate::navigate::Axis;
use crate::panels::graph::GraphPanel;
use crate::panels::slices::SlicesPanel;
use crate::panels::transfer::TransferSight;
use crate::panels::{messages, parameters, ray, transfer};
use crate::settings::{Overlay, Pane, Settings};
use crate::transfer::TransferEdit;
use crate::view::View;
use crate::worker::{Request, Told, Worker};
use crate::write_back;

const UNDO_HINT: &str = "Ctrl+Z and Ctrl+Shift+Z over the transfer function";

/// Keys, and what they do.
const KEYS: [(&str, &str); 21] = [
    ("drag", "orbit (look around while walking)"),
    ("Shift + drag, middle drag", "pan"),
    ("wheel, right drag", "zoom (walk while walking)"),
    ("Ctrl + drag", "roll"),
    (
        "Alt + drag",
        "window and level: shift and stretch the transfer function",
    ),
    ("arrows", "orbit"),
    ("1 to 6", "front, back, left, right, top, bottom"),
    ("F", "fit the volumes into the view"),
    ("O", "parallel or perspective projection"),
    (
        "Tab",
        "walk inside of the volume: W A S D, E and Q up and down",
    ),
    ("Alt + hover", "numbers of a pixel"),
    ("Space", "pause: files are not followed"),
    ("Enter", "read the files again and draw one frame"),
    ("click", "the ray of that pixel, in the panel Ray"),
    ("B", "before and after the last change; drag the bar"),
    ("C", "compare a small picture with its reference"),
    ("P", "save the picture"),
    ("Ctrl + O", "open a graph or a volume"),
    ("Ctrl + S", "write changed values into the graph file"),
    ("Ctrl + Z", "undo in the transfer function"),
    ("F1", "this sheet"),
];

/// The whole interface, without its window.
pub struct Viewer {
    worker: Worker,
    settings: Settings,
    layout: Tree<Pane>,
    panels: Panels,
    is_budget_given: bool,
    is_help_open: bool,
    message: Option<String>,
    export: Export,
}

/// What panels remember.
#[derive(Default)]
struct Panels {
    view: View,
    graph: GraphPanel,
    slices: SlicesPanel,
    transfer: Option<TransferEdit>,
    histograms: Histograms,
    /// The study that the slices followed last.
    followed: usize,
}

impl Viewer {
    /// An interface to a thread that draws.
    #[must_use]
    pub fn new(worker: Worker, settings: Settings) -> Self {
        Self {
            is_budget_given: false,
            worker,
            settings,
            layout: default_layout(),
            panels: Panels::default(),
            is_help_open: false,
            message: None,
            export: Export::default(),
        }
    }

    /// Holds to a budget whatever is remembered.
    #[must_use]
    pub fn with_budget(mut self, budget: std::time::Duration) -> Self {
        self.settings.budget_ms = budget.as_secs_f64() * 1e3;
        self.is_budget_given = true;
        self
    }

    /// Takes over what an earlier window remembered.
    pub fn restore(&mut self, settings: Option<Settings>, layout: Option<Tree<Pane>>) {
        if let Some(settings) = settings {
            let budget_ms = self.settings.budget_ms;
            self.settings = settings;
            // What the command line says counts more than what is remembered.
            if self.is_budget_given {
                self.settings.budget_ms = budget_ms;
            }
        }
        // A layout of other panels than there are now is not taken.
        let is_whole = |layout: &Tree<Pane>| {
            Pane::ALL
                .iter()
                .all(|pane| layout.tiles.find_pane(pane).is_some())
        };
        if let Some(layout) = layout.filter(is_whole) {
            self.layout = layout;
        }
        self.worker.ask(Request::Budget(self.settings.budget_ms));
    }

    /// The thread that draws.
    #[must_use]
    pub fn worker(&self) -> &Worker {
        &self.worker
    }

    /// What is remembered.
    #[must_use]
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Puts a graph in front of the recent ones; those of volgraph's own are in a menu anyway.
    pub(crate) fn remember(&mut self, graph: &Path) {
        if graph.is_file() {
            self.settings.remember(graph);
        }
    }

    /// Lets go of what belongs to a window that was closed.
    pub(crate) fn leave_window(&mut self) {
        self.panels.view.leave_window();
        self.panels.graph.leave_window();
        self.panels.slices.leave_window();
    }

    /// Where the panels are.
    #[must_use]
    pub fn layout(&self) -> &Tree<Pane> {
        &self.layout
    }

    /// Turns the camera, in heights of the view.
    pub fn orbit(&mut self, right: f64, down: f64) {
        if let Some(navigation) = &mut self.panels.view.navigation {
            navigation.orbit(right, down);
            self.panels.view.has_moved = true;
            self.worker.ask(Request::Camera(navigation.camera));
        }
    }

    /// Draws pictures of this size, however large the view is.
    #[must_use]
    pub fn with_size(mut self, size: [u32; 2]) -> Self {
        self.panels.view.fixed_size = Some(size);
        self
    }

    /// Brings a panel to the front.
    pub fn bring(&mut self, pane: Pane) {
        if let Some(tile) = self.layout.tiles.find_pane(&pane) {
            self.layout.set_visible(tile, true);
            self.layout.make_active(|id, _| id == tile);
        }
    }

    /// Draws the interface; `shot` is the picture as the interface's renderer knows it.
    pub fn show(&mut self, ui: &mut Ui, shot: Option<&Shot>) {
        let mut requests = Vec::new();
        self.take_dropped(ui);
        self.shortcuts(ui, &mut requests);
        egui::Panel::top("menu").show(ui, |ui| self.menu(ui, &mut requests));
        {
            let told = self.worker.told();
            self.panels.follow_ray(&told);
            let mut panes = Panes {
                told: &told,
                shot,
                settings: &mut self.settings,
                panels: &mut self.panels,
                requests: &mut requests,
            };
            egui::CentralPanel::no_frame().show(ui, |ui| self.layout.ui(&mut panes, ui));
        }
        self.windows(ui);
        for request in requests {
            self.worker.ask(request);
        }
        if self.worker.has_ended() {
            self.message = Some(
                "The drawing thread has ended by a fault of volgraph; please report it.".to_owned(),
            );
        }
    }

    fn open(&mut self, file: &Path) {
        self.remember(file);
        self.panels.view.forget();
        self.panels.transfer = None;
        self.worker.ask(Request::Open(file.to_owned()));
    }

    /// Files that are dropped into the window: graphs and volumes are opened, a transfer function is taken, a shader
    /// takes the place of the choice of its slot.
    fn take_dropped(&mut self, ui: &Ui) {
        let dropped = ui.input(|input| input.raw.dropped_files.clone());
        for file in dropped.into_iter().map(|file| file.path().to_owned()) {
            self.take_file(&file);
        }
    }

    /// As if the file was dropped into the window.
    pub fn take_file(&mut self, file: &Path) {
        let name = file
            .extension()
            .map(|name| name.to_string_lossy().to_lowercase());
        match name.as_deref() {
            Some("wgsl") => self.take_shader(file),
            Some("ron") => match volgraph_optics::TransferFunction::load(file) {
                Ok(transfer) => {
                    if let Some(edit) = &mut self.panels.transfer {
                        for request in edit.change(Ok(transfer)) {
                            self.worker.ask(request);
                        }
                    }
                }
                // What is no transfer function is a graph, and says itself what is wrong with it.
                Err(_) => self.open(file),
            },
            _ => self.open(file),
        }
    }

    /// A shader file fills the slot that its folder is named after, of the node that makes the picture.
    fn take_shader(&mut self, file: &Path) {
        let slot = file
            .parent()
            .and_then(Path::file_name)
            .map(|name| name.to_string_lossy().into_owned());
        let node = {
            let told = self.worker.told();
            told.plan.as_ref().and_then(|plan| {
                let link = plan.graph.outputs.get("color")?;
                let node = &plan.graph.nodes[link.node];
                let slot = slot.as_deref()?;
                node.slots.contains_key(slot).then(|| node.name.clone())
            })
        };
        let (Some(slot), Some(node)) = (slot, node) else {
            self.message = Some(format!(
                "{} fills no slot of the picture's node: its folder must be named after the slot, as in slot/technique",
                file.display()
            ));
            return;
        };
        let typed = format!("{node}.slots.{slot}={:?}", file.display().to_string());
        if let Ok(set) = volgraph_engine::ParamOverride::parse(&typed) {
            self.worker.ask(Request::Set(vec![set]));
        }
    }

    fn shortcuts(&mut self, ui: &Ui, requests: &mut Vec<Request>) {
        if ui.ctx().egui_wants_keyboard_input() {
            return;
        }
        let pressed = |modifiers, key| {
            ui.input_mut(|input| input.consume_shortcut(&KeyboardShortcut::new(modifiers, key)))
        };
        if pressed(Modifiers::COMMAND, Key::O) {
            self.ask_for_file();
        }
        if pressed(Modifiers::COMMAND, Key::S) {
            self.write_back(false, None);
        }
        if pressed(Modifiers::NONE, Key::F1) {
            self.is_help_open = !self.is_help_open;
        }
        if pressed(Modifiers::NONE, Key::Space) {
            let is_paused = self.worker.told().is_paused;
            requests.push(Request::Pause(!is_paused));
        }
        if pressed(Modifiers::NONE, Key::Enter) {
            requests.push(Request::Frame);
        }
        if pressed(Modifiers::NONE, Key::Tab) {
            self.settings.is_walking = !self.settings.is_walking;
        }
        if pressed(Modifiers::NONE, Key::B) {
            self.settings.overlay = match self.settings.overlay {
                Overlay::Wipe => Overlay::None,
                _ => Overlay::Wipe,
            };
        }
        if pressed(Modifiers::NONE, Key::C) {
            self.settings.overlay = Overlay::Error;
            requests.push(Request::Compare);
        }
        if pressed(Modifiers::NONE, Key::P) {
            self.save_picture();
        }
    }

    fn menu(&mut self, ui: &mut Ui, requests: &mut Vec<Request>) {
        egui::MenuBar::new().ui(ui, |ui| {
            ui.menu_button("File", |ui| self.file_menu(ui));
            ui.menu_button("View", |ui| self.view_menu(ui, requests));
            ui.menu_button("Compare", |ui| {
                for (overlay, name) in Overlay::ALL {
                    if ui.radio(self.settings.overlay == overlay, name).clicked() {
                        self.settings.overlay = overlay;
                        if overlay == Overlay::Error {
                            requests.push(Request::Compare);
                        }
                    }
                }
            });
            ui.menu_button("Panels", |ui| {
                for pane in Pane::ALL {
                    if let Some(tile) = self.layout.tiles.find_pane(&pane) {
                        let mut is_open = self.layout.is_visible(tile);
                        if ui.checkbox(&mut is_open, pane.title()).changed() {
                            self.layout.set_visible(tile, is_open);
                        }
                    }
                }
                if ui.button("As at first").clicked() {
                    self.layout = default_layout();
                }
            });
            ui.menu_button("Help", |ui| {
                if ui.button("Keys and mouse").clicked() {
                    self.is_help_open = true;
                }
            });
            let told = self.worker.told();
            if !told.findings.is_empty() {
                ui.colored_label(
                    ui.visuals().error_fg_color,
                    format!("{} wrong", told.findings.len()),
                );
            }
            if told.is_busy {
                ui.spinner();
            }
            if let Some(scene) = &told.scene {
                ui.weak(scene.path.display().to_string());
            }
            if let Some(gpu) = &told.gpu {
                ui.weak(gpu.adapter().to_string());
            }
        });
    }

    fn file_menu(&mut self, ui: &mut Ui) {
        if ui.button("Open…").clicked() {
            self.ask_for_file();
        }
        let recent = self.settings.recent.clone();
        ui.menu_button("Recent", |ui| {
            for file in recent {
                if ui.button(file.display().to_string()).clicked() {
                    self.open(&file);
                }
            }
        });
        ui.menu_button("Ready graphs", |ui| {
            egui::ScrollArea::vertical().show(ui, |ui| {
                for ready in volgraph_engine::ready_graphs() {
                    if ui.button(&ready.name).clicked() {
                        self.open(Path::new(&ready.name));
                    }
                }
            });
        });
        ui.separator();
        if ui.button("Write changes into the graph file").clicked() {
            self.write_back(false, None);
        }
        if ui
            .button("Write changes and camera into the graph file")
            .clicked()
        {
            self.write_back(true, None);
        }
        if ui.button("Write into another graph file…").clicked()
            && let Some(file) = rfd::FileDialog::new()
                .add_filter("graph", &["ron"])
                .save_file()
        {
            self.write_back(true, Some(&file));
        }
        ui.separator();
        if ui.button("Save the picture…").clicked() {
            self.save_picture();
        }
        if ui.button("Picture of any size, film…").clicked() {
            self.export.is_open = true;
        }
        ui.separator();
        if ui.button("Quit").clicked() {
            ui.ctx().send_viewport_cmd(egui::ViewportCommand::Close);
        }
    }

    fn view_menu(&mut self, ui: &mut Ui, requests: &mut Vec<Request>) {
        let mut moved = false;
        if let Some(navigation) = &mut self.panels.view.navigation {
            if ui.button("Fit").clicked() {
                navigation.fit(navigation.middle, 1.0);
                moved = true;
            }
            if ui.button("Parallel or perspective").clicked() {
                navigation.toggle_orthographic();
                moved = true;
            }
            ui.menu_button("From", |ui| {
                for (axis, name) in Axis::ALL {
                    if ui.button(name).clicked() {
                        navigation.look_along(axis);
                        moved = true;
                    }
                }
            });
            if moved {
                requests.push(Request::Camera(navigation.camera));
            }
        }
        self.panels.view.has_moved |= moved;
        let settings = &mut self.settings;
        ui.checkbox(&mut settings.is_walking, "Walk");
        ui.separator();
        let mut is_paused = self.worker.told().is_paused;
        if ui.checkbox(&mut is_paused, "Paused").changed() {
            requests.push(Request::Pause(is_paused));
        }
        if ui.button("One frame").clicked() {
            requests.push(Request::Frame);
        }
        ui.separator();
        ui.checkbox(&mut settings.has_scale_bar, "Scale bar");
        ui.checkbox(&mut settings.has_marker, "Axes");
        ui.checkbox(&mut settings.has_color_bar, "Colour bar");
        ui.checkbox(&mut settings.has_handles, "Handles of clip shapes");
        let budget = egui::Slider::new(&mut settings.budget_ms, 5.0..=500.0)
            .logarithmic(true)
            .text("ms while moving");
        if ui.add(budget).changed() {
            requests.push(Request::Budget(settings.budget_ms));
        }
        ui.add(
            egui::Slider::new(&mut settings.resolution, 0.25..=2.0).text("pixels per screen pixel"),
        );
        ui.separator();
        // In words: the fonts hold no sun and moon.
        ui.horizontal(|ui| {
            let mut theme = ui.ctx().options(|options| options.theme_preference);
            for (preference, name) in [
                (egui::ThemePreference::System, "As the system"),
                (egui::ThemePreference::Dark, "Dark"),
                (egui::ThemePreference::Light, "Light"),
            ] {
                ui.selectable_value(&mut theme, preference, name);
            }
            ui.ctx().set_theme(theme);
        });
    }

    fn windows(&mut self, ui: &Ui) {
        egui::Window::new("Keys and mouse")
            .open(&mut self.is_help_open)
            .resizable(false)
            .show(ui.ctx(), |ui| {
                egui::Grid::new("keys")
                    .num_columns(2)
                    .striped(true)
                    .show(ui, |ui| {
                        for (keys, what) in KEYS {
                            ui.strong(keys);
                            ui.label(what);
                            ui.end_row();
                        }
                    });
                ui.weak(UNDO_HINT);
            });
        if let Some(request) = self.export.show(ui, self.panels.view.navigation.as_ref()) {
            self.worker.ask(request);
        }
        if let Some(message) = self.message.clone() {
            let mut is_open = true;
            egui::Window::new("Note")
                .open(&mut is_open)
                .collapsible(false)
                .show(ui.ctx(), |ui| {
                    ui.label(message);
                });
            if !is_open {
                self.message = None;
            }
        }
    }

    fn ask_for_file(&mut self) {
        let mut dialog = rfd::FileDialog::new().set_title("Open a graph or a volume");
        if let Some(folder) = self.settings.recent.first().and_then(|file| file.parent()) {
            dialog = dialog.set_directory(folder);
        }
        if let Some(file) = dialog.pick_file() {
            self.take_file(&file);
        }
    }

    fn save_picture(&mut self) {
        let picture = self.worker.told().refined.clone();
        let Some(picture) = picture else {
            self.message = Some("There is no picture yet.".to_owned());
            return;
        };
        let dialog = rfd::FileDialog::new()
            .add_filter("picture", &["png", "exr"])
            .set_file_name("volgraph.png");
        let Some(file) = dialog.save_file() else {
            return;
        };
        if let Err(error) = picture.save(&file, Default::default()) {
            self.message = Some(error.to_string());
        }
    }

    /// Writes what was set, and the camera where asked for, into the graph's own file or another one.
    fn write_back(&mut self, with_camera: bool, to: Option<&Path>) {
        let Some(scene) = self.worker.told().scene.clone() else {
            return;
        };
        let navigation = self.panels.view.navigation.filter(|_| with_camera);
        let camera = navigation.map(|navigation| navigation.described());
        let to = to.unwrap_or(&scene.path);
        let written = write_back::write(&scene, self.panels.transfer.as_ref(), camera, to);
        self.message = Some(written.unwrap_or_else(|findings| findings.to_string()));
    }
}

/// The panels, as the layout shows them.
struct Panes<'a> {
    told: &'a Told,
    shot: Option<&'a Shot>,
    settings: &'a mut Settings,
    panels: &'a mut Panels,
    requests: &'a mut Vec<Request>,
}

impl Behavior<Pane> for Panes<'_> {
    fn pane_ui(&mut self, ui: &mut Ui, _tile: TileId, pane: &mut Pane) -> UiResponse {
        let frame = match pane {
            Pane::View => egui::Frame::NONE,
            _ => egui::Frame::NONE.inner_margin(6.0),
        };
        frame.show(ui, |ui| self.pane(ui, *pane));
        UiResponse::None
    }

    fn tab_title_for_pane(&mut self, pane: &Pane) -> egui::WidgetText {
        let count = self.told.findings.len();
        match pane {
            Pane::Messages if count > 0 => format!("Messages ({count})").into(),
            _ => pane.title().into(),
        }
    }

    fn simplification_options(&self) -> SimplificationOptions {
        SimplificationOptions {
            all_panes_must_have_tabs: true,
            ..Default::default()
        }
    }
}

impl Panes<'_> {
    fn pane(&mut self, ui: &mut Ui, pane: Pane) {
        let (told, panels) = (self.told, &mut *self.panels);
        let asked = match pane {
            Pane::View => {
                let crosshair = told
                    .scene
                    .as_ref()
                    .and_then(first_volume)
                    .and_then(|(_, digest, volume)| panels.slices.crosshair(digest, &volume));
                let view = &mut panels.view;
                let mut asked = view.show(ui, told, self.shot, self.settings, crosshair);
                asked.extend(panels.window(told));
                asked
            }
            Pane::Parameters => parameters::show(ui, told),
            Pane::Messages => {
                messages::show(ui, told);
                Vec::new()
            }
            Pane::Graph => panels.graph.show(ui, told),
            Pane::Slices => {
                match told.scene.as_ref().and_then(first_volume) {
                    Some((_, digest, volume)) => panels.slices.show(ui, digest, &volume),
                    None => {
                        ui.weak("The graph has no volume.");
                    }
                }
                Vec::new()
            }
            Pane::Transfer => panels.transfer(ui, told, self.settings),
            Pane::Ray => {
                ray::show(ui, told);
                Vec::new()
            }
        };
        self.requests.extend(asked);
    }
}

impl Panels {
    /// The crosshair of the slices goes to where the studied ray met most.
    fn follow_ray(&mut self, told: &Told) {
        let Some(Ok(study)) = &told.ray else {
            return;
        };
        let key = std::sync::Arc::as_ptr(study) as usize;
        let place = study.hit.as_ref().or(study.strongest.as_ref());
        if let (true, Some(probe), Some(scene)) = (self.followed != key, place, &told.scene)
            && let Some((_, digest, volume)) = first_volume(scene)
        {
            self.slices.go_to(digest, &volume, probe.world.into());
        }
        self.followed = key;
    }

    /// Window and level: a drag over the picture shifts the transfer function (across) and stretches it (down).
    fn window(&mut self, told: &Told) -> Vec<Request> {
        let drag = self.view.window.take();
        let Some(edit) = self.edit(told) else {
            return Vec::new();
        };
        let Some([right, down]) = drag else {
            if !edit.is_panel_dragging {
                edit.end_drag();
            }
            return Vec::new();
        };
        edit.begin_drag();
        let (low, high) = edit.transfer.range();
        edit.window(right * (high - low), 1.0 + 2.0 * down)
    }

    /// The transfer function of the scene, under edit.
    fn edit(&mut self, told: &Told) -> Option<&mut TransferEdit> {
        let scene = told.scene.as_ref()?;
        match &mut self.transfer {
            Some(edit) => edit.follow(scene),
            none => *none = TransferEdit::of(scene),
        }
        self.transfer.as_mut()
    }

    fn transfer(&mut self, ui: &mut Ui, told: &Told, settings: &mut Settings) -> Vec<Request> {
        let Some(scene) = &told.scene else {
            ui.weak("No graph is open.");
            return Vec::new();
        };
        self.edit(told);
        let (Some(edit), Some((_, digest, volume))) = (&mut self.transfer, first_volume(scene))
        else {
            ui.weak("The graph has no volume with a transfer function.");
            return Vec::new();
        };
        let counted = self.histograms.of(digest, &volume, ui.ctx());
        let sight = TransferSight {
            volume: &volume,
            counted: counted.as_ref().and_then(|counted| counted.get()),
        };
        transfer::show(ui, edit, &sight, &mut settings.is_log)
    }
}

/// The view, what changes it on its right, what tells of it below.
fn default_layout() -> Tree<Pane> {
    let mut tiles = Tiles::default();
    let mut pane = |pane: Pane| tiles.insert_pane(pane);
    let (view, parameters, messages) = (
        pane(Pane::View),
        pane(Pane::Parameters),
        pane(Pane::Messages),
    );
    let (transfer, graph) = (pane(Pane::Transfer), pane(Pane::Graph));
    let (slices, ray) = (pane(Pane::Slices), pane(Pane::Ray));
    let below = tiles.insert_tab_tile(vec![transfer, messages, graph, slices, ray]);
    let left = tiles.insert_vertical_tile(vec![view, below]);
    let right = tiles.insert_tab_tile(vec![parameters]);
    let root = tiles.insert_horizontal_tile(vec![left, right]);
    for (container, shares) in [
        (left, [(view, 1.7), (below, 1.0)]),
        (root, [(left, 3.0), (right, 1.0)]),
    ] {
        if let Some(egui_tiles::Tile::Container(egui_tiles::Container::Linear(linear))) =
            tiles.get_mut(container)
        {
            for (tile, share) in shares {
                linear.shares.set_share(tile, share);
            }
        }
    }
    Tree::new(egui::Id::unique("panels"), root, tiles)
}
