//! `distance_map`: of each brick whether anything of it may be seen, and how far the next one is of the other kind.
//!
//! A compute shader makes it of the bricks' ranges and of what the slot `emptiness` says, in one pass for each axis, twice:
//! bricks between seen ones, over which a leap would gain nothing, count as seen. Of
//! transfer functions it depends only on which scalars absorb: as long as those stay the same, it is not made again.

use volgraph_graph::{
    Demand, InputPort, NodeContext, NodeKind, OutputPort, Pass, PortType, ProgramSpec, Requirement,
    ResourceDesc, Size, SlotSpec, Uniform,
};
use volgraph_optics::union;
use volgraph_report::Finding;
use volgraph_shader::{ParamSpec, UniformValue};
use wgpu_types::TextureFormat;

use crate::brick_ranges::{self, map_size, size_param};
use crate::placement;
use crate::raycast::data_value;
use crate::transfer_table::transfers;
use crate::volume_texture::storage_param;

/// The node kind `distance_map`.
pub struct DistanceMap;

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
        requirement: Requirement::Optional,
        doc: "The transfer function.",
    },
    InputPort {
        name: "segments",
        ty: PortType::Segments,
        requirement: Requirement::Optional,
        doc: "What labels mean, with their transfer functions.",
    },
    InputPort {
        name: "brick_ranges",
        ty: PortType::BrickRanges,
        requirement: Requirement::Demanded(RANGES),
        doc: "The least and the largest scalar of each brick.",
    },
];

/// The ranges of the bricks of a node's volume.
pub(crate) const RANGES: Demand = Demand {
    kind: "brick_ranges",
    inputs: &[("volume", "volume")],
    params: &[
        ("volume_storage", "volume_storage"),
        ("brick_size", "brick_size"),
    ],
    slots: &[("reconstruct", "reconstruct")],
};

const OUTPUTS: &[OutputPort] = &[OutputPort {
    name: "distance_map",
    ty: PortType::DistanceMap,
    doc: "In the upper half of each number, whether a brick may be seen, and how far the next one of the other kind is, in bricks along the axis where that is most.",
}];

/// The slot that says what is empty, for kinds that call for this one.
pub(crate) const EMPTINESS: SlotSpec = SlotSpec {
    name: "emptiness",
    default: "none",
    doc: "Of which scalars is nothing seen?",
};

const SLOTS: &[SlotSpec] = &[
    EMPTINESS,
    SlotSpec {
        name: "reconstruct",
        default: "trilinear",
        doc: "What is the scalar at a point?",
    },
];

/// Intervals that the shader holds (`Absorbing` in `lib/absorbing.wgsl`); of more, those nearest to each other are one.
const SPANS: usize = 64;

/// The scalars that any of a node's transfer functions makes absorb, as shaders count them: open intervals.
pub(crate) fn absorbing(node: &NodeContext<'_>) -> Result<Vec<(f64, f64)>, Finding> {
    let volume = placement::placed(node, "volume")?;
    let reference = placement::encoding(node)?.reference;
    let mut all = Vec::new();
    for transfer in transfers(node)? {
        let scalar = |at: f64| {
            if at.is_finite() {
                data_value(volume, transfer.domain(), at) - reference
            } else {
                at
            }
        };
        let spans = transfer.absorbing().into_iter();
        all.extend(spans.map(|(from, to)| (scalar(from), scalar(to))));
    }
    let mut spans = union(all);
    join_nearest(&mut spans, SPANS);
    Ok(spans)
}

/// Whether all scalars of a node's volume absorb: then there is nothing to leap over.
pub(crate) fn absorbs_everywhere(node: &NodeContext<'_>) -> bool {
    let everywhere = || {
        let (low, high) = placement::data_range(placement::placed(node, "volume")?);
        let reference = placement::encoding(node)?.reference;
        let covers = |&(from, to): &(f64, f64)| from < low - reference && high - reference < to;
        Ok::<_, Finding>(absorbing(node)?.iter().any(covers))
    };
    everywhere().unwrap_or(false)
}

