//! The transfer function over the histogram: points to drag, colours, colour maps, undo and redo, reading and saving.

mod curve;

use std::path::Path;

use egui::{Color32, ComboBox, DragValue, Key, Modifiers, Ui};
use volgraph_engine::presets::presets;
use volgraph_optics::{ControlPoint, TransferFunction, color_map_names};
use volgraph_volume::Volume;

use self::curve::curve;
use crate::histogram::{Counted, Scale, visible_share};
use crate::transfer::TransferEdit;
use crate::worker::Request;

/// What the panel needs besides the edit.
pub(crate) struct TransferSight<'a> {
    /// The volume that is classified.
    pub volume: &'a Volume,
    /// The range of its values.
    pub range: Option<(f64, f64)>,
    /// Its histogram, once it is counted.
    pub counted: Option<&'a Counted>,
}

pub(crate) fn show(
    ui: &mut Ui,
    edit: &mut TransferEdit,
    sight: &TransferSight<'_>,
    is_log: &mut bool,
) -> Vec<Request> {
    let mut requests = Vec::new();
    let scale = Scale::of(&edit.transfer, sight.volume, sight.range);
    bar(ui, edit, sight, scale, is_log, &mut requests);
    requests.extend(curve(ui, edit, sight, scale, *is_log));
    requests.extend(selected(ui, edit, scale));
    if !edit.findings.is_empty() {
        super::messages::findings(ui, &edit.findings);
    }
    requests
}

fn bar(
    ui: &mut Ui,
    edit: &mut TransferEdit,
    sight: &TransferSight<'_>,
    scale: Scale,
    is_log: &mut bool,
    requests: &mut Vec<Request>,
) {
    ui.horizontal_wrapped(|ui| {
        let (can_undo, can_redo) = edit.steps();
        let has_focus = ui.ui_contains_pointer() && !ui.ctx().egui_wants_keyboard_input();
        let pressed = |ui: &Ui, modifiers: Modifiers, key: Key| {
            has_focus && ui.input_mut(|input| input.consume_key(modifiers, key))
        };
        let is_redo = pressed(ui, Modifiers::COMMAND | Modifiers::SHIFT, Key::Z)
            || pressed(ui, Modifiers::COMMAND, Key::Y);
        let is_undo = pressed(ui, Modifiers::COMMAND, Key::Z);
        if ui
            .add_enabled(can_undo, egui::Button::new("Undo"))
            .clicked()
            || is_undo
        {
            requests.extend(edit.undo());
        }
        if ui
            .add_enabled(can_redo, egui::Button::new("Redo"))
            .clicked()
            || is_redo
        {
            requests.extend(edit.redo());
        }
        ui.checkbox(is_log, "Log");
        let map = edit
            .transfer
            .color_map()
            .unwrap_or("own colours")
            .to_owned();
        let label = ui.label("Colours");
        let mut picked = map.clone();
        let menu = ComboBox::from_id_salt("colour map")
            .selected_text(&map)
            .show_ui(ui, |ui| {
                ui.selectable_value(&mut picked, "own colours".to_owned(), "own colours");
                for name in color_map_names() {
                    ui.selectable_value(&mut picked, name.to_owned(), name);
                }
            });
        menu.response.labelled_by(label.id);
        if picked != map {
            let (low, high) = edit.transfer.range();
            let changed = match picked.as_str() {
                "own colours" => own_colors(&edit.transfer),
                name => edit.transfer.with_color_map(name, low, high, false),
            };
            requests.extend(edit.change(changed));
        }
        let label = ui.label("Preset");
        let menu = ComboBox::from_id_salt("preset")
            .selected_text("…")
            .show_ui(ui, |ui| {
                for preset in presets() {
                    if ui.button(preset.name).on_hover_text(preset.shows).clicked() {
                        let text = preset
                            .text(sight.volume)
                            .map_err(volgraph_engine::Findings::from);
                        let changed = text.and_then(|text| {
                            TransferFunction::parse(Path::new(preset.name), &text)
                        });
                        requests.extend(edit.change(changed));
                    }
                }
            });
        menu.response.labelled_by(label.id);
        if ui.button("Load…").clicked()
            && let Some(file) = rfd::FileDialog::new()
                .add_filter("transfer function", &["ron"])
                .pick_file()
        {
            requests.extend(edit.change(TransferFunction::load(&file)));
        }
        let name = edit
            .file()
            .file_name()
            .map(|name| name.to_string_lossy().into_owned());
        let save = ui.add_enabled(
            edit.is_changed() && edit.file().is_file(),
            egui::Button::new("Save"),
        );
        if save
            .on_hover_text(format!("Into {}", edit.file().display()))
            .clicked()
        {
            let file = edit.file().to_owned();
            match edit.save(&file) {
                Ok(more) => requests.extend(more),
                Err(findings) => edit.findings = findings,
            }
        }
        if ui.button("Save as…").clicked()
            && let Some(file) = rfd::FileDialog::new()
                .set_file_name(name.unwrap_or_default())
                .save_file()
        {
            match edit.save(&file) {
                Ok(more) => requests.extend(more),
                Err(findings) => edit.findings = findings,
            }
        }
        if let Some(counted) = sight.counted {
            let share = visible_share(&counted.histogram, &edit.transfer, scale);
            ui.label(format!("{:.1} % of the voxels are seen", 100.0 * share));
        }
    });
}

