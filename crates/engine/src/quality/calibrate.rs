//! Drawing small views to find the method for a budget.
//!
//! For each way to classify, on the device and by the software raycaster, the longest step that keeps an error budget is
//! searched (`search`), or the step that fills a time; those that are inside race each other, and the one that wins keeps
//! the error in the picture itself. Storages of the volume are only tried with the way that came out best, from its step
//! on. A time that is promised is measured once more, at the picture's own size.

use std::sync::Arc;

use volgraph_gpu::Gpu;
use volgraph_graph::{Budget, Plan};
use volgraph_report::{Finding, Findings};
use volgraph_shader::ParamValue;

use super::search::{self, COARSEST};
use super::trial::{Entrant, SHARE, STEP, Trial, Way};
use super::{Chosen, Sample};
use crate::methods::{Axis, MethodSpace};
use crate::renderer::{RENDERER, SOFTWARE};
use crate::scene::Scene;
use crate::session::SessionOptions;

/// What is varied beside the step.
const CLASSIFY: &str = "classify";
const STORAGE: &str = "volume_storage";

/// The share of a time budget that is planned with.
const TIME_SHARE: f64 = 0.9;

/// A way is not followed to steps shorter by more octaves than this than those of another that is inside: no segment
/// costs so many times less.
const OCTAVES_BEHIND: i32 = 3;

/// How often a promised time is measured until it is kept and used.
const ATTEMPTS: usize = 5;

/// So many methods are held against the picture itself, at most.
const MOST_HELD: usize = 6;

/// A time budget is used where a frame takes at least this share of it.
const USED: f64 = 0.75;

pub(super) fn calibrate(
    scene: &Scene,
    gpu: &Arc<Gpu>,
    options: &SessionOptions,
    plan: &Plan,
    node: &str,
    budget: Budget,
) -> Result<Option<Chosen>, Findings> {
    let shaders = scene.shader_library(gpu.capabilities());
    let space = MethodSpace::of(plan, shaders.roots(), &scene.registry, &[])?;
    // What is set by name is held.
    let is_held = |name: &str| {
        let mut sets = scene.overrides.params.iter();
        sets.any(|set| set.target == node && set.name == name)
    };
    let axis = |name: &str| {
        let mut axes = space.axes.iter();
        axes.find(|axis| axis.name == name && !axis.is_software && !is_held(name))
    };
    let (classify, storage) = (axis(CLASSIFY), axis(STORAGE));
    let has_step = axis(STEP).is_some();
    if classify.is_none() && storage.is_none() && !has_step {
        return Ok(None);
    }
    let mut trial = Trial::new(scene, gpu, options, node, budget, has_step)?;
    let base = own(&Way::default(), storage);
    let mut ways: Vec<Way> = match classify {
        Some(axis) => axis.values.iter().map(|it| base.with(axis, it)).collect(),
        None => vec![base],
    };
    // What is set of the raycast by name is not the software raycaster's.
    if [CLASSIFY, "traverse", RENDERER]
        .iter()
        .all(|name| !is_held(name))
    {
        ways.extend(software_ways(&space));
    }
    let start = trial.finest_step().max(1.0);
    let found = entrants(&mut trial, ways, start, budget);
    let mut best = winner(&mut trial, found, budget)?;
    if let Some(axis) = storage.filter(|_| !best.way.is_software()) {
        let others = axis.values.iter().enumerate();
        let others = others.filter(|(at, _)| *at != axis.base);
        let ways = others.map(|(_, value)| best.way.with(axis, value));
        let ways: Vec<Way> = ways.collect();
        let step = best.step.unwrap_or(start);
        let mut found = entrants(&mut trial, ways, step, budget);
        // In turn with the best so far: times of different minutes do not compare.
        found.push(best);
        best = winner(&mut trial, found, budget)?;
    }
    best = match budget {
        Budget::Rmse(most) => keep_error(&mut trial, best, most)?,
        Budget::TimeMs(most) => keep_time(&mut trial, best, most)?,
    };
    let is_met = match budget {
        Budget::Rmse(rmse) => best.rmse <= rmse,
        Budget::TimeMs(time) => best.ms <= time,
    };
    Ok(Some(Chosen {
        budget,
        node: node.to_owned(),
        method: best.way.method(best.step),
        predicted_rmse: best.rmse,
        predicted_ms: best.ms,
        is_met,
        truth: trial.kind(),
        tried: trial.tried,
        is_kept: false,
        overruled: Vec::new(),
    }))
}

