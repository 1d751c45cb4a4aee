//! Controls for every parameter and slot of the shaders in use, from reflection.

use egui::{ComboBox, DragValue, ScrollArea, Slider, Ui};
use volgraph_engine::{ParamOverride, Plan, Scene};
use volgraph_graph::Node;
use volgraph_shader::{DiskFiles, ParamSpec, ParamType, ParamValue, SnapshotFiles};

use crate::worker::{Request, Told};

/// Slots that follow from other choices: nobody picks them.
const DERIVED: [&str; 18] = [
    "behind",
    "clip_volume_filter",
    "emptiness",
    "heed",
    "labels",
    "leap",
    "light_places",
    "look",
    "parts",
    "pixels",
    "shadow_leap",
    "steps",
    "table_filter",
    "transfer_reach",
    "transfer_tables",
    "volume_filter",
    "volume_texel",
    "walk",
];

pub(crate) fn show(ui: &mut Ui, told: &Told) -> Vec<Request> {
    let (Some(plan), Some(scene)) = (&told.plan, &told.scene) else {
        ui.weak("No graph is open.");
        return Vec::new();
    };
    let mut sets = Vec::new();
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        for &id in plan.order.iter().rev() {
            let node = &plan.graph.nodes[id];
            // What the graph did not name is not the user's to set.
            if node.is_source() || !scene.desc.nodes.contains_key(&node.name) {
                continue;
            }
            let is_main = told_main(plan) == Some(id);
            egui::CollapsingHeader::new(format!("{} ({})", node.name, node.kind_name()))
                .default_open(is_main)
                .id_salt(("node", &node.name))
                .show(ui, |ui| {
                    slots(ui, scene, node, &mut sets);
                    params(ui, node, &mut sets);
                });
        }
    });
    if sets.is_empty() {
        Vec::new()
    } else {
        vec![Request::Set(sets)]
    }
}

/// The node that makes the picture.
fn told_main(plan: &Plan) -> Option<usize> {
    plan.graph.outputs.get("color").map(|link| link.node)
}

fn slots(ui: &mut Ui, scene: &Scene, node: &Node, sets: &mut Vec<ParamOverride>) {
    let Some(program) = &node.program else {
        return;
    };
    let used = &program.module.linked.slots_used;
    let Some(kind) = node.kind() else {
        return;
    };
    let roots = scene.shader_roots(std::sync::Arc::new(SnapshotFiles::new(
        std::sync::Arc::new(DiskFiles),
    )));
    for slot in kind.slots() {
        let Some(choice) = node.slots.get(slot.name) else {
            continue;
        };
        if DERIVED.contains(&slot.name)
            || slot.name.ends_with("_layer")
            || !used.contains_key(slot.name)
        {
            continue;
        }
        ui.horizontal(|ui| {
            let label = ui.label(slot.name).on_hover_text(slot.doc);
            let mut picked = choice.choice.clone();
            let id = ("slot", &node.name, slot.name);
            // The folders are read while a menu is open, and not each frame.
            let menu = ComboBox::from_id_salt(id)
                .selected_text(&picked)
                .show_ui(ui, |ui| {
                    for known in roots.choices(slot.name) {
                        ui.selectable_value(&mut picked, known.clone(), known);
                    }
                });
            menu.response.labelled_by(label.id);
            if picked != choice.choice {
                set(
                    &node.name,
                    &format!("slots.{}", slot.name),
                    &ParamValue::Text(picked),
                    sets,
                );
            }
        });
    }
}

/// What the shaders declare, then, folded in, what only the node kind's own code reads.
fn params(ui: &mut Ui, node: &Node, sets: &mut Vec<ParamOverride>) {
    let of_kind = node.kind().map(|kind| kind.params()).unwrap_or_default();
    let (own, declared): (Vec<ParamSpec>, Vec<ParamSpec>) = node
        .specs()
        .into_iter()
        .partition(|spec| of_kind.iter().any(|other| other.name == spec.name));
    for spec in declared.iter().filter(|spec| is_counted(node, spec)) {
        param(ui, node, spec, sets);
    }
    if own.is_empty() {
        return;
    }
    egui::CollapsingHeader::new("Settings")
        .id_salt(("settings", &node.name))
        .default_open(declared.is_empty())
        .show(ui, |ui| {
            for spec in &own {
                param(ui, node, spec, sets);
            }
        });
}

/// Whether a numbered parameter (`light_2_color`) is one of as many as another one says (`lights`).
fn is_counted(node: &Node, spec: &ParamSpec) -> bool {
    let mut words = spec.name.split('_');
    let (Some(thing), Some(number)) = (words.next(), words.next()) else {
        return true;
    };
    let (Ok(number), Some(ParamValue::Int(count))) =
        (number.parse::<i64>(), node.params.get(&format!("{thing}s")))
    else {
        return true;
    };
    number <= *count || node.given.contains_key(&spec.name)
}

