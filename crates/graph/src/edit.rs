//! A graph's text with some of its values changed, and all else as it stands: comments, layout, order, quotes.
//!
//! The way of the data: each [`Edit`] is one cut in the text, at the bytes where its value stands, or where an entry of its
//! name belongs. Then the text is read again, as any graph is. It must mean what the old one means with the same changes
//! made in its description; else there is a finding, and no text. What already is as an edit wants it stays as it is
//! written: `0.50` remains where 0.5 is set.

use std::path::Path;

use volgraph_report::{Finding, Findings, Place, did_you_mean};
use volgraph_shader::ParamValue;

use crate::desc::{EdgeDesc, GraphDesc, ParamDesc, SourceDesc};
use crate::read;

mod layout;

/// One change of a graph.
#[derive(Clone, Debug, PartialEq)]
pub enum Edit {
    /// A node's parameter or a source's field; without a value it is taken out.
    Param {
        /// The node's or source's name.
        target: String,
        /// The parameter or field.
        name: String,
        /// What it is set to.
        value: Option<ParamValue>,
    },
    /// A node's slot; without a choice it is taken out.
    Slot {
        /// The node's name.
        node: String,
        /// The slot.
        slot: String,
        /// Its choice.
        choice: Option<ParamValue>,
    },
    /// A source becomes a volume from a file, whatever it was.
    Volume {
        /// The source's name.
        source: String,
        /// The file, as the graph is to name it.
        path: String,
    },
    /// The camera, as a graph writes it, such as `orbit(azimuth: 40)`; without one the graph has the default camera.
    Camera(Option<String>),
}

/// The text with all edits made, one after the other.
///
/// # Errors
/// Everything wrong with the text as it stands; `unknown-node` for a name that is no node or source; what is wrong with a
/// camera; `bad-edit` where the edited text would not mean what was asked for.
pub fn apply_edits(text: &str, file: &Path, edits: &[Edit]) -> Result<String, Findings> {
    let mut wanted = read::graph(file, text)?;
    let mut findings = Findings::new();
    let mut edited = text.to_owned();
    for edit in edits {
        match change(&mut wanted, file, edit) {
            Ok(true) => edited = in_text(&edited, edit),
            Ok(false) => {}
            Err(found) => findings.extend(found),
        }
    }
    findings.into_result(())?;
    let bad = |finding: Finding| {
        finding
            .at(Place::whole_file(file))
            .help("change the file by hand; it was left as it is")
    };
    let read = read::graph(file, &edited).map_err(|found| {
        let first = found
            .sorted()
            .first()
            .map(|finding| finding.message.clone());
        let message = format!(
            "the edited graph could not be read: {}",
            first.unwrap_or_default()
        );
        bad(Finding::error("bad-edit", message))
    })?;
    if without_places(read) != without_places(wanted) {
        let message = "the edited graph would mean something else than what was asked for";
        return Err(bad(Finding::error("bad-edit", message)).into());
    }
    Ok(edited)
}

/// Makes the change in the description; whether it is one.
fn change(desc: &mut GraphDesc, file: &Path, edit: &Edit) -> Result<bool, Findings> {
    let place = Place::whole_file(file);
    let of = |value: &ParamValue| ParamDesc {
        value: value.clone(),
        name_place: place.clone(),
        place: place.clone(),
    };
    match edit {
        Edit::Camera(text) => {
            let camera = text.as_deref().map(|text| {
                let typed = Path::new("--camera");
                read::camera_text(typed, text)
            });
            let camera = camera.transpose()?;
            let is_new = desc.camera != camera;
            desc.camera = camera;
            Ok(is_new)
        }
        Edit::Volume { source, path } => {
            let value = ParamValue::Text(path.clone());
            let names: Vec<String> = desc.sources.keys().cloned().collect();
            let there = desc
                .sources
                .get_mut(source)
                .ok_or_else(|| unknown(source, file, &names))?;
            let volume = SourceDesc {
                kind: "volume".to_owned(),
                params: [("path".to_owned(), of(&value))].into(),
                place,
            };
            let is_new = !there.asks_the_same(&volume);
            *there = volume;
            Ok(is_new)
        }
        Edit::Param { target: name, .. } | Edit::Slot { node: name, .. } => {
            let names: Vec<String> = (desc.nodes.keys())
                .chain(desc.sources.keys())
                .cloned()
                .collect();
            let (map, key, value) = match edit {
                Edit::Slot { slot, choice, .. } => (
                    desc.nodes.get_mut(name).map(|node| &mut node.slots),
                    slot,
                    choice,
                ),
                Edit::Param {
                    name: key, value, ..
                } => {
                    let of_source = desc.sources.get_mut(name).map(|source| &mut source.params);
                    let of_node = desc.nodes.get_mut(name).map(|node| &mut node.params);
                    (of_node.or(of_source), key, value)
                }
                _ => return Ok(false),
            };
            let map = map.ok_or_else(|| unknown(name, file, &names))?;
            let old = match value {
                Some(value) => map.insert(key.clone(), of(value)),
                None => map.shift_remove(key),
            };
            Ok(old.map(|old| old.value) != *value)
        }
    }
}

fn unknown(name: &str, file: &Path, known: &[String]) -> Findings {
    Finding::error(
        "unknown-node",
        format!("the graph has nothing named `{name}`"),
    )
    .at(Place::whole_file(file))
    .help_opt(did_you_mean(name, known.iter().map(String::as_str)))
    .into()
}

