//! Going through a space of methods: all of a small one, of a large one what may be on the front.
//!
//! First every method gets a few frames. Of a large space these are the renderer, the classification, the traversal and the step in all
//! combinations, and each other setting alone; then the neighbours of whatever is near the front, until there are no new
//! ones or a part of the time is over. What is near the front at the end is timed for longer, the nearest first, until the
//! time is over. Methods are taken in small batches, so that the time is passed by one batch at most.
//!
//! Frames are timed in rounds: one of each method, forwards in one round and backwards in the next, the base always among
//! them. Times are compared by their ratio to the base's of the same round.

use std::collections::{BTreeSet, VecDeque};

use serde::Serialize;
use volgraph_measure::timing::{Summary, ratio};
use volgraph_report::Findings;

use super::accuracy::Errors;
use super::front::{front, near_front};
use super::measurement::{Measurement, Method};
use super::space::MethodSpace;
use super::stand::{Stand, alternate};
use crate::renderer::RENDERER;

/// The settings that a large space is first looked at in all combinations of.
const PLANE: [&str; 4] = [RENDERER, "classify", "traverse", "step"];

/// Share of the time after which no new methods are looked for.
const SCOUTING_SHARE: f64 = 0.6;

/// Fewest rounds of the last pass, whatever the time.
const MIN_ROUNDS: u32 = 3;

/// Most methods that are timed together. More of them would each be drawn before the time is looked at again.
const BATCH: usize = 16;

/// Told how far a survey is.
pub trait SurveyProgress {
    /// So many of the methods that are known of are measured; or rounds of the last pass.
    fn progress(&self, what: &str, done: usize, total: usize);
}

/// How a space is gone through.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SurveyOptions {
    /// Seconds that it may take; a batch that has been begun is ended, and a small space is measured as a whole.
    pub seconds: f64,
    /// Frames before those that are timed.
    pub warm_up: u32,
    /// Rounds of the first pass.
    pub scout_rounds: u32,
    /// Rounds of the last pass, at most.
    pub rounds: u32,
    /// How far from the front a method may be, as a factor in both time and error, to be timed for longer.
    pub slack: f64,
    /// Spaces of at most so many methods are measured as a whole.
    pub max_whole: usize,
    /// Methods whose resources take more than this together are not kept on the device at once.
    pub max_bytes: u64,
}

impl Default for SurveyOptions {
    fn default() -> Self {
        Self {
            seconds: 180.0,
            warm_up: 1,
            scout_rounds: 3,
            rounds: 15,
            slack: 1.25,
            max_whole: 64,
            max_bytes: 1 << 30,
        }
    }
}

/// What a survey found.
#[derive(Clone, Debug, Serialize)]
pub struct Survey {
    /// The methods that were measured, in the order in which they were found. The first is the base.
    pub measured: Vec<Measurement>,
    /// Those that the scene refuses, and why.
    pub refused: Vec<(Method, String)>,
    /// Methods of the whole space.
    pub product: usize,
    /// The base's frames of all rounds, in milliseconds.
    pub base_ms: Summary,
    /// How it was gone about.
    pub options: SurveyOptions,
    /// Seconds that it took.
    pub seconds: f64,
}

/// Measures the methods of a space.
///
/// # Errors
/// Why the base method cannot be drawn.
pub fn survey<S: Stand>(
    stand: &mut S,
    space: &MethodSpace,
    options: &SurveyOptions,
    progress: &dyn SurveyProgress,
) -> Result<Survey, Findings> {
    let base = space.base();
    let method = space.method(&base);
    let (mut ready, errors) = stand.prepare(&method)?;
    let mut run = Run {
        stand,
        space,
        options,
        progress,
        known: BTreeSet::from([base.clone()]),
        found: Vec::new(),
        refused: Vec::new(),
        base_times: Vec::new(),
    };
    run.found.push(Found {
        at: base.clone(),
        errors,
        times: Vec::new(),
        base_times: Vec::new(),
        is_refined: true,
    });
    run.scout(&mut ready, first(space, &base, options))?;
    if space.len() > options.max_whole {
        loop {
            let next = run.neighbours_of_the_near()?;
            if next.is_empty() || run.is_over(SCOUTING_SHARE) {
                break;
            }
            run.scout(&mut ready, next)?;
        }
    }
    run.refine(&mut ready)?;
    run.conclude()
}

