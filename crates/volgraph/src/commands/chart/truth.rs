//! What a chart's pictures are held against: the reference, or the graph itself at a very fine step.

use std::sync::Arc;

use volgraph::methods::{Yardstick, fine_method, fine_step, is_uncovered, raycast_node};
use volgraph::{Findings, Plan, Scene, Session, SessionOptions};
use volgraph_gpu::Gpu;

use crate::args::{ChartArgs, TruthChoice};
use crate::commands::reference::Rows;
use crate::output;
use crate::progress::Bars;

/// The truth of a graph's picture, of the kind that is asked for.
pub fn of(
    args: &ChartArgs,
    scene: &Scene,
    gpu: &Arc<Gpu>,
    options: &SessionOptions,
    plan: &Plan,
    bars: &Bars,
) -> Result<Yardstick, Findings> {
    if args.truth == Some(TruthChoice::Fine) {
        return fine(scene, gpu, options, plan);
    }
    let view = plan.view();
    let reference = Yardstick::reference(plan, &view, &args.reference.options(), &Rows(bars));
    match reference {
        Err(findings) if args.truth.is_none() && is_uncovered(&findings) => {
            bars.clear();
            if let Some(finding) = findings.sorted().first() {
                output::note(&format!(
                    "{}; the truth is the same graph at a step of 1/{:.0} voxel",
                    finding.message,
                    1.0 / fine_step(plan)?
                ));
            }
            fine(scene, gpu, options, plan)
        }
        reference => reference,
    }
}

/// The graph at a very fine step.
fn fine(
    scene: &Scene,
    gpu: &Arc<Gpu>,
    options: &SessionOptions,
    plan: &Plan,
) -> Result<Yardstick, Findings> {
    let node = &plan.graph.nodes[raycast_node(plan)?].name;
    let scene = scene.with_sets(&fine_method(plan)?.overrides(node))?;
    let options = SessionOptions {
        is_as_written: true,
        ..options.clone()
    };
    let mut session = Session::start(scene, Arc::clone(gpu), &options)?;
    let (picture, _) = session.render_checked()?;
    Yardstick::fine(plan, &plan.view(), picture)
}
