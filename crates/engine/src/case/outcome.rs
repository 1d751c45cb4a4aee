//! What became of an expectation.

use std::sync::Arc;

use serde::Serialize;
use volgraph_report::Findings;

use crate::Picture;

/// Whether an expectation holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// It holds.
    Passed,
    /// It does not, or could not be measured.
    Failed,
    /// It was not looked at, for a reason that the detail gives.
    NotRun,
}

/// What became of an expectation at a point.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Outcome {
    /// The expectation, as the case has it.
    pub expectation: String,
    /// The settings that were tried, such as `image.step=0.5`; empty for the case's own.
    pub point: String,
    /// Whether it holds.
    pub verdict: Verdict,
    /// The figure that decided; `None` where there are no two pictures of numbers to compare.
    pub measured: Option<f64>,
    /// What it is held against.
    pub bound: Option<f64>,
    /// The figures in words.
    pub detail: String,
    /// How long it took, in seconds; pictures that others had rendered before are not counted.
    pub seconds: f64,
    /// Why it could not be measured.
    #[serde(skip)]
    pub findings: Findings,
    /// The pictures that it was measured on, where the options ask to keep them.
    #[serde(skip)]
    pub pictures: Vec<Shown>,
    /// Errors over a parameter, where that is what was measured.
    pub curve: Option<Curve>,
}

impl Outcome {
    /// Whether it holds; also where it was not run, `false`.
    #[must_use]
    pub fn passed(&self) -> bool {
        self.verdict == Verdict::Passed
    }

    /// Whether it does not hold.
    #[must_use]
    pub fn failed(&self) -> bool {
        self.verdict == Verdict::Failed
    }

    /// Expectation and point, as a test is named: `finite [image.step=0.5]`.
    #[must_use]
    pub fn name(&self) -> String {
        name(&self.expectation, &self.point)
    }
}

/// Expectation and point as a name.
pub(super) fn name(expectation: &str, point: &str) -> String {
    if point.is_empty() {
        expectation.to_owned()
    } else {
        format!("{expectation} [{point}]")
    }
}

/// A picture, and what it is.
#[derive(Clone, Debug, PartialEq)]
pub struct Shown {
    /// What was set for it.
    pub name: String,
    /// The picture.
    pub picture: Arc<Picture>,
}

/// Errors over a parameter's values.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Curve {
    /// The parameter.
    pub name: String,
    /// Value and root mean square error.
    pub points: Vec<(f64, f64)>,
}

/// A figure, its bound, and both in words.
pub(super) struct Measured {
    pub passed: bool,
    pub figure: Option<(f64, f64)>,
    pub detail: String,
    pub pictures: Vec<Shown>,
    pub curve: Option<Curve>,
}

impl Measured {
    pub fn new(passed: bool, figure: Option<(f64, f64)>, detail: String) -> Self {
        Self {
            passed,
            figure,
            detail,
            pictures: Vec::new(),
            curve: None,
        }
    }

    /// A figure that may not pass its bound.
    pub fn at_most(name: &str, figure: f64, bound: f64) -> Self {
        let detail = format!("{name} {figure:.3e}, at most {bound:e}");
        Self::new(figure <= bound, Some((figure, bound)), detail)
    }

    pub fn with(mut self, pictures: impl IntoIterator<Item = Shown>) -> Self {
        self.pictures.extend(pictures);
        self
    }
}
