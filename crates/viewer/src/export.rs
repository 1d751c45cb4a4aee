//! The form for pictures of any size and films of a turning camera.

use std::path::PathBuf;

use egui::{DragValue, Ui};
use glam::DVec3;
use volgraph_engine::CameraDesc;

use crate::navigate::Navigation;
use crate::worker::{Request, Turntable};

/// What the form holds.
pub(crate) struct Export {
    pub is_open: bool,
    size: [u32; 2],
    frames: u32,
    frames_per_second: f64,
    degrees: f64,
    /// The cameras of a path, in their order.
    keys: Vec<CameraDesc>,
    trouble: Option<String>,
}

impl Default for Export {
    fn default() -> Self {
        Self {
            is_open: false,
            size: [1920, 1080],
            frames: 120,
            frames_per_second: 25.0,
            degrees: 360.0,
            keys: Vec::new(),
            trouble: None,
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
                ui.separator();
                self.path(ui, navigation);
                ui.weak(
                    "`volgraph animate` does the same without a window, and along paths of keys.",
                );
            });
        self.is_open = is_open;
        request
    }

    /// The keys of a path, and the file that `volgraph animate --path` reads.
    fn path(&mut self, ui: &mut Ui, navigation: Option<&Navigation>) {
        ui.horizontal(|ui| {
            ui.label(format!("Path of {} cameras", self.keys.len()));
            if ui.button("Add the present one").clicked() {
                self.keys.extend(navigation.map(Navigation::described));
            }
            if ui.button("Drop the last").clicked() {
                self.keys.pop();
            }
            let save = ui.add_enabled(self.keys.len() > 1, egui::Button::new("Save the path…"));
            if save
                .on_hover_text("for `volgraph animate --path`")
                .clicked()
                && let Some(file) = dialog("path.ron", &["ron"])
                && let Err(error) = std::fs::write(&file, self.path_text())
            {
                self.trouble = Some(format!("{}: {error}", file.display()));
            }
        });
        if let Some(trouble) = &self.trouble {
            ui.colored_label(ui.visuals().error_fg_color, trouble);
        }
    }

    fn path_text(&self) -> String {
        let last = self.keys.len().saturating_sub(1).max(1);
        let frames = self.frames.max(self.keys.len() as u32);
        let keys = self.keys.iter().enumerate();
        let keys: String = keys
            .map(|(index, key)| {
                // Keys lie at frames, each at one of its own.
                let at = index * (frames as usize - 1) / last;
                format!("        (at: {at}, camera: {}),\n", key.to_ron())
            })
            .collect();
        let rate = self.frames_per_second;
        format!(
            "(\n    path: 1,\n    frames: {frames},\n    fps: {rate:?},\n    keys: [\n{keys}    ],\n)\n"
        )
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

#[cfg(test)]
mod tests {
    use std::path::Path;

    use volgraph_engine::film::CameraPath;

    use super::*;

    #[test]
    fn a_path_of_keys_is_read_as_it_was_written() {
        let export = Export {
            keys: vec![CameraDesc::default(); 3],
            ..Export::default()
        };
        let path = CameraPath::of_text(Path::new("path.ron"), &export.path_text());
        let path = path.unwrap_or_else(|findings| panic!("{findings}\n{}", export.path_text()));
        assert_eq!(
            (path.frames(), path.frames_per_second()),
            (Some(120), Some(25.0))
        );
    }
}
