//! `transfer_table`: transfer functions as a table for post-classification, a row for each.

use std::sync::Arc;

use volgraph_graph::{
    InputPort, NodeContext, NodeKind, OutputPort, Pass, PortType, Requirement, ResourceDesc, Size,
    UploadBytes,
};
use volgraph_optics::TransferFunction;
use volgraph_report::Finding;
use volgraph_shader::ParamSpec;
use wgpu_types::TextureFormat;

use crate::source::segments::SegmentsSource;
use crate::source::transfer::TransferSource;

/// The node kind `transfer_table`.
pub struct TransferTable;

/// Inputs of all kinds of tables over one scalar with rows for each transfer function.
pub(crate) const INPUTS: &[InputPort] = &[
    InputPort {
        name: "transfer",
        ty: PortType::Transfer,
        requirement: Requirement::Optional,
        doc: "The transfer function; the first row.",
    },
    InputPort {
        name: "segments",
        ty: PortType::Segments,
        requirement: Requirement::Optional,
        doc: "What labels mean; a row for each transfer function that they name.",
    },
];

const OUTPUTS: &[OutputPort] = &[OutputPort {
    name: "table",
    ty: PortType::Table1d,
    doc: "Linear colour and extinction per reference length.",
}];

/// The parameter with the number of entries, for kinds that call for this one.
#[must_use]
pub fn size_param() -> ParamSpec {
    ParamSpec::int("table_size", 8192, "Entries of the classification table.").range(1024.0, 8192.0)
}

/// The transfer function at a node's input port.
///
/// # Errors
/// `missing-input` where there is none.
pub fn transfer(node: &NodeContext<'_>, port: &str) -> Result<Arc<TransferFunction>, Finding> {
    node.source::<TransferSource>(port)
        .map(|source| Arc::clone(&source.transfer))
        .ok_or_else(|| {
            node.error(
                "missing-input",
                format!("its input `{port}` is not a transfer function"),
            )
        })
}

/// The transfer functions of a node with the inputs `transfer` and `segments`, in the order of the rows of its tables:
/// its own first, where it has one.
///
/// # Errors
/// `missing-input` where there is none.
pub fn transfers(node: &NodeContext<'_>) -> Result<Vec<Arc<TransferFunction>>, Finding> {
    let Some(segments) = node.source::<SegmentsSource>("segments") else {
        return Ok(vec![transfer(node, "transfer")?]);
    };
    let own = node.is_connected("transfer");
    let own = own.then(|| transfer(node, "transfer")).transpose()?;
    let all: Vec<_> = own.into_iter().chain(segments.transfers.clone()).collect();
    if all.is_empty() {
        transfer(node, "transfer")?;
    }
    Ok(all)
}

impl NodeKind for TransferTable {
    fn name(&self) -> &'static str {
        "transfer_table"
    }

    fn doc(&self) -> &'static str {
        "Samples transfer functions into a table of colour and extinction."
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
            // Rows of a 2D texture: wgpu 30 makes 1D textures 2D on GL, where shaders still ask for 1D ones.
            dimensions: 2,
            size: Size::Absolute([node.uint("table_size"), row_count(&transfers(node)?), 1]),
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
                    .post_table(size)
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

/// How many rows that are.
pub(crate) fn row_count(transfers: &[Arc<TransferFunction>]) -> u32 {
    u32::try_from(transfers.len()).unwrap_or(u32::MAX)
}