/// Colours of a map as a few points of their own.
fn own_colors(transfer: &TransferFunction) -> Result<TransferFunction, volgraph_engine::Findings> {
    let (low, high) = transfer.range();
    let places = (0..=8).map(|i| low + (high - low) * f64::from(i) / 8.0);
    let point = |at: f64| ControlPoint {
        at,
        color: transfer.color(at),
        opacity: transfer.opacity(at),
    };
    let mut points: Vec<ControlPoint> = places.map(point).collect();
    points.extend(
        transfer
            .control_points()
            .into_iter()
            .map(|own| ControlPoint {
                color: transfer.color(own.at),
                ..own
            }),
    );
    transfer.without_color_map().with_control_points(&points)
}

fn remove(edit: &mut TransferEdit, index: usize) -> Vec<Request> {
    let mut points = edit.points();
    if points.len() < 2 || index >= points.len() {
        return Vec::new();
    }
    points.remove(index);
    edit.selected = None;
    edit.set_points(&points)
}

/// The selected point in numbers.
fn selected(ui: &mut Ui, edit: &mut TransferEdit, scale: Scale) -> Vec<Request> {
    let mut points = edit.points();
    let Some(index) = edit.selected.filter(|index| *index < points.len()) else {
        ui.weak("Click a point to edit it.");
        return Vec::new();
    };
    let mut is_changed = false;
    let mut is_removed = false;
    ui.horizontal(|ui| {
        let mut data = scale.data(points[index].at);
        let label = ui.label("Value");
        if ui
            .add(DragValue::new(&mut data).speed(0.5))
            .labelled_by(label.id)
            .changed()
        {
            points[index].at = scale.scalar(data);
            is_changed = true;
        }
        let label = ui.label("Opacity");
        let opacity = DragValue::new(&mut points[index].opacity)
            .range(0.0..=1.0)
            .speed(0.005);
        is_changed |= ui.add(opacity).labelled_by(label.id).changed();
        if edit.transfer.color_map().is_none() {
            let label = ui.label("Colour");
            let mut rgb = points[index].color.map(|c| c as f32);
            if ui
                .color_edit_button_rgb(&mut rgb)
                .labelled_by(label.id)
                .changed()
            {
                points[index].color = rgb.map(f64::from);
                is_changed = true;
            }
        }
        is_removed = ui.button("Remove").clicked();
    });
    if is_removed {
        return remove(edit, index);
    }
    if is_changed {
        edit.set_points(&points)
    } else {
        Vec::new()
    }
}

/// Linear RGB on the screen.
pub(crate) fn srgb(color: [f64; 3]) -> Color32 {
    let [red, green, blue] = color.map(|c| c as f32);
    egui::Rgba::from_rgb(red, green, blue).into()
}
