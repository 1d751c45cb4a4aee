//! What the command line changes in a graph before it is looked at.

use std::path::{Path, PathBuf};

use serde::{Serialize, Serializer};
use volgraph_graph::{CameraDesc, EdgeDesc, GraphDesc, ParamDesc, SourceDesc};
use volgraph_report::{Finding, Findings, Place, did_you_mean};
use volgraph_shader::ParamValue;

use crate::renderer::{RENDERER, set_renderer};

/// Changes to a graph, in the words of the command line.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Overrides {
    /// `--set node.param=value`, in their order.
    pub params: Vec<ParamOverride>,
    /// `--volume name=FILE`: (source name, file). Without a name it is the graph's only volume, or the one named `volume`.
    #[serde(serialize_with = "shown_volumes")]
    pub volumes: Vec<(String, PathBuf)>,
    /// `--camera …`.
    pub camera: Option<CameraDesc>,
    /// `--data FOLDER`: where files of sources are looked for that do not lie beside the graph.
    #[serde(serialize_with = "shown")]
    pub data: Vec<PathBuf>,
    /// `--time STEP`: the time step of all volumes that have several.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time: Option<u32>,
    /// `node.port`: what the output [`LOOK`] shows beside the graph's own.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub look: Option<String>,
}

/// The output that [`Overrides::look`] adds.
pub const LOOK: &str = "look";

/// Paths as people read them: those that are no text at all as near as it goes.
fn shown<S: Serializer>(paths: &[PathBuf], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(paths.iter().map(|path| path.display().to_string()))
}

fn shown_volumes<S: Serializer>(
    volumes: &[(String, PathBuf)],
    serializer: S,
) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(
        volumes
            .iter()
            .map(|(name, path)| (name, path.display().to_string())),
    )
}

/// One `--set`: `node.param=value`, `node.slots.slot=choice` or `source.field=value`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ParamOverride {
    /// The node's or source's name.
    pub target: String,
    /// Whether it is a slot's choice.
    pub is_slot: bool,
    /// The parameter, field or slot.
    pub name: String,
    /// The value, by its form.
    pub value: ParamValue,
    /// As it was typed, for findings.
    pub typed: String,
}

impl ParamOverride {
    /// Reads `node.param=value`. A value that is not RON is taken as a text, so that quotes may be left out.
    ///
    /// # Errors
    /// What is missing.
    pub fn parse(typed: &str) -> Result<Self, String> {
        let (path, value) = typed
            .split_once('=')
            .ok_or("write it as node.param=value")?;
        let (target, name) = path
            .trim()
            .split_once('.')
            .ok_or("name a node and its parameter: node.param=value")?;
        let (is_slot, name) = match name.strip_prefix("slots.") {
            Some(slot) => (true, slot),
            None => (false, name),
        };
        if target.is_empty() || name.is_empty() {
            return Err("name a node and its parameter: node.param=value".to_owned());
        }
        let value = value.trim();
        let value = volgraph_graph::read::param_text(Path::new("--set"), value)
            .unwrap_or_else(|_| ParamValue::Text(value.to_owned()));
        Ok(Self {
            target: target.to_owned(),
            is_slot,
            name: name.to_owned(),
            value,
            typed: typed.to_owned(),
        })
    }

    fn desc(&self) -> ParamDesc {
        let place = self.place();
        ParamDesc {
            value: self.value.clone(),
            name_place: place.clone(),
            place,
        }
    }

    /// Whether both set the same thing.
    pub(crate) fn sets_the_same(&self, other: &Self) -> bool {
        let thing = |set: &Self| (set.target.clone(), set.is_slot, set.name.clone());
        thing(self) == thing(other)
    }

    /// Where it was typed.
    pub(crate) fn place(&self) -> Place {
        Place::whole_file(format!("--set {}", self.typed))
    }
}