/// The ways of the software raycaster, where it draws the same picture.
fn software_ways(space: &MethodSpace) -> Vec<Way> {
    let axis = |name: &str, is_software: bool| {
        let mut axes = space.axes.iter();
        axes.find(|axis| axis.name == name && axis.is_software == is_software)
    };
    let software = ParamValue::Text(SOFTWARE.to_owned());
    let (Some(renderer), Some(classify)) = (axis(RENDERER, false), axis(CLASSIFY, true)) else {
        return Vec::new();
    };
    let values = classify.values.iter();
    let base = Way::default().with(renderer, &software);
    values.map(|value| base.with(classify, value)).collect()
}

/// A way with the graph's own value of an axis, by name.
fn own(way: &Way, axis: Option<&Axis>) -> Way {
    match axis {
        Some(axis) => way.with(axis, &axis.values[axis.base]),
        None => way.clone(),
    }
}

/// Of each way what the budget asks for; ways that the scene refuses are left out.
fn entrants(trial: &mut Trial, ways: Vec<Way>, step: f64, budget: Budget) -> Vec<Entrant> {
    let mut found: Vec<Entrant> = Vec::new();
    let mut finest = trial.finest;
    for way in ways {
        let entered = trial.enter(way, step).and_then(|mut entrant| {
            match budget {
                Budget::Rmse(rmse) => longest_step(trial, &mut entrant, finest, SHARE * rmse)?,
                Budget::TimeMs(time) => {
                    entrant = step_in_time(trial, entrant, TIME_SHARE * time)?;
                }
            }
            Ok(entrant)
        });
        match entered {
            Ok(mut entrant) => {
                if let (Budget::Rmse(rmse), Some(step)) = (budget, entrant.step)
                    && entrant.rmse <= SHARE * rmse
                {
                    finest = finest.max(search::rung(step) - 4 * OCTAVES_BEHIND);
                }
                trial.rest(&mut entrant, &found);
                found.push(entrant);
            }
            Err(findings) => trial.refused.push(findings),
        }
    }
    found
}

/// The best of what was found. Of an error budget only those race that are inside; where none is, the nearest is taken.
fn winner(trial: &mut Trial, mut found: Vec<Entrant>, budget: Budget) -> Result<Entrant, Findings> {
    if let Budget::Rmse(rmse) = budget {
        let least = found.iter().map(|it| it.rmse).fold(f64::INFINITY, f64::min);
        let most = least.max(SHARE * rmse);
        found.retain(|it| it.rmse <= most);
    }
    trial.race(found, budget).ok_or_else(|| {
        let refused = trial.refused.drain(..).next();
        refused.unwrap_or_else(|| Finding::error("quality", "no method can draw this graph").into())
    })
}

/// Gives an entrant the longest step whose error is at most `most`; the finest that was tried where none is.
fn longest_step(
    trial: &mut Trial,
    entrant: &mut Entrant,
    finest: i32,
    most: f64,
) -> Result<(), Findings> {
    let Some(start) = entrant.step else {
        return trial.measure(entrant).map(drop);
    };
    let found = search::longest(search::rung(start), finest, most, |rung| {
        trial.set_step(entrant, search::step(rung))?;
        trial.measure(entrant)
    })?;
    trial.set_step(entrant, search::step(found.rung))?;
    entrant.rmse = found.rmse;
    Ok(())
}

/// Gives an entrant the step with which a frame should take `most` milliseconds.
fn step_in_time(trial: &mut Trial, mut entrant: Entrant, most: f64) -> Result<Entrant, Findings> {
    if trial.has_step {
        let finest = trial.finest_step();
        let first = finest.max(1.0);
        let mut timed = [(first, 0.0), (4.0 * first, 0.0)];
        for (step, ms) in &mut timed {
            trial.set_step(&mut entrant, *step)?;
            entrant = trial.time(entrant, false)?;
            *ms = entrant.ms;
        }
        let [fine, coarse] = timed;
        trial.set_step(
            &mut entrant,
            search::step_in_time(fine, coarse, most, finest),
        )?;
    }
    trial.measure(&mut entrant)?;
    Ok(entrant)
}

