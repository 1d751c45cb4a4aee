//! `step_table`: a transfer function as a table of whole steps: what one of a single scalar emits and lets through. A walk
//! that knows its segments to be steps needs no exponential of each.

use volgraph_graph::{
    InputPort, NodeContext, NodeKind, OutputPort, Pass, PortType, ResourceDesc, Size, UploadBytes,
};
use volgraph_report::Finding;
use volgraph_shader::ParamSpec;
use wgpu_types::TextureFormat;

use crate::preintegration::{self, segment_references, step_param};
use crate::transfer_table::{size_param, transfer};

/// The node kind `step_table`.
pub struct StepTable;

const OUTPUTS: &[OutputPort] = &[OutputPort {
    name: "table",
    ty: PortType::Table1d,
    doc: "Premultiplied colour and transmittance of a step of one scalar.",
}];

impl NodeKind for StepTable {
    fn name(&self) -> &'static str {
        "step_table"
    }

    fn doc(&self) -> &'static str {
        "Samples a transfer function into a table of what a step emits and lets through."
    }

    fn inputs(&self) -> &[InputPort] {
        preintegration::INPUTS_OF_ONE
    }

    fn outputs(&self) -> &[OutputPort] {
        OUTPUTS
    }

    fn params(&self) -> Vec<ParamSpec> {
        vec![step_param(), size_param()]
    }

    fn output(&self, _port: &str, node: &NodeContext<'_>) -> Result<ResourceDesc, Finding> {
        Ok(ResourceDesc::Texture {
            dimensions: 2,
            size: Size::Absolute([node.uint("table_size"), 1, 1]),
            format: TextureFormat::Rgba32Float,
        })
    }

    fn record(&self, node: &NodeContext<'_>) -> Result<Vec<Pass>, Finding> {
        let transfer = transfer(node, "transfer")?;
        let references = segment_references(node, &transfer)?;
        let size = node.uint("table_size");
        let bytes = UploadBytes::new(move || {
            let entries = transfer
                .step_table(size, references)
                .map_err(|error| Finding::error("table", error.to_string()))?;
            Ok(bytemuck::cast_slice(&entries).to_vec())
        });
        Ok(vec![Pass::Upload {
            port: "table",
            bytes,
        }])
    }
}