/// The methods that are looked at first, without the base.
fn first(space: &MethodSpace, base: &[usize], options: &SurveyOptions) -> Vec<Vec<usize>> {
    if space.len() <= options.max_whole {
        return space.product(base, |_| true);
    }
    let mut first = space.product(base, |axis| PLANE.contains(&axis.name.as_str()));
    first.extend(space.neighbours(base));
    // They are few and need no device to be made ready: time that is short reaches them too.
    first.sort_by_key(|at| !space.method(at).is_software());
    first
}

/// A method with its samples.
struct Found {
    at: Vec<usize>,
    errors: Errors,
    times: Vec<f64>,
    /// The base's in the same rounds.
    base_times: Vec<f64>,
    is_refined: bool,
}

/// What methods are made ready for.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Pass {
    /// A few frames each.
    Scouting,
    /// More frames of what is near the front.
    Refining,
}

struct Run<'r, S: Stand> {
    stand: &'r mut S,
    space: &'r MethodSpace,
    options: &'r SurveyOptions,
    progress: &'r dyn SurveyProgress,
    known: BTreeSet<Vec<usize>>,
    /// The base first.
    found: Vec<Found>,
    refused: Vec<(Method, String)>,
    base_times: Vec<f64>,
}

impl<S: Stand> Run<'_, S> {
    fn is_over(&self, share: f64) -> bool {
        self.stand.seconds() >= share * self.options.seconds
    }

    fn refuse(&mut self, at: &[usize], findings: &Findings) {
        let why = findings.sorted();
        let why = why.first().map_or_else(String::new, |finding| {
            format!("{}: {}", finding.code, finding.message)
        });
        self.refused.push((self.space.method(at), why));
    }

    /// No more methods of a large space are looked at.
    fn is_scouted(&self) -> bool {
        self.is_over(SCOUTING_SHARE) && self.space.len() > self.options.max_whole
    }

    /// Measures methods that are not known yet with a few frames each.
    fn scout(&mut self, base: &mut S::Ready, methods: Vec<Vec<usize>>) -> Result<(), Findings> {
        let new = methods
            .into_iter()
            .filter(|at| self.known.insert(at.clone()));
        let mut rest: VecDeque<Vec<usize>> = new.collect();
        while !rest.is_empty() {
            let batch = self.batch(base, &mut rest, Pass::Scouting);
            self.time(base, batch, self.options.scout_rounds, |_, _| true)?;
            if self.is_scouted() {
                for at in rest.drain(..) {
                    self.known.remove(&at);
                }
            }
        }
        Ok(())
    }

    /// Makes the next methods ready: as many as are kept on the device at once.
    fn batch(
        &mut self,
        base: &S::Ready,
        rest: &mut VecDeque<Vec<usize>>,
        pass: Pass,
    ) -> Vec<(Found, S::Ready)> {
        let mut batch = Vec::new();
        let mut bytes = self.stand.bytes(base);
        let mut taken = 0;
        while taken < BATCH && bytes <= self.options.max_bytes {
            if pass == Pass::Scouting && self.is_scouted() {
                break;
            }
            let Some(at) = rest.pop_front() else {
                break;
            };
            taken += 1;
            match self.stand.prepare(&self.space.method(&at)) {
                Ok((ready, errors)) => {
                    bytes += self.stand.bytes(&ready);
                    let found = Found {
                        at,
                        errors,
                        times: Vec::new(),
                        base_times: Vec::new(),
                        is_refined: pass == Pass::Refining,
                    };
                    batch.push((found, ready));
                }
                Err(findings) => self.refuse(&at, &findings),
            }
            if pass == Pass::Scouting {
                let total = self.known.len();
                self.progress
                    .progress("measuring methods", total - rest.len(), total);
            }
        }
        batch
    }

    /// Times a batch against the base.
    fn time(
        &mut self,
        base: &mut S::Ready,
        mut batch: Vec<(Found, S::Ready)>,
        rounds: u32,
        goes_on: impl FnMut(&S, u32) -> bool,
    ) -> Result<(), Findings> {
        let mut methods: Vec<&mut S::Ready> = vec![base];
        methods.extend(batch.iter_mut().map(|(_, ready)| ready));
        // The same views for every batch.
        let warm = 1..1 + self.options.warm_up;
        let timed = warm.end..warm.end + rounds;
        let warmed = alternate(self.stand, &mut methods, warm, |_, _| true);
        let mut times = alternate(self.stand, &mut methods, timed, goes_on).into_iter();
        let mut base_times = Vec::new();
        if let Some(times) = times.next() {
            base_times = times?;
        }
        self.base_times.extend(&base_times);
        let warmed = warmed.into_iter().skip(1);
        for (((mut found, _), times), warmed) in batch.into_iter().zip(times).zip(warmed) {
            match warmed.and(times) {
                Ok(times) => {
                    found.times = times;
                    found.base_times.clone_from(&base_times);
                    self.found.retain(|before| before.at != found.at);
                    self.found.push(found);
                }
                Err(findings) => self.refuse(&found.at, &findings),
            }
        }
        Ok(())
    }

    /// Time and error of all that is found.
    fn points(&self) -> Result<Vec<(f64, f64)>, Findings> {
        let measured = self.measured()?;
        Ok(measured.iter().map(Measurement::point).collect())
    }

    /// What is near the front, the nearest first.
    fn near(&self) -> Result<Vec<Vec<usize>>, Findings> {
        let near = near_front(&self.points()?, self.options.slack);
        Ok(near.into_iter().map(|i| self.found[i].at.clone()).collect())
    }

    fn neighbours_of_the_near(&self) -> Result<Vec<Vec<usize>>, Findings> {
        let near = self.near()?;
        let next = near.iter().flat_map(|at| self.space.neighbours(at));
        let next: BTreeSet<Vec<usize>> = next.filter(|at| !self.known.contains(at)).collect();
        Ok(next.into_iter().collect())
    }

    /// Times what is near the front for longer.
    fn refine(&mut self, base: &mut S::Ready) -> Result<(), Findings> {
        let base_at = self.space.base();
        let mut rest = VecDeque::from(self.near()?);
        rest.retain(|at| *at != base_at);
        if rest.is_empty() {
            return self.time(base, Vec::new(), self.options.rounds, |_, _| true);
        }
        let total = self.options.rounds as usize;
        let mut is_first = true;
        while !rest.is_empty() && (is_first || !self.is_over(1.0)) {
            is_first = false;
            let start = self.stand.seconds();
            let batch = self.batch(base, &mut rest, Pass::Refining);
            // What is left of the time is shared by the batches that are left.
            let share = batch.len() as f64 / (batch.len() + rest.len()).max(1) as f64;
            let until = start + share * (self.options.seconds - start);
            let (first, progress) = (1 + self.options.warm_up, self.progress);
            self.time(base, batch, self.options.rounds, |stand, frame| {
                let rounds = frame + 1 - first;
                progress.progress("timing the front", rounds as usize, total);
                rounds < MIN_ROUNDS || stand.seconds() < until
            })?;
        }
        Ok(())
    }

    /// The measurements, without the front.
    fn measured(&self) -> Result<Vec<Measurement>, Findings> {
        let base_ms = self.base_ms()?;
        let found = self.found.iter().enumerate();
        found
            .map(|(i, found)| {
                let (time_ms, ratio) = if i == 0 {
                    (base_ms, ratio(&self.base_times, &self.base_times))
                } else {
                    (
                        summary(&found.times)?,
                        ratio(&found.times, &found.base_times),
                    )
                };
                let ratio = ratio.map_err(unmeasured)?;
                Ok(Measurement {
                    method: self.space.method(&found.at),
                    errors: found.errors,
                    time_ms,
                    ratio,
                    steady_ms: ratio.median * base_ms.median,
                    is_refined: found.is_refined,
                    is_front: false,
                })
            })
            .collect()
    }

    fn base_ms(&self) -> Result<Summary, Findings> {
        summary(&self.base_times)
    }

    fn conclude(self) -> Result<Survey, Findings> {
        let mut measured = self.measured()?;
        let points: Vec<(f64, f64)> = measured.iter().map(Measurement::point).collect();
        for at in front(&points) {
            measured[at].is_front = true;
        }
        Ok(Survey {
            base_ms: self.base_ms()?,
            measured,
            refused: self.refused,
            product: self.space.len(),
            options: *self.options,
            seconds: self.stand.seconds(),
        })
    }
}

fn summary(times: &[f64]) -> Result<Summary, Findings> {
    Summary::of(times).map_err(unmeasured)
}

#[expect(clippy::needless_pass_by_value, reason = "for map_err")]
fn unmeasured(error: volgraph_measure::MeasureError) -> Findings {
    volgraph_report::Finding::error("measure", error.to_string()).into()
}
