//! `brick_ranges`: the least and the largest scalar of each brick of a volume, as shaders read its texture.
//!
//! The processor makes them in one pass over the voxels, which it has in memory. What is read of a brick's edge reaches
//! into the voxels beside it, by as many as the reconstruction does.

use std::sync::Arc;

use glam::DVec3;
use volgraph_graph::{
    InputPort, NodeContext, NodeKind, OutputPort, Pass, PortType, Requirement, ResourceDesc, Size,
    SlotSpec, Uniform, UploadBytes,
};
use volgraph_report::Finding;
use volgraph_shader::{ParamSpec, UniformValue};
use volgraph_volume::brick_dims;
use wgpu_types::TextureFormat;

use crate::encoding::Encoding;
use crate::placement::{placed, vec3, volume};
use crate::source::volume::VolumeSource;
use crate::volume_texture::storage_param;

/// The node kind `brick_ranges`.
pub struct BrickRanges;

const INPUTS: &[InputPort] = &[InputPort {
    name: "volume",
    ty: PortType::Volume,
    requirement: Requirement::Required,
    doc: "The volume.",
}];

const OUTPUTS: &[OutputPort] = &[OutputPort {
    name: "ranges",
    ty: PortType::BrickRanges,
    doc: "The least and the largest scalar of each brick.",
}];

const SLOTS: &[SlotSpec] = &[SlotSpec {
    name: "reconstruct",
    default: "trilinear",
    doc: "What is the scalar at a point?",
}];

/// The parameter `brick_size`.
pub fn size_param() -> ParamSpec {
    ParamSpec::int(
        "brick_size",
        LARGEST_DEFAULT.into(),
        "Voxels along an edge of the bricks that walks leap over; by default 1 or 2 where a scout looks for all rays and the volume has at most 262,144 bricks then.",
    )
    .range(1.0, 64.0)
}

/// The edge where nothing else is said, and most bricks of a smaller one: a transfer function's edit looks at all of them.
const LARGEST_DEFAULT: u32 = 4;
const MOST_OF_SMALLER: u64 = 1 << 18;

/// What counts as far away in maps of bricks: so many of them, and no less than so many voxels.
const FARTHEST: u32 = 7;
const FARTHEST_VOXELS: u32 = 28;

/// The smallest edge, a power of two, of which a grid has few enough bricks.
pub(crate) fn smallest_edge(dims: [u32; 3]) -> u32 {
    let is_small = |edge: &u32| {
        let bricks = brick_dims(dims, *edge).map(u64::from);
        bricks.into_iter().fold(1, u64::saturating_mul) <= MOST_OF_SMALLER
    };
    [1, 2].into_iter().find(is_small).unwrap_or(LARGEST_DEFAULT)
}

/// How many voxels beside a brick the scalars at its faces are made of. `None` where scalars may lie outside of the range
/// of the voxels around: bricks then tell nothing.
#[must_use]
pub(crate) fn margin(reconstruct: &str) -> Option<u32> {
    match reconstruct {
        "nearest" | "trilinear" => Some(1),
        "tricubic" => Some(2),
        _ => None,
    }
}

/// The margin for a node's own reconstruction.
///
/// # Errors
/// `bad-slot` where it is not known.
pub(crate) fn known_margin(node: &NodeContext<'_>) -> Result<u32, Finding> {
    margin(node.slot("reconstruct")).ok_or_else(|| {
        node.error(
            "bad-slot",
            "of its slot `reconstruct` it is not known which voxels a scalar is made of",
        )
        .help("choose `nearest`, `trilinear` or `tricubic`")
    })
}

/// Slices of a map of bricks in a row of its texture: as near to a square as slices lie.
fn columns([x, y, z]: [u32; 3]) -> u32 {
    let wanted = f64::from(z) * f64::from(y) / f64::from(x.max(1));
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "from 1 to the number of slices"
    )]
    let columns = wanted.sqrt().ceil().clamp(1.0, f64::from(z.max(1))) as u32;
    columns
}

