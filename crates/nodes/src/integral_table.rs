//! `integral_table`: integrals of transfer functions over the scalar, three rows for each.

use volgraph_graph::{
    InputPort, NodeContext, NodeKind, OutputPort, Pass, PortType, ResourceDesc, Size, UploadBytes,
};
use volgraph_report::Finding;
use volgraph_shader::ParamSpec;
use wgpu_types::TextureFormat;

use crate::transfer_table::{INPUTS, row_count, size_param, transfers};

/// The node kind `integral_table`.
pub struct IntegralTable;

/// Rows of a transfer function.
pub const ROWS: u32 = 3;

const OUTPUTS: &[OutputPort] = &[OutputPort {
    name: "table",
    ty: PortType::Table1d,
    doc: "Integrals of colour times extinction and of extinction: in two floats, and what the next entry adds.",
}];

impl NodeKind for IntegralTable {
    fn name(&self) -> &'static str {
        "integral_table"
    }

    fn doc(&self) -> &'static str {
        "Integrates transfer functions over the scalar (1D pre-integration)."
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
        let rows = ROWS * row_count(&transfers(node)?);
        Ok(ResourceDesc::Texture {
            dimensions: 2,
            size: Size::Absolute([node.uint("table_size"), rows, 1]),
            format: TextureFormat::Rgba32Float,
        })
    }

    fn record(&self, node: &NodeContext<'_>) -> Result<Vec<Pass>, Finding> {
        let transfers = transfers(node)?;
        let size = node.uint("table_size");
        let bytes = UploadBytes::new(move || {
            let mut bytes = Vec::new();
            for transfer in &transfers {
                let table = transfer
                    .integral_table(size)
                    .map_err(|error| Finding::error("table", error.to_string()))?;
                bytes.extend_from_slice(bytemuck::cast_slice(&table.entries));
            }
            Ok(bytes)
        });
        Ok(vec![Pass::Upload {
            port: "table",
            bytes,
        }])
    }
}
