//! `preintegration`: the table of integrals over segments, for one segment length.

use volgraph_graph::{
    InputPort, NodeContext, NodeKind, OutputPort, Pass, PortType, Requirement, ResourceDesc, Size,
    UploadBytes,
};
use volgraph_optics::TransferFunction;
use volgraph_report::Finding;
use volgraph_shader::ParamSpec;
use wgpu_types::TextureFormat;

use crate::placement::volume;
use crate::transfer_table::transfer;

/// The node kind `preintegration`.
pub struct Preintegration;

/// Inputs of all kinds that integrate over segments.
pub(crate) const INPUTS: &[InputPort] = &[
    InputPort {
        name: "transfer",
        ty: PortType::Transfer,
        requirement: Requirement::Required,
        doc: "The transfer function.",
    },
    InputPort {
        name: "volume",
        ty: PortType::Volume,
        requirement: Requirement::Required,
        doc: "The volume, whose smallest spacing is the unit of the step.",
    },
];

const OUTPUTS: &[OutputPort] = &[OutputPort {
    name: "table",
    ty: PortType::Table2d,
    doc: "Premultiplied colour and optical depth of a segment from front scalar (x) to back scalar (y).",
}];

/// The parameter with the entries along a side, for kinds that call for this one.
#[must_use]
pub fn size_param() -> ParamSpec {
    ParamSpec::int(
        "preintegration_size",
        1024,
        "Entries along each side of the pre-integrated table.",
    )
    .range(64.0, 4096.0)
}

/// The parameter with the length of the segments.
pub(crate) fn step_param() -> ParamSpec {
    ParamSpec::float("step", 1.0, "Length of the segments.")
        .range(0.01, 64.0)
        .unit("voxel")
}

/// The length of the segments in reference lengths.
pub(crate) fn segment_references(
    node: &NodeContext<'_>,
    transfer: &TransferFunction,
) -> Result<f64, Finding> {
    let voxel = volume(node, "volume")?.grid().min_spacing();
    let segment_world = node.float("step") * voxel;
    Ok(segment_world * transfer.reference_length().extinction_per_world(voxel))
}

impl NodeKind for Preintegration {
    fn name(&self) -> &'static str {
        "preintegration"
    }

    fn doc(&self) -> &'static str {
        "Integrates a transfer function over all segments between two scalars (2D pre-integration)."
    }

    fn inputs(&self) -> &[InputPort] {
        INPUTS
    }

    fn outputs(&self) -> &[OutputPort] {
        OUTPUTS
    }

    fn params(&self) -> Vec<ParamSpec> {
        vec![step_param(), size_param()]
    }

    fn output(&self, _port: &str, node: &NodeContext<'_>) -> Result<ResourceDesc, Finding> {
        let size = node.uint("preintegration_size");
        Ok(ResourceDesc::Texture {
            dimensions: 2,
            size: Size::Absolute([size, size, 1]),
            format: TextureFormat::Rgba32Float,
        })
    }

    fn record(&self, node: &NodeContext<'_>) -> Result<Vec<Pass>, Finding> {
        let transfer = transfer(node, "transfer")?;
        let segment_references = segment_references(node, &transfer)?;
        let size = node.uint("preintegration_size");
        let bytes = UploadBytes::new(move || {
            let table = transfer
                .preintegrated_table(size, segment_references)
                .map_err(|error| Finding::error("table", error.to_string()))?;
            Ok(bytemuck::cast_slice(&table.entries).to_vec())
        });
        Ok(vec![Pass::Upload {
            port: "table",
            bytes,
        }])
    }
}
