//! Menus, keys, and the windows that they open.

use std::path::Path;

use egui::{Key, KeyboardShortcut, Modifiers, Ui};

use super::Viewer;
use super::panes::default_layout;
use crate::navigate::Axis;
use crate::settings::{Overlay, Pane};
use crate::worker::Request;

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

impl Viewer {
    pub(super) fn shortcuts(&mut self, ui: &Ui, requests: &mut Vec<Request>) {
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

    pub(super) fn menu(&mut self, ui: &mut Ui, requests: &mut Vec<Request>) {
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

    pub(super) fn windows(&mut self, ui: &Ui) {
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
}
