//! `difference`: how one picture differs from another, such as a raycast's from its reference.

use volgraph_graph::{
    InputPort, NodeContext, NodeKind, OutputPort, Pass, PortType, ProgramSpec, Requirement,
    ResourceDesc, Size,
};
use volgraph_report::Finding;
use wgpu_types::TextureFormat;

/// The node kind `difference`.
pub struct Difference;

const INPUTS: &[InputPort] = &[
    InputPort {
        name: "a",
        ty: PortType::Color,
        requirement: Requirement::Required,
        doc: "A picture.",
    },
    InputPort {
        name: "b",
        ty: PortType::Color,
        requirement: Requirement::Required,
        doc: "The picture that it is held against.",
    },
];

const OUTPUTS: &[OutputPort] = &[
    OutputPort {
        name: "color",
        ty: PortType::Color,
        doc: "The difference of the linear colours, opaque.",
    },
    OutputPort {
        name: "error",
        ty: PortType::Scalar2d,
        doc: "The largest absolute difference of the four linear premultiplied components.",
    },
];

/// The entry point that writes an output.
fn entry(port: &str) -> &'static str {
    if port == "error" {
        "difference_error"
    } else {
        "difference_color"
    }
}

fn wanted(node: &NodeContext<'_>) -> Vec<&'static str> {
    let ports = OUTPUTS.iter().map(|port| port.name);
    ports.filter(|port| node.is_wanted(port)).collect()
}

impl NodeKind for Difference {
    fn name(&self) -> &'static str {
        "difference"
    }

    fn doc(&self) -> &'static str {
        "Shows how one picture differs from another, such as a raycast's from its reference."
    }

    fn inputs(&self) -> &[InputPort] {
        INPUTS
    }

    fn outputs(&self) -> &[OutputPort] {
        OUTPUTS
    }

    fn program(&self, node: &NodeContext<'_>) -> Option<ProgramSpec> {
        Some(ProgramSpec {
            root: "node/difference.wgsl",
            fixed_slots: Default::default(),
            inherited: Vec::new(),
            entries: wanted(node).into_iter().map(entry).collect(),
        })
    }

    fn output(&self, port: &str, node: &NodeContext<'_>) -> Result<ResourceDesc, Finding> {
        let _ = node;
        Ok(ResourceDesc::Texture {
            dimensions: 2,
            size: Size::ViewRelative(1.0),
            format: match port {
                "error" => TextureFormat::R32Float,
                _ => TextureFormat::Rgba32Float,
            },
        })
    }

    fn record(&self, node: &NodeContext<'_>) -> Result<Vec<Pass>, Finding> {
        let [width, height] = node.view().map_or([0; 2], |view| view.size);
        if node.input_resource("a") != node.input_resource("b") {
            return Err(node
                .error(
                    "size-mismatch",
                    "its two pictures have different sizes or formats",
                )
                .help("connect pictures of the same size"));
        }
        let passes = wanted(node).into_iter().map(|port| Pass::Compute {
            entry: entry(port),
            workgroups: [width.div_ceil(8), height.div_ceil(8), 1],
            constants: Vec::new(),
        });
        Ok(passes.collect())
    }
}