/// Of more than so many rising intervals, those nearest to each other become one.
pub(crate) fn join_nearest(spans: &mut Vec<(f64, f64)>, most: usize) {
    while spans.len() > most.max(1) {
        let gap = |at: &usize| spans[at + 1].0 - spans[*at].1;
        let least = (0..spans.len() - 1).min_by(|a, b| gap(a).total_cmp(&gap(b)));
        let at = least.unwrap_or(0);
        spans[at].1 = spans.remove(at + 1).1;
    }
}

/// The members of the uniform `absorbing` (see `lib/absorbing.wgsl`).
///
/// # Errors
/// `missing-input`.
pub(crate) fn absorbing_uniform(node: &NodeContext<'_>) -> Result<Uniform, Finding> {
    let spans = absorbing(node)?;
    let count = u32::try_from(spans.len()).unwrap_or(u32::MAX);
    let finite = |at: f64| at.clamp(f64::from(f32::MIN), f64::from(f32::MAX));
    let span = |at: usize| {
        let (from, to) = spans.get(at).copied().unwrap_or_default();
        // Rounded outwards.
        #[expect(clippy::cast_possible_truncation, reason = "shaders compute in f32")]
        let ends = [finite(from) as f32, finite(to) as f32];
        let from_low = if f64::from(ends[0]) > from {
            ends[0].next_down()
        } else {
            ends[0]
        };
        let to_high = if f64::from(ends[1]) < to {
            ends[1].next_up()
        } else {
            ends[1]
        };
        UniformValue::Vec4([from_low, to_high, 0.0, 0.0])
    };
    Ok(vec![
        ("count", UniformValue::U32(count)),
        ("spans", UniformValue::Array((0..SPANS).map(span).collect())),
    ])
}

/// What is run in turn, over all bricks.
const PASSES: [&str; 10] = [
    "distance_map_begin",
    "distance_map_near_x",
    "distance_map_near_y",
    "distance_map_near_z",
    "distance_map_open_x",
    "distance_map_open_y",
    "distance_map_open_z",
    "distance_map_x",
    "distance_map_y",
    "distance_map_z",
];

impl NodeKind for DistanceMap {
    fn name(&self) -> &'static str {
        "distance_map"
    }

    fn doc(&self) -> &'static str {
        "Finds which bricks may be seen, and how far the next one of the other kind is."
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
        SLOTS
    }

    fn uniforms(&self) -> &[&'static str] {
        &["volume", "bricks", "absorbing"]
    }

    fn depends_on(&self, port: &str, node: &NodeContext<'_>) -> Option<Vec<u8>> {
        if !["transfer", "segments"].contains(&port) {
            return None;
        }
        let spans = absorbing(node).ok()?;
        let ends = spans.into_iter().flat_map(|(from, to)| [from, to]);
        Some(ends.flat_map(f64::to_le_bytes).collect())
    }

    fn program(&self, node: &NodeContext<'_>) -> Option<ProgramSpec> {
        Some(ProgramSpec {
            root: "node/distance_map.wgsl",
            fixed_slots: placement::texel_slots(node).into(),
            entries: PASSES.to_vec(),
            inherited: Vec::new(),
        })
    }

    fn output(&self, _port: &str, node: &NodeContext<'_>) -> Result<ResourceDesc, Finding> {
        let (_, size) = map_size(node)?;
        Ok(ResourceDesc::Texture {
            dimensions: 2,
            size: Size::Absolute(size),
            format: TextureFormat::R32Float,
        })
    }

    fn uniform(&self, name: &str, node: &NodeContext<'_>) -> Result<Uniform, Finding> {
        match name {
            "volume" => placement::uniform(node),
            "bricks" => brick_ranges::uniform(node),
            _ => absorbing_uniform(node),
        }
    }

    fn record(&self, node: &NodeContext<'_>) -> Result<Vec<Pass>, Finding> {
        let (dims, _) = map_size(node)?;
        let pass = |entry| Pass::Compute {
            entry,
            workgroups: [
                dims[0].div_ceil(8),
                dims[1].div_ceil(4),
                dims[2].div_ceil(4),
            ],
            constants: Vec::new(),
        };
        Ok(PASSES.into_iter().map(pass).collect())
    }
}
