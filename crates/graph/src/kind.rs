//! What a node kind says of itself: the trait that a third-party crate implements.
//!
//! A node kind reads top to bottom: its name and meaning, its ports, its parameters and slots, the shader
//! program it runs, the size of what it writes, and the passes of one frame.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

use indexmap::IndexMap;
use serde::Serialize;
use volgraph_report::Finding;
use volgraph_shader::{ParamSpec, ParamValue, UniformValue};

use crate::desc::ParamDesc;
use crate::node_context::NodeContext;
use crate::{Pass, ResourceDesc, State};

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
    /// What labels mean, on the CPU (a source).
    Segments,
    /// A 2D texture of linear premultiplied colour.
    Color,
    /// A 2D texture of one number per pixel.
    Scalar2d,
    /// A 2D texture of a vector of world space per pixel; the fourth is 1 where there is one.
    Vector2d,
    /// A 2D texture of the walk along one ray, record by record.
    Trace,
    /// Colour and extinction over the scalar, one row for each transfer function.
    Table1d,
    /// A 2D texture of segment colour and optical depth.
    Table2d,
    /// A 2D texture of what a table of segments is made of.
    Pieces,
    /// A 3D texture of segment colour and extinction.
    Table3d,
    /// A 3D texture of scalars.
    VolumeTexture,
    /// A 3D texture of bricks of scalars, side by side.
    BrickPool,
    /// A 3D texture that says of each brick which one of a pool has its scalars.
    PageTable,
    /// A 3D texture of colours.
    ColorVolume,
    /// A 3D texture of gradients.
    GradientTexture,
    /// A 3D texture of labels and of how far each is the only one around.
    LabelTexture,
    /// A 2D texture of an image.
    ImageTexture,
    /// A 3D texture of the least and the largest scalar of each brick.
    BrickRanges,
    /// A 2D texture with the slices of a grid of bricks side by side: of each brick, how far the next is that may be seen.
    DistanceMap,
    /// A 3D texture of the largest first and second derivative of each brick.
    BrickDetails,
    /// A 2D texture with the slices of a grid of bricks side by side: how long the segments of each brick may be.
    StrideMap,
    /// A 2D texture of the parts of rays that may see anything, tile by tile of the picture.
    Spans,
    /// A 2D texture with the slices of a grid side by side: of four lights, the share that reaches a point.
    LightGrid,
    /// A buffer of triangles.
    Mesh,
    /// A buffer of whatever a node's passes hand on to each other.
    Buffer,
}

impl fmt::Display for PortType {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Volume => "volume",
            Self::Transfer => "transfer",
            Self::Image => "image",
            Self::Segments => "segments",
            Self::Color => "color",
            Self::Scalar2d => "scalar_2d",
            Self::Vector2d => "vector_2d",
            Self::Trace => "trace",
            Self::Table1d => "table_1d",
            Self::Table2d => "table_2d",
            Self::Pieces => "pieces",
            Self::Table3d => "table_3d",
            Self::VolumeTexture => "volume_texture",
            Self::BrickPool => "brick_pool",
            Self::PageTable => "page_table",
            Self::ColorVolume => "color_volume",
            Self::GradientTexture => "gradient_texture",
            Self::LabelTexture => "label_texture",
            Self::ImageTexture => "image_texture",
            Self::BrickRanges => "brick_ranges",
            Self::DistanceMap => "distance_map",
            Self::BrickDetails => "brick_details",
            Self::StrideMap => "stride_map",
            Self::Spans => "spans",
            Self::LightGrid => "light_grid",
            Self::Mesh => "mesh",
            Self::Buffer => "buffer",
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
    /// The same with a node of this kind to which all goes on that has a name in common with this node: the writers of
    /// input ports, parameters that its shader declares, choices of slots.
    DemandedAlike(&'static str),
}

impl Requirement {
    /// The kind of the node that a demanded port calls for.
    #[must_use]
    pub fn demanded_kind(&self) -> Option<&'static str> {
        match self {
            Self::Demanded(demand) => Some(demand.kind),
            Self::DemandedAlike(kind) => Some(kind),
            Self::Required | Self::Optional => None,
        }
    }
}