impl Overrides {
    /// Changes the graph. Whether parameters exist and fit is checked with those of the file.
    ///
    /// # Errors
    /// `unknown-node` for a name that is no node or source.
    pub fn apply(&self, desc: &mut GraphDesc) -> Result<(), Findings> {
        let mut findings = Findings::new();
        for (name, file) in &self.volumes {
            let typed = if name.is_empty() {
                file.display().to_string()
            } else {
                format!("{name}={}", file.display())
            };
            let place = Place::whole_file(format!("--volume {typed}"));
            let Some(name) = findings.take(volume_source(desc, name, &place)) else {
                continue;
            };
            let Some(source) = desc.sources.get_mut(&name) else {
                findings.push(unknown(&name, &place, desc.sources.keys()));
                continue;
            };
            // Paths of the command line start at the current folder, those of the file at the file's.
            let path = std::path::absolute(file).unwrap_or_else(|_| file.clone());
            let value = ParamValue::Text(path.display().to_string());
            let path = ParamDesc {
                value,
                name_place: place.clone(),
                place: place.clone(),
            };
            *source = SourceDesc {
                kind: "volume".to_owned(),
                params: [("path".to_owned(), path)].into(),
                place,
            };
        }
        let is_renderer =
            |set: &&ParamOverride| set.name == RENDERER && !set.is_slot && desc_has(desc, set);
        let renderers: Vec<&ParamOverride> = self.params.iter().filter(is_renderer).collect();
        for set in &self.params {
            if renderers
                .iter()
                .any(|renderer| std::ptr::eq(*renderer, set))
            {
                continue;
            }
            if let Some(node) = desc.nodes.get_mut(&set.target) {
                let values = if set.is_slot {
                    &mut node.slots
                } else {
                    &mut node.params
                };
                values.insert(set.name.clone(), set.desc());
            } else if let (Some(source), false) = (desc.sources.get_mut(&set.target), set.is_slot) {
                source.params.insert(set.name.clone(), set.desc());
            } else {
                findings.push(unknown(
                    &set.target,
                    &set.place(),
                    desc.nodes.keys().chain(desc.sources.keys()),
                ));
            }
        }
        // What is set beside it is known by now.
        for set in renderers {
            if let Some(node) = desc.nodes.get_mut(&set.target) {
                findings.take(set_renderer(&set.target, node, &set.value, &set.place()));
            }
        }
        if let Some(time) = self.time {
            let set = time_desc(time);
            let volumes = desc.sources.values_mut().filter(|it| it.kind == VOLUME);
            for source in volumes {
                source.params.insert(TIME.to_owned(), set.clone());
            }
        }
        if let Some(camera) = &self.camera {
            desc.camera = Some(camera.clone());
        }
        if let Some(look) = &self.look {
            let place = Place::whole_file(format!("--look {look}"));
            let edge = EdgeDesc {
                from: look.clone(),
                name_place: place.clone(),
                place,
            };
            desc.outputs.insert(LOOK.to_owned(), edge);
        }
        findings.into_result(())
    }
}

/// The kind of source that has time steps, and its field for them.
pub(crate) const VOLUME: &str = "volume";
/// See [`VOLUME`].
pub(crate) const TIME: &str = "time";

fn time_desc(time: u32) -> ParamDesc {
    let place = Place::whole_file(format!("--time {time}"));
    ParamDesc {
        value: ParamValue::Int(time.into()),
        name_place: place.clone(),
        place,
    }
}

/// Whether a graph has the node that is set.
fn desc_has(desc: &GraphDesc, set: &ParamOverride) -> bool {
    desc.nodes.contains_key(&set.target)
}

/// The name of the source that `--volume` means.
pub(crate) fn volume_source(
    desc: &GraphDesc,
    name: &str,
    place: &Place,
) -> Result<String, Finding> {
    if !name.is_empty() {
        return Ok(name.to_owned());
    }
    let volumes: Vec<&String> = desc
        .sources
        .iter()
        .filter(|(_, source)| ["volume", "analytic"].contains(&source.kind.as_str()))
        .map(|(name, _)| name)
        .collect();
    match volumes.as_slice() {
        [only] => Ok((*only).clone()),
        _ if volumes.iter().any(|name| *name == "volume") => Ok("volume".to_owned()),
        _ => {
            let names = volgraph_report::list_names(volumes.iter().map(|name| name.as_str()));
            Err(Finding::error(
                "ambiguous-volume",
                format!(
                    "the graph has {} volumes, and none is named `volume`",
                    volumes.len()
                ),
            )
            .at(place.clone())
            .help(format!("write `--volume NAME=FILE` with one of: {names}")))
        }
    }
}

/// What to say of a name that the graph does not have.
pub(crate) fn unknown<'a>(
    name: &str,
    place: &Place,
    known: impl Iterator<Item = &'a String>,
) -> Finding {
    Finding::error(
        "unknown-node",
        format!("the graph has nothing named `{name}`"),
    )
    .at(place.clone())
    .help_opt(did_you_mean(name, known.map(String::as_str)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_ron_or_bare_texts() {
        let parse = |typed| ParamOverride::parse(typed).unwrap();
        assert_eq!(parse("image.step=0.5").value, ParamValue::Float(0.5));
        assert_eq!(
            parse("image.stage=compute").value,
            ParamValue::Text("compute".to_owned())
        );
        assert_eq!(
            parse("light.direction=(1, 0, 0)").value,
            ParamValue::Vector(vec![1.0, 0.0, 0.0])
        );
        let slot = parse("image.slots.classify=post");
        assert_eq!((slot.is_slot, slot.name.as_str()), (true, "classify"));
        assert!(ParamOverride::parse("image.step").is_err());
        assert!(ParamOverride::parse("step=1").is_err());
    }
}