/// Makes a change in the text of a graph that has what it names.
fn in_text(text: &str, edit: &Edit) -> String {
    let root = layout::root(text);
    let part = |name: &str| {
        root.entry(text, name)
            .map(|it| layout::container(text, it.value.start))
    };
    let named = |part: &str, name: &str| {
        let container = layout::container(text, root.entry(text, part)?.value.start);
        container.entry(text, name).map(|it| it.value.clone())
    };
    match edit {
        Edit::Camera(None) => without(text, &root, "camera"),
        Edit::Camera(Some(camera)) => {
            let after = root
                .entries
                .iter()
                .position(|it| text[it.name.clone()] == *"sources");
            let after = after.unwrap_or(root.entries.len().saturating_sub(1));
            with(text, &root, Some(after), "camera", "camera", camera)
        }
        Edit::Volume { source, path } => {
            let Some(sources) = part("sources") else {
                return text.to_owned();
            };
            let volume = format!(
                "volume(path: {})",
                written(&ParamValue::Text(path.clone()), "")
            );
            with(text, &sources, None, source, source, &volume)
        }
        Edit::Slot { node, slot, choice } => match named("nodes", node) {
            Some(value) => in_map(text, value.start, "slots", slot, choice.as_ref()),
            None => text.to_owned(),
        },
        Edit::Param {
            target,
            name,
            value,
        } => {
            if let Some(node) = named("nodes", target) {
                return in_map(text, node.start, "params", name, value.as_ref());
            }
            let Some(source) = named("sources", target) else {
                return text.to_owned();
            };
            if !text[source.clone()].contains('(') {
                // A kind without fields.
                let value = value.as_ref().map(|value| written(value, ""));
                let fields = value.map(|value| format!("({name}: {value})"));
                let mut edited = text.to_owned();
                edited.insert_str(source.end, &fields.unwrap_or_default());
                return edited;
            }
            let fields = layout::container(text, source.start);
            let Some(value) = value else {
                return without(text, &fields, name);
            };
            let old = fields
                .entry(text, name)
                .map_or("", |it| &text[it.value.clone()]);
            let last = fields.entries.len().checked_sub(1);
            with(text, &fields, last, name, name, &written(value, old))
        }
    }
}

/// Changes an entry of the map `params` or `slots` of a node; the map is made where the node has none.
fn in_map(text: &str, node: usize, map: &str, name: &str, value: Option<&ParamValue>) -> String {
    let fields = layout::container(text, node);
    let quoted = written(&ParamValue::Text(name.to_owned()), "");
    let Some(entry) = fields.entry(text, map) else {
        let Some(value) = value else {
            return text.to_owned();
        };
        let last = fields.entries.len().checked_sub(1);
        let made = format!("{{ {quoted}: {} }}", written(value, ""));
        return with(text, &fields, last, map, map, &made);
    };
    let values = layout::container(text, entry.value.start);
    let Some(value) = value else {
        return without(text, &values, name);
    };
    let old = values
        .entry(text, name)
        .map_or("", |it| &text[it.value.clone()]);
    let last = values.entries.len().checked_sub(1);
    with(text, &values, last, name, &quoted, &written(value, old))
}

/// The text with an entry set: over its old value, or behind the entry `after`.
fn with(
    text: &str,
    container: &layout::Container,
    after: Option<usize>,
    name: &str,
    written_name: &str,
    value: &str,
) -> String {
    match container.entry(text, name) {
        Some(entry) => {
            let mut edited = text.to_owned();
            edited.replace_range(entry.value.clone(), value);
            edited
        }
        None => layout::insert(text, container, after, &format!("{written_name}: {value}")),
    }
}

fn without(text: &str, container: &layout::Container, name: &str) -> String {
    let mut entries = container.entries.iter();
    let index = entries.position(|entry| {
        container
            .entry(text, name)
            .is_some_and(|it| it.name == entry.name)
    });
    index.map_or_else(
        || text.to_owned(),
        |index| layout::remove(text, container, index),
    )
}

/// A value as a graph writes it; lists keep the brackets of what they replace.
fn written(value: &ParamValue, old: &str) -> String {
    match value {
        // RON knows these escapes; those of Rust's own are others.
        ParamValue::Text(text) => ron::to_string(text).unwrap_or_else(|_| format!("{text:?}")),
        ParamValue::Vector(values) => {
            let (open, close) = if old.starts_with('(') {
                ("(", ")")
            } else {
                ("[", "]")
            };
            let values: Vec<String> = values.iter().map(|value| format!("{value:?}")).collect();
            format!("{open}{}{close}", values.join(", "))
        }
        other => other.to_string(),
    }
}

/// What a graph means, wherever it is written.
fn without_places(mut desc: GraphDesc) -> GraphDesc {
    let nowhere = || Place::whole_file("");
    let of_params = |params: &mut indexmap::IndexMap<String, ParamDesc>| {
        for param in params.values_mut() {
            (param.name_place, param.place) = (nowhere(), nowhere());
        }
    };
    let of_edges = |edges: &mut indexmap::IndexMap<String, EdgeDesc>| {
        for edge in edges.values_mut() {
            (edge.name_place, edge.place) = (nowhere(), nowhere());
        }
    };
    for source in desc.sources.values_mut() {
        source.place = nowhere();
        of_params(&mut source.params);
    }
    if let Some(quality) = &mut desc.quality {
        quality.place = nowhere();
    }
    for node in desc.nodes.values_mut() {
        (node.place, node.kind_place) = (nowhere(), nowhere());
        of_edges(&mut node.inputs);
        of_params(&mut node.slots);
        of_params(&mut node.params);
    }
    of_edges(&mut desc.outputs);
    desc
}

#[cfg(test)]
mod tests;
