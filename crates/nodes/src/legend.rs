//! `legend`: the bar of a transfer function's colours with the numbers beside it, drawn on the CPU.
//!
//! The legend is drawn twice, for letters are made of whole pixels: small, for pictures of 256 pixels, and with twice as
//! large letters beside it (see `slot/legend/scale.wgsl`). `marks` says which numbers stand where, `drawing` draws.

mod drawing;
mod marks;

use volgraph_graph::{
    InputPort, NodeContext, NodeKind, OutputPort, Pass, PortType, Requirement, ResourceDesc, Size,
    UploadBytes,
};
use volgraph_report::Finding;
use volgraph_shader::ParamSpec;
use wgpu_types::TextureFormat;

use self::drawing::Drawing;
use self::marks::marks;
use crate::false_color::check_scale;
use crate::image_texture::half;
use crate::transfer_table;

/// The node kind `legend`.
pub struct Legend;

const INPUTS: &[InputPort] = &[InputPort {
    name: "transfer",
    ty: PortType::Transfer,
    requirement: Requirement::Required,
    doc: "The transfer function with the colours.",
}];

const OUTPUTS: &[OutputPort] = &[OutputPort {
    name: "texture",
    ty: PortType::ImageTexture,
    doc: "The legend twice, linear premultiplied: small, and to the right of it with twice as large letters.",
}];

impl NodeKind for Legend {
    fn name(&self) -> &'static str {
        "legend"
    }

    fn doc(&self) -> &'static str {
        "Draws the bar of a transfer function's colours with the numbers that they stand for."
    }

    fn inputs(&self) -> &[InputPort] {
        INPUTS
    }

    fn outputs(&self) -> &[OutputPort] {
        OUTPUTS
    }

    fn params(&self) -> Vec<ParamSpec> {
        vec![
            ParamSpec::float("low", 0.0, "The number at the bar's lower end."),
            ParamSpec::float("high", 1.0, "The number at its upper end."),
            ParamSpec::choice(
                "scale",
                &["linear", "logarithmic"],
                "linear",
                "How numbers are placed between them: evenly, or each ratio alike.",
            ),
        ]
    }

    fn output(&self, _port: &str, node: &NodeContext<'_>) -> Result<ResourceDesc, Finding> {
        let [width, height] = Drawing::texels(&node_marks(node)?);
        Ok(ResourceDesc::Texture {
            dimensions: 2,
            size: Size::Absolute([width, height, 1]),
            format: TextureFormat::Rgba16Float,
        })
    }

    fn record(&self, node: &NodeContext<'_>) -> Result<Vec<Pass>, Finding> {
        let marks = node_marks(node)?;
        let transfer = transfer_table::transfer(node, "transfer")?;
        let bytes = UploadBytes::new(move || {
            let (from, to) = transfer.range();
            let color = |share: f64| transfer.color(from + share * (to - from));
            let texels = Drawing::of(&marks, color).into_texels();
            Ok(texels
                .iter()
                .flatten()
                .flat_map(|value| half(*value).to_le_bytes())
                .collect())
        });
        Ok(vec![Pass::Upload {
            port: "texture",
            bytes,
        }])
    }
}

fn node_marks(node: &NodeContext<'_>) -> Result<Vec<marks::Mark>, Finding> {
    check_scale(node)?;
    let is_logarithmic = node.text("scale") == "logarithmic";
    Ok(marks(node.float("low"), node.float("high"), is_logarithmic))
}
