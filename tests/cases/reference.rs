//! The float64 reference itself: against closed forms, against the harness's own float64, against fine steps.

mod closed;
mod orders;
mod ready;

use std::path::Path;

use volgraph::truth::plan_without_device;
use volgraph::{Findings, NoProgress, Scene, Truth, TruthOptions, View};
use volgraph_reference::Silent;
use volgraph_tests::options;

/// The truth of a graph file with `--set`s, to 1e-9, and its view.
fn truth_of(graph: &Path, sets: &[&str], size: [u32; 2]) -> Result<(Truth, View), Findings> {
    let options = options(sets, "vulkan", size);
    let scene = Scene::load(
        graph,
        &options.overrides,
        &options.shader_folders,
        volgraph::registry(),
        &NoProgress,
    )?;
    let plan = plan_without_device(&scene, size)?;
    let view = plan.view();
    let how = TruthOptions {
        tolerance: 1e-9,
        cache: None,
    };
    Ok((Truth::of(&plan, &view, &how, &Silent)?, view))
}

/// The same of the file `graph.ron` of a stage, which is covered.
fn truth(stage: &volgraph_tests::Stage, sets: &[&str], size: [u32; 2]) -> (Truth, View) {
    truth_of(&stage.path().join("graph.ron"), sets, size)
        .unwrap_or_else(|findings| panic!("{findings}"))
}
