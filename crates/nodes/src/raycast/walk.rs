//! What every walk through the volume needs, that of a light as well: choices of slots, and an end.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::DVec3;
use volgraph_graph::{NodeContext, NodeKind, Uniform};
use volgraph_optics::TransferFunction;
use volgraph_report::Finding;
use volgraph_shader::{ParamValue, UniformValue};
use volgraph_volume::Grid;
use wgpu_types::TextureFormat;

use super::Raycast;
use super::tables::data_value;
use crate::gradient::Gradient;
use crate::preintegration::Preintegration;
use crate::step_table::StepTable;
use crate::{brick_ranges, clip_volume, light_volume, placement, segmentation, transfer_table};

/// Most segments of a ray: software drivers end loops after 65,535 turns, and a GPU would be busy for seconds.
pub(crate) const MAX_SEGMENTS: f64 = 65_535.0;

/// The choices of slots that every walk through the volume needs, that of a light as well.
pub(crate) fn walk_slots(node: &NodeContext<'_>) -> BTreeMap<String, String> {
    let tables = if segmentation::has_labels(node) {
        "many"
    } else {
        "one"
    };
    let table_filter = if node.limits().float32_filterable {
        "hardware"
    } else {
        "loads"
    };
    // Most rays have one part, and need no loop over parts.
    let is_whole = node.slot("clip") == "none" && !segmentation::has_labels(node);
    let parts = if is_whole { "one" } else { "many" };
    let mut slots = BTreeMap::from([
        ("parts".to_owned(), parts.to_owned()),
        ("table_filter".to_owned(), table_filter.to_owned()),
        placement::filter_slot_at(node, "clip_volume"),
        (segmentation::TABLES_SLOT.to_owned(), tables.to_owned()),
        ("transfer_reach".to_owned(), reach(node).to_owned()),
        // A walk in pairs knows of steps.
        ("steps".to_owned(), "computed".to_owned()),
        light_volume::places_slot(node),
        // Rays from single points go apart from each other: looks cost them as much as they gain.
        ("shadow_leap".to_owned(), "none".to_owned()),
    ]);
    slots.extend(placement::texel_slots(node));
    slots
}

