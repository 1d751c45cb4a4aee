//! RON text → [`GraphDesc`], with every finding at its place.
//!
//! Only the form is checked here: known fields, types of values, names given twice. Names of kinds, ports,
//! parameters and sources are looked up in [`crate::resolve`].

use std::path::Path;

use glam::DVec3;
use indexmap::IndexMap;
use volgraph_report::ron_text::{Document, Entry, Fields, Value};
use volgraph_report::{Finding, Findings, Place, did_you_mean};
use volgraph_shader::ParamValue;

use crate::camera::{CameraDesc, Pose, Projection};
use crate::desc::{EdgeDesc, GraphDesc, NodeDesc, ParamDesc, SourceDesc};
use crate::quality::quality;

/// Longest text that is read; a graph of a thousand nodes is shorter.
const MAX_TEXT_BYTES: usize = 256 << 10;

/// Most nodes, and most sources.
const MAX_ENTRIES: usize = 1024;

/// Reads a graph file's text. `file` is its name for findings.
///
/// # Errors
/// All findings, each with its place; `too-large` for a text over 256 KiB, or more than 1024 nodes or sources.
pub fn graph(file: &Path, text: &str) -> Result<GraphDesc, Findings> {
    if text.len() > MAX_TEXT_BYTES {
        return Err(
            Finding::error("too-large", "a graph of more than 256 KiB is refused")
                .at(Place::whole_file(file))
                .help("split it, or check that this is a graph file")
                .into(),
        );
    }
    let document = Document::parse(file, text)?;
    let mut findings = Findings::new();
    let mut desc = GraphDesc::default();
    let mut fields = Fields::new(document.fields()?);
    if let Some(sources) = fields.take("sources") {
        for entry in named(&sources, "sources", &mut findings) {
            if let Some(source) = findings.take_all(source(&entry)) {
                desc.sources.insert(entry.name, source);
            }
        }
    }
    if let Some(value) = fields.take("camera") {
        desc.camera = findings.take_all(camera(&value));
    }
    if let Some(value) = fields.take("quality") {
        desc.quality = findings.take_all(quality(&value));
    }
    if let Some(nodes) = fields.take("nodes") {
        for entry in named(&nodes, "nodes", &mut findings) {
            if let Some(first) = desc.sources.get(&entry.name) {
                findings.push(
                    Finding::error(
                        "duplicate",
                        format!("`{}` is a source and a node", entry.name),
                    )
                    .at(entry.name_place.clone())
                    .related(first.place.clone(), "the source"),
                );
            }
            if let Some(node) = node(&entry, &mut findings) {
                desc.nodes.insert(entry.name, node);
            }
        }
    }
    let outputs_place = document.place();
    if let Some(outputs) = fields.take("outputs") {
        desc.outputs = edges(&outputs, &mut findings);
    }
    fields.finish(&mut findings);
    if desc.outputs.is_empty() && !findings.has_errors() {
        findings.push(
            Finding::error("no-output", "the graph names no output")
                .at(Place { length: 1, ..outputs_place })
                .help("add `outputs: { \"color\": \"image.color\" }` with the name of a node and its port"),
        );
    }
    findings.into_result(desc)
}

