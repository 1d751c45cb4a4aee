//! `brick_pool`: a volume in bricks on the device: those that a picture needs, and a table that says where they are.
//!
//! The way of a brick: `target` walks the pyramid from its top and splits the brick whose refinement is expected to better
//! the picture most, until no brick's estimated error is above the source's tolerance, no voxel larger than its pixels, or
//! the pool full; `stream` keeps what is in the pool from frame to frame and gives each new brick a place; `layout` draws the page
//! table (Hadwiger et al. 2012, Fogal et al. 2013); the pass of tiles reads from disk those that are not on the device yet.
//! What is seen follows the transfer function (`sight`): of bricks in which nothing absorbs no finer level is read.
//!
//! A picture is whole at once, or, where the source is progressive, starts from coarse levels and gets better from frame to
//! frame. Both end with the same bricks, whatever was seen before.

mod layout;
mod sight;
mod stream;
mod target;

use std::sync::{Arc, PoisonError};

use volgraph_graph::{
    InputPort, NodeContext, NodeKind, OutputPort, Pass, PortType, Requirement, ResourceDesc, Size,
    SlotSpec, State, Tiles, Uniform, UploadBytes, View,
};
use volgraph_report::Finding;
use volgraph_shader::ParamSpec;
use wgpu_types::TextureFormat;

use self::layout::Layout;
pub(crate) use self::stream::Streams;
use self::stream::{Brick, Request};
use crate::brick_ranges::margin;
use crate::distance_map::{EMPTINESS, absorbing};
use crate::encoding::{Encoder, Encoding};
use crate::placement::{f32_value, placed, vec3};
use crate::source::bricks::BricksSource;
use crate::source::segments::SegmentsSource;
use crate::source::transfer::TransferSource;
use crate::volume_texture::storage_param;

/// The node kind `brick_pool`.
pub struct BrickPool;

const INPUTS: &[InputPort] = &[
    InputPort {
        name: "volume",
        ty: PortType::Volume,
        requirement: Requirement::Required,
        doc: "The volume, in bricks.",
    },
    InputPort {
        name: "transfer",
        ty: PortType::Transfer,
        requirement: Requirement::Optional,
        doc: "The transfer function: what absorbs is seen.",
    },
    InputPort {
        name: "segments",
        ty: PortType::Segments,
        requirement: Requirement::Optional,
        doc: "What labels mean, with their transfer functions.",
    },
];

const OUTPUTS: &[OutputPort] = &[
    OutputPort {
        name: "pool",
        ty: PortType::BrickPool,
        doc: "Bricks of scalars side by side, each with a voxel more on every side.",
    },
    OutputPort {
        name: "pages",
        ty: PortType::PageTable,
        doc: "For each brick of the finest level, which brick of the pool has its scalars, and of what level that is.",
    },
];

const SLOTS: &[SlotSpec] = &[
    EMPTINESS,
    SlotSpec {
        name: "reconstruct",
        default: "trilinear",
        doc: "What is the scalar at a point?",
    },
];

/// Bricks of the pool along an axis, which a page tells in eight bits.
const MOST_SLOTS: u32 = 255;

/// Bricks of the pool along each axis: as many as its memory allows, or as there are.
fn slots(
    node: &NodeContext<'_>,
    source: &BricksSource,
    encoding: &Encoding,
) -> Result<[u32; 3], Finding> {
    let whole = source.store.edge() + 2;
    let bytes = u64::from(whole).pow(3) * encoding.texel_len() as u64;
    let all: u64 = source
        .store
        .levels()
        .iter()
        .map(|level| level.bricks.map(u64::from).iter().product::<u64>())
        .fold(0, u64::saturating_add);
    let room = source.effort.pool_bytes / bytes;
    let count = room.min(all);
    let most = u64::from(MOST_SLOTS).min(node.limits().max_texture_3d / u64::from(whole));
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "at most 255"
    )]
    let side = ((count as f64).cbrt().ceil() as u64).clamp(1, most.max(1)) as u32;
    let layer = u64::from(side) * u64::from(side);
    let high = count.div_ceil(layer).min(room / layer).min(most);
    // Room for the top, for the way down to one brick, and for something to be seen.
    let least = 8 * source.store.levels().len() as u64;
    if high * layer < least.min(all) {
        return Err(node
            .error(
                "over-limit",
                format!(
                    "bricks of {whole} voxels along each edge take {bytes} bytes, and {} of them do not fit in `pool_mib`",
                    least.min(all)
                ),
            )
            .help("give the source `bricks` a larger `pool_mib`, or build its pyramid with smaller bricks"));
    }
    Ok([side, side, u32::try_from(high).unwrap_or(1)])
}

/// The members of the uniform `pages` (see `lib/pages.wgsl`), for a node with the input `volume`.
///
/// # Errors
/// `missing-input`.
pub(crate) fn uniform(node: &NodeContext<'_>) -> Result<Uniform, Finding> {
    let writer = node.writer("brick_pool").unwrap_or(*node);
    let (source, encoding) = known(&writer)?;
    let slots = slots(&writer, source, &encoding)?;
    let whole = f64::from(source.store.edge() + 2);
    Ok(vec![
        ("edge", f32_value(f64::from(source.store.edge()))),
        (
            "per_texel",
            vec3(slots.map(|n| (f64::from(n) * whole).recip()).into()),
        ),
        ("texels", vec3(slots.map(|n| f64::from(n) * whole).into())),
    ])
}