/// Voxels along the edge of the bricks of a node's volume: those that it is read in, or as `brick_size` says.
fn edge(node: &NodeContext<'_>) -> Result<u32, Finding> {
    let edge = placed(node, "volume")?.brick_edge;
    Ok(edge.unwrap_or_else(|| node.uint("brick_size")))
}

/// The bricks of the volume of a node with the parameter `brick_size`, and the size of a map of them.
///
/// # Errors
/// `missing-input`.
pub(crate) fn map_size(node: &NodeContext<'_>) -> Result<([u32; 3], [u32; 3]), Finding> {
    let dims = brick_dims(placed(node, "volume")?.grid().dims, edge(node)?);
    let columns = columns(dims);
    let size = [
        dims[0].saturating_mul(columns),
        dims[1].saturating_mul(dims[2].div_ceil(columns)),
        1,
    ];
    Ok((dims, size))
}

/// The members of the uniform `bricks` (see `lib/bricks.wgsl`).
///
/// # Errors
/// `missing-input`.
pub(crate) fn uniform(node: &NodeContext<'_>) -> Result<Uniform, Finding> {
    let (dims, map) = map_size(node)?;
    let size = edge(node)?.max(1);
    let placed = placed(node, "volume")?;
    let voxels = placed.grid().dims;
    // Those that a volume is read in go from face to face.
    let shift = match placed.brick_edge {
        Some(_) => 0.0,
        None => 0.5 / f64::from(size),
    };
    let whole = |n: u32| i32::try_from(n).unwrap_or(i32::MAX);
    Ok(vec![
        ("dims", UniformValue::IVec3(dims.map(whole))),
        ("columns", UniformValue::I32(whole(columns(dims)))),
        (
            "per_texture",
            vec3(DVec3::from_array(voxels.map(f64::from)) / f64::from(size)),
        ),
        ("shift", vec3(DVec3::splat(shift))),
        // As far in voxels for small bricks as for usual ones: tiles of pixels are as wide.
        (
            "farthest",
            UniformValue::U32((FARTHEST_VOXELS / size).max(FARTHEST)),
        ),
        (
            "map_size",
            UniformValue::Vec2([map[0] as f32, map[1] as f32]),
        ),
    ])
}

impl NodeKind for BrickRanges {
    fn name(&self) -> &'static str {
        "brick_ranges"
    }

    fn doc(&self) -> &'static str {
        "Finds the least and the largest scalar of each brick of a volume."
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

    fn output(&self, _port: &str, node: &NodeContext<'_>) -> Result<ResourceDesc, Finding> {
        let (dims, _) = map_size(node)?;
        Ok(ResourceDesc::Texture {
            dimensions: 3,
            size: Size::Absolute(dims),
            format: TextureFormat::Rg32Float,
        })
    }

    fn record(&self, node: &NodeContext<'_>) -> Result<Vec<Pass>, Finding> {
        let encoding = Encoding::choose(volume(node, "volume")?, node.text("volume_storage"));
        // From voxel centre to voxel centre.
        let behind = known_margin(node)?;
        let margin = [behind.saturating_sub(1), behind];
        let size = node.uint("brick_size");
        let source = node.source::<VolumeSource>("volume");
        let volume = source.map(|source| Arc::clone(&source.volume));
        let bytes = UploadBytes::by_layers(move || {
            let volume = volume.clone();
            Ok(Box::new(move |layers, texels| {
                let ranges = volume
                    .as_ref()
                    .map(|volume| volume.brick_ranges_of(size, margin, layers))
                    .unwrap_or_default();
                // Storage keeps the order of scalars, so that these are the least and the largest that are read.
                for (texel, scalar) in texels.chunks_exact_mut(4).zip(ranges.iter().flatten()) {
                    texel.copy_from_slice(&encoding.stored(*scalar).to_le_bytes());
                }
                Ok(())
            }))
        });
        Ok(vec![Pass::Upload {
            port: "ranges",
            bytes,
        }])
    }
}
