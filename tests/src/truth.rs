//! The float64 reference of a graph file.

use std::path::Path;

use volgraph::truth::plan_without_device;
use volgraph::{Findings, Truth, TruthOptions, View};
use volgraph_reference::Silent;

use crate::{Stage, load};

/// The truth of a graph file with `--set`s to a tolerance, and its view. It is kept nowhere.
///
/// # Errors
/// What is wrong with the scene, or what of it the reference does not compute.
pub fn truth_of(
    graph: &Path,
    sets: &[&str],
    size: [u32; 2],
    tolerance: f64,
) -> Result<(Truth, View), Findings> {
    let scene = load(graph, sets)?;
    let plan = plan_without_device(&scene, size)?;
    let view = plan.view();
    let how = TruthOptions {
        tolerance,
        cache: None,
    };
    Ok((Truth::of(&plan, &view, &how, &Silent)?, view))
}

/// The same of the file `graph.ron` of a stage, which is covered, to 1e-9.
///
/// # Panics
/// Where it is not covered.
#[must_use]
pub fn truth(stage: &Stage, sets: &[&str], size: [u32; 2]) -> (Truth, View) {
    truth_of(&stage.path().join("graph.ron"), sets, size, 1e-9)
        .unwrap_or_else(|findings| panic!("{findings}"))
}
