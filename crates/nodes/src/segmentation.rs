//! The uniforms of segmented volumes: where the labels are, and which rows of which table each one means.

use glam::{DAffine3, DMat4, DVec3};
use volgraph_graph::{NodeContext, Uniform};
use volgraph_optics::TransferFunction;
use volgraph_report::Finding;
use volgraph_shader::{ParamSpec, UniformValue};

use crate::integral_table;
use crate::placement::{columns, f32_value, over_box, texture_from_world, vec3, volume};
use crate::preintegration::tiles;
use crate::raycast::{TablePorts, transfer_uniform};
use crate::source::segments::{LABELS, SegmentsSource};
use crate::transfer_table::transfers;

/// The slot that holds the tables of transfer functions: one, or a row for each label's.
pub const TABLES_SLOT: &str = "transfer_tables";

/// Rows that the uniform `transfers` has room for.
const MAX_TRANSFERS: usize = 256;

/// The parameters that say where labels are.
#[must_use]
pub fn params() -> [ParamSpec; 2] {
    [
        ParamSpec::choice(
            "label_boundary",
            &["smooth", "blocky"],
            "smooth",
            "Where labels meet: where their trilinear memberships are equal, or at the faces of voxels.",
        ),
        ParamSpec::choice(
            "label_placement",
            &["world", "box"],
            "world",
            "Where the volume of labels is: at its own place, or over the volume's box whatever its own place is.",
        ),
    ]
}

/// Whether a node's slot `labels` may tell labels apart.
#[must_use]
pub fn has_labels(node: &NodeContext<'_>) -> bool {
    !matches!(node.slot("labels"), "" | "none")
}

/// The segments of a node that tells labels apart.
#[must_use]
pub fn segments<'g>(node: &NodeContext<'g>) -> Option<&'g SegmentsSource> {
    node.source("segments").filter(|_| has_labels(node))
}

/// Where labels are.
pub(crate) struct Placed {
    /// Index coordinates of the labels from world positions.
    pub(crate) index_from_world: DAffine3,
    /// The box outside of which is label 0, in index coordinates.
    pub(crate) low: DVec3,
    /// Its other corner.
    pub(crate) high: DVec3,
}

/// Where a node's labels are.
///
/// # Errors
/// `missing-input`.
pub(crate) fn placed(node: &NodeContext<'_>) -> Result<Placed, Finding> {
    let grid = volume(node, "volume")?.grid();
    let labels = volume(node, "labels")?.grid();
    let (low, high) = labels.box_index();
    let index_from_world = if node.text("label_placement") == "box" {
        over_box(grid, labels)
    } else {
        labels.world_from_index.inverse()
    };
    // Where the labels reach as far as the volume does, no rounding may find their end before the volume's.
    let corners = grid.corners_world();
    let corners = corners
        .iter()
        .map(|corner| index_from_world.transform_point3(*corner));
    let (first, last) = corners.fold(
        (DVec3::INFINITY, DVec3::NEG_INFINITY),
        |(first, last), corner| (first.min(corner), last.max(corner)),
    );
    let farther = |is_inside: bool| if is_inside { 1.0 } else { 0.0 };
    let below = DVec3::from_array([0, 1, 2].map(|i| farther(first[i] >= low[i] - 1e-3)));
    let above = DVec3::from_array([0, 1, 2].map(|i| farther(last[i] <= high[i] + 1e-3)));
    Ok(Placed {
        index_from_world,
        low: low - below,
        high: high + above,
    })
}

/// The label at a world position, by the node's `label_boundary`; `None` where the node tells no labels apart.
///
/// # Errors
/// `missing-input`.
pub fn label_at(node: &NodeContext<'_>, world: DVec3) -> Result<Option<u8>, Finding> {
    if !has_labels(node) {
        return Ok(None);
    }
    let labels = volume(node, "labels")?;
    let Placed {
        index_from_world,
        low,
        high,
    } = placed(node)?;
    let at = index_from_world.transform_point3(world);
    if !(at.cmpge(low).all() && at.cmple(high).all()) {
        return Ok(Some(0));
    }
    let last = DVec3::from_array(labels.grid().dims.map(|n| f64::from(n) - 1.0));
    let label = |index: DVec3| {
        let value = labels.voxel(index.clamp(DVec3::ZERO, last).as_uvec3().to_array());
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "labels are whole numbers of 0 to 255"
        )]
        let label = value.clamp(0.0, 255.0) as u8;
        label
    };
    if node.text("label_boundary") == "blocky" {
        return Ok(Some(label((at + 0.5).floor())));
    }
    // The label with the largest trilinear membership; of equal ones the least.
    let cell = at.floor();
    let share = at - cell;
    let mut memberships = [0.0; LABELS];
    for corner in 0..8_u32 {
        let is_high = [0, 1, 2].map(|axis| corner >> axis & 1 != 0);
        let step = DVec3::from_array(is_high.map(f64::from));
        let weights = DVec3::select(step.cmpgt(DVec3::ZERO), share, 1.0 - share);
        memberships[usize::from(label(cell + step))] += weights.element_product();
    }
    let best = (0..=u8::MAX)
        .rev()
        .max_by(|a, b| memberships[usize::from(*a)].total_cmp(&memberships[usize::from(*b)]));
    Ok(best)
}

