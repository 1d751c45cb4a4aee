//! The form for pictures of any size and films of a turning camera.

use std::path::PathBuf;

use egui::{DragValue, Ui};
use glam::DVec3;

use crate::navigate::Navigation;
use crate::worker::{Request, Turntable};

/// What the form holds.
pub(crate) struct Export {
    pub is_open: bool,
    size: [u32; 2],
    frames: u32,
    frames_per_second: f64,
    degrees: f64,
}

impl Default for Export {
    fn default() -> Self {
        Self {
            is_open: false,
            size: [1920, 1080],
            frames: 120,
            frames_per_second: 25.0,
            degrees: 360.0,
        }
    }
}

impl Export {
    pub fn show(&mut self, ui: &Ui, navigation: Option<&Navigation>) -> Option<Request> {
        let mut is_open = self.is_open;
        let mut request = None;
        egui::Window::new("Picture and film")
            .open(&mut is_open)
            .resizable(false)
            .show(ui.ctx(), |ui| {
                egui::Grid::new("export").num_columns(2).show(ui, |ui| {
                    for (name, side) in ["Width", "Height"].into_iter().zip(&mut self.size) {
                        let label = ui.label(name);
                        ui.add(DragValue::new(side).range(1..=65_535).suffix(" px"))
                            .labelled_by(label.id);
                        ui.end_row();
                    }
                    let label = ui.label("Frames");
                    ui.add(DragValue::new(&mut self.frames).range(1..=100_000))
                        .labelled_by(label.id);
                    ui.end_row();
                    let label = ui.label("Frames a second");
                    ui.add(DragValue::new(&mut self.frames_per_second).range(0.1..=240.0))
                        .labelled_by(label.id);
                    ui.end_row();
                    let label = ui.label("Turn");
                    ui.add(
                        DragValue::new(&mut self.degrees)
                            .range(-3600.0..=3600.0)
                            .suffix("°"),
                    )
                    .labelled_by(label.id);
                    ui.end_row();
                });
                ui.horizontal(|ui| {
                    if ui.button("Save the picture…").clicked()
                        && let Some(file) = dialog("volgraph.png", &["png", "exr"])
                    {
                        request = Some(Request::Save {
                            file,
                            size: self.size,
                        });
                    }
                    if ui
                        .button("Save the turn…")
                        .on_hover_text(".png, .apng or .gif")
                        .clicked()
                        && let (Some(to), Some(navigation)) =
                            (dialog("turn.png", &["png", "apng", "gif"]), navigation)
                    {
                        request = Some(Request::Film(self.turntable(to, navigation)));
                    }
                    if ui
                        .button("Save its frames…")
                        .on_hover_text("numbered pictures in a folder")
                        .clicked()
                        && let (Some(to), Some(navigation)) =
                            (rfd::FileDialog::new().pick_folder(), navigation)
                    {
                        request = Some(Request::Film(self.turntable(to, navigation)));
                    }
                });
                ui.weak(
                    "`volgraph animate` does the same without a window, and along paths of keys.",
                );
            });
        self.is_open = is_open;
        request
    }

    fn turntable(&self, to: PathBuf, navigation: &Navigation) -> Turntable {
        let up = navigation.camera.up;
        let is_upright = up.z.abs() > 0.2;
        Turntable {
            to,
            size: self.size,
            frames: self.frames,
            frames_per_second: self.frames_per_second,
            degrees: self.degrees,
            target: navigation.pivot,
            axis: if is_upright {
                DVec3::Z * up.z.signum()
            } else {
                up
            },
        }
    }
}

fn dialog(name: &str, extensions: &[&str]) -> Option<PathBuf> {
    rfd::FileDialog::new()
        .set_file_name(name)
        .add_filter("picture", extensions)
        .save_file()
}
