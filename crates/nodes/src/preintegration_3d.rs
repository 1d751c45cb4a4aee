//! `preintegration_3d`: the table of integrals over segments of any length up to a longest.

use volgraph_graph::{
    InputPort, NodeContext, NodeKind, OutputPort, Pass, PortType, Requirement, ResourceDesc, Size,
    Uniform, UploadBytes,
};
use volgraph_report::Finding;
use volgraph_shader::ParamSpec;
use wgpu_types::TextureFormat;

use crate::placement::{f32_value, placed};
use crate::preintegration::{MAX_BYTES, step_param};
use crate::raycast::table_range;
use crate::transfer_table::transfer;

/// The node kind `preintegration_3d`.
pub struct Preintegration3d;

const INPUTS: &[InputPort] = &[
    InputPort {
        name: "transfer",
        ty: PortType::Transfer,
        requirement: Requirement::Required,
        doc: "The transfer function.",
    },
    InputPort {
        name: "volume",
        ty: PortType::Volume,
        requirement: Requirement::Required,
        doc: "The volume, whose smallest spacing is the unit of lengths.",
    },
];

const OUTPUTS: &[OutputPort] = &[OutputPort {
    name: "table",
    ty: PortType::Table3d,
    doc: "Mean colour and extinction of a segment from front scalar (x) to back scalar (y), by the root of its length (z).",
}];

/// The parameters with the table's size, for kinds that call for this one.
#[must_use]
pub fn params() -> [ParamSpec; 3] {
    [
        ParamSpec::int(
            "preintegration_3d_size",
            512,
            "Entries along each side of the pre-integrated table of all lengths.",
        )
        .range(64.0, 2048.0),
        ParamSpec::int(
            "preintegration_3d_layers",
            8,
            "Lengths that the pre-integrated table of all lengths is made for; it is interpolated between them.",
        )
        .range(2.0, 64.0),
        ParamSpec::float(
            "preintegration_3d_longest",
            0.0,
            "Longest segment that the pre-integrated table of all lengths is made for; at least the step.",
        )
        .range(0.0, 64.0)
        .unit("voxel"),
    ]
}

/// World length of the longest segment that a node makes the table for.
fn longest_world(node: &NodeContext<'_>) -> Result<f64, Finding> {
    let voxel = placed(node, "volume")?.grid().min_spacing();
    let longest = node.float("preintegration_3d_longest");
    Ok(voxel * node.float("step").max(longest))
}

/// Size and layers, where they fit; else the remedy names the size that does.
fn size(node: &NodeContext<'_>) -> Result<[u32; 2], Finding> {
    let size = node.uint("preintegration_3d_size");
    let layers = node.uint("preintegration_3d_layers");
    let most_bytes = MAX_BYTES.min(node.limits().max_resource_bytes);
    let bytes = |size: u32| u64::from(size).pow(2) * u64::from(layers) * 16;
    let fits = |size: u32| {
        bytes(size) <= most_bytes && u64::from(size.max(layers)) <= node.limits().max_texture_3d
    };
    if fits(size) {
        return Ok([size, layers]);
    }
    let help = match (6..11).rev().map(|power| 1 << power).find(|size| fits(*size)) {
        Some(size) => format!("set `preintegration_3d_size` to {size} or less, or use fewer layers"),
        None => "set `preintegration_3d_layers` to less, or choose the slot `classify` \"preintegrated_2d\"".to_owned(),
    };
    let message = format!(
        "a pre-integrated table of {size}x{size}x{layers} entries takes {} MiB and is too large: of {} MiB and {} \
         entries a side at most",
        bytes(size) >> 20,
        most_bytes >> 20,
        node.limits().max_texture_3d,
    );
    Err(node.error("over-limit", message).help(help))
}

impl NodeKind for Preintegration3d {
    fn name(&self) -> &'static str {
        "preintegration_3d"
    }

    fn doc(&self) -> &'static str {
        "Integrates a transfer function over segments of all lengths between two scalars (3D pre-integration)."
    }

    fn inputs(&self) -> &[InputPort] {
        INPUTS
    }

    fn outputs(&self) -> &[OutputPort] {
        OUTPUTS
    }

    fn params(&self) -> Vec<ParamSpec> {
        [step_param()].into_iter().chain(params()).collect()
    }

    fn output(&self, _port: &str, node: &NodeContext<'_>) -> Result<ResourceDesc, Finding> {
        let [size, layers] = size(node)?;
        Ok(ResourceDesc::Texture {
            dimensions: 3,
            size: Size::Absolute([size, size, layers]),
            format: TextureFormat::Rgba32Float,
        })
    }

    fn record(&self, node: &NodeContext<'_>) -> Result<Vec<Pass>, Finding> {
        let transfer = transfer(node, "transfer")?;
        let voxel = placed(node, "volume")?.grid().min_spacing();
        let references_per_world = transfer.reference_length().extinction_per_world(voxel);
        let longest = longest_world(node)? * references_per_world;
        let [size, layers] = size(node)?;
        let bytes = UploadBytes::new(move || {
            let table = transfer
                .preintegrated_table_3d(size, layers, longest)
                .map_err(|error| Finding::error("table", error.to_string()))?;
            Ok(bytemuck::cast_slice(&table.entries).to_vec())
        });
        Ok(vec![Pass::Upload {
            port: "table",
            bytes,
        }])
    }
}

/// The members of the uniform `preintegration_3d` (see `slot/classify/preintegrated_3d.wgsl`).
pub(crate) fn uniform(node: &NodeContext<'_>) -> Result<Uniform, Finding> {
    let (low, span) = table_range(node, &*transfer(node, "transfer")?)?;
    let writer = node.writer("preintegration_3d_table").unwrap_or(*node);
    let last = |param: &str| f64::from(writer.uint(param).max(2) - 1);
    let last_entry = last("preintegration_3d_size");
    Ok(vec![
        ("low", f32_value(low)),
        ("entries_per_scalar", f32_value(last_entry / span)),
        ("last_entry", f32_value(last_entry)),
        ("last_layer", f32_value(last("preintegration_3d_layers"))),
        ("longest", f32_value(longest_world(&writer)?)),
    ])
}