/// The members of the uniform `segmentation` (see `slot/labels/volume.wgsl`).
///
/// # Errors
/// `missing-input`, `over-limit`.
pub fn uniform(node: &NodeContext<'_>) -> Result<Uniform, Finding> {
    let grid = volume(node, "volume")?.grid();
    let labels = volume(node, "labels")?.grid();
    let Placed {
        index_from_world,
        low,
        high,
    } = placed(node)?;
    let index_from_texture = index_from_world * texture_from_world(grid).inverse();
    // A gradient maps by the transpose of the map that positions have the other way.
    let gradient = index_from_world.matrix3.transpose();
    Ok(vec![
        (
            "index_from_texture",
            UniformValue::Mat4(columns(DMat4::from(index_from_texture))),
        ),
        (
            "world_from_index_gradient",
            UniformValue::Mat3(gradient.as_mat3().to_cols_array_2d()),
        ),
        ("dims", vec3(DVec3::from_array(labels.dims.map(f64::from)))),
        ("box_low", vec3(low)),
        ("box_high", vec3(high)),
        (
            "is_blocky",
            UniformValue::U32(u32::from(node.text("label_boundary") == "blocky")),
        ),
        ("rows", rows(node)),
    ])
}

/// For each label: the row of its parameters, that of its transfer function, and whether it is drawn.
fn rows(node: &NodeContext<'_>) -> UniformValue {
    let segments = segments(node);
    let own = usize::from(node.is_connected("transfer"));
    let rows_of_params = segments.map_or([0; LABELS], SegmentsSource::row_of_params);
    let row = |at: usize| {
        let label = u8::try_from(at).unwrap_or(u8::MAX);
        let segment = segments.and_then(|segments| segments.segment(label));
        let params = rows_of_params[at];
        let transfer = segment.and_then(|segment| segment.transfer);
        let transfer = transfer.map_or(0, |at| at + own);
        let is_visible = segment.is_none_or(|segment| segment.is_visible);
        let whole = |n: usize| u32::try_from(n).unwrap_or(u32::MAX);
        UniformValue::UVec4([whole(params), whole(transfer), u32::from(is_visible), 0])
    };
    UniformValue::Array((0..LABELS).map(row).collect())
}

/// The members of the uniform `transfers` (see `slot/transfer_tables/many.wgsl`).
///
/// # Errors
/// `missing-input` where a label that is drawn has no transfer function; `over-limit`.
pub fn transfers_uniform(node: &NodeContext<'_>) -> Result<Uniform, Finding> {
    let ports = TablePorts::MANY;
    let all = if ports.are_read(node) {
        check_each_has_one(node)?;
        transfers(node)?
    } else {
        // Nothing is classified; the members still have to be there.
        nothing().into_iter().map(Into::into).collect()
    };
    if all.len() > MAX_TRANSFERS {
        let message = format!(
            "{} transfer functions, of {MAX_TRANSFERS} at most",
            all.len()
        );
        return Err(node.error("over-limit", message));
    }
    // The first entry of a table in the texture of all.
    let count = u32::try_from(all.len()).unwrap_or(u32::MAX);
    let tile = |port: &str, at: u32| {
        let size = node
            .writer(port)
            .map_or(1, |writer| writer.uint("preintegration_size").max(1));
        let [columns, _] = tiles(node.limits(), size, count as usize);
        UniformValue::UVec2([at % columns * size, at / columns * size])
    };
    let mut rows = Vec::with_capacity(MAX_TRANSFERS);
    for (at, transfer) in (0_u32..).zip(&all) {
        let members = transfer_uniform(node, transfer, &ports)?
            .into_iter()
            .map(|(name, value)| (name.to_owned(), value));
        let place = (f64::from(at) + 0.5) / f64::from(count);
        rows.push(UniformValue::Struct(vec![
            (
                "transfer".to_owned(),
                UniformValue::Struct(members.collect()),
            ),
            ("tile".to_owned(), tile(ports.preintegration, at)),
            ("place".to_owned(), f32_value(place)),
            (
                "integral_row".to_owned(),
                UniformValue::U32(integral_table::ROWS * at),
            ),
            ("half_tile".to_owned(), tile(ports.half, at)),
        ]));
    }
    // Rows that no label means are as the first.
    if let Some(first) = rows.first().cloned() {
        rows.resize(MAX_TRANSFERS, first);
    }
    Ok(vec![("rows", UniformValue::Array(rows))])
}

fn check_each_has_one(node: &NodeContext<'_>) -> Result<(), Finding> {
    if node.is_connected("transfer") {
        return Ok(());
    }
    // Labels beyond the volume's own are never met; outside of it is label 0.
    let (least, most) = volume(node, "labels")?
        .statistics()
        .range()
        .unwrap_or((0.0, 0.0));
    let is_met = |label: &u8| *label == 0 || (least..=most).contains(&f64::from(*label));
    let without = (0..=u8::MAX).filter(is_met).find(|label| {
        segments(node)
            .and_then(|segments| segments.segment(*label))
            .is_none_or(|segment| segment.is_visible && segment.transfer.is_none())
    });
    without.map_or(Ok(()), |label| {
        let message = format!("label {label} is drawn and has no transfer function");
        Err(node.error("missing-input", message).help(
            "connect `transfer`, or give one to each label and to `others` in the file of its segments",
        ))
    })
}

/// A transfer function of nothing.
fn nothing() -> Option<TransferFunction> {
    let text = "(points: [(at: 0, color: (0, 0, 0), opacity: 0)])";
    TransferFunction::parse(std::path::Path::new(""), text).ok()
}
