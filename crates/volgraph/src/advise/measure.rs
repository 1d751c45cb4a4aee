//! Errors of classifications and steps against the float64 reference.

use serde::Serialize;
use volgraph_reference::Progress;
use volgraph_report::Findings;

use super::Advice;
use crate::overrides::ParamOverride;
use crate::scene::{NoProgress, Scene};
use crate::session::{Change, Outcome, Session, SessionOptions};
use crate::truth::{Truth, TruthOptions, plan_without_device};

/// The steps that are measured, voxels.
pub const MEASURED_STEPS: [f64; 5] = [4.0, 2.0, 1.0, 0.5, 0.25];

/// The classifications that are measured: at samples, and integrated.
const CLASSIFY: [&str; 2] = ["post", "preintegrated_2d"];

/// The error of a picture.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Measurement {
    /// The choice of `classify`.
    pub classify: String,
    /// The step, voxels.
    pub step: f64,
    /// Root mean square error of linear premultiplied colours.
    pub rmse: f64,
    /// The largest error.
    pub max: f64,
}

/// Measures a scene on an adapter, in pictures of `options.size`. What the reference does not compute is taken out of the
/// graph (light, clips, labels, other reconstructions), and noted.
///
/// # Errors
/// Where even then there is no reference, or a picture is refused.
pub fn measure(
    advice: &mut Advice,
    scene: &Scene,
    options: &SessionOptions,
    truth_options: &TruthOptions,
    progress: &dyn Progress,
) -> Result<(), Findings> {
    let set = |text: String| {
        ParamOverride::parse(&text)
            .map_err(|message| volgraph_report::Finding::error("internal", message))
    };
    let node = advice.node.clone();
    let mut overrides = scene.overrides.clone();
    let plain = scene.with_overrides(&overrides, &NoProgress)?;
    let mut truth = truth_of(&plain, options.size, truth_options, progress);
    let mut base = plain;
    if truth.is_err() {
        let slots = [
            ("technique", "dvr"),
            ("light", "unlit"),
            ("clip", "none"),
            ("labels", "none"),
            ("reconstruct", "trilinear"),
        ];
        for (slot, choice) in slots {
            overrides
                .params
                .push(set(format!("{node}.slots.{slot}={choice}"))?);
        }
        advice.notes.push(
            "measured as plain direct volume rendering: the reference does not compute the graph's own technique, \
             light or parts"
                .to_owned(),
        );
        base = scene.with_overrides(&overrides, &NoProgress)?;
        truth = truth_of(&base, options.size, truth_options, progress);
    }
    let truth = truth?;
    overrides
        .params
        .push(set(format!("{node}.early_termination=0"))?);
    let base = base.with_overrides(&overrides, &NoProgress)?;
    let gpu = std::sync::Arc::new(volgraph_gpu::Gpu::open(&options.adapter)?);
    let mut session = Session::start(base, gpu, options)?;
    for classify in CLASSIFY {
        for step in MEASURED_STEPS {
            let sets = vec![
                set(format!("{node}.slots.classify={classify}"))?,
                set(format!("{node}.step={step:?}"))?,
            ];
            let picture = match session.apply(&Change::Set(sets)) {
                Ok(Outcome::Drawn(drawn)) => drawn.picture,
                Ok(Outcome::Unchanged) => session.render()?.0,
                Err(refused) => return Err(refused.findings),
            };
            let comparison = truth.compare(&picture)?;
            advice.measured.push(Measurement {
                classify: classify.to_owned(),
                step,
                rmse: comparison.rmse,
                max: comparison.max.error,
            });
        }
    }
    Ok(())
}

fn truth_of(
    scene: &Scene,
    size: [u32; 2],
    options: &TruthOptions,
    progress: &dyn Progress,
) -> Result<Truth, Findings> {
    let plan = plan_without_device(scene, size)?;
    Truth::of(&plan, &plan.view(), options, progress)
}