/// Reads a camera, such as `orbit(azimuth: 40)`: also the command line's `--camera`.
///
/// # Errors
/// All findings, each with its place.
pub fn camera(value: &Value<'_>) -> Result<CameraDesc, Findings> {
    let (name, entries) = value.variant()?;
    let mut findings = Findings::new();
    let mut fields = Fields::new(entries);
    let default = CameraDesc::default();
    let up = fields
        .read(&mut findings, "up", Value::f64s::<3>)
        .map_or(default.up, DVec3::from_array);
    let target = fields
        .read(&mut findings, "target", Value::f64s::<3>)
        .map(DVec3::from_array);
    let projection = projection(&mut fields, &mut findings);
    let pose = match name.as_str() {
        "orbit" => {
            let mut number = |name, default| {
                fields
                    .read(&mut findings, name, Value::f64)
                    .unwrap_or(default)
            };
            let (azimuth, elevation, roll) = (
                number("azimuth", 0.0),
                number("elevation", 0.0),
                number("roll", 0.0),
            );
            let distance = fields.read(&mut findings, "distance", |value| {
                positive(value, value.f64()?, "a distance")
            });
            let zoom = fields.read(&mut findings, "zoom", |value| {
                let zoom = positive(value, value.f64()?, "a zoom")?;
                let is_fitted = match projection {
                    Projection::Perspective { .. } => distance.is_none(),
                    Projection::Orthographic { height } => height.is_none(),
                };
                if is_fitted {
                    return Ok(zoom);
                }
                Err(value
                    .error(
                        "exclusive-fields",
                        "`zoom` changes what is fitted, and nothing is",
                    )
                    .help("leave out `distance` (of an orthographic camera `height`), or `zoom`"))
            });
            Pose::Orbit {
                azimuth,
                elevation,
                roll,
                distance,
                target,
                zoom: zoom.unwrap_or(1.0),
            }
        }
        "look_at" => {
            let eye = fields
                .read(&mut findings, "eye", Value::f64s::<3>)
                .map(DVec3::from_array);
            if eye.is_none() && !findings.has_errors() {
                findings.push(value.error(
                    "missing-field",
                    "`look_at` needs the field `eye: (x, y, z)`",
                ));
            }
            let eye = eye.unwrap_or(DVec3::ONE);
            if target == Some(eye) {
                findings.push(value.error("camera", "the eye and the target are the same point"));
            }
            Pose::LookAt { eye, target }
        }
        _ => {
            return Err(value
                .error("unknown-camera", format!("unknown camera `{name}`"))
                .help_opt(did_you_mean(&name, ["orbit", "look_at"]))
                .into());
        }
    };
    if up.length_squared() == 0.0 {
        findings.push(value.error("camera", "`up` has no length"));
    }
    fields.finish(&mut findings);
    findings.into_result(CameraDesc {
        pose,
        up,
        projection,
    })
}

/// Reads a camera from a text of its own.
///
/// # Errors
/// All findings; `file` names the text.
pub fn camera_text(file: &Path, text: &str) -> Result<CameraDesc, Findings> {
    camera(&Document::parse(file, text)?)
}

/// Reads one parameter value from a text of its own.
///
/// # Errors
/// Where the text is no value; `file` names it.
pub fn param_text(file: &Path, text: &str) -> Result<ParamValue, Finding> {
    param_value(&Document::parse(file, text)?)
}

fn projection(fields: &mut Fields<'_>, findings: &mut Findings) -> Projection {
    let named = fields.read(findings, "projection", |value| {
        let name = value.text();
        match name {
            "perspective" => Ok(false),
            "orthographic" => Ok(true),
            _ => Err(value
                .error("unknown-projection", format!("unknown projection `{name}`"))
                .help_opt(did_you_mean(name, ["perspective", "orthographic"]))),
        }
    });
    let fov_y = fields.read(findings, "fov_y", |value| {
        let degrees = value.f64()?;
        if degrees > 0.0 && degrees < 180.0 {
            Ok((degrees, value.place()))
        } else {
            Err(value.error(
                "camera",
                format!("a field of view of {degrees} degrees is not between 0 and 180"),
            ))
        }
    });
    let height = fields.read(findings, "height", |value| {
        positive(value, value.f64()?, "a height")
    });
    match (named.unwrap_or(height.is_some()), fov_y) {
        (true, None) => Projection::Orthographic { height },
        (true, Some((_, place))) => {
            let finding = Finding::error("camera", "an orthographic camera has no `fov_y`");
            findings.push(
                finding
                    .at(place)
                    .help("give `height`, in world units, or leave both out"),
            );
            Projection::Orthographic { height }
        }
        (false, fov_y) => Projection::Perspective {
            fov_y: fov_y.map_or(30.0, |(degrees, _)| degrees),
        },
    }
}

fn positive(value: &Value<'_>, number: f64, what: &str) -> Result<f64, Finding> {
    if number > 0.0 {
        Ok(number)
    } else {
        Err(value.error("camera", format!("{what} of {number} is not above 0")))
    }
}

