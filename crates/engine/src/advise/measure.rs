//! Errors of classifications and steps against the float64 reference.

use std::sync::Arc;

use serde::Serialize;
use volgraph_gpu::Gpu;
use volgraph_reference::Progress;
use volgraph_report::{Finding, Findings};

use super::Advice;
use crate::overrides::{Overrides, ParamOverride};
use crate::scene::Scene;
use crate::session::{Session, SessionOptions};
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

/// Parameters that say how a ray is walked and classified, and not what is drawn.
const WALK: [&str; 8] = [
    "stage",
    "step",
    "early_termination",
    "table_size",
    "preintegration_size",
    "preintegration_built_on",
    "volume_storage",
    "preintegration_3d_size",
];

/// Measures a scene on an adapter, in pictures of `options.size`. What the reference does not compute is taken out of the
/// graph (technique, light, clips, labels, other reconstructions), and noted; where even then there is no reference, the
/// note says so, and nothing is measured.
///
/// # Errors
/// What ended the reference, or refused a picture.
pub fn measure(
    advice: &mut Advice,
    scene: &Scene,
    options: &SessionOptions,
    truth_options: &TruthOptions,
    progress: &dyn Progress,
) -> Result<(), Findings> {
    let plan = plan_without_device(scene, options.size)?;
    let has = |param: &str| {
        let mut nodes = plan.graph.nodes.iter();
        let node = nodes.find(|node| node.name == advice.node);
        node.is_some_and(|node| node.specs().iter().any(|spec| spec.name == param))
    };
    let nothing = if advice.transfer.is_none() {
        Some(advice.no_rule())
    } else if !has("step") {
        Some("it has no step to choose")
    } else {
        None
    };
    if let Some(why) = nothing {
        advice.notes.push(format!("nothing is measured: {why}"));
        return Ok(());
    }
    // A kind that ends no ray early has nothing to switch off.
    let whole_rays = has("early_termination").then(|| "early_termination=0".to_owned());
    let as_it_is = altered(scene, &advice.node, &[], false)?;
    let mut truth = truth_of(&as_it_is, options.size, truth_options, progress);
    let is_plain = truth.is_err();
    if is_plain {
        let plain = altered(scene, &advice.node, &[], true)?;
        truth = truth_of(&plain, options.size, truth_options, progress);
        advice.notes.push(
            "measured as plain direct volume rendering: the reference does not compute the graph's own technique, \
             light or parts"
                .to_owned(),
        );
    }
    let truth = match truth {
        Ok(truth) => truth,
        Err(findings) => {
            let why = findings.sorted().first().map(|it| it.message.clone());
            let why = why.unwrap_or_default();
            advice.notes = vec![format!(
                "nothing is measured, as there is no reference: {why}"
            )];
            return Ok(());
        }
    };
    let options = &SessionOptions {
        is_as_written: true,
        ..options.clone()
    };
    let gpu = Arc::new(Gpu::open(&options.adapter)?);
    for classify in CLASSIFY {
        for step in MEASURED_STEPS {
            let mut sets = vec![
                format!("slots.classify={classify}"),
                format!("step={step:?}"),
            ];
            sets.extend(whole_rays.clone());
            let scene = altered(scene, &advice.node, &sets, is_plain)?;
            let picture = Session::start(scene, Arc::clone(&gpu), options)?
                .render()?
                .0;
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

/// The scene with these settings of a node, which shares its sources; as plain direct volume rendering where asked for.
fn altered(scene: &Scene, node: &str, sets: &[String], is_plain: bool) -> Result<Scene, Findings> {
    let mut desc = scene.desc.clone();
    let mut all: Vec<String> = Vec::new();
    if is_plain {
        if let Some(node) = desc.nodes.get_mut(node) {
            node.params.retain(|name, _| WALK.contains(&name.as_str()));
            node.slots.retain(|slot, _| slot == "classify");
        }
        all.extend([
            "slots.technique=dvr".to_owned(),
            "slots.light=unlit".to_owned(),
        ]);
    }
    all.extend_from_slice(sets);
    let params: Result<Vec<ParamOverride>, String> = all
        .iter()
        .map(|set| ParamOverride::parse(&format!("{node}.{set}")))
        .collect();
    let overrides = Overrides {
        params: params.map_err(|message| Finding::error("internal", message))?,
        ..Overrides::default()
    };
    overrides.apply(&mut desc)?;
    Ok(Scene {
        path: scene.path.clone(),
        text: scene.text.clone(),
        desc,
        overrides: scene.overrides.clone(),
        sources: scene.sources.clone(),
        registry: scene.registry.clone(),
        shader_folders: scene.shader_folders.clone(),
        data: scene.data.clone(),
    })
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