/// Whether scalars may leave the tables of transfer functions: of data that go farther, and of fields that overshoot
/// the data.
fn reach(node: &NodeContext<'_>) -> &'static str {
    let Ok(volume) = placement::placed(node, "volume") else {
        return "within";
    };
    let (low, high) = placement::data_range(volume);
    let is_left = |transfer: &TransferFunction| {
        let (from, to) = transfer.range();
        let [from, to] = [from, to].map(|at| data_value(volume, transfer.domain(), at));
        low < from || to < high
    };
    let stays_among_voxels =
        ["trilinear", "nearest", "tricubic"].contains(&node.slot("reconstruct"));
    let transfers = transfer_table::transfers(node).unwrap_or_default();
    if stays_among_voxels && !transfers.iter().any(|transfer| is_left(transfer)) {
        "within"
    } else {
        "beyond"
    }
}

/// Whether such a walk comes to its end, and solves the field that it reads.
pub(crate) fn check_walk(node: &NodeContext<'_>) -> Result<(), Finding> {
    check_segments(node)?;
    check_refinement(node)?;
    clip_volume::check_steps(node)
}

/// The longest ray must not have more segments than are walked (`WALK_MAX_SEGMENTS` in `lib/walked.wgsl`).
fn check_segments(node: &NodeContext<'_>) -> Result<(), Finding> {
    let placed = placement::placed(node, "volume")?;
    let grid = placed.grid();
    for param in ["step", "shadow_step"] {
        // Labels may have steps of their own.
        let rows = Raycast.param_rows(node).into_iter();
        let steps = rows.filter_map(|row| match row.get(param)?.value {
            ParamValue::Float(step) => Some(step),
            #[expect(clippy::cast_precision_loss, reason = "steps are small")]
            ParamValue::Int(step) => Some(step as f64),
            _ => None,
        });
        let step = steps.fold(node.float(param), f64::min) * grid.min_spacing();
        let segments = (longest_ray(grid) / step).ceil();
        if step > 0.0 && segments > MAX_SEGMENTS {
            return Err(node
                .error(
                    "too-many-segments",
                    format!("its longest ray has {segments} segments, of {MAX_SEGMENTS} at most"),
                )
                .help(format!(
                    "choose a longer `{param}`, or resample the volume to voxels closer to cubes"
                )));
        }
    }
    Ok(())
}

/// Parameters that choose what is exact for the trilinear field, and of no other (`lib/crossing.wgsl`, `lib/extremum.wgsl`):
/// with what is nearest to it for the others.
const OF_TRILINEAR: [(&str, &str, &str); 2] = [
    ("refinement", "cubic", "bisection"),
    ("extremum", "field", "samples"),
];

fn is_trilinear(node: &NodeContext<'_>) -> bool {
    node.slot("reconstruct") == "trilinear"
}

/// The default of a parameter where that of the kind does not fit the node's walk, or that of the shader its reconstruction
/// or its technique: rays in glass go to and fro, and solving the field in each cell that they meet takes more turns than software drivers give all
/// loops of a pixel.
pub(crate) fn default_of(param: &str, node: &NodeContext<'_>) -> Option<ParamValue> {
    if param == "brick_size" && node.uses_binding("spans") {
        // One ray looks at bricks for a whole tile of pixels: smaller ones pay.
        let size = brick_ranges::smallest_edge(placement::placed(node, "volume").ok()?.grid().dims);
        return Some(ParamValue::Int(i64::from(size)));
    }
    let (_, _, other) = OF_TRILINEAR
        .into_iter()
        .find(|(name, _, _)| *name == param)?;
    let default = match node.slot("technique") {
        "refraction_surface" if param == "refinement" => "linear",
        _ if !is_trilinear(node) => other,
        _ => return None,
    };
    Some(ParamValue::Text(default.to_owned()))
}

fn check_refinement(node: &NodeContext<'_>) -> Result<(), Finding> {
    let reconstruct = node.slot("reconstruct");
    for (param, exact, other) in OF_TRILINEAR {
        if node.text(param) == exact && !is_trilinear(node) {
            let message = format!(
                "its `{param}` `{exact}` solves the trilinear field, but its slot `reconstruct` is `{reconstruct}`"
            );
            let help = format!("set `{param}` to `{other}`, or `reconstruct` to `trilinear`");
            return Err(node.error("bad-param", message).help(help));
        }
    }
    Ok(())
}

/// The shortest step, in voxels of the smallest spacing, at which the longest ray through a volume is still walked whole.
#[must_use]
pub fn shortest_step(grid: &Grid) -> f64 {
    longest_ray(grid) / (MAX_SEGMENTS * grid.min_spacing())
}

/// The longest way through a volume's box, in world units.
pub(crate) fn longest_ray(grid: &Grid) -> f64 {
    let corners = grid.corners_world();
    let pairs = corners
        .iter()
        .flat_map(|from| corners.iter().map(move |to| from.distance(*to)));
    pairs.fold(0.0, f64::max)
}

/// How parts of rays are walked along, the choice of the slot `walk`: in pairs of whole steps where the technique's file
/// says that it may, nothing else is to be known of single segments, and the tables of segments are made for the step.
pub(super) fn walk(node: &NodeContext<'_>, look: &str) -> String {
    let walk = node.slot("walk");
    let takes_whole_steps = ["uniform", "skip", "adaptive"].contains(&node.slot("traverse"))
        && !["stride_map", "pages"].contains(&look);
    let is_asked = ["error", "trace"].iter().any(|layer| node.is_wanted(layer));
    // A walk of its own in each segment would be built three times.
    let is_light = ["none", "light_volume"].contains(&node.slot("shadow"));
    // Labels may have steps of their own.
    if walk == "pairs"
        && (!takes_whole_steps
            || is_asked
            || !is_light
            || segmentation::has_labels(node)
            || !has_table_of_step(node))
    {
        return "segments".to_owned();
    }
    walk.to_owned()
}

/// Pairs are for techniques that know of them, which their files say: no graph can.
pub(super) fn check_pairs(node: &NodeContext<'_>) -> Result<(), Finding> {
    if node.is_slot_given("walk") && node.slot("walk") == "pairs" {
        let message = "its slot `walk` is `pairs`, which only the file of a technique can ask for";
        return Err(node.error("bad-slot", message).help(
            "leave the slot out, and write `// @walks pairs` into the technique's file if it may be walked so",
        ));
    }
    Ok(())
}

/// Whether a walk that leaps over bricks goes by spans, which one ray has found for all of a tile: where no ray is bent, as
/// none is that goes in pairs, and bricks are empty by the transfer function alone, whatever a ray has met.
pub(super) fn goes_by_spans(
    node: &NodeContext<'_>,
    walk: &str,
    slots: &BTreeMap<String, String>,
) -> bool {
    let is = |slot: &str, choice: &str| slots.get(slot).is_some_and(|it| it == choice);
    walk == "pairs"
        && is("leap", "bricks")
        && is("look", "distance_map")
        && node.slot("emptiness") == "transfer"
}

/// Whether scalars are read from the texture of gradients, which has both: where each is asked for at the same places. Of other
/// walks not all are known.
pub(super) fn reads_beside_gradients(node: &NodeContext<'_>, walk: &str) -> bool {
    let is_made_so = |writer: NodeContext<'_>| {
        writer.kind_name() == Gradient.name()
            && writer.slot("gradient_storage") == "rgba32f"
            && writer.text("volume_storage") == node.text("volume_storage")
    };
    walk == "pairs"
        && node.writer("gradient_volume").is_none_or(is_made_so)
        && node.slot("gradient_storage") == "rgba32f"
        && asks_beside_gradients(node)
}