/// The entries of `sources` or `nodes`, their number and names checked.
fn named<'s>(value: &Value<'s>, what: &str, findings: &mut Findings) -> Vec<Entry<'s>> {
    let entries = findings.take_all(value.entries()).unwrap_or_default();
    if entries.len() > MAX_ENTRIES {
        let message = format!("a graph of more than {MAX_ENTRIES} {what} is refused");
        findings.push(Finding::error("too-large", message).at(Place {
            length: 1,
            ..value.place()
        }));
        return Vec::new();
    }
    for entry in &entries {
        // A dot separates a node from its port, in edges and on the command line.
        if entry.name.is_empty()
            || entry
                .name
                .contains(|c: char| c == '.' || c == '=' || c.is_control())
        {
            let message = format!("`{}` cannot be a name", entry.name.escape_debug());
            findings.push(
                Finding::error("bad-name", message)
                    .at(entry.name_place.clone())
                    .help("a name is not empty and has no `.`, no `=` and no line breaks"),
            );
        }
    }
    entries
}

/// Reads a source, such as `analytic(field: "sphere")`; it stands where its entry is named.
///
/// # Errors
/// All findings, each with its place.
pub fn source(entry: &Entry<'_>) -> Result<SourceDesc, Findings> {
    let (kind, entries) = entry.value.variant()?;
    let mut findings = Findings::new();
    let params = params(entries, &mut findings);
    findings.into_result(SourceDesc {
        kind,
        params,
        place: entry.name_place.clone(),
    })
}

fn node(entry: &Entry<'_>, findings: &mut Findings) -> Option<NodeDesc> {
    let mut fields = Fields::new(findings.take_all(entry.value.fields())?);
    let kind_value = fields.take("kind");
    let inputs = fields
        .take("in")
        .map(|value| edges(&value, findings))
        .unwrap_or_default();
    let mut values = |name| {
        let entries = fields
            .take(name)
            .and_then(|value| findings.take_all(value.entries()));
        params(entries.unwrap_or_default(), findings)
    };
    let (slots, params) = (values("slots"), values("params"));
    fields.finish(findings);
    let Some(kind_value) = kind_value else {
        findings.push(
            Finding::error(
                "missing-field",
                format!("node `{}` has no kind", entry.name),
            )
            .at(entry.name_place.clone())
            .help("add `kind: \"…\"`; `volgraph nodes` lists the kinds"),
        );
        return None;
    };
    let kind = findings.take(kind_value.string())?;
    Some(NodeDesc {
        kind,
        kind_place: kind_value.place(),
        inputs,
        slots,
        params,
        place: entry.name_place.clone(),
    })
}

fn edges(value: &Value<'_>, findings: &mut Findings) -> IndexMap<String, EdgeDesc> {
    let mut edges = IndexMap::new();
    for entry in findings.take_all(value.entries()).unwrap_or_default() {
        if let Some(from) = findings.take(entry.value.string()) {
            let edge = EdgeDesc {
                from,
                name_place: entry.name_place,
                place: entry.value.place(),
            };
            edges.insert(entry.name, edge);
        }
    }
    edges
}

/// Named values, by their form alone, as the parameters of a node are written; a finding for each that is none.
pub fn params(entries: Vec<Entry<'_>>, findings: &mut Findings) -> IndexMap<String, ParamDesc> {
    let mut params = IndexMap::new();
    for entry in entries {
        if let Some(value) = findings.take(param_value(&entry.value)) {
            let place = entry.value.place();
            params.insert(
                entry.name,
                ParamDesc {
                    value,
                    name_place: entry.name_place,
                    place,
                },
            );
        }
    }
    params
}

/// A parameter's value by its form alone: true or false, a whole number, a number, a text, a list of numbers.
fn param_value(value: &Value<'_>) -> Result<ParamValue, Finding> {
    let text = value.text();
    if text.starts_with(['[', '(']) {
        let numbers: Result<Vec<f64>, Finding> = value.items()?.iter().map(Value::f64).collect();
        return Ok(ParamValue::Vector(numbers?));
    }
    if text.starts_with('"') || text.starts_with('r') {
        return Ok(ParamValue::Text(value.string()?));
    }
    if text == "true" || text == "false" {
        return Ok(ParamValue::Bool(value.bool()?));
    }
    match value.i64() {
        Ok(whole) => Ok(ParamValue::Int(whole)),
        Err(_) => value.f64().map(ParamValue::Float).map_err(|finding| Finding {
            message: format!("expected true, false, a number, a text in quotes or a list of numbers, found `{text}`"),
            ..finding
        }),
    }
}
