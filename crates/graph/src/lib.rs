//! The render graph as plain data: from a graph file to a [`Plan`], without a GPU.
//!
//! The way of the data: [`read`] turns RON text into a [`GraphDesc`] with every finding at its place; a
//! [`Registry`] knows the node kinds and source kinds; [`sources`] loads what the graph draws. The phases are functions over plain values, each with
//! its own tests: [`resolve`] (names, ports, slots, defaults), [`demand`] (link each node's shader, see which
//! bindings its entry points really use, add the nodes that those call for), [`check`] (types, parameters,
//! cycles; collects all), [`cull`] (backwards from the outputs), [`order`] (deterministic), [`size`] (absolute,
//! view-relative, input-relative) and [`lifetime`] (which resources may share memory). [`Plan::build`] runs
//! them all; [`Plan::record`] asks each node for its [`Pass`]es of one frame, and [`fingerprint`] says
//! which nodes need not run because what they wrote last still holds.

#![warn(missing_docs)]

pub mod camera;
mod camera_text;
pub mod check;
pub mod choices;
pub mod cull;
pub mod demand;
mod desc;
pub mod edit;
pub mod fingerprint;
mod graph;
mod kind;
pub mod lifetime;
mod limits;
mod node_context;
pub mod order;
mod pass;
mod plan;
mod planned;
pub mod print;
mod quality;
pub mod read;
mod registry;
pub mod resolve;
mod resource;
pub mod size;
mod source;
pub mod sources;
mod tiles;
mod upload;

pub use camera::{Camera, CameraDesc, Lens, Pose, Projection, View, Window};
pub use desc::{EdgeDesc, GraphDesc, NodeDesc, ParamDesc, SourceDesc};
pub use edit::{Edit, apply_edits};
pub use fingerprint::{Digest, hex};
pub use graph::{Graph, Link, Node, NodeBody, NodeId, Origin, Program};
pub use kind::{
    Demand, DerivedSlot, Inherited, InputPort, NodeKind, OutputPort, ParamRow, PortType,
    ProgramSpec, Requirement, SlotSpec, Uniform,
};
pub use limits::Limits;
pub use node_context::NodeContext;
pub use pass::{Blend, Depth, Geometry, Mesh, Pass, Target};
pub use plan::{Allocation, Plan, PlanRequest};
pub use planned::{PlannedBinding, PlannedNode, PlannedResource};
pub use quality::{Budget, QualityDesc};
pub use registry::Registry;
pub use resource::{Extent, ResourceDesc, ResourceKind, Size};
pub use source::{EMBEDDED_GRAPHS, Folders, Progress, Source, SourceKind, is_embedded, is_there};
pub use tiles::{Progress as StateProgress, State, TileTag, Tiles};
pub use upload::{FillLayers, Piece, Pieces, UploadBytes};
