//! `reference`: what the picture of a raycast should be, computed in float64 on the processor.

mod behind;
mod covered;
mod labels;
mod looks;
mod scene;
mod space;
mod values;

pub(crate) use behind::behind;
pub(crate) use covered::choice_of;
pub(crate) use looks::own_look;
pub use scene::{raycast_scene, rays};

use volgraph_graph::{
    InputPort, NodeContext, NodeKind, OutputPort, Pass, PortType, Requirement, ResourceDesc, Size,
    UploadBytes,
};
use volgraph_reference::{DEFAULT_TOLERANCE, Silent, render};
use volgraph_report::Finding;
use volgraph_shader::ParamSpec;
use wgpu_types::TextureFormat;

/// The node kind `reference`.
pub struct Reference;

const INPUTS: &[InputPort] = &[InputPort {
    name: "of",
    ty: PortType::Color,
    requirement: Requirement::Required,
    doc: "The picture of a raycast, whose scene is computed.",
}];

const OUTPUTS: &[OutputPort] = &[OutputPort {
    name: "color",
    ty: PortType::Color,
    doc: "What that picture should be: linear premultiplied colour.",
}];

/// The parameter with the absolute tolerance of colours.
#[must_use]
pub fn tolerance_param() -> ParamSpec {
    ParamSpec::float(
        "tolerance",
        DEFAULT_TOLERANCE,
        "Absolute tolerance of linear premultiplied colours.",
    )
    .range(1e-10, 1.0)
}

impl NodeKind for Reference {
    fn name(&self) -> &'static str {
        "reference"
    }

    fn doc(&self) -> &'static str {
        "Computes in float64 what the picture of a raycast should be, on the processor: seconds, not milliseconds."
    }

    fn inputs(&self) -> &[InputPort] {
        INPUTS
    }

    fn outputs(&self) -> &[OutputPort] {
        OUTPUTS
    }

    fn params(&self) -> Vec<ParamSpec> {
        vec![tolerance_param()]
    }

    // Its rays are those of a whole picture.
    fn draws_windows(&self, _node: &NodeContext<'_>) -> bool {
        false
    }

    fn passes_follow_camera(&self) -> bool {
        true
    }

    fn output(&self, _port: &str, _node: &NodeContext<'_>) -> Result<ResourceDesc, Finding> {
        Ok(ResourceDesc::Texture {
            dimensions: 2,
            size: Size::ViewRelative(1.0),
            format: TextureFormat::Rgba32Float,
        })
    }

    fn record(&self, node: &NodeContext<'_>) -> Result<Vec<Pass>, Finding> {
        let (Some(view), Some(raycast)) = (node.view(), node.writer("of")) else {
            return Ok(Vec::new());
        };
        let scene = raycast_scene(&raycast, view)?;
        let tolerance = node.float("tolerance");
        let bytes = UploadBytes::new(move || {
            let rendered = render(&scene, tolerance, &Silent)
                .map_err(|error| Finding::error("reference", error.to_string()))?;
            #[expect(clippy::cast_possible_truncation, reason = "textures hold f32")]
            let color: Vec<[f32; 4]> = rendered
                .color
                .iter()
                .map(|pixel| pixel.map(|value| value as f32))
                .collect();
            Ok(bytemuck::cast_slice(&color).to_vec())
        });
        Ok(vec![Pass::Upload {
            port: "color",
            bytes,
        }])
    }
}