/// Holds the picture itself against the reference, since small views may miss where most of its error is. What is not
/// inside gets a shorter step. Where that does not help (a floor: tables, storage), and where it makes it slower than
/// others, those that lost the race take their turn; the fastest that is inside is taken, and where none is, the nearest.
/// What the reference does not compute is left as it is.
fn keep_error(trial: &mut Trial, best: Entrant, most: f64) -> Result<Entrant, Findings> {
    let mut best = best;
    let Some(sample) = trial.sample(&mut best)? else {
        return Ok(best);
    };
    let (mut kept, mut nearest): (Option<Entrant>, Option<Entrant>) = (None, None);
    let mut next = Some(best);
    for _ in 0..MOST_HELD {
        let Some(entrant) = next else { break };
        match shortened(trial, &sample, entrant, most) {
            Ok(entrant) if entrant.rmse <= most => {
                if kept.as_ref().is_none_or(|kept| entrant.ms < kept.ms) {
                    kept = Some(entrant);
                }
            }
            Ok(entrant) => {
                if nearest.as_ref().is_none_or(|it| entrant.rmse < it.rmse) {
                    nearest = Some(entrant);
                }
            }
            Err(findings) => trial.refused.push(findings),
        }
        let faster_than = kept.as_ref().map_or(f64::INFINITY, |kept| kept.ms);
        next = trial.next_best(SHARE * most, faster_than);
    }
    kept.or(nearest)
        .ok_or_else(|| trial.refused.pop().unwrap_or_default())
}

/// The same entrant with the first step that keeps the error in a sample of the picture, as long as shorter steps help.
fn shortened(
    trial: &mut Trial,
    sample: &Sample,
    mut entrant: Entrant,
    most: f64,
) -> Result<Entrant, Findings> {
    // A shorter step is not worse in the small views either.
    let (predicted, ms) = (entrant.rmse, entrant.ms);
    let Some(step) = entrant.step else {
        let rmse = sample.rmse(&trial.picture(&mut entrant)?);
        entrant.rmse = predicted.max(rmse);
        return Ok(entrant);
    };
    let finest = trial.finest_step();
    let (found, rmse) = search::shortened(step, finest, most, SHARE, |step| {
        trial.set_step(&mut entrant, step)?;
        Ok::<_, Findings>(sample.rmse(&trial.picture(&mut entrant)?))
    })?;
    if found == step {
        entrant.ms = ms;
    } else {
        entrant = trial.time(entrant, false)?;
    }
    entrant.rmse = predicted.max(rmse);
    Ok(entrant)
}

/// Measures the time of a frame at the picture's own size, and changes the step until the time is kept and used.
fn keep_time(trial: &mut Trial, mut best: Entrant, most: f64) -> Result<Entrant, Findings> {
    let bounds = [trial.finest_step(), search::step(COARSEST)];
    // The shortest step that kept the time.
    let mut kept: Option<(f64, f64)> = None;
    for _ in 0..ATTEMPTS {
        best = trial.time(best, true)?;
        let Some(step) = best.step else { break };
        if best.ms <= most && kept.is_none_or(|(known, _)| step < known) {
            kept = Some((step, best.ms));
        }
        let next = (step * best.ms / (TIME_SHARE * most)).clamp(bounds[0], bounds[1]);
        let is_used = best.ms >= USED * most;
        if (best.ms <= most && is_used) || next == step {
            break;
        }
        trial.set_step(&mut best, next)?;
    }
    // The last step that was set may not have been timed.
    match kept {
        Some((step, ms)) => {
            trial.set_step(&mut best, step)?;
            best.ms = ms;
        }
        None => best = trial.time(best, true)?,
    }
    trial.measure(&mut best)?;
    Ok(best)
}
