//! `refraction_table`: the refractive index of a transfer function as a table.

use volgraph_graph::{
    InputPort, NodeContext, NodeKind, OutputPort, Pass, PortType, Requirement, ResourceDesc, Size,
    UploadBytes,
};
use volgraph_report::Finding;
use volgraph_shader::ParamSpec;
use wgpu_types::TextureFormat;

use crate::transfer_table::{size_param, transfer};

/// The node kind `refraction_table`.
pub struct RefractionTable;

const INPUTS: &[InputPort] = &[InputPort {
    name: "transfer",
    ty: PortType::Transfer,
    requirement: Requirement::Required,
    doc: "The transfer function.",
}];

const OUTPUTS: &[OutputPort] = &[OutputPort {
    name: "table",
    ty: PortType::Table1d,
    doc: "Refractive index over the scalar.",
}];

impl NodeKind for RefractionTable {
    fn name(&self) -> &'static str {
        "refraction_table"
    }

    fn doc(&self) -> &'static str {
        "Samples the refractive index of a transfer function into a table."
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

    fn output(&self, _port: &str, node: &NodeContext<'_>) -> Result<ResourceDesc, Finding> {
        Ok(ResourceDesc::Texture {
            // One row of a 2D texture: wgpu 30 makes 1D textures 2D on GL, where shaders still ask for 1D ones.
            dimensions: 2,
            size: Size::Absolute([node.uint("table_size"), 1, 1]),
            format: TextureFormat::R32Float,
        })
    }

    fn record(&self, node: &NodeContext<'_>) -> Result<Vec<Pass>, Finding> {
        let transfer = transfer(node, "transfer")?;
        let size = node.uint("table_size");
        let bytes = UploadBytes::new(move || {
            let table = transfer
                .refraction_table(size)
                .map_err(|error| Finding::error("table", error.to_string()))?;
            Ok(bytemuck::cast_slice(&table).to_vec())
        });
        Ok(vec![Pass::Upload {
            port: "table",
            bytes,
        }])
    }
}
