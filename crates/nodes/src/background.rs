//! `background`: a pattern over the whole picture.

use volgraph_graph::{
    Demand, InputPort, NodeContext, NodeKind, OutputPort, Pass, PortType, ProgramSpec, Requirement,
    ResourceDesc, Size,
};
use volgraph_report::Finding;
use volgraph_shader::ParamSpec;
use wgpu_types::TextureFormat;

/// The node kind `background`.
pub struct Background;

const INPUTS: &[InputPort] = &[
    InputPort {
        name: "image",
        ty: PortType::Image,
        requirement: Requirement::Optional,
        doc: "The image of the pattern `image`.",
    },
    InputPort {
        name: "image_texture",
        ty: PortType::ImageTexture,
        requirement: Requirement::Demanded(Demand {
            kind: "image_texture",
            inputs: &[("image", "image")],
            params: &[],
            slots: &[],
        }),
        doc: "The image on the device.",
    },
];

const OUTPUTS: &[OutputPort] = &[OutputPort {
    name: "color",
    ty: PortType::Color,
    doc: "The pattern, linear premultiplied colour.",
}];

impl NodeKind for Background {
    fn name(&self) -> &'static str {
        "background"
    }

    fn doc(&self) -> &'static str {
        "Draws a pattern over the whole picture, attached to the view."
    }

    fn inputs(&self) -> &[InputPort] {
        INPUTS
    }

    fn outputs(&self) -> &[OutputPort] {
        OUTPUTS
    }

    fn params(&self) -> Vec<ParamSpec> {
        vec![ParamSpec::choice(
            "pattern",
            &["uniform", "gradient", "checker", "image"],
            "uniform",
            "The pattern; each has parameters of its own.",
        )]
    }

    fn program(&self, node: &NodeContext<'_>) -> Option<ProgramSpec> {
        Some(ProgramSpec {
            root: "node/background.wgsl",
            fixed_slots: [("pattern".to_owned(), node.text("pattern").to_owned())].into(),
            entries: vec!["background_compute"],
            inherited: Vec::new(),
        })
    }

    fn output(&self, _port: &str, _node: &NodeContext<'_>) -> Result<ResourceDesc, Finding> {
        Ok(ResourceDesc::Texture {
            dimensions: 2,
            size: Size::ViewRelative(1.0),
            format: TextureFormat::Rgba32Float,
        })
    }

    fn record(&self, node: &NodeContext<'_>) -> Result<Vec<Pass>, Finding> {
        let [width, height] = node.view().map_or([0; 2], |view| view.size);
        Ok(vec![Pass::Compute {
            entry: "background_compute",
            workgroups: [width.div_ceil(8), height.div_ceil(8), 1],
            constants: Vec::new(),
        }])
    }
}
