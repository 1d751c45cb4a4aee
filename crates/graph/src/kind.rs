//! What a node kind and a source kind say of themselves: the two traits a third-party crate implements.
//!
//! A node kind reads top to bottom: its name and meaning, its ports, its parameters and slots, the shader
//! program it runs, the size of what it writes, and the passes of one frame.

use std::any::Any;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::path::PathBuf;
use std::sync::Arc;

use glam::DVec3;
use serde::Serialize;
use volgraph_report::{Finding, Findings};
use volgraph_shader::{Binding, ParamSpec, ParamValue, UniformValue};

use crate::graph::{Graph, NodeBody, NodeId};
use crate::{Digest, Limits, Pass, ResourceDesc, ResourceKind, View};

/// What an edge carries. Two ports connect where their types are equal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum PortType {
    /// A volume on the CPU (a source).
    Volume,
    /// A transfer function on the CPU (a source).
    Transfer,
    /// A picture on the CPU (a source).
    Image,
    /// A 2D texture of linear premultiplied colour.
    Color,
    /// A 2D texture of one number per pixel.
    Scalar2d,
    /// A row of colour and extinction over the scalar.
    Table1d,
    /// A 2D texture of segment colour and optical depth.
    Table2d,
    /// A 3D texture of scalars.
    VolumeTexture,
    /// A 3D texture of gradients.
    GradientTexture,
    /// A 2D texture of an image.
    ImageTexture,
    /// A buffer of triangles.
    Mesh,
}

impl fmt::Display for PortType {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Volume => "volume",
            Self::Transfer => "transfer",
            Self::Image => "image",
            Self::Color => "color",
            Self::Scalar2d => "scalar_2d",
            Self::Table1d => "table_1d",
            Self::Table2d => "table_2d",
            Self::VolumeTexture => "volume_texture",
            Self::GradientTexture => "gradient_texture",
            Self::ImageTexture => "image_texture",
            Self::Mesh => "mesh",
        })
    }
}

/// Whether an input port has to be connected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Requirement {
    /// The graph file must connect it.
    Required,
    /// It may stay open.
    Optional,
    /// Where a used binding has this port's name and the file does not connect it, a node is added for it; where
    /// no used binding has its name, it is not connected at all.
    Demanded(Demand),
}

/// The node that a demanded port calls for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Demand {
    /// Its kind.
    pub kind: &'static str,
    /// Its inputs: (its port, the demanding node's port that is connected to the same writer).
    pub inputs: &'static [(&'static str, &'static str)],
    /// Its parameters: (its parameter, the demanding node's parameter with the value).
    pub params: &'static [(&'static str, &'static str)],
    /// Its slots: (its slot, the demanding node's slot with the choice).
    pub slots: &'static [(&'static str, &'static str)],
}

/// An input port.
#[derive(Clone, Copy, Debug)]
pub struct InputPort {
    /// Its name; a shader binding of this name reads it.
    pub name: &'static str,
    /// What it takes.
    pub ty: PortType,
    /// Whether it has to be connected.
    pub requirement: Requirement,
    /// What it means, one sentence.
    pub doc: &'static str,
}

/// An output port.
#[derive(Clone, Copy, Debug)]
pub struct OutputPort {
    /// Its name; a storage binding named `<name>_out` writes it.
    pub name: &'static str,
    /// What it gives.
    pub ty: PortType,
    /// What it means, one sentence.
    pub doc: &'static str,
}

/// A slot that a node kind's shader imports.
#[derive(Clone, Copy, Debug)]
pub struct SlotSpec {
    /// Its name.
    pub name: &'static str,
    /// The choice where the graph says none.
    pub default: &'static str,
    /// The question it answers, one sentence.
    pub doc: &'static str,
}

/// The shader program of a node.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ProgramSpec {
    /// The shader file with the entry points.
    pub root: &'static str,
    /// Choices of slots that the node itself makes (not open to the graph file).
    pub fixed_slots: BTreeMap<String, String>,
    /// The entry points that this node may run.
    pub entries: Vec<&'static str>,
}