/// Whether a raycast reads pool and pages of one node, which is of its own volume.
///
/// # Errors
/// `bad-input` where it does not.
pub(crate) fn check(node: &NodeContext<'_>) -> Result<(), Finding> {
    let (Some(pool), Some(pages)) = (node.writer("brick_pool"), node.writer("page_table")) else {
        return Ok(());
    };
    let is_of = |writer: &NodeContext<'_>| {
        let sources = (node.shared_source("volume"), writer.shared_source("volume"));
        matches!(sources, (Some(own), Some(its)) if Arc::ptr_eq(&own, &its))
    };
    if pool.name() == pages.name() && is_of(&pool) {
        return Ok(());
    }
    let message = format!(
        "its bricks are of `{}` and its pages of `{}`, and not both of one `brick_pool` of its own volume",
        pool.name(),
        pages.name()
    );
    Err(node
        .error("bad-input", message)
        .help("connect neither: a pool is made for it"))
}

fn known<'g>(node: &NodeContext<'g>) -> Result<(&'g BricksSource, Encoding), Finding> {
    let source = node.source::<BricksSource>("volume").ok_or_else(|| {
        node.error("missing-input", "its input `volume` is no volume in bricks")
            .help("connect a source `bricks`")
    })?;
    let encoding = Encoding::choose(placed(node, "volume")?, node.text("volume_storage"));
    Ok((source, encoding))
}

/// What is in the pool and in the page table now, for a node in a view.
fn layout(node: &NodeContext<'_>) -> Result<(Arc<Layout>, State), Finding> {
    let (source, encoding) = known(node)?;
    let view = node.view().copied().map(whole);
    let transfer = node.source::<TransferSource>("transfer");
    let has_others = node
        .source::<SegmentsSource>("segments")
        .is_some_and(|segments| !segments.transfers.is_empty());
    // Where scalars may leave the range of the voxels around, bricks tell nothing.
    let margin = margin(node.slot("reconstruct"));
    let spans = match (node.slot("emptiness"), margin) {
        ("transfer", Some(_)) => Some(absorbing(node)?),
        _ => None,
    };
    let request = Request {
        store: &source.store,
        effort: source.effort,
        is_progressive: source.progressive.get(),
        slots: slots(node, source, &encoding)?,
        encoding,
        view,
        spans,
        reaches_far: margin.is_some_and(|margin| margin > 1),
        // What labels with others would show is not known.
        transfer: transfer
            .filter(|_| !has_others && node.slot("emptiness") == "transfer")
            .map(|source| source.transfer.as_ref()),
    };
    let mut streams = source
        .streams
        .lock()
        .unwrap_or_else(PoisonError::into_inner);
    Ok(streams.of(node.name()).layout(&request))
}

/// All parts of a picture are made of the same bricks.
fn whole(view: View) -> View {
    View {
        size: view.window.map_or(view.size, |window| window.whole),
        window: None,
        ..view
    }
}

impl NodeKind for BrickPool {
    fn name(&self) -> &'static str {
        "brick_pool"
    }

    fn doc(&self) -> &'static str {
        "Keeps those bricks of a volume on the device that a picture needs."
    }

    fn inputs(&self) -> &[InputPort] {
        INPUTS
    }

    fn outputs(&self) -> &[OutputPort] {
        OUTPUTS
    }

    fn params(&self) -> Vec<ParamSpec> {
        vec![storage_param()]
    }

    fn slots(&self) -> &[SlotSpec] {
        SLOTS
    }

    fn tiled(&self) -> &[&'static str] {
        &["pool"]
    }

    fn state(&self, node: &NodeContext<'_>) -> Result<Option<State>, Finding> {
        layout(node).map(|(_, state)| Some(state))
    }

    fn output(&self, port: &str, node: &NodeContext<'_>) -> Result<ResourceDesc, Finding> {
        let (source, encoding) = known(node)?;
        let (size, format) = match port {
            "pool" => (
                slots(node, source, &encoding)?.map(|n| n * (source.store.edge() + 2)),
                encoding.format,
            ),
            _ => (source.store.levels()[0].bricks, TextureFormat::Rgba8Unorm),
        };
        Ok(ResourceDesc::Texture {
            dimensions: 3,
            size: Size::Absolute(size),
            format,
        })
    }

    fn record(&self, node: &NodeContext<'_>) -> Result<Vec<Pass>, Finding> {
        let (source, encoding) = known(node)?;
        let (layout, _) = layout(node)?;
        layout.note_recorded();
        let encoder = Encoder::new(encoding, source.scalars());
        let (store, pages) = (Arc::clone(&source.store), Arc::clone(&layout));
        let whole = source.store.edge() + 2;
        let texels = (whole as usize).pow(3);
        let read = {
            let layout = Arc::clone(&layout);
            move |at: &[usize], bytes: &mut [u8]| {
                let bricks: Vec<Brick> = at.iter().map(|at| layout.bricks[*at]).collect();
                layout::read(&store, &encoder, &bricks, texels, bytes, &layout.pace)
            }
        };
        Ok(vec![
            Pass::Tiles {
                port: "pool",
                tiles: Tiles::new([whole; 3], Arc::clone(&layout.tiles), read),
            },
            Pass::Upload {
                port: "pages",
                bytes: UploadBytes::new(move || Ok(pages.pages.as_flattened().to_vec())),
            },
        ])
    }
}
