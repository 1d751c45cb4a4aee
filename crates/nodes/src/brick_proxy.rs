//! `brick_proxy`: the smallest box around the bricks of which anything may be seen, as triangles that start rays.
//!
//! In place of `proxy_box`: rays that meet no such brick never start, and show what is behind. Those that start walk from
//! the volume's own box on, by the same steps, so the picture is that of the box. It follows the transfer function: bricks
//! are seen where their scalars absorb. The processor has the bricks' ranges in memory, and looks at all of them where the
//! transfer function has changed.

use std::sync::Arc;

use glam::DVec3;
use volgraph_graph::{
    InputPort, NodeContext, NodeKind, OutputPort, Pass, PortType, Requirement, ResourceDesc, Source,
};
use volgraph_report::Finding;
use volgraph_shader::ParamSpec;

use crate::distance_map::absorbing;
use crate::placement::{encoding, placed, volume};
use crate::proxy_box;
use crate::source::volume::VolumeSource;
use crate::volume_texture::storage_param;

/// The node kind `brick_proxy`.
pub struct BrickProxy;

/// Voxels along the edge of a brick.
pub(crate) const EDGE: u32 = 8;
/// Voxels beside a brick that its scalars may be made of, by any reconstruction that does not overshoot.
pub(crate) const MARGIN: u32 = 2;

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
        doc: "The transfer function: what absorbs may be seen.",
    },
    InputPort {
        name: "segments",
        ty: PortType::Segments,
        requirement: Requirement::Optional,
        doc: "What labels mean, with their transfer functions.",
    },
];

impl NodeKind for BrickProxy {
    fn name(&self) -> &'static str {
        "brick_proxy"
    }

    fn doc(&self) -> &'static str {
        "Makes the smallest box around all that a transfer function lets be seen, as the geometry that starts rays."
    }

    fn inputs(&self) -> &[InputPort] {
        INPUTS
    }

    fn outputs(&self) -> &[OutputPort] {
        proxy_box::OUTPUTS
    }

    fn params(&self) -> Vec<ParamSpec> {
        vec![storage_param()]
    }

    fn depends_on(&self, port: &str, node: &NodeContext<'_>) -> Option<Vec<u8>> {
        if !["transfer", "segments"].contains(&port) {
            return None;
        }
        let ends = seen(node).ok()?.into_iter().flatten();
        Some(
            ends.flat_map(|end| end.to_array().map(f64::to_le_bytes))
                .flatten()
                .collect(),
        )
    }

    fn output(&self, _port: &str, _node: &NodeContext<'_>) -> Result<ResourceDesc, Finding> {
        Ok(proxy_box::resource())
    }

    fn record(&self, node: &NodeContext<'_>) -> Result<Vec<Pass>, Finding> {
        // Where nothing is seen no pass draws it.
        let [low, high] = seen(node)?.unwrap_or_default();
        proxy_box::passes(node, volume(node, "volume")?.grid(), low, high)
    }
}

/// The part of its volume's box that a node's proxy geometry covers, in index coordinates; `None` where it covers nothing.
///
/// # Errors
/// `missing-input`.
pub(crate) fn covered(node: &NodeContext<'_>) -> Result<Option<[DVec3; 2]>, Finding> {
    match bricks(node) {
        Some(proxy) => seen(&proxy),
        None => {
            let (low, high) = placed(node, "volume")?.grid().box_index();
            Ok(Some([low, high]))
        }
    }
}

/// The `brick_proxy` that starts a node's rays.
fn bricks<'g>(node: &NodeContext<'g>) -> Option<NodeContext<'g>> {
    let writer = node.writer("rays");
    writer.filter(|writer| writer.kind_name() == BrickProxy.name())
}

/// Whether what a raycast draws is within its proxy geometry.
///
/// # Errors
/// `not-covered` where it may see more than the bricks of a `brick_proxy`.
pub(crate) fn check(node: &NodeContext<'_>) -> Result<(), Finding> {
    let Some(proxy) = bricks(node) else {
        return Ok(());
    };
    let refused = |why: String, help: String| {
        let message = format!(
            "its rays start from `{}`, a `brick_proxy`, {why}",
            proxy.name()
        );
        Err(node.error("not-covered", message).help(help))
    };
    let instead = "start them from a `proxy_box`";
    if node.slot("emptiness") != "transfer" {
        return refused(
            format!(
                "which covers what the transfer function makes absorb; but its technique `{}` may show more",
                node.slot("technique")
            ),
            format!("{instead}, or choose the technique `dvr`"),
        );
    }
    let reconstruct = node.slot("reconstruct");
    if !["nearest", "trilinear", "tricubic"].contains(&reconstruct) {
        return refused(
            format!(
                "but scalars of its slot `reconstruct`, `{reconstruct}`, leave the range of their voxels"
            ),
            format!("{instead}, or choose `trilinear`"),
        );
    }
    for port in ["volume", "transfer", "segments"] {
        if !is_same(node.shared_source(port), proxy.shared_source(port)) {
            return refused(
                format!("whose input `{port}` is another one than its own"),
                format!(
                    "connect `{port}` of `{}` as that of `{}`",
                    proxy.name(),
                    node.name()
                ),
            );
        }
    }
    if node.text("volume_storage") != proxy.text("volume_storage") {
        return refused(
            "whose `volume_storage` is another one than its own".to_owned(),
            format!(
                "set `volume_storage` of both to `{}`",
                node.text("volume_storage")
            ),
        );
    }
    Ok(())
}

/// Whether a node whose rays take all samples starts them from a whole box.
///
/// # Errors
/// `not-covered` where it does not.
pub(crate) fn check_whole(node: &NodeContext<'_>) -> Result<(), Finding> {
    bricks(node).map_or(Ok(()), |proxy| {
        let message = format!(
            "its rays start from `{}`, a `brick_proxy`, but it shows all of the volume",
            proxy.name()
        );
        Err(node
            .error("not-covered", message)
            .help("start them from a `proxy_box`"))
    })
}

fn is_same(a: Option<Arc<dyn Source>>, b: Option<Arc<dyn Source>>) -> bool {
    match (a, b) {
        (Some(a), Some(b)) => Arc::ptr_eq(&a, &b),
        (None, None) => true,
        _ => false,
    }
}

/// The smallest box around the bricks whose scalars absorb, in index coordinates.
fn seen(node: &NodeContext<'_>) -> Result<Option<[DVec3; 2]>, Finding> {
    let grid = volume(node, "volume")?.grid();
    let Some(source) = node.source::<VolumeSource>("volume") else {
        return Ok(None);
    };
    let spans = absorbing(node)?;
    let encoding = encoding(node)?;
    let storage = node.text("volume_storage");
    Ok(source
        .seen_bricks(storage, spans, &encoding)
        .map(|[first, last]| {
            let at = |brick: [u32; 3]| DVec3::from(brick.map(|n| f64::from(n * EDGE))) - 0.5;
            let (low, high) = grid.box_index();
            let last = last.map(|n| n + 1);
            [at(first).clamp(low, high), at(last).clamp(low, high)]
        }))
}
