//! Halving the step.

use volgraph_measure::Convergence;
use volgraph_picture::Picture;
use volgraph_reference::{Progress, Rendered};
use volgraph_report::Findings;

use super::errors::{Look, Measured};
use super::{
    Against, Axis, Declared, OrdersOptions, Quantity, SceneLimit, Study, Target, Tell, Untold,
    Verdict, integral_truth, slot_settings,
};
use crate::{Change, Outcome, ParamOverride, Session};

/// Of numbers in f32 as large as 1, after some hundred roundings.
const ROUNDING: f64 = 1.5e-7;

/// A chosen study has at least so many points above its floor, if steps as coarse as that still make sense.
const WANTED_POINTS: usize = 4;

/// More than this share of pixels in which only one picture has a surface is told.
const MANY_ONE_SIDED: f64 = 0.02;

/// Draws with some settings.
pub(super) fn draw(session: &mut Session, sets: Vec<ParamOverride>) -> Result<Picture, Findings> {
    match session.apply(&Change::Set(sets)) {
        Ok(Outcome::Drawn(drawn)) => Ok(drawn.picture),
        Ok(Outcome::Unchanged) => Ok(session.render_checked()?.0),
        Err(refused) => Err(refused.findings),
    }
}

/// Rows of a reference, told.
struct Rows<'t>(Tell<'t>);

impl Progress for Rows<'_> {
    fn rows(&self, done: usize, total: usize) -> bool {
        (self.0)("computing the reference", done as u64, total as u64);
        true
    }
}

/// The truth of what a session draws now with some settings, or what the reference does not compute.
pub(super) fn truth(
    session: &Session,
    sets: &[ParamOverride],
    options: &OrdersOptions,
    tell: Tell<'_>,
) -> Result<Result<Rendered, String>, Findings> {
    let (scene, view) = (session.scene(), session.view());
    let mut settings = slot_settings(scene, &options.stands_for);
    settings.extend(sets.iter().cloned());
    match integral_truth(scene, view, &settings, &options.truth, &Rows(tell)) {
        Ok(truth) => Ok(Ok(truth.rendered)),
        Err(findings) => {
            let not_covered = (&findings)
                .into_iter()
                .find(|finding| finding.code == "not-covered");
            match not_covered {
                Some(finding) => Ok(Err(finding.message.clone())),
                None => Err(findings),
            }
        }
    }
}

/// Looks at one step after the other, and what they are held against.
pub(super) struct Course {
    pub steps: Vec<f64>,
    pub looks: Vec<Look>,
    /// The truth, or what stands in for it; each is held against the next where it is `None`.
    pub truth: Option<Look>,
    /// What the errors are taken against, in words.
    pub against: Against,
    pub is_surface: bool,
}

impl Course {
    /// The errors of each step, and the share of one-sided pixels of the last. Without a truth the finest is only held
    /// against.
    pub(super) fn errors(&self) -> (Vec<Vec<Measured>>, f64) {
        let mut one_sided = 0.0;
        let mut held = |a: &Look, b: &Look| {
            let (errors, share) = a.errors(b, self.is_surface);
            one_sided = share;
            errors
        };
        let errors = match &self.truth {
            Some(truth) => self.looks.iter().map(|look| held(look, truth)).collect(),
            None => self
                .looks
                .windows(2)
                .map(|pair| held(&pair[0], &pair[1]))
                .collect(),
        };
        (errors, one_sided)
    }

    /// The convergence of one quantity of the first picture's; without points where that has none.
    fn convergence(&self, errors: &[Vec<Measured>], name: &str, highest: f64) -> Convergence {
        let of_name = |step: &Vec<Measured>| step.iter().find(|it| it.name == name).copied();
        let measured: Vec<Measured> = errors.iter().map_while(of_name).collect();
        let scale = measured.last().map_or(1.0, |last| last.scale);
        let values: Vec<f64> = measured.iter().map(|it| it.error).collect();
        Convergence::of(
            &self.steps[..values.len()],
            &values,
            ROUNDING * scale,
            highest * scale,
        )
    }

