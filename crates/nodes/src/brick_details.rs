//! `brick_details`: how fast scalars change in each brick of a volume, as bounds of the first and the second derivative.
//!
//! The processor makes them in one pass over the voxels. They belong to the volume alone: an edit of the transfer function
//! finds them where they are.

use std::sync::Arc;

use volgraph_graph::{
    Demand, InputPort, NodeContext, NodeKind, OutputPort, Pass, PortType, Requirement,
    ResourceDesc, Size, SlotSpec, UploadBytes,
};
use volgraph_report::Finding;
use volgraph_shader::ParamSpec;
use wgpu_types::TextureFormat;

use crate::brick_ranges::{self, map_size, size_param};
use crate::source::volume::VolumeSource;

/// The node kind `brick_details`.
pub struct BrickDetails;

/// The details of the bricks of a node's volume.
pub(crate) const DETAILS: Demand = Demand {
    kind: "brick_details",
    inputs: &[("volume", "volume")],
    params: &[("brick_size", "brick_size")],
    slots: &[("reconstruct", "reconstruct")],
};

const INPUTS: &[InputPort] = &[InputPort {
    name: "volume",
    ty: PortType::Volume,
    requirement: Requirement::Required,
    doc: "The volume.",
}];

const OUTPUTS: &[OutputPort] = &[OutputPort {
    name: "details",
    ty: PortType::BrickDetails,
    doc: "Of each brick, the largest first and second derivative along any direction, in data units per world unit.",
}];

const SLOTS: &[SlotSpec] = &[SlotSpec {
    name: "reconstruct",
    default: "trilinear",
    doc: "What is the scalar at a point?",
}];

impl NodeKind for BrickDetails {
    fn name(&self) -> &'static str {
        "brick_details"
    }

    fn doc(&self) -> &'static str {
        "Finds how fast scalars change in each brick of a volume."
    }

    fn inputs(&self) -> &[InputPort] {
        INPUTS
    }

    fn outputs(&self) -> &[OutputPort] {
        OUTPUTS
    }

    fn params(&self) -> Vec<ParamSpec> {
        vec![size_param()]
    }

    fn slots(&self) -> &[SlotSpec] {
        SLOTS
    }

    fn output(&self, _port: &str, node: &NodeContext<'_>) -> Result<ResourceDesc, Finding> {
        let (dims, _) = map_size(node)?;
        Ok(ResourceDesc::Texture {
            dimensions: 3,
            size: Size::Absolute(dims),
            format: TextureFormat::Rg32Float,
        })
    }

    fn record(&self, node: &NodeContext<'_>) -> Result<Vec<Pass>, Finding> {
        let margin = brick_ranges::known_margin(node)?;
        let size = node.uint("brick_size");
        let source = node.source::<VolumeSource>("volume");
        let volume = source.map(|source| Arc::clone(&source.volume));
        let bytes = UploadBytes::by_layers(move || {
            let volume = volume.clone();
            Ok(Box::new(move |layers, texels| {
                let details = volume
                    .as_ref()
                    .map(|volume| volume.brick_details_of(size, margin, layers))
                    .unwrap_or_default();
                for (texel, number) in texels.chunks_exact_mut(4).zip(details.iter().flatten()) {
                    texel.copy_from_slice(&(*number as f32).to_le_bytes());
                }
                Ok(())
            }))
        });
        Ok(vec![Pass::Upload {
            port: "details",
            bytes,
        }])
    }
}
