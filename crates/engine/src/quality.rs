//! Model no more than a scene needs: the method that a graph's budget asks for.
//!
//! A graph that states `quality: budget(rmse: 0.002)` or `budget(time_ms: 40)` leaves the method of its raycast to
//! volgraph. [`choose`] draws small views by each way to classify, finds the longest step that keeps the error against
//! the float64 reference (`calibrate`), times what is left at the picture's own size, and takes the fastest, with a step
//! that keeps the error in a sample of the picture itself as well; or, in a given time, the most accurate. What is chosen
//! is kept on disk under the digest of all that it depends on, the adapter included. What the user sets by name (`--set`)
//! is held as it is. [`achieved`] says how wrong a picture then is, by the reference of a sample of its pixels.

mod calibrate;
mod keep;
mod search;
mod trial;

use std::fmt;
use std::sync::Arc;

use serde::Serialize;
use volgraph_gpu::Gpu;
use volgraph_graph::{Budget, Plan, View};
use volgraph_nodes::reference::raycast_scene;
use volgraph_picture::Picture;
use volgraph_report::Findings;

use crate::methods::{Method, TruthKind, draws_the_same, raycast_node};
use crate::overrides::ParamOverride;
use crate::renderer::{self, is_software};
use crate::scene::Scene;
use crate::session::SessionOptions;

/// What was chosen for a budget.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Chosen {
    /// The budget.
    pub budget: Budget,
    /// The raycast's name.
    pub node: String,
    /// Its settings.
    pub method: Method,
    /// The largest root mean square error of linear premultiplied colours of three small views; of an error budget also of
    /// a sample of the picture itself.
    pub predicted_rmse: f64,
    /// The median time of a frame of the picture's size, in milliseconds, when it was chosen.
    pub predicted_ms: f64,
    /// Whether the budget can be kept; where it cannot, this is what comes nearest.
    pub is_met: bool,
    /// What the small views were held against.
    pub truth: TruthKind,
    /// Methods that were drawn.
    pub tried: usize,
    /// Whether it was chosen before and kept.
    pub is_kept: bool,
    /// Settings of the method that were set by name since, and hold: what was predicted is then not what is drawn.
    pub overruled: Vec<String>,
}

impl Chosen {
    /// The same choice where these are set by name.
    pub(crate) fn overruled_by(&self, sets: &[ParamOverride]) -> Self {
        let own = self.method.overrides(&self.node).into_iter();
        // What it set itself is among them.
        let by_another = |own: &ParamOverride| {
            let mut sets = sets.iter();
            sets.any(|set| set.sets_the_same(own) && set.value != own.value)
        };
        Self {
            overruled: own.filter(by_another).map(|own| own.name).collect(),
            ..self.clone()
        }
    }
}

impl fmt::Display for Chosen {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.budget {
            Budget::Rmse(rmse) => write!(f, "budget of rmse {rmse}: ")?,
            Budget::TimeMs(time) => write!(f, "budget of {time} ms: ")?,
        }
        let unmet = if self.is_met {
            ""
        } else {
            " (the nearest there is)"
        };
        write!(f, "{}{unmet}; ", self.method)?;
        if !self.overruled.is_empty() {
            let names = self.overruled.join(", ");
            return write!(
                f,
                "set by name since, so that nothing is predicted: {names}"
            );
        }
        write!(
            f,
            "predicted rmse {:.2e} in {:.1} ms",
            self.predicted_rmse, self.predicted_ms
        )
    }
}

/// Chooses the method that a scene's budget asks for; `None` where it states none, or all that could be chosen is set by
/// name.
///
/// # Errors
/// What is wrong with the scene; `no-raycast` where its picture is none of a raycast.
pub fn choose(
    scene: &Scene,
    gpu: &Arc<Gpu>,
    options: &SessionOptions,
) -> Result<Option<Chosen>, Findings> {
    let Some(desc) = &scene.desc.quality else {
        return Ok(None);
    };
    let shaders = scene.shader_library(gpu.capabilities());
    let plan = scene.plan(&shaders, &options.limits(gpu), options.size, false)?;
    let node = plan.graph.nodes[raycast_node(&plan)?].name.clone();
    let digest = keep::digest(scene, &plan, &shaders, gpu, desc.budget);
    let file = options
        .cache
        .as_ref()
        .map(|folder| folder.join("quality").join(format!("{digest}.json")));
    if let Some(kept) = file.as_deref().and_then(keep::read) {
        return Ok(Some(kept.chosen(desc.budget, node)));
    }
    let chosen = calibrate::calibrate(scene, gpu, options, &plan, &node, desc.budget);
    // What was only tried has filled it.
    scene.registry.forget();
    let chosen = chosen?;
    // What cannot be kept is chosen again next time; so is what may have been too slow for another's load alone.
    let is_lasting = |chosen: &&Chosen| chosen.is_met || matches!(chosen.budget, Budget::Rmse(_));
    if let (Some(file), Some(chosen)) = (file, chosen.as_ref().filter(is_lasting)) {
        let _ = keep::write(&file, chosen);
    }
    Ok(chosen)
}

