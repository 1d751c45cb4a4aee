//! `scout`: which parts of rays may see anything, for all rays of a tile of pixels together.
//!
//! One ray through a tile's middle looks at the bricks of the distance map ahead. The walk then goes from span to span, and
//! no ray looks for itself. It follows the camera. Where rays
//! run in compute shaders they go over the blocks of pixels that have a span, and over no others.

use std::collections::BTreeSet;

use volgraph_graph::{
    Demand, InputPort, NodeContext, NodeKind, OutputPort, Pass, PortType, ProgramSpec, Requirement,
    ResourceDesc, Size, SlotSpec, Uniform,
};
use volgraph_report::Finding;
use volgraph_shader::ParamSpec;
use wgpu_types::TextureFormat;

use crate::brick_ranges::{self, size_param};
use crate::distance_map::EMPTINESS;
use crate::placement;
use crate::volume_texture::storage_param;

/// The node kind `scout`.
pub struct Scout;

/// The spans of a node's rays.
pub(crate) const SPANS: Demand = Demand {
    kind: "scout",
    inputs: &[("volume", "volume"), ("transfer", "transfer")],
    params: &[
        ("volume_storage", "volume_storage"),
        ("brick_size", "brick_size"),
        ("step", "step"),
    ],
    slots: &[("reconstruct", "reconstruct"), ("emptiness", "emptiness")],
};

const INPUTS: &[InputPort] = &[
    InputPort {
        name: "volume",
        ty: PortType::Volume,
        requirement: Requirement::Required,
        doc: "The volume.",
    },
    InputPort {
        name: "transfer",
        ty: PortType::Transfer,
        requirement: Requirement::Required,
        doc: "The transfer function: what absorbs may be seen.",
    },
    InputPort {
        name: "distance_map",
        ty: PortType::DistanceMap,
        requirement: Requirement::DemandedAlike("distance_map"),
        doc: "How far each brick is from the next one of which anything may be seen.",
    },
];

const OUTPUTS: &[OutputPort] = &[
    OutputPort {
        name: "spans",
        ty: PortType::Spans,
        doc: "World distances along the rays of each tile where what may be seen starts and ends, two spans a texel.",
    },
    OutputPort {
        name: "active_blocks",
        ty: PortType::Buffer,
        doc: "The squares of four pixels a side that have a span, behind how many workgroups go over them.",
    },
];

/// Texels for a pixel of the picture (`spans_tiles` in `lib/spans.wgsl`).
const TEXELS_PER_PIXEL: f32 = 0.5;

/// Pixels along the side of a tile, about, and of a block; and a workgroup's tiles along a side.
const TILE: u32 = 4;
const TILES: u32 = 8;

impl NodeKind for Scout {
    fn name(&self) -> &'static str {
        "scout"
    }

    fn doc(&self) -> &'static str {
        "Finds the parts of rays that may see anything, for all rays of a tile of pixels together."
    }

    fn inputs(&self) -> &[InputPort] {
        INPUTS
    }

    fn outputs(&self) -> &[OutputPort] {
        OUTPUTS
    }

    fn params(&self) -> Vec<ParamSpec> {
        vec![storage_param(), size_param()]
    }

    fn slots(&self) -> &[SlotSpec] {
        const SLOTS: &[SlotSpec] = &[
            EMPTINESS,
            SlotSpec {
                name: "reconstruct",
                default: "trilinear",
                doc: "What is the scalar at a point?",
            },
        ];
        SLOTS
    }

    fn uniforms(&self) -> &[&'static str] {
        &["volume", "bricks"]
    }

    fn program(&self, node: &NodeContext<'_>) -> Option<ProgramSpec> {
        let mut fixed_slots: std::collections::BTreeMap<_, _> = placement::texel_slots(node).into();
        fixed_slots.insert("look".to_owned(), "distance_map".to_owned());
        let mut entries = vec!["scout_compute"];
        if node.is_wanted("active_blocks") {
            entries.extend(["scout_reset", "scout_list", "scout_settle"]);
        }
        Some(ProgramSpec {
            root: "node/scout.wgsl",
            fixed_slots,
            entries,
            inherited: Vec::new(),
        })
    }

    fn written(&self, wanted: &BTreeSet<&str>) -> Vec<&'static str> {
        let ports = OUTPUTS.iter().map(|port| port.name);
        // The list is made of spans.
        ports
            .filter(|name| wanted.contains(name) || (*name == "spans" && !wanted.is_empty()))
            .collect()
    }

    fn output(&self, port: &str, _node: &NodeContext<'_>) -> Result<ResourceDesc, Finding> {
        Ok(match port {
            // `ActiveBlocks` in the shader: 16 bytes, then four for each sixteen pixels, of blocks that are cut off as well.
            "active_blocks" => ResourceDesc::ViewBuffer {
                head: 32,
                per_pixel: 1,
            },
            _ => ResourceDesc::Texture {
                dimensions: 2,
                size: Size::ViewRelative(TEXELS_PER_PIXEL),
                format: TextureFormat::Rgba32Float,
            },
        })
    }

    fn uniform(&self, name: &str, node: &NodeContext<'_>) -> Result<Uniform, Finding> {
        match name {
            "volume" => placement::uniform(node),
            _ => brick_ranges::uniform(node),
        }
    }

    fn record(&self, node: &NodeContext<'_>) -> Result<Vec<Pass>, Finding> {
        let size = node.view().map_or([0; 2], |view| view.size);
        // One tile more where tiles are a little smaller.
        let [x, y] = size.map(|pixels| (pixels / TILE + 1).div_ceil(TILES));
        let compute = |entry, workgroups| Pass::Compute {
            entry,
            workgroups,
            constants: Vec::new(),
        };
        let mut passes = vec![compute("scout_compute", [x, y, 1])];
        if node.is_wanted("active_blocks") {
            passes.push(compute("scout_reset", [1; 3]));
            passes.push(compute("scout_list", [x, y, 1]));
            passes.push(compute("scout_settle", [1; 3]));
        }
        Ok(passes)
    }
}
