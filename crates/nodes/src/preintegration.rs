//! `preintegration` and `preintegration_half`: the table of integrals over segments, for one segment length; of several transfer functions, side by
//! side in one texture.
//!
//! The processor makes it, or a compute shader of the same pieces (`node/preintegration.wgsl`).

use std::collections::BTreeMap;

use rayon::prelude::*;
use volgraph_graph::{
    Demand, InputPort, Limits, NodeContext, NodeKind, OutputPort, Pass, PortType, ProgramSpec,
    Requirement, ResourceDesc, Size, Uniform, UploadBytes,
};
use volgraph_optics::TransferFunction;
use volgraph_report::Finding;
use volgraph_shader::{ParamSpec, UniformValue};
use wgpu_types::TextureFormat;

use crate::placement::placed;
use crate::transfer_table::transfers;

/// The node kinds of one table each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Preintegration {
    /// `preintegration`: over segments.
    Whole,
    /// `preintegration_half`: over halves of segments.
    Half,
}

impl Preintegration {
    /// The length that it integrates over, in steps.
    #[must_use]
    pub fn steps(self) -> f64 {
        match self {
            Self::Whole => 1.0,
            Self::Half => 0.5,
        }
    }
}

/// Inputs of all kinds that integrate over segments.
pub(crate) const INPUTS: &[InputPort] = &[
    InputPort {
        name: "transfer",
        ty: PortType::Transfer,
        requirement: Requirement::Optional,
        doc: "The transfer function; the first table.",
    },
    InputPort {
        name: "segments",
        ty: PortType::Segments,
        requirement: Requirement::Optional,
        doc: "What labels mean; a table for each transfer function that they name.",
    },
    InputPort {
        name: "volume",
        ty: PortType::Volume,
        requirement: Requirement::Required,
        doc: "The volume, whose smallest spacing is the unit of the step.",
    },
];

/// Inputs of kinds that integrate one transfer function over segments.
pub(crate) const INPUTS_OF_ONE: &[InputPort] = &[INPUTS[0], INPUTS[2]];

/// The same for this kind.
const OWN_INPUTS: &[InputPort] = &[
    INPUTS[0],
    INPUTS[1],
    INPUTS[2],
    InputPort {
        name: "preintegration_pieces",
        ty: PortType::Pieces,
        requirement: Requirement::Demanded(Demand {
            kind: "preintegration_pieces",
            inputs: &[
                ("transfer", "transfer"),
                ("segments", "segments"),
                ("volume", "volume"),
            ],
            params: &[
                ("step", "step"),
                ("preintegration_size", "preintegration_size"),
            ],
            slots: &[],
        }),
        doc: "What the table is made of, where the graphics processor makes it.",
    },
];

/// Parameters that go on from kinds that call for this one.
pub(crate) const DEMANDED_PARAMS: &[(&str, &str)] = &[
    ("step", "step"),
    ("preintegration_size", "preintegration_size"),
    ("preintegration_built_on", "preintegration_built_on"),
    ("lookup", "lookup"),
];

const OUTPUTS: &[OutputPort] = &[OutputPort {
    name: "table",
    ty: PortType::Table2d,
    doc: "Premultiplied colour and optical depth of a segment from front scalar (x) to back scalar (y); its transmittance in place of the depth where `lookup` is `nearest`, which halves do not have.",
}];

/// The parameter with the entries along a side, for kinds that call for this one.
#[must_use]
pub fn size_param() -> ParamSpec {
    ParamSpec::int(
        "preintegration_size",
        1024,
        "Entries along each side of the pre-integrated table.",
    )
    .range(64.0, 4096.0)
}

/// The parameter that says where the table is made, for kinds that call for this one.
#[must_use]
pub fn built_on_param() -> ParamSpec {
    ParamSpec::choice(
        "preintegration_built_on",
        &["cpu", "gpu"],
        "cpu",
        "Who makes the pre-integrated table: the processor in float64, or the graphics processor in float32.",
    )
}

