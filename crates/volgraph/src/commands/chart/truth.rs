//! What a chart's pictures are held against: the reference, or the graph itself at a very fine step.

use std::sync::Arc;

use volgraph::methods::{FINE_STEP, Method, MethodSpace, Setting, Yardstick, parse_filters};
use volgraph::{Finding, Findings, Plan, Scene, Session, SessionOptions};
use volgraph_gpu::Gpu;
use volgraph_shader::{DiskFiles, ParamValue};

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
    let is_uncovered = |findings: &Findings| {
        let mut findings = findings.into_iter();
        findings.all(|finding| finding.code == "not-covered")
    };
    match reference {
        Err(findings) if args.truth.is_none() && is_uncovered(&findings) => {
            bars.clear();
            if let Some(finding) = findings.sorted().first() {
                output::note(&format!(
                    "{}; the truth is the same graph at a step of 1/{:.0} voxel",
                    finding.message,
                    1.0 / FINE_STEP
                ));
            }
            fine(scene, gpu, options, plan)
        }
        reference => reference,
    }
}

/// The graph at a very fine step, to the end of each ray, its voxels in f32.
fn fine(
    scene: &Scene,
    gpu: &Arc<Gpu>,
    options: &SessionOptions,
    plan: &Plan,
) -> Result<Yardstick, Findings> {
    // What the raycast has of these.
    let roots = scene.shader_roots(Arc::new(DiskFiles));
    let mut settings = Vec::new();
    for (name, value) in [
        ("step", ParamValue::Float(FINE_STEP)),
        ("early_termination", ParamValue::Float(0.0)),
        ("volume_storage", ParamValue::Text("r32float".to_owned())),
    ] {
        let filters = parse_filters(&format!("{name}={value}"))
            .map_err(|why| Findings::from(Finding::error("fine-truth", why)))?;
        let is_own = plan.graph.nodes[volgraph::methods::raycast_node(plan)?]
            .params
            .contains_key(name);
        if is_own && MethodSpace::of(plan, &roots, &scene.registry, &filters).is_ok() {
            settings.push(Setting {
                name: name.to_owned(),
                is_slot: false,
                value,
            });
        }
    }
    let node = &plan.graph.nodes[volgraph::methods::raycast_node(plan)?].name;
    let mut overrides = scene.overrides.clone();
    overrides.params.extend(Method { settings }.overrides(node));
    let scene = scene.with_overrides(&overrides, &volgraph::NoProgress)?;
    let mut session = Session::start(scene, Arc::clone(gpu), options)?;
    let (picture, _) = session.render_checked()?;
    Yardstick::fine(plan, &plan.view(), picture)
}