fn param(ui: &mut Ui, node: &Node, spec: &ParamSpec, sets: &mut Vec<ParamOverride>) {
    let Some(value) = node.params.get(&spec.name) else {
        return;
    };
    ui.horizontal(|ui| {
        let is_given = node.given.contains_key(&spec.name);
        let name = egui::RichText::new(&spec.name);
        let name = if is_given { name.strong() } else { name };
        let label = ui.label(name).on_hover_text(hint(spec));
        let mut changed = value.clone();
        if control(ui, spec, &mut changed, label.id) && changed != *value {
            set(&node.name, &spec.name, &changed, sets);
        }
        if let Some(unit) = &spec.unit {
            ui.weak(unit);
        }
        if is_given && *value != spec.default {
            let back = ui.small_button("default");
            if back
                .on_hover_text(format!("Back to {}", spec.default))
                .clicked()
            {
                set(&node.name, &spec.name, &spec.default, sets);
            }
        }
    });
}

fn hint(spec: &ParamSpec) -> String {
    match spec.range {
        Some((low, high)) => format!("{}\n{low} to {high}; {} by default", spec.doc, spec.default),
        None => format!("{}\n{} by default", spec.doc, spec.default),
    }
}

fn set(node: &str, name: &str, value: &ParamValue, sets: &mut Vec<ParamOverride>) {
    let typed = format!("{node}.{name}={}", written(value));
    // Names and values come from the plan, so there is nothing that could not be read.
    sets.extend(ParamOverride::parse(&typed));
}

/// A value in the words of the command line.
fn written(value: &ParamValue) -> String {
    match value {
        ParamValue::Text(text) => format!("{text:?}"),
        ParamValue::Float(number) => format!("{number:?}"),
        ParamValue::Vector(numbers) => {
            let numbers: Vec<String> = numbers.iter().map(|number| format!("{number:?}")).collect();
            format!("({})", numbers.join(", "))
        }
        other => other.to_string(),
    }
}

/// The control of a parameter; whether it was changed.
fn control(ui: &mut Ui, spec: &ParamSpec, value: &mut ParamValue, label: egui::Id) -> bool {
    match (&spec.ty, value) {
        (ParamType::Bool, ParamValue::Bool(is_on)) => {
            ui.checkbox(is_on, "").labelled_by(label).changed()
        }
        (ParamType::Choice(choices), ParamValue::Text(text)) => {
            let mut is_changed = false;
            let menu = ComboBox::from_id_salt(("choice", label))
                .selected_text(&*text)
                .show_ui(ui, |ui| {
                    for choice in choices {
                        is_changed |= ui.selectable_value(text, choice.clone(), choice).changed();
                    }
                });
            menu.response.labelled_by(label);
            is_changed
        }
        (ParamType::Text, ParamValue::Text(text)) => {
            let edit = ui.text_edit_singleline(text).labelled_by(label);
            edit.changed()
        }
        (ParamType::Int | ParamType::Uint, ParamValue::Int(number)) => {
            let drag = match spec.range {
                Some((low, high)) => DragValue::new(number).range(low as i64..=high as i64),
                None if spec.ty == ParamType::Uint => {
                    DragValue::new(number).range(0..=u32::MAX as i64)
                }
                None => DragValue::new(number),
            };
            ui.add(drag).labelled_by(label).changed()
        }
        (_, ParamValue::Float(number)) => float(ui, spec, number, label),
        (_, ParamValue::Vector(numbers)) if spec.is_color && numbers.len() >= 3 => {
            let mut rgb = [numbers[0] as f32, numbers[1] as f32, numbers[2] as f32];
            let picked = ui.color_edit_button_rgb(&mut rgb).labelled_by(label);
            if picked.changed() {
                for (number, channel) in numbers.iter_mut().zip(rgb) {
                    *number = f64::from(channel);
                }
            }
            picked.changed()
        }
        (ty, ParamValue::Vector(numbers)) => {
            let is_whole = matches!(ty, ParamType::IntVector(_) | ParamType::UintVector(_));
            let mut is_changed = false;
            for number in numbers {
                let speed = if is_whole { 1.0 } else { 0.01 };
                let mut drag = DragValue::new(number).speed(speed);
                if is_whole {
                    drag = drag.fixed_decimals(0);
                }
                if let Some((low, high)) = spec.range {
                    drag = drag.range(low..=high);
                }
                is_changed |= ui.add(drag).labelled_by(label).changed();
            }
            is_changed
        }
        (_, value) => {
            ui.monospace(value.to_string());
            false
        }
    }
}

fn float(ui: &mut Ui, spec: &ParamSpec, number: &mut f64, label: egui::Id) -> bool {
    let Some((low, high)) = spec.range else {
        let speed = (number.abs() * 0.01).max(0.001);
        return ui
            .add(DragValue::new(number).speed(speed))
            .labelled_by(label)
            .changed();
    };
    // A range over more than two powers of ten is a scale to multiply along.
    let is_wide = low > 0.0 && high / low > 100.0;
    let slider = Slider::new(number, low..=high).logarithmic(is_wide);
    ui.add(slider).labelled_by(label).changed()
}
