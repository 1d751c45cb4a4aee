//! A graph file as it was written: names and values with their places, nothing looked up yet.

use indexmap::IndexMap;
use serde::Serialize;
use volgraph_report::Place;
use volgraph_shader::ParamValue;

use crate::camera::CameraDesc;
use crate::quality::QualityDesc;

/// A graph file's content. Names keep the order of the file.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct GraphDesc {
    /// Volumes, transfer functions, images.
    pub sources: IndexMap<String, SourceDesc>,
    /// The camera; the default one where `None`.
    pub camera: Option<CameraDesc>,
    /// What the picture may cost, or how wrong it may be; the settings stand as they are where `None`.
    pub quality: Option<QualityDesc>,
    /// The nodes.
    pub nodes: IndexMap<String, NodeDesc>,
    /// What is wanted: output name → port.
    pub outputs: IndexMap<String, EdgeDesc>,
}

/// A source, such as `volume(path: "engine.nrrd")`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SourceDesc {
    /// The source kind's name.
    pub kind: String,
    /// Its fields.
    pub params: IndexMap<String, ParamDesc>,
    /// Where it is named.
    pub place: Place,
}

impl SourceDesc {
    /// Whether both ask for the same, wherever it is written.
    #[must_use]
    pub fn asks_the_same(&self, other: &Self) -> bool {
        let values = |desc: &Self| -> Vec<(String, ParamValue)> {
            let mut values: Vec<_> = desc
                .params
                .iter()
                .map(|(name, param)| (name.clone(), param.value.clone()))
                .collect();
            values.sort_by(|a, b| a.0.cmp(&b.0));
            values
        };
        self.kind == other.kind && values(self) == values(other)
    }
}

/// A node.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct NodeDesc {
    /// The node kind's name.
    pub kind: String,
    /// Where the kind is named.
    pub kind_place: Place,
    /// Input port → what it is connected to.
    pub inputs: IndexMap<String, EdgeDesc>,
    /// Slot → choice.
    pub slots: IndexMap<String, ParamDesc>,
    /// Parameters.
    pub params: IndexMap<String, ParamDesc>,
    /// Where the node is named.
    pub place: Place,
}

/// The writer of an edge: `"node"` (its first output port), `"node.port"` or `"source"`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EdgeDesc {
    /// The text as written.
    pub from: String,
    /// Where the reader's port is named.
    pub name_place: Place,
    /// Where the writer is named.
    pub place: Place,
}

/// A value somebody set, and where.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ParamDesc {
    /// The value as written, not yet checked against a type.
    pub value: ParamValue,
    /// Where the name stands.
    pub name_place: Place,
    /// Where the value stands.
    pub place: Place,
}
