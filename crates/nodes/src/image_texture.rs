//! `image_texture`: an image on the device.

use half::f16;
use volgraph_graph::{
    InputPort, NodeContext, NodeKind, OutputPort, Pass, PortType, Requirement, ResourceDesc, Size,
    UploadBytes,
};
use volgraph_report::Finding;
use wgpu_types::TextureFormat;

use crate::source::image::ImageSource;

/// The node kind `image_texture`.
pub struct ImageTexture;

const INPUTS: &[InputPort] = &[InputPort {
    name: "image",
    ty: PortType::Image,
    requirement: Requirement::Required,
    doc: "The image.",
}];

const OUTPUTS: &[OutputPort] = &[OutputPort {
    name: "texture",
    ty: PortType::ImageTexture,
    doc: "The image as a texture of linear premultiplied half floats.",
}];

impl NodeKind for ImageTexture {
    fn name(&self) -> &'static str {
        "image_texture"
    }

    fn doc(&self) -> &'static str {
        "Uploads an image as a texture."
    }

    fn inputs(&self) -> &[InputPort] {
        INPUTS
    }

    fn outputs(&self) -> &[OutputPort] {
        OUTPUTS
    }

    fn output(&self, _port: &str, node: &NodeContext<'_>) -> Result<ResourceDesc, Finding> {
        let picture = &image(node)?.picture;
        Ok(ResourceDesc::Texture {
            dimensions: 2,
            size: Size::Absolute([picture.width, picture.height, 1]),
            // Filtered everywhere, which single floats are not.
            format: TextureFormat::Rgba16Float,
        })
    }

    fn record(&self, node: &NodeContext<'_>) -> Result<Vec<Pass>, Finding> {
        let picture = image(node)?.picture.clone();
        let bytes = UploadBytes::new(move || {
            Ok(picture
                .color
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

/// A half float of a value. Light brighter than a half float goes is as bright as one goes, for an infinity would spread
/// over all that is filtered with it; what is not a number is nothing.
pub(crate) fn half(value: f32) -> f16 {
    if value.is_nan() {
        return f16::ZERO;
    }
    f16::from_f32(value.clamp(f16::MIN.to_f32(), f16::MAX.to_f32()))
}

fn image<'g>(node: &NodeContext<'g>) -> Result<&'g ImageSource, Finding> {
    node.source::<ImageSource>("image")
        .ok_or_else(|| node.error("missing-input", "its input `image` is not an image"))
}