/// The parameter that says how the table is read.
fn lookup_param() -> ParamSpec {
    ParamSpec::choice(
        "lookup",
        &["bilinear", "nearest"],
        "bilinear",
        "How entries are looked up: between four of them optical depths are interpolated; of the nearest one the transmittance is known.",
    )
}

/// Whether entries have transmittances in place of depths.
fn has_transmittances(node: &NodeContext<'_>) -> bool {
    node.text("lookup") == "nearest"
}

/// The parameter with the length of the segments.
pub(crate) fn step_param() -> ParamSpec {
    ParamSpec::float("step", 1.0, "Length of the segments.")
        .range(0.01, 64.0)
        .unit("voxel")
}

/// The same of halves, which the processor alone makes.
pub(crate) const DEMANDED_PARAMS_OF_HALVES: &[(&str, &str)] = &[
    ("step", "step"),
    ("preintegration_size", "preintegration_size"),
];

/// The length of the segments in reference lengths.
pub(crate) fn segment_references(
    node: &NodeContext<'_>,
    transfer: &TransferFunction,
) -> Result<f64, Finding> {
    let voxel = placed(node, "volume")?.grid().min_spacing();
    let segment_world = node.float("step") * voxel;
    Ok(segment_world * transfer.reference_length().extinction_per_world(voxel))
}

/// The share of light that passes through an optical depth, as the nearest entry has it (`transfer_depth` in
/// `lib/transfer.wgsl` takes it back): of depths beyond 64, of which no light is left, still a number that tells them.
fn transmittance(depth: f32) -> f32 {
    let depth = f64::from(depth);
    let told = if depth > 64.0 {
        64.0 + (depth / 64.0).ln()
    } else {
        depth
    };
    (-told).exp() as f32
}

/// Entries that one invocation of the shader makes (`PREINTEGRATION_WINDOWS`), on both sides of the diagonal.
const WINDOWS: u32 = 32;

fn is_built_on_gpu(node: &NodeContext<'_>) -> bool {
    node.text("preintegration_built_on") == "gpu"
}

/// Most bytes of all tables of a node together.
pub(crate) const MAX_BYTES: u64 = 1 << 30;

/// Columns and rows of tables in the texture. One column is enough while the texture is not too high for it.
#[must_use]
pub fn tiles(limits: &Limits, size: u32, count: usize) -> [u32; 2] {
    let count = u32::try_from(count.max(1)).unwrap_or(u32::MAX);
    let most = u32::try_from(limits.max_texture_2d).unwrap_or(u32::MAX) / size.max(1);
    let columns = count.div_ceil(most.max(1));
    [columns, count.div_ceil(columns)]
}

/// Where the tables are more than fit, the remedy names the size that does.
fn check_sum(node: &NodeContext<'_>, size: u32, count: usize) -> Result<(), Finding> {
    let fits = |size: u32| {
        let bytes = u64::from(size).pow(2) * 16 * count as u64;
        let [columns, rows] = tiles(node.limits(), size, count);
        let is_in = |n: u32| u64::from(n) * u64::from(size) <= node.limits().max_texture_2d;
        bytes <= MAX_BYTES && is_in(columns) && is_in(rows)
    };
    // One table alone is judged as all textures are.
    if count <= 1 || fits(size) {
        return Ok(());
    }
    let help = match (6..12)
        .rev()
        .map(|power| 1 << power)
        .find(|size| fits(*size))
    {
        Some(size) => format!("set `preintegration_size` to {size} or less"),
        None => "name fewer transfer functions, or choose the slot `classify` \"post\"".to_owned(),
    };
    let message = format!("{count} pre-integrated tables of {size}x{size} entries are too large");
    Err(node.error("over-limit", message).help(help))
}