/// The members of a uniform by name. A shader's struct may declare fewer.
pub type Uniform = Vec<(&'static str, UniformValue)>;

/// A kind of node.
pub trait NodeKind: Send + Sync {
    /// Its name: one word for the kind, its file, its shader and its label.
    fn name(&self) -> &'static str;

    /// What it does, one sentence.
    fn doc(&self) -> &'static str;

    /// Its input ports.
    fn inputs(&self) -> &[InputPort] {
        &[]
    }

    /// Its output ports; the first is the default one.
    fn outputs(&self) -> &[OutputPort];

    /// Its parameters beside those that its shader declares.
    fn params(&self) -> Vec<ParamSpec> {
        Vec::new()
    }

    /// Its slots.
    fn slots(&self) -> &[SlotSpec] {
        &[]
    }

    /// The uniforms it fills itself, beside `lens`, `camera` and `params`.
    fn uniforms(&self) -> &[&'static str] {
        &[]
    }

    /// The shader program; `None` for a node that only uploads.
    fn program(&self, node: &NodeContext<'_>) -> Option<ProgramSpec> {
        let _ = node;
        None
    }

    /// Whether its passes (not its shader) depend on where the camera stands.
    fn passes_follow_camera(&self) -> bool {
        false
    }

    /// The ways the node may run that differ in speed alone; one is measured to be the fastest. Empty for one way.
    fn variants(&self, node: &NodeContext<'_>) -> Vec<&'static str> {
        let _ = node;
        Vec::new()
    }

    /// The output ports that the node writes where these are wanted of it: at least those.
    fn written(&self, wanted: &BTreeSet<&str>) -> Vec<&'static str> {
        self.outputs()
            .iter()
            .map(|port| port.name)
            .filter(|name| wanted.contains(name))
            .collect()
    }

    /// What is written at an output port.
    ///
    /// # Errors
    /// Why it cannot be: a size over the device's limits, an unfit input.
    fn output(&self, port: &str, node: &NodeContext<'_>) -> Result<ResourceDesc, Finding>;

    /// The members of one of [`Self::uniforms`].
    ///
    /// # Errors
    /// Why there is none.
    fn uniform(&self, name: &str, node: &NodeContext<'_>) -> Result<Uniform, Finding> {
        Err(Finding::error(
            "internal",
            format!("`{}` fills no uniform `{name}`", self.name()),
        )
        .help(format!("node `{}` uses it", node.name())))
    }

    /// What is done in a frame.
    ///
    /// # Errors
    /// Why nothing can be.
    fn record(&self, node: &NodeContext<'_>) -> Result<Vec<Pass>, Finding>;
}

/// A loaded source: a volume, a transfer function, an image, or anything else a node kind can downcast.
pub trait Source: Send + Sync + fmt::Debug {
    /// What its single output port gives.
    fn ty(&self) -> PortType;

    /// Changes whenever its content does.
    fn digest(&self) -> Digest;

    /// One line: what it is.
    fn summary(&self) -> String;

    /// The files it was read from.
    fn files(&self) -> Vec<PathBuf>;

    /// The corners of its box in world space, for cameras that fit; empty where it has none.
    fn corners(&self) -> Vec<DVec3> {
        Vec::new()
    }

    /// What the user should know: voxels that are not numbers, say.
    fn warnings(&self) -> Vec<String> {
        Vec::new()
    }

    /// Itself, for a node kind that knows the type.
    fn as_any(&self) -> &dyn Any;
}

/// Reports how much of a long read is done: (bytes so far, bytes in all or 0 where unknown).
pub type Progress<'p> = &'p (dyn Fn(u64, u64) + Sync);

/// Where the files of sources are looked for: the graph's own folder first, then folders of data.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Folders(Vec<PathBuf>);

impl Folders {
    /// The graph's folder, then the others in their order.
    #[must_use]
    pub fn new(graph: impl Into<PathBuf>, data: &[PathBuf]) -> Self {
        Self(
            std::iter::once(graph.into())
                .chain(data.iter().cloned())
                .collect(),
        )
    }

    /// The first folder's file that is there; where none is, the one in the graph's folder.
    #[must_use]
    pub fn find(&self, path: &str) -> PathBuf {
        let in_folders = || self.0.iter().map(|folder| folder.join(path));
        in_folders()
            .find(|file| file.exists())
            .or_else(|| in_folders().next())
            .unwrap_or_else(|| path.into())
    }
}

/// A kind of source.
pub trait SourceKind: Send + Sync {
    /// Its name, such as `volume`.
    fn name(&self) -> &'static str;

    /// What it gives, one sentence.
    fn doc(&self) -> &'static str;

    /// The type of its output.
    fn ty(&self) -> PortType;

    /// Its fields. A field whose default is an empty text or vector may be left out without a meaning of its own.
    fn params(&self) -> Vec<ParamSpec>;

    /// Reads it. `params` are checked against [`Self::params`] and hold given values alone; paths are looked up in
    /// `folders`.
    ///
    /// # Errors
    /// Everything wrong with its files; findings without a place get the source's place in the graph file.
    fn load(
        &self,
        params: &BTreeMap<String, ParamValue>,
        folders: &Folders,
        progress: Progress<'_>,
    ) -> Result<Arc<dyn Source>, Findings>;
}

/// A node as its kind sees it.
#[derive(Clone, Copy)]
pub struct NodeContext<'g> {
    pub(crate) graph: &'g Graph,
    pub(crate) id: NodeId,
    pub(crate) limits: &'g Limits,
    pub(crate) resources: Option<&'g BTreeMap<(NodeId, String), ResourceKind>>,
    pub(crate) frame: Option<FrameContext<'g>>,
}

#[derive(Clone, Copy)]
pub(crate) struct FrameContext<'g> {
    pub view: &'g View,
    pub variant: Option<&'g str>,
}

impl<'g> NodeContext<'g> {
    pub(crate) fn new(graph: &'g Graph, id: NodeId, limits: &'g Limits) -> Self {
        Self {
            graph,
            id,
            limits,
            resources: None,
            frame: None,
        }
    }

    fn node(&self) -> &'g crate::Node {
        &self.graph.nodes[self.id]
    }

    /// The node's name.
    #[must_use]
    pub fn name(&self) -> &'g str {
        &self.node().name
    }

    /// What the device can do.
    #[must_use]
    pub fn limits(&self) -> &'g Limits {
        self.limits
    }

    /// A parameter's value.
    #[must_use]
    pub fn param(&self, name: &str) -> Option<&'g ParamValue> {
        self.node().params.get(name)
    }

    /// A number parameter; 0 where there is none of that name.
    #[must_use]
    pub fn float(&self, name: &str) -> f64 {
        match self.param(name) {
            Some(ParamValue::Float(value)) => *value,
            #[expect(
                clippy::cast_precision_loss,
                reason = "parameters are small whole numbers"
            )]
            Some(ParamValue::Int(value)) => *value as f64,
            _ => 0.0,
        }
    }

    /// A text or choice parameter; empty where there is none of that name.
    #[must_use]
    pub fn text(&self, name: &str) -> &'g str {
        match self.param(name) {
            Some(ParamValue::Text(value)) => value,
            _ => "",
        }
    }

    /// A whole-number parameter; 0 where there is none of that name or it is negative.
    #[must_use]
    pub fn uint(&self, name: &str) -> u32 {
        match self.param(name) {
            Some(ParamValue::Int(value)) => u32::try_from(*value).unwrap_or(0),
            _ => 0,
        }
    }

    /// Whether an input port is connected.
    #[must_use]
    pub fn is_connected(&self, port: &str) -> bool {
        self.node().inputs.contains_key(port)
    }

    /// Whether somebody reads an output port.
    #[must_use]
    pub fn is_wanted(&self, port: &str) -> bool {
        self.graph.wanted(self.id).contains(port)
    }

    /// The choice of a slot.
    #[must_use]
    pub fn slot(&self, name: &str) -> &'g str {
        self.node()
            .slots
            .get(name)
            .map_or("", |choice| choice.choice.as_str())
    }

    /// The source of type `T` that an input port is connected to.
    #[must_use]
    pub fn source<T: 'static>(&self, port: &str) -> Option<&'g T> {
        let link = self.node().inputs.get(port)?;
        match &self.graph.nodes[link.node].body {
            NodeBody::Source(source) => source.as_any().downcast_ref(),
            NodeBody::Kind(_) => None,
        }
    }

    /// The source at an input port, shared, for work that is done later.
    #[must_use]
    pub fn shared_source(&self, port: &str) -> Option<Arc<dyn Source>> {
        let link = self.node().inputs.get(port)?;
        match &self.graph.nodes[link.node].body {
            NodeBody::Source(source) => Some(Arc::clone(source)),
            NodeBody::Kind(_) => None,
        }
    }

    /// The node that writes an input port, as its own kind sees it.
    #[must_use]
    pub fn writer(&self, port: &str) -> Option<NodeContext<'g>> {
        let link = self.node().inputs.get(port)?;
        Some(NodeContext {
            id: link.node,
            ..*self
        })
    }

    /// Whether one of the entry points uses a binding of this name.
    #[must_use]
    pub fn uses_binding(&self, name: &str) -> bool {
        self.node()
            .program
            .as_ref()
            .is_some_and(|program| program.uses(name))
    }

    /// A binding that one of the entry points uses.
    #[must_use]
    pub fn binding(&self, name: &str) -> Option<&'g Binding> {
        self.node()
            .program
            .as_ref()?
            .used()
            .into_iter()
            .find(|binding| binding.name == name)
    }

    /// The sized resource at an output port; known from the size phase on.
    #[must_use]
    pub fn output_resource(&self, port: &str) -> Option<ResourceKind> {
        self.resources?.get(&(self.id, port.to_owned())).copied()
    }

    /// The sized resource at an input port; known from the size phase on.
    #[must_use]
    pub fn input_resource(&self, port: &str) -> Option<ResourceKind> {
        let link = self.node().inputs.get(port)?;
        self.resources?
            .get(&(link.node, link.port.clone()))
            .copied()
    }

    /// The frame's view; `None` outside of recording.
    #[must_use]
    pub fn view(&self) -> Option<&'g View> {
        self.frame.map(|frame| frame.view)
    }

    /// The variant to record (see [`NodeKind::variants`]).
    #[must_use]
    pub fn variant(&self) -> Option<&'g str> {
        self.frame.and_then(|frame| frame.variant)
    }

    /// An error at this node's place.
    #[must_use]
    pub fn error(&self, code: &'static str, message: impl Into<String>) -> Finding {
        let finding = Finding::error(code, format!("node `{}`: {}", self.name(), message.into()));
        match self.node().place(self.graph) {
            Some(place) => finding.at(place),
            None => finding,
        }
    }
}