/// Whether both are asked for at the same places: others classify at the ends of segments. A volume's texture of the user's
/// own may be stored in another way.
fn asks_beside_gradients(node: &NodeContext<'_>) -> bool {
    let is = |slot: &str, choice: &str| node.slot(slot) == choice;
    node.writer("volume_texture").is_none()
        && is("gradient", "stored")
        && is("technique", "dvr")
        && is("classify", "post")
        && is("light", "phong")
        && is("reconstruct", "trilinear")
}

/// Most bytes of gradients in single floats where nobody has asked for them: those of 256 voxels a side.
const MOST_GRADIENTS: u64 = 256 << 20;

/// Whether gradients in single floats, with scalars beside them, are the faster ones, for twice the memory. How the
/// walk goes, which is another one where layers are asked for, does not change how they are stored.
pub(super) fn gains_beside_gradients(node: &NodeContext<'_>) -> bool {
    let limits = node.limits();
    let bytes = placement::volume(node, "volume")
        .map(|volume| 16 * volume.grid().dims.map(u64::from).iter().product::<u64>());
    limits.float32_filterable
        && limits.float32_fast
        && node.writer("gradient_volume").is_none()
        && bytes.is_ok_and(|bytes| bytes <= MOST_GRADIENTS.min(limits.max_resource_bytes))
        && asks_beside_gradients(node)
}

/// Where a walk has what a step emits and lets through, the choice of the slot `steps`: in a table where one transfer
/// function and one step hold for all of it. Tables of a user's own may be of others.
pub(super) fn steps(node: &NodeContext<'_>, walk: &str) -> &'static str {
    let is_ours = |writer: &NodeContext<'_>| {
        let of = |node: &NodeContext<'_>| transfer_table::transfer(node, "transfer").ok();
        let same = of(writer).zip(of(node));
        writer.uint("table_size") == node.uint("table_size")
            && same.is_some_and(|(theirs, ours)| Arc::ptr_eq(&theirs, &ours))
    };
    let entries = node.writer("transfer_table");
    let steps = node.writer("step_table");
    let is_table_of_step = |writer: &NodeContext<'_>| {
        writer.kind_name() == StepTable.name() && is_of_step(writer, node)
    };
    let is_of_ours = entries.is_none_or(|entries| is_ours(&entries))
        && steps.is_none_or(|steps| is_table_of_step(&steps) && is_ours(&steps));
    if walk == "pairs" && is_of_ours {
        "table"
    } else {
        "computed"
    }
}

/// Whether the table of segments, if there is one, is made for the walk's step: that of a user's own may not be.
fn has_table_of_step(node: &NodeContext<'_>) -> bool {
    node.writer("preintegration_table").is_none_or(|writer| {
        writer.kind_name() == Preintegration::Whole.name() && is_of_step(&writer, node)
    })
}

/// The step that a node was given, which its shader declares.
pub(super) fn step_of(node: &NodeContext<'_>) -> f64 {
    match node.param("step").or_else(|| node.given("step")) {
        Some(ParamValue::Float(step)) => *step,
        #[expect(clippy::cast_precision_loss, reason = "steps are small whole numbers")]
        Some(ParamValue::Int(step)) => *step as f64,
        _ => 1.0,
    }
}

/// Whether two nodes walk by one step.
fn is_of_step(one: &NodeContext<'_>, other: &NodeContext<'_>) -> bool {
    step_of(one).to_bits() == step_of(other).to_bits()
}

/// The members of the uniform `steepness` (see `lib/steepness.wgsl`).
pub(super) fn steepness_uniform(node: &NodeContext<'_>) -> Result<Uniform, Finding> {
    let volume = placement::volume(node, "volume")?;
    let encoding = placement::encoding(node)?;
    let steepest = volume.steepness();
    let span = encoding.range.1 - encoding.range.0;
    // Filters weigh with 8 bits at least, and 8-bit formats may be rounded at each of three turns.
    let weights = steepest.iter().sum::<f64>() * 3.0 / 256.0;
    let texels = if encoding.format == TextureFormat::R8Unorm {
        4.0 * encoding.scale.abs() / 255.0
    } else {
        span / 1024.0
    };
    Ok(vec![
        (
            "per_voxel",
            placement::vec3(DVec3::from_array(steepest) * (1.0 + 1.0e-3)),
        ),
        (
            "error",
            UniformValue::F32((encoding.error + weights + texels) as f32),
        ),
    ])
}
