//! The interface: menus, keys, panels, and the requests that come of them.

mod menus;
mod panes;
mod time;

use std::path::Path;

use egui::Ui;
use egui_tiles::Tree;

use self::panes::{Panels, Panes, default_layout};
use self::time::TimeBar;
use crate::blit::Shot;
use crate::export::Export;
use crate::settings::{Pane, Settings};
use crate::worker::{Request, Worker};
use crate::write_back;

/// The whole interface, without its window.
pub struct Viewer {
    worker: Worker,
    settings: Settings,
    layout: Tree<Pane>,
    panels: Panels,
    time: TimeBar,
    is_budget_given: bool,
    is_help_open: bool,
    message: Option<String>,
    export: Export,
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
            time: TimeBar::default(),
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
        if graph.exists() {
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
            if TimeBar::is_needed(&told) {
                egui::Panel::bottom("time").show(ui, |ui| {
                    requests.extend(self.time.show(ui, &told));
                });
            }
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
