//! Runs a case: each expectation at each point, and what came of it.

use std::path::PathBuf;
use std::time::Instant;

use volgraph_graph::{GraphDesc, read};
use volgraph_report::Findings;

use super::outcome::{Measured, Outcome, Verdict, name};
use super::render::{Devices, Renderer};
use super::{Case, Expectation, ExpectationKind, Point};
use crate::{AdapterChoice, ShaderFolders, scene};

/// What all cases are run with.
#[derive(Clone, Debug, Default)]
pub struct CaseOptions {
    /// Which adapter.
    pub adapter: AdapterChoice,
    /// Where shaders are, besides the graph's folder and those at and above the case's own.
    pub shader_folders: ShaderFolders,
    /// Folders of volumes.
    pub data: Vec<PathBuf>,
    /// Which expectations are looked at.
    pub selection: Selection,
    /// Whether expectations of times are run; they take a machine that does nothing else.
    pub timing: bool,
    /// Whether stored pictures are written instead of compared.
    pub bless: bool,
    /// Whether outcomes keep their pictures.
    pub keep_pictures: bool,
}

/// Which expectations are looked at: those whose name has one of the words; all where there is no word. A name is
/// `tests/glow.ron: finite [image.step=0.5]`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Selection {
    /// The words.
    pub words: Vec<String>,
    /// Whether a word is a whole name, with or without its point, or a case's file or its name without folder and
    /// ending.
    pub exact: bool,
}

impl Selection {
    /// Whether an expectation at a point is looked at.
    #[must_use]
    pub fn takes(&self, case: &Case, expectation: &str, point: &str) -> bool {
        let file = case.file.display().to_string();
        let whole = format!("{file}: {}", name(expectation, point));
        let without = format!("{file}: {expectation}");
        let stem = case.file.file_stem().unwrap_or_default().to_string_lossy();
        let fits = |word: &String| {
            if self.exact {
                [whole.as_str(), &without, &file, &stem].contains(&word.as_str())
            } else {
                whole.contains(word)
            }
        };
        self.words.is_empty() || self.words.iter().any(fits)
    }
}

impl Case {
    /// Renders and measures: an outcome for each expectation that is selected at each point, in their order. A picture
    /// that cannot be rendered fails the expectations that need it.
    ///
    /// # Errors
    /// What [`check`](Self::check) finds, or where the graph cannot be read.
    pub fn run(&self, options: &CaseOptions) -> Result<Vec<Outcome>, Findings> {
        self.run_on(options, &mut Devices::default())
    }

    /// The same, on devices that are open already.
    pub(super) fn run_on(
        &self,
        options: &CaseOptions,
        devices: &mut Devices,
    ) -> Result<Vec<Outcome>, Findings> {
        self.check_with(options).into_result(())?;
        let (points, unswept) = self.points(options)?;
        let text = scene::read_text(&self.graph.path)?;
        let mut run = Run {
            renderer: Renderer::new(self, options, devices),
            desc: read::graph(&self.graph.path, &text)?,
        };
        let mut outcomes = Vec::new();
        for (point, expectation) in self.looked_at(&points, options) {
            outcomes.push(run.outcome(expectation, &point));
        }
        outcomes.extend(unswept.iter().filter_map(|param| {
            let expectation = format!("sweep of {}", param.name);
            let is_taken = options.selection.takes(self, &expectation, "");
            is_taken.then(|| {
                let mut outcome = empty(&expectation, "");
                outcome.verdict = Verdict::NotRun;
                param.why.clone_into(&mut outcome.detail);
                outcome
            })
        }));
        Ok(outcomes)
    }

    /// The names of what [`run`](Self::run) looks at.
    ///
    /// # Errors
    /// As [`points`](Self::points).
    pub fn names(&self, options: &CaseOptions) -> Result<Vec<String>, Findings> {
        let (points, _) = self.points(options)?;
        let looked_at = self.looked_at(&points, options);
        Ok(looked_at
            .iter()
            .map(|(point, expectation)| name(&expectation.text, &point.name))
            .collect())
    }

    /// What is looked at: each expectation at all points, then those of `once`.
    fn looked_at(&self, points: &[Point], options: &CaseOptions) -> Vec<(Point, &Expectation)> {
        let own = [self.own_point()];
        let swept = self.expect.iter().map(|it| (it, points));
        let once = self.once.iter().map(|it| (it, own.as_slice()));
        swept
            .chain(once)
            .flat_map(|(expectation, points)| points.iter().map(move |point| (point, expectation)))
            .filter(|(point, it)| options.selection.takes(self, &it.text, &point.name))
            .map(|(point, expectation)| (point.clone(), expectation))
            .collect()
    }
}

/// An outcome that is not known yet.
fn empty(expectation: &str, point: &str) -> Outcome {
    Outcome {
        expectation: expectation.to_owned(),
        point: point.to_owned(),
        verdict: Verdict::Failed,
        measured: None,
        bound: None,
        detail: String::new(),
        seconds: 0.0,
        findings: Findings::new(),
        pictures: Vec::new(),
        curve: None,
    }
}

pub(super) struct Run<'c> {
    pub renderer: Renderer<'c>,
    pub desc: GraphDesc,
}

impl Run<'_> {
    fn outcome(&mut self, expectation: &Expectation, point: &Point) -> Outcome {
        let mut outcome = empty(&expectation.text, &point.name);
        if let Some(why) = self.why_not(expectation) {
            outcome.verdict = Verdict::NotRun;
            outcome.detail = why;
            return outcome;
        }
        let start = Instant::now();
        match self.measure(expectation, point) {
            Ok(measured) => {
                let Measured {
                    passed,
                    figure,
                    detail,
                    pictures,
                    curve,
                } = measured;
                if passed {
                    outcome.verdict = Verdict::Passed;
                }
                (outcome.measured, outcome.bound) = figure.unzip();
                outcome.detail = detail;
                outcome.curve = curve;
                if self.renderer.options.keep_pictures {
                    outcome.pictures = pictures;
                }
            }
            Err(findings) => {
                "it could not be measured".clone_into(&mut outcome.detail);
                outcome.findings = findings;
            }
        }
        outcome.seconds = start.elapsed().as_secs_f64();
        outcome
    }

    /// Why an expectation is not looked at, if it is not.
    fn why_not(&self, expectation: &Expectation) -> Option<String> {
        match &expectation.kind {
            ExpectationKind::NotSlower { .. } if !self.renderer.options.timing => {
                Some("times are measured with `--timing`".to_owned())
            }
            ExpectationKind::AdaptersAgree { .. } => {
                let backends = backends();
                (backends.len() < 2).then(|| {
                    format!(
                        "this machine has one backend alone: {}",
                        backends.join(", ")
                    )
                })
            }
            _ => None,
        }
    }
}

/// The backends of this machine's adapters, each once.
pub(super) fn backends() -> Vec<String> {
    let mut backends: Vec<String> = Vec::new();
    for adapter in crate::list_adapters() {
        if !backends.contains(&adapter.backend) {
            backends.push(adapter.backend);
        }
    }
    backends
}
