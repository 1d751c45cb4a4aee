//! What came of a case.

use serde::Serialize;

use super::case::{Case, Expect};
use super::judge::{Measured, Pixels};

/// What came of a method, against what was expected.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// It holds, as it must.
    Holds,
    /// It must hold, and does not.
    Broken,
    /// It fails, as is known.
    FailsAsKnown,
    /// It is known to fail, and held at every point.
    HoldsNow,
    /// It is measured and not judged.
    Reported,
}

impl Verdict {
    /// In words, for tables.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Self::Holds => "holds",
            Self::Broken => "BROKEN",
            Self::FailsAsKnown => "fails, as known",
            Self::HoldsNow => "holds now",
            Self::Reported => "reported",
        }
    }
}

/// What came of a method at all points.
#[derive(Clone, Debug, Serialize)]
pub struct MethodReport {
    /// Its name.
    pub name: String,
    /// What was expected.
    pub expect: Expect,
    /// What came.
    pub verdict: Verdict,
    /// The reason for its bound.
    pub why: &'static str,
    /// The number of the point where it is worst.
    pub worst: usize,
    /// What was measured, point by point.
    pub points: Vec<Measured>,
    /// The pixels, point by point; `None` where nothing was drawn.
    #[serde(skip)]
    pub pixels: Vec<Option<Pixels>>,
}

impl MethodReport {
    /// Of what was measured.
    #[must_use]
    pub fn new(method: &super::Method, points: Vec<Measured>, pixels: Vec<Option<Pixels>>) -> Self {
        let badness = |at: &usize| points[*at].badness();
        let worst = (0..points.len())
            .max_by(|a, b| badness(a).total_cmp(&badness(b)))
            .unwrap_or(0);
        let is_good = points.iter().all(Measured::holds);
        let verdict = match (method.expect, is_good) {
            (Expect::Holds, true) => Verdict::Holds,
            (Expect::Holds, false) => Verdict::Broken,
            (Expect::Fails, true) => Verdict::HoldsNow,
            (Expect::Fails, false) => Verdict::FailsAsKnown,
            (Expect::Reported, _) => Verdict::Reported,
        };
        Self {
            name: method.name.clone(),
            expect: method.expect,
            verdict,
            why: method.bound.why,
            worst,
            points,
            pixels,
        }
    }

    /// What was measured where it is worst.
    #[must_use]
    pub fn worst(&self) -> &Measured {
        &self.points[self.worst]
    }
}

/// What came of all methods of a case.
#[derive(Clone, Debug, Serialize)]
pub struct CaseReport {
    /// Its name.
    pub name: &'static str,
    /// What breaks there.
    pub breaks: &'static str,
    /// What is swept.
    pub swept: &'static str,
    /// The unit of errors.
    pub unit: &'static str,
    /// The swept numbers.
    pub at: Vec<f64>,
    /// The same in words.
    pub labels: Vec<String>,
    /// The methods.
    pub methods: Vec<MethodReport>,
    /// Seconds that it took.
    pub seconds: f64,
    /// The truth, point by point.
    #[serde(skip)]
    pub truth: Vec<Pixels>,
    /// The graphs' texts of the methods at the last point.
    #[serde(skip)]
    pub graphs: Vec<String>,
}

impl CaseReport {
    /// Of a case, with nothing measured yet.
    #[must_use]
    pub fn new(case: &Case) -> Self {
        Self {
            name: case.name,
            breaks: case.breaks,
            swept: case.swept,
            unit: case.quantity.unit(),
            at: case.points.iter().map(|point| point.at).collect(),
            labels: case
                .points
                .iter()
                .map(|point| point.label.clone())
                .collect(),
            methods: Vec::new(),
            seconds: 0.0,
            truth: Vec::new(),
            graphs: Vec::new(),
        }
    }

    /// Whether a method that must hold does not.
    #[must_use]
    pub fn is_broken(&self) -> bool {
        self.methods
            .iter()
            .any(|method| method.verdict == Verdict::Broken)
    }

    /// The point to show: where the worst method that is judged is worst.
    #[must_use]
    pub fn shown(&self) -> usize {
        let judged = self
            .methods
            .iter()
            .filter(|it| it.expect != Expect::Reported);
        judged
            .max_by(|a, b| a.worst().badness().total_cmp(&b.worst().badness()))
            .map_or(0, |method| method.worst)
    }
}