impl NodeKind for Preintegration {
    fn name(&self) -> &'static str {
        match self {
            Self::Whole => "preintegration",
            Self::Half => "preintegration_half",
        }
    }

    fn doc(&self) -> &'static str {
        match self {
            Self::Whole => {
                "Integrates transfer functions over all segments between two scalars (2D pre-integration)."
            }
            Self::Half => {
                "Integrates transfer functions over all halves of segments between two scalars."
            }
        }
    }

    fn inputs(&self) -> &[InputPort] {
        match self {
            Self::Whole => OWN_INPUTS,
            Self::Half => INPUTS,
        }
    }

    fn outputs(&self) -> &[OutputPort] {
        OUTPUTS
    }

    fn params(&self) -> Vec<ParamSpec> {
        match self {
            Self::Whole => vec![step_param(), size_param(), built_on_param(), lookup_param()],
            Self::Half => vec![step_param(), size_param()],
        }
    }

    fn uniforms(&self) -> &[&'static str] {
        &["preintegration"]
    }

    fn program(&self, node: &NodeContext<'_>) -> Option<ProgramSpec> {
        is_built_on_gpu(node).then(|| ProgramSpec {
            root: "node/preintegration.wgsl",
            fixed_slots: BTreeMap::new(),
            entries: vec!["preintegration_compute"],
            inherited: Vec::new(),
        })
    }

    fn output(&self, _port: &str, node: &NodeContext<'_>) -> Result<ResourceDesc, Finding> {
        let size = node.uint("preintegration_size");
        let count = transfers(node)?.len();
        check_sum(node, size, count)?;
        let [columns, rows] = tiles(node.limits(), size, count);
        Ok(ResourceDesc::Texture {
            dimensions: 2,
            size: Size::Absolute([size * columns, size * rows, 1]),
            format: TextureFormat::Rgba32Float,
        })
    }

    fn uniform(&self, _name: &str, node: &NodeContext<'_>) -> Result<Uniform, Finding> {
        let size = node.uint("preintegration_size");
        let count = transfers(node)?.len();
        let [columns, _] = tiles(node.limits(), size, count);
        let count = u32::try_from(count).unwrap_or(u32::MAX);
        Ok(vec![
            ("size", UniformValue::U32(size)),
            ("columns", UniformValue::U32(columns)),
            ("tables", UniformValue::U32(count)),
            (
                "has_transmittances",
                UniformValue::U32(u32::from(has_transmittances(node))),
            ),
        ])
    }

    fn record(&self, node: &NodeContext<'_>) -> Result<Vec<Pass>, Finding> {
        let transfers = transfers(node)?;
        if is_built_on_gpu(node) {
            let size = node.uint("preintegration_size");
            let tables = u32::try_from(transfers.len()).unwrap_or(u32::MAX);
            return Ok(vec![Pass::Compute {
                entry: "preintegration_compute",
                workgroups: [size.div_ceil(WINDOWS * 8), size, tables],
                constants: Vec::new(),
            }]);
        }
        let references: Vec<f64> = transfers
            .iter()
            .map(|transfer| Ok(self.steps() * segment_references(node, transfer)?))
            .collect::<Result<_, Finding>>()?;
        let size = node.uint("preintegration_size");
        let [columns, rows] = tiles(node.limits(), size, transfers.len()).map(|n| n as usize);
        let has_transmittances = has_transmittances(node);
        let bytes = UploadBytes::new(move || {
            let side = size as usize;
            let mut entries = vec![[0.0_f32; 4]; side * columns * side * rows];
            for (at, (transfer, references)) in transfers.iter().zip(&references).enumerate() {
                let table = transfer
                    .preintegrated_table(size, *references)
                    .map_err(|error| Finding::error("table", error.to_string()))?;
                let first = (at / columns * side * columns + at % columns) * side;
                for (row, line) in table.entries.chunks(side).enumerate() {
                    let start = first + row * side * columns;
                    entries[start..start + side].copy_from_slice(line);
                }
            }
            if has_transmittances {
                entries
                    .par_iter_mut()
                    .for_each(|entry| entry[3] = transmittance(entry[3]));
            }
            Ok(bytemuck::cast_slice(&entries).to_vec())
        });
        Ok(vec![Pass::Upload {
            port: "table",
            bytes,
        }])
    }
}
