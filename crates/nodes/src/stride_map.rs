//! `stride_map`: how many steps a segment may take in each brick, so that all of them stay within an error that is stated;
//! and how far around that holds (Röttger et al. 2003: adaptive pre-integration from an importance volume).
//!
//! Along a ray, colour and extinction are functions of a scalar that changes by at most `D1` per length and bends by at
//! most `D2`. A segment of length `h` around a sample at its middle is wrong by at most `h³/8` times how much its
//! function bends: `K1·D2`, where the transfer function changes by at most `K1` per scalar, and `V·D1` per voxel, where
//! its slope changes by `V` in all between the least and the largest scalar of the brick. So a segment may be as long as
//! the third root of `8·tolerance / (K1·D2 + V·D1/voxel)`: errors that are alike in all segments need the fewest of them.
//! What is integrated over a scalar that runs linearly (`preintegrated_3d`) is wrong by the first of these alone.
//!
//! It bounds what each segment adds, and so is far above what a picture is wrong by: errors of segments cancel, derivatives
//! are not everywhere as large as at most, and what lies behind other matter counts little. How light changes within a
//! segment nothing bounds: of what is lit, segments stay as long as a step, and only what is not seen is leapt over.

use std::sync::Arc;

use volgraph_graph::{
    Demand, InputPort, NodeContext, NodeKind, OutputPort, Pass, PortType, ProgramSpec, Requirement,
    ResourceDesc, Size, SlotSpec, Uniform,
};
use volgraph_optics::TransferFunction;
use volgraph_report::Finding;
use volgraph_shader::{ParamSpec, UniformValue};
use wgpu_types::TextureFormat;

use crate::brick_details::DETAILS;
use crate::brick_ranges::{self, map_size, size_param};
use crate::distance_map::{self, RANGES};
use crate::placement;
use crate::preintegration;
use crate::raycast::data_value;
use crate::transfer_table::transfer;
use crate::volume_texture::storage_param;

/// The node kind `stride_map`.
pub struct StrideMap;

/// The strides of a node's walk.
pub(crate) const STRIDES: Demand = Demand {
    kind: "stride_map",
    inputs: &[("volume", "volume"), ("transfer", "transfer")],
    params: &[
        ("volume_storage", "volume_storage"),
        ("brick_size", "brick_size"),
        ("step", "step"),
        ("step_tolerance", "step_tolerance"),
    ],
    slots: &[
        ("reconstruct", "reconstruct"),
        ("classify", "classify"),
        ("light", "light"),
    ],
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
        doc: "The transfer function.",
    },
    InputPort {
        name: "brick_ranges",
        ty: PortType::BrickRanges,
        requirement: Requirement::Demanded(RANGES),
        doc: "The least and the largest scalar of each brick.",
    },
    InputPort {
        name: "brick_details",
        ty: PortType::BrickDetails,
        requirement: Requirement::Demanded(DETAILS),
        doc: "The largest derivatives of each brick.",
    },
];

const OUTPUTS: &[OutputPort] = &[OutputPort {
    name: "stride_map",
    ty: PortType::StrideMap,
    doc: "In each number, as a power of two how many steps a segment may take in a brick (7: nothing is seen), and how far around that holds.",
}];

const SLOTS: &[SlotSpec] = &[
    SlotSpec {
        name: "reconstruct",
        default: "trilinear",
        doc: "What is the scalar at a point?",
    },
    SlotSpec {
        name: "classify",
        default: "preintegrated_2d",
        doc: "What are colour and opacity of a segment?",
    },
    SlotSpec {
        name: "light",
        default: "unlit",
        doc: "How is a point lit?",
    },
];

/// Entries of the transfer function's changes (`Importance` in `lib/importance.wgsl`).
const ENTRIES: usize = 512;
/// Places at which the transfer function is looked at for each entry.
const PLACES: usize = 16;
/// The radii around a brick that are tried: 2^1 - 1 to 2^LEVELS - 1 bricks.
const LEVELS: usize = 4;

/// The parameter with the error that longer segments may make, for kinds that call for this one.
#[must_use]
pub fn tolerance_param() -> ParamSpec {
    ParamSpec::float(
        "step_tolerance",
        0.1,
        "Largest error of a colour that a segment longer than a step may make, where `traverse` is `adaptive`: a bound, far above what a picture is wrong by.",
    )
    .range(1e-9, 1e4)
}