/// A scene with the method that its budget asks for. A budget that was settled before is settled as it was: while people
/// edit, the method stays.
pub(crate) fn settle(
    scene: Scene,
    gpu: &Arc<Gpu>,
    options: &SessionOptions,
    before: Option<&Chosen>,
) -> Result<(Scene, Option<Chosen>), Findings> {
    let Some(desc) = scene
        .desc
        .quality
        .as_ref()
        .filter(|_| !options.is_as_written)
    else {
        return Ok((scene, None));
    };
    let same_budget = before.filter(|before| before.budget == desc.budget);
    let chosen = match same_budget {
        Some(before) if still_draws(before, &scene, gpu, options)? => {
            Some(before.overruled_by(&scene.overrides.params))
        }
        _ => choose(&scene, gpu, options)?,
    };
    let Some(chosen) = chosen else {
        return Ok((scene, None));
    };
    // What is set by name holds, that of an earlier choice as well.
    let mut method = chosen.method.overrides(&chosen.node);
    let known = &scene.overrides.params;
    method.retain(|set| known.iter().all(|known| !known.sets_the_same(set)));
    Ok((scene.with_sets(&method)?, Some(chosen)))
}

/// Whether what was chosen draws what the scene is now: the software raycaster draws less than a device does.
fn still_draws(
    before: &Chosen,
    scene: &Scene,
    gpu: &Arc<Gpu>,
    options: &SessionOptions,
) -> Result<bool, Findings> {
    let Some(node) = scene.desc.nodes.get(&before.node) else {
        return Ok(false);
    };
    if !before.method.is_software() {
        return Ok(true);
    }
    if !renderer::may_take_over(&before.node, node, &scene.overrides.params) {
        return Ok(false);
    }
    let shaders = scene.shader_library(gpu.capabilities());
    let plan = scene.plan(&shaders, &options.limits(gpu), options.size, false)?;
    let mut nodes = plan.graph.nodes.iter();
    let id = nodes.position(|node| node.name == before.node);
    Ok(id.is_some_and(|id| is_software(&node.kind) || draws_the_same(&plan, id)))
}

/// Most pixels of a picture that are held against the reference to say what was achieved.
const SAMPLED: usize = 4096;

/// The root mean square error of linear premultiplied colours of a picture, over a sample of its pixels, and how many
/// those are. `None` where the reference does not compute what the graph draws.
#[must_use]
pub fn achieved(plan: &Plan, view: &View, picture: &Picture) -> Option<(f64, usize)> {
    let sample = Sample::of(plan, view, 1e-6)?;
    Some((sample.rmse(picture), sample.pixels.len()))
}

/// Some pixels of a view, and what they should be.
struct Sample {
    pixels: Vec<[u32; 2]>,
    colors: Vec<[f64; 4]>,
}

impl Sample {
    /// To a tolerance; `None` where the reference does not compute what the graph draws.
    fn of(plan: &Plan, view: &View, tolerance: f64) -> Option<Self> {
        let node = raycast_node(plan).ok()?;
        let scene = raycast_scene(&plan.context(node, view, None), view).ok()?;
        let [width, height] = view.size;
        let pixels = sample(width, height);
        let colors = volgraph_reference::render_pixels(&scene, &pixels, tolerance).ok()?;
        Some(Self { pixels, colors })
    }

    /// The error of a picture of that view.
    fn rmse(&self, picture: &Picture) -> f64 {
        let mut squares = 0.0;
        for ([x, y], truth) in self.pixels.iter().zip(&self.colors) {
            let drawn = picture.color[*y as usize * picture.width as usize + *x as usize];
            let errors = drawn.iter().zip(truth).map(|(a, b)| f64::from(*a) - b);
            squares += errors.map(|error| error * error).sum::<f64>();
        }
        (squares / (4 * self.pixels.len().max(1)) as f64).sqrt()
    }
}

/// Pixels of a picture, spread evenly: all of a small one, else the points of a lattice that repeats nowhere (the
/// additive recurrence of the plastic number).
fn sample(width: u32, height: u32) -> Vec<[u32; 2]> {
    let all = width as usize * height as usize;
    if all <= SAMPLED {
        return (0..height)
            .flat_map(|y| (0..width).map(move |x| [x, y]))
            .collect();
    }
    let plastic: f64 = 1.324_717_957_244_746;
    let (across, down) = (plastic.recip(), plastic.powi(-2));
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a share of the picture's sides"
    )]
    let place = |at: usize| {
        let share =
            |step: f64, side: u32| ((0.5 + at as f64 * step).fract() * f64::from(side)) as u32;
        [share(across, width), share(down, height)]
    };
    (0..SAMPLED).map(place).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sample_is_of_the_picture_and_even() {
        assert_eq!(
            sample(3, 2),
            [[0, 0], [1, 0], [2, 0], [0, 1], [1, 1], [2, 1]]
        );
        let pixels = sample(640, 480);
        assert_eq!(pixels.len(), SAMPLED);
        // Of 16 parts of the picture each has its share.
        let mut counts = [0; 16];
        for [x, y] in pixels {
            counts[(x / 160 + 4 * (y / 120)) as usize] += 1;
        }
        assert!(
            counts.iter().all(|count| (240..=272).contains(count)),
            "{counts:?}"
        );
    }
}