    /// All quantities, that named `of` held against what is declared: also where it is in no picture. Where
    /// pictures that are held against each other are all the same, nothing was tested, and all is untold.
    pub(super) fn quantities(
        &self,
        declared: (Option<Declared>, &'static str),
        limits: &[SceneLimit],
        options: &OrdersOptions,
    ) -> (Vec<Quantity>, f64) {
        let (errors, one_sided) = self.errors();
        let (declared, of) = declared;
        let is_next = matches!(self.against, Against::Next { .. });
        let is_still = is_next && errors.iter().flatten().all(|it| it.error == 0.0);
        let limit = limits
            .iter()
            .map(|it| it.order)
            .fold(f64::INFINITY, f64::min);
        let of_quantity = |name| {
            let convergence = self.convergence(&errors, name, options.highest_floor);
            let declared = declared.clone().filter(|_| name == of);
            if convergence.points.is_empty() && declared.is_none() {
                return None;
            }
            let expected = declared.as_ref().map(|it| it.order.min(limit));
            let untold = Untold::of(&convergence, is_next);
            let verdict = if is_still {
                Verdict::Untold
            } else {
                Verdict::of(&convergence, untold, expected, options.tolerance)
            };
            Some(Quantity {
                name,
                verdict,
                untold,
                convergence,
                declared,
                expected,
            })
        };
        let quantities = ["colour", "depth", "normal"];
        (
            quantities.into_iter().filter_map(of_quantity).collect(),
            one_sided,
        )
    }
}

/// What a reader should know of pictures in which surfaces are not where those of the truth are.
pub(super) fn note_one_sided(share: f64) -> Option<String> {
    (share > MANY_ONE_SIDED).then(|| {
        format!(
            "in {:.1} % of the pixels only one of the finest picture and what it is held against has a surface",
            100.0 * share
        )
    })
}

/// The study, or why there is none.
pub(super) fn study(
    target: &Target,
    session: &mut Session,
    options: &OrdersOptions,
    tell: Tell<'_>,
) -> Result<Result<Study, String>, Findings> {
    let truth = truth(session, &[], options, tell)?;
    let declared = target.declared(session, Axis::Step, options)?;
    let limits = target.limits(session.plan(), session.view());
    let (least, most) = target.step_range;
    let diagonal = diagonal_voxels(target, session);
    let from = options
        .from
        .unwrap_or_else(|| (diagonal / 6.0).clamp(0.25, 2.0));
    let (against, truth) = match truth {
        Ok(rendered) => (Against::Reference, Some(Look::from(&rendered))),
        Err(because) => (Against::Next { because }, None),
    };
    // One more without a truth: the finest tells nothing of itself.
    let halvings = options.halvings + u32::from(truth.is_none());
    let mut course = Course {
        steps: Vec::new(),
        looks: Vec::new(),
        truth,
        against,
        is_surface: declared.1 == "depth",
    };
    for halving in 0..=halvings {
        let step = from * 0.5_f64.powi(halving as i32);
        if !(least..=most).contains(&step) {
            break;
        }
        tell("drawing", u64::from(halving), u64::from(halvings) + 1);
        let picture = draw(session, target.settings("step", step))?;
        course.steps.push(step);
        course.looks.push(Look::from(&picture));
    }
    let is_short = |course: &Course| {
        let (quantities, _) = course.quantities(declared.clone(), &limits, options);
        let held = quantities.iter().find(|it| it.name == declared.1);
        held.is_some_and(|held| {
            let convergence = &held.convergence;
            convergence.floor.is_some() && convergence.fitted().count() < WANTED_POINTS
        })
    };
    // Where most of a study is floor, coarser steps tell more, and then the steps between.
    while options.from.is_none() && is_short(&course) {
        let coarser = 2.0 * course.steps.first().copied().unwrap_or(most);
        if coarser > most || coarser > diagonal / 2.0 {
            break;
        }
        let picture = draw(session, target.settings("step", coarser))?;
        course.steps.insert(0, coarser);
        course.looks.insert(0, Look::from(&picture));
    }
    // Without a truth each step is held against its half.
    if course.truth.is_some() && is_short(&course) {
        for at in (1..course.steps.len().min(WANTED_POINTS + 1)).rev() {
            let between = (course.steps[at - 1] * course.steps[at]).sqrt();
            let picture = draw(session, target.settings("step", between))?;
            course.steps.insert(at, between);
            course.looks.insert(at, Look::from(&picture));
        }
    }
    if course.errors().0.is_empty() {
        return Ok(Err(format!(
            "steps are {least} to {most} voxels, and too few of those halved from {from} are"
        )));
    }
    let (quantities, one_sided) = course.quantities(declared, &limits, options);
    let mut notes: Vec<String> = note_one_sided(one_sided).into_iter().collect();
    if from * 0.5_f64.powi(halvings as i32) < least {
        notes.push(format!(
            "steps below {least} voxels cannot be set: there are fewer halvings than asked for"
        ));
    }
    Ok(Ok(Study {
        axis: Axis::Step,
        against: course.against,
        quantities,
        limits,
        one_sided,
        notes,
    }))
}

/// The diagonal of everything drawn, in voxels of the main raycast's volume.
fn diagonal_voxels(target: &Target, session: &Session) -> f64 {
    let corners = session.plan().corners();
    let low = corners.iter().copied().reduce(glam::DVec3::min);
    let high = corners.iter().copied().reduce(glam::DVec3::max);
    let world = low
        .zip(high)
        .map_or(1.0, |(low, high)| (high - low).length());
    let plan = session.plan();
    let spacing = target.main(plan).and_then(|(id, _)| {
        let context = plan.context(id, session.view(), None);
        let source = context.source::<volgraph_nodes::source::volume::VolumeSource>("volume")?;
        Some(source.volume.grid().min_spacing())
    });
    world / spacing.unwrap_or(world / 100.0)
}
