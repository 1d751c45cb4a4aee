//! Which segments the technique looks into, and what they are known by.

use std::sync::Arc;

use volgraph_graph::{NodeContext, Uniform};
use volgraph_report::Finding;
use volgraph_shader::UniformValue;
use volgraph_volume::Grid;

use super::tables::table_range;
use super::walk::{MAX_SEGMENTS, longest_ray, step_of};
use crate::{distance_map, placement, segmentation, transfer_table};

/// Intervals that a test in straight line looks through (`AbsorbingFew` in `lib/absorbing_few.wgsl`).
const FEW: usize = 4;

/// Tables that classify, and the parameters of their sizes.
const TABLES: [(&str, &str); 5] = [
    ("transfer_table", "table_size"),
    ("step_table", "table_size"),
    ("preintegration_table", "preintegration_size"),
    ("integral_table", "table_size"),
    ("preintegration_3d_table", "preintegration_3d_size"),
];

/// What a technique's file says that sees only what the transfer function makes absorb.
const ABSORBING: &str = "absorbing";

/// The choice of the slot `heed`; `walk` is that of the slot `walk`, `leaps` is whether the walk leaps over what is not seen.
///
/// Of the trilinear field it is known how much it changes within a segment, so that only those are looked into that may show
/// something: what the technique's file says holds for it. Whoever skips what is not seen lights no segments that absorb
/// nothing either: light costs several times as much as a look at a segment.
pub(super) fn heed(node: &NodeContext<'_>, walk: &str, leaps: bool) -> String {
    // The estimate of the error goes along with every segment.
    if node.is_wanted("error") || placement::is_in_bricks(node) {
        return "all".to_owned();
    }
    let heeds = match node.slot("heed") {
        ABSORBING if leaps => absorbing(node, walk),
        ABSORBING => "all",
        heeds if node.slot("reconstruct") == "trilinear" => heeds,
        _ => "all",
    };
    heeds.to_owned()
}

/// Whether another node is made of the same transfer function as this one.
pub(crate) fn is_of_own_transfer(node: &NodeContext<'_>, other: &NodeContext<'_>) -> bool {
    let [ours, theirs] = [node, other].map(|node| transfer_table::transfer(node, "transfer").ok());
    ours.zip(theirs)
        .is_some_and(|(ours, theirs)| Arc::ptr_eq(&ours, &theirs))
}

/// Whether the tables that classify are made of the node's own transfer function; those of a user's own may be of others.
pub(crate) fn tables_are_own(node: &NodeContext<'_>) -> bool {
    let mut writers = TABLES.iter().filter_map(|(port, _)| node.writer(port));
    writers.all(|writer| is_of_own_transfer(node, &writer))
}

/// Where a segment that absorbs shows that it does.
fn absorbing(node: &NodeContext<'_>, walk: &str) -> &'static str {
    // A walk in segments looks at bricks behind each that is heeded: of light that is a walk itself that is the least.
    let pays = node.slot("light") != "unlit"
        && (walk == "pairs" || !["none", "light_volume"].contains(&node.slot("shadow")));
    // Labels may have transfer functions of their own, and so may tables of the user's own.
    if !pays || segmentation::has_labels(node) || !tables_are_own(node) {
        return "all";
    }
    // Software drivers end loops after so many turns, and a hunt takes up to twice as many as a walk.
    let segments = |grid: &Grid| longest_ray(grid) / (step_of(node) * grid.min_spacing());
    let placed = placement::placed(node, "volume");
    if !placed.is_ok_and(|placed| segments(placed.grid()) < MAX_SEGMENTS / 4.0) {
        return "all";
    }
    match node.slot("classify") {
        "post" => "absorbing_centre",
        // Their scalar runs from one end to the other; the rest look in between.
        "preintegrated_2d" | "preintegrated_3d" | "integral_1d" => "absorbing_ends",
        _ => "all",
    }
}

/// The members of the uniform `absorbing_few` (see `lib/absorbing_few.wgsl`).
///
/// # Errors
/// `missing-input`.
pub(super) fn absorbing_few(node: &NodeContext<'_>) -> Result<Uniform, Finding> {
    let transfer = transfer_table::transfer(node, "transfer")?;
    let (_, span) = table_range(node, &transfer)?;
    // What is between two entries of a table is made of both.
    let size = |(port, size): &(&str, &str)| {
        let writer = node.writer(port)?;
        writer.param(size).map(|_| writer.uint(size))
    };
    let entries = TABLES.iter().filter_map(size).min().unwrap_or(3).max(3);
    // The fewest cells that a table of so many entries has.
    let entry = span / f64::from(entries - 2);
    let mut intervals = distance_map::absorbing(node)?;
    distance_map::join_nearest(&mut intervals, FEW);
    let end = |at: usize, is_high: bool| match intervals.get(at) {
        Some((_, high)) if is_high => high + entry,
        Some((low, _)) => low - entry,
        None if is_high => f64::MIN,
        None => f64::MAX,
    };
    #[expect(clippy::cast_possible_truncation, reason = "shaders compute in f32")]
    let ends = |is_high| {
        let ends = std::array::from_fn(|at| {
            end(at, is_high).clamp(f64::from(f32::MIN), f64::from(f32::MAX)) as f32
        });
        UniformValue::Vec4(ends)
    };
    Ok(vec![("low", ends(false)), ("high", ends(true))])
}
