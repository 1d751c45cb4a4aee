//! Which segments the technique looks into, and what they are known by.

use volgraph_graph::{NodeContext, Uniform};
use volgraph_report::Finding;
use volgraph_shader::UniformValue;

use super::tables::table_range;
use crate::{distance_map, placement, segmentation, transfer_table};

/// Intervals that a test in straight line looks through (`AbsorbingFew` in `lib/absorbing_few.wgsl`).
const FEW: usize = 4;

/// What a technique's file says that sees only what the transfer function makes absorb.
const ABSORBING: &str = "absorbing";

/// The choice of the slot `heed`; `leaps` is whether the walk leaps over what is not seen.
///
/// Of the trilinear field it is known how much it changes within a segment, so that only those are looked into that may show
/// something: what the technique's file says holds for it. Whoever skips what is not seen lights no segments that absorb
/// nothing either: light costs several times as much as a look at a segment.
pub(super) fn heed(node: &NodeContext<'_>, leaps: bool) -> String {
    // The estimate of the error goes along with every segment.
    if node.is_wanted("error") || placement::is_in_bricks(node) {
        return "all".to_owned();
    }
    let heeds = match node.slot("heed") {
        ABSORBING if leaps => absorbing(node),
        ABSORBING => "all",
        heeds if node.slot("reconstruct") == "trilinear" => heeds,
        _ => "all",
    };
    heeds.to_owned()
}

/// Where a segment that absorbs shows that it does.
fn absorbing(node: &NodeContext<'_>) -> &'static str {
    // Labels may have transfer functions of their own.
    if node.slot("light") == "unlit" || segmentation::has_labels(node) {
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
    let sizes = [
        "table_size",
        "preintegration_size",
        "preintegration_3d_size",
    ];
    let sizes = sizes.map(|size| node.param(size).map_or(u32::MAX, |_| node.uint(size)));
    let entries = sizes.into_iter().min().unwrap_or(2).max(2);
    let entry = span / f64::from(entries - 1);
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