/// The node that a demanded port calls for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Demand {
    /// Its kind.
    pub kind: &'static str,
    /// Its inputs: (its port, the demanding node's port that is connected to the same writer). Where that one is open,
    /// so is its own, if it may be.
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
    /// Its name; a storage binding named `<name>_out` writes it, and a texture binding of its own name reads what an
    /// earlier pass of the node left there.
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

/// A slot whose choice, where the graph states none, is stated by the file that fills another slot: behind a tag in the
/// comment at its head (`// @skips transfer`).
#[derive(Clone, Copy, Debug)]
pub struct DerivedSlot {
    /// The slot.
    pub slot: &'static str,
    /// The other one.
    pub from: &'static str,
    /// The tag, without its `@`.
    pub tag: &'static str,
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
    /// What the node takes over from its writers, where its shader imports it.
    pub inherited: Vec<Inherited>,
}

/// Parameters and inputs that a node takes over from the writer at an input port, because both import the same slot:
/// a raycast whose rays see the pattern of the background behind it, say.
///
/// Only where the slot is imported; what the graph gives the node itself goes before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Inherited {
    /// The slot: all parameters that are declared in the file that fills it are taken over.
    pub slot: &'static str,
    /// The input port.
    pub port: &'static str,
    /// Input ports of this node that are connected as the writer's of the same name are.
    pub inputs: &'static [&'static str],
}

/// Parameters by name that a row of their table has for itself.
pub type ParamRow = IndexMap<String, ParamDesc>;

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

    /// Those of its slots that follow another.
    fn derived_slots(&self) -> &[DerivedSlot] {
        &[]
    }

    /// What its work depends on of the source at an input port, where that is not all of it: work is done again where
    /// these bytes change.
    fn depends_on(&self, port: &str, node: &NodeContext<'_>) -> Option<Vec<u8>> {
        let _ = (port, node);
        None
    }

    /// What its result in a view depends on beside parameters and inputs: what has been read until now of something larger
    /// than memory, say. Asking may take it further.
    ///
    /// # Errors
    /// What is wrong with the inputs.
    fn state(&self, node: &NodeContext<'_>) -> Result<Option<State>, Finding> {
        let _ = node;
        Ok(None)
    }

    /// The output ports whose textures it fills in tiles ([`crate::Pass::Tiles`]).
    fn tiled(&self) -> &[&'static str] {
        &[]
    }

    /// The default of a parameter that its shader declares, where it is another than the shader's because of what the node
    /// is made of.
    fn default_of(&self, param: &str, node: &NodeContext<'_>) -> Option<ParamValue> {
        let _ = (param, node);
        None
    }

    /// The choice of a slot that the graph leaves open, where it is another than [`SlotSpec::default`] because of what the
    /// node is made of. It is asked once [`Self::derived_slots`] are known.
    fn default_slot(&self, slot: &str, node: &NodeContext<'_>) -> Option<&'static str> {
        let _ = (slot, node);
        None
    }

    /// Lets go of what it keeps from picture to picture, which costs the next one time alone.
    fn forget(&self) {}

    /// The uniforms it fills itself, beside `lens`, `camera` and `params`.
    fn uniforms(&self) -> &[&'static str] {
        &[]
    }

    /// The shader program; `None` for a node that only uploads.
    fn program(&self, node: &NodeContext<'_>) -> Option<ProgramSpec> {
        let _ = node;
        None
    }

    /// The output ports that its passes draw into (see [`crate::Target`] and [`crate::Depth`]). What only its own passes
    /// read is an output port as well, which [`Self::written`] names.
    fn targets(&self) -> &[&'static str] {
        &[]
    }

    /// Whether it can draw a window of a picture ([`crate::View::window`]) as that part of the whole: what finds its rays
    /// by `lib/frame.wgsl`, pixel by pixel, can.
    fn draws_windows(&self, node: &NodeContext<'_>) -> bool {
        let _ = node;
        true
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

    /// The rows of the table of parameters after the first, which is the node's own, for shaders that select one
    /// (`params_select`). A row says what differs from the node's own.
    fn param_rows<'g>(&self, node: &NodeContext<'g>) -> Vec<&'g ParamRow> {
        let _ = node;
        Vec::new()
    }

    /// What is done in a frame.
    ///
    /// # Errors
    /// Why nothing can be.
    fn record(&self, node: &NodeContext<'_>) -> Result<Vec<Pass>, Finding>;
}
