//! `false_color`: a layer of numbers, such as the samples of each ray, in the colours of a transfer function, with a legend.

use volgraph_graph::{
    Demand, InputPort, NodeContext, NodeKind, OutputPort, Pass, PortType, ProgramSpec, Requirement,
    ResourceDesc, Size, SlotSpec,
};
use volgraph_report::Finding;
use volgraph_shader::ParamSpec;
use wgpu_types::TextureFormat;

use crate::transfer_table;

/// The node kind `false_color`.
pub struct FalseColor;

const INPUTS: &[InputPort] = &[
    InputPort {
        name: "layer",
        ty: PortType::Scalar2d,
        requirement: Requirement::Required,
        doc: "The numbers, one for each pixel.",
    },
    InputPort {
        name: "transfer",
        ty: PortType::Transfer,
        requirement: Requirement::Required,
        doc: "The transfer function whose colours are shown, from its first to its last; its opacities do not count.",
    },
    InputPort {
        name: "transfer_table",
        ty: PortType::Table1d,
        requirement: Requirement::Demanded(Demand {
            kind: "transfer_table",
            inputs: &[("transfer", "transfer")],
            params: &[("table_size", "table_size")],
            slots: &[],
        }),
        doc: "The transfer function as a table.",
    },
    InputPort {
        name: "legend",
        ty: PortType::ImageTexture,
        requirement: Requirement::Demanded(Demand {
            kind: "legend",
            inputs: &[("transfer", "transfer")],
            params: &[("low", "low"), ("high", "high"), ("scale", "scale")],
            slots: &[],
        }),
        doc: "The legend, drawn.",
    },
];

const OUTPUTS: &[OutputPort] = &[OutputPort {
    name: "color",
    ty: PortType::Color,
    doc: "Opaque linear colour.",
}];

impl NodeKind for FalseColor {
    fn name(&self) -> &'static str {
        "false_color"
    }

    fn doc(&self) -> &'static str {
        "Shows a layer of numbers, such as the samples of each ray, in the colours of a transfer function."
    }

    fn inputs(&self) -> &[InputPort] {
        INPUTS
    }

    fn outputs(&self) -> &[OutputPort] {
        OUTPUTS
    }

    fn params(&self) -> Vec<ParamSpec> {
        vec![transfer_table::size_param()]
    }

    fn slots(&self) -> &[SlotSpec] {
        &[SlotSpec {
            name: "legend",
            default: "none",
            doc: "Which legend is drawn into the picture?",
        }]
    }

    fn program(&self, _node: &NodeContext<'_>) -> Option<ProgramSpec> {
        Some(ProgramSpec {
            root: "node/false_color.wgsl",
            fixed_slots: Default::default(),
            inherited: Vec::new(),
            entries: vec!["false_color_compute"],
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
        check_scale(node)?;
        let [width, height] = node.view().map_or([0; 2], |view| view.size);
        Ok(vec![Pass::Compute {
            entry: "false_color_compute",
            workgroups: [width.div_ceil(8), height.div_ceil(8), 1],
            constants: Vec::new(),
        }])
    }
}

/// Whether a node's `scale` has places for all numbers between its `low` and its `high`.
///
/// # Errors
/// `bad-param` where a logarithmic scale starts or ends at 0 or below.
pub(crate) fn check_scale(node: &NodeContext<'_>) -> Result<(), Finding> {
    let is_fit = |name| node.text("scale") != "logarithmic" || node.float(name) > 0.0;
    match ["low", "high"].into_iter().find(|name| !is_fit(name)) {
        None => Ok(()),
        Some(name) => Err(node
            .error(
                "bad-param",
                format!("its `scale` is logarithmic, but its `{name}` is not above 0"),
            )
            .help("choose a number above 0, such as 1e-6, or set `scale` to `linear`")),
    }
}