/// How a transfer function changes between the entries of its table, from the first scalar to the last: of each entry, the
/// steepest slope in it, and how much slopes have changed up to its start and its end, per world length and scalar.
fn changes(transfer: &TransferFunction, per_world: f64, scalar_of: impl Fn(f64) -> f64) -> Changes {
    let (from, to) = transfer.range();
    let places = ENTRIES * PLACES;
    let place = |at: usize| from + (to - from) * at as f64 / places as f64;
    let low = scalar_of(from);
    let high = scalar_of(to);
    let apart = ((high - low) / places as f64).max(f64::MIN_POSITIVE);
    let value = |at: usize| {
        let s = place(at);
        let extinction = transfer.extinction(s) * per_world;
        let [r, g, b] = transfer.color(s).map(|c| c * extinction);
        [extinction, r, g, b]
    };
    // The size of the extinction's change, and of the largest one of the colours'.
    let size = |a: [f64; 4], b: [f64; 4]| {
        let parts: [f64; 4] = std::array::from_fn(|i| (b[i] - a[i]).abs());
        parts[0] + parts[1..].iter().copied().fold(0.0, f64::max)
    };
    let values: Vec<[f64; 4]> = (0..=places).map(value).collect();
    let slope = |at: usize| -> [f64; 4] {
        std::array::from_fn(|i| (values[at + 1][i] - values[at][i]) / apart)
    };
    let mut entries = Vec::with_capacity(ENTRIES);
    let mut total = 0.0;
    // Beyond the table its ends hold: they bend where it begins.
    let mut before = [0.0; 4];
    for entry in 0..ENTRIES {
        let start = total;
        let mut steepest = 0.0_f64;
        for at in entry * PLACES..(entry + 1) * PLACES {
            let slope = slope(at);
            total += size(before, slope);
            steepest = steepest.max(size([0.0; 4], slope));
            before = slope;
        }
        if entry + 1 == ENTRIES {
            total += size(before, [0.0; 4]);
        }
        entries.push([steepest, start, total]);
    }
    Changes {
        low,
        per_scalar: ENTRIES as f64 / (high - low).max(f64::MIN_POSITIVE),
        entries,
    }
}

struct Changes {
    low: f64,
    per_scalar: f64,
    entries: Vec<[f64; 3]>,
}

impl NodeKind for StrideMap {
    fn name(&self) -> &'static str {
        "stride_map"
    }

    fn doc(&self) -> &'static str {
        "Finds how long the segments of a walk may be in each brick."
    }

    fn inputs(&self) -> &[InputPort] {
        INPUTS
    }

    fn outputs(&self) -> &[OutputPort] {
        OUTPUTS
    }

    fn params(&self) -> Vec<ParamSpec> {
        vec![
            storage_param(),
            size_param(),
            preintegration::step_param(),
            tolerance_param(),
        ]
    }

    fn slots(&self) -> &[SlotSpec] {
        SLOTS
    }

    fn uniforms(&self) -> &[&'static str] {
        &["volume", "bricks", "absorbing", "importance"]
    }

    fn program(&self, node: &NodeContext<'_>) -> Option<ProgramSpec> {
        Some(ProgramSpec {
            root: "node/stride_map.wgsl",
            fixed_slots: placement::texel_slots(node).into(),
            entries: vec![
                "stride_map_begin",
                "stride_map_x",
                "stride_map_y",
                "stride_map_z",
            ],
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
            "absorbing" => distance_map::absorbing_uniform(node),
            _ => importance(node),
        }
    }

    fn record(&self, node: &NodeContext<'_>) -> Result<Vec<Pass>, Finding> {
        let (dims, _) = map_size(node)?;
        let pass = |entry| Pass::Compute {
            entry,
            workgroups: dims.map(|n| n.div_ceil(4)),
            constants: Vec::new(),
        };
        let axes = ["stride_map_x", "stride_map_y", "stride_map_z"];
        let spread = (0..LEVELS).flat_map(|_| axes);
        Ok(std::iter::once("stride_map_begin")
            .chain(spread)
            .map(pass)
            .collect())
    }
}

/// The members of the uniform `importance` (see `lib/importance.wgsl`).
fn importance(node: &NodeContext<'_>) -> Result<Uniform, Finding> {
    let volume = placement::volume(node, "volume")?;
    let grid = volume.grid();
    let reference = placement::encoding(node)?.reference;
    let transfer: Arc<TransferFunction> = transfer(node, "transfer")?;
    let voxel = grid.min_spacing();
    let per_world = transfer.reference_length().extinction_per_world(voxel);
    let scalar = |at: f64| data_value(volume, transfer.domain(), at) - reference;
    let changes = changes(&transfer, per_world, scalar);
    let bends = if node.slot("classify") == "preintegrated_3d" {
        0.0
    } else {
        1.0 / voxel
    };
    #[expect(clippy::cast_possible_truncation, reason = "shaders compute in f32")]
    let number = |value: f64| value.min(f64::from(f32::MAX)) as f32;
    let entry = |[steepest, start, end]: &[f64; 3]| {
        UniformValue::Vec4([number(*steepest), number(*start), number(*end), 0.0])
    };
    let cubes = if node.slot("light") == "unlit" {
        8.0 * node.float("step_tolerance")
    } else {
        0.0
    };
    let step = node.float("step") * voxel;
    Ok(vec![
        ("low", UniformValue::F32(number(changes.low))),
        ("per_scalar", UniformValue::F32(number(changes.per_scalar))),
        // In steps.
        ("cubes", UniformValue::F32(number(cubes / step.powi(3)))),
        ("bends", UniformValue::F32(number(bends))),
        (
            "entries",
            UniformValue::Array(changes.entries.iter().map(entry).collect()),
        ),
    ])
}
