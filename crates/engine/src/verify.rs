//! The orders of convergence of a graph, measured and held against what its slots declare (Etiene et al. 2014).
//!
//! The way of the data: [`Target`] is a graph with early termination off, and what its slots declare (`declared`) and
//! its scene allows (`limits`). A study halves one thing ([`Axis`]) and draws each picture: `step`, `grid` and
//! `pixel`. Errors are taken against the float64 truth where it covers the graph, else between one picture and the
//! next ([`Against`]), of colour, depth and normal (`errors`). [`Convergence`] says which of them tell an order and
//! which it is, and [`Verdict`] whether it holds: what is not told, for a reason ([`Untold`]), does not.

mod declared;
mod errors;
mod grid;
mod limits;
mod pixel;
mod step;
mod stock;
mod target;
mod verdict;

use serde::Serialize;
use volgraph_measure::Convergence;
use volgraph_report::Findings;

use crate::{Session, TruthOptions};

pub use declared::Declared;
pub use limits::SceneLimit;
pub use stock::{STOCK, Stock, stock_for};
pub use target::{Target, integral_truth, slot_settings};
pub use verdict::{Untold, Verdict};

/// What is halved.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Axis {
    /// The step along rays, in voxels.
    Step,
    /// The spacing of the grids of analytic sources.
    Grid,
    /// The width of a pixel.
    Pixel,
}

impl Axis {
    /// Its name.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Step => "step",
            Self::Grid => "grid",
            Self::Pixel => "pixel",
        }
    }

    /// What its steps are counted in.
    #[must_use]
    pub fn unit(self) -> &'static str {
        match self {
            Self::Step => "voxels",
            Self::Grid => "of the box",
            Self::Pixel => "pixels",
        }
    }
}

/// How orders are measured.
#[derive(Clone, Debug, PartialEq)]
pub struct OrdersOptions {
    /// What is halved.
    pub axes: Vec<Axis>,
    /// The coarsest step in voxels; chosen by the size of the volume where it is `None`.
    pub from: Option<f64>,
    /// How often it is halved.
    pub halvings: u32,
    /// An error that stands still below this (of depths: times the largest depth) has met rounding or tables.
    pub highest_floor: f64,
    /// How far below the declared order the measured one may be.
    pub tolerance: f64,
    /// The order in the step to hold against, whatever is declared.
    pub expected: Option<f64>,
    /// Choices of slots that the truth is computed with in the place of the user's own.
    pub stands_for: Vec<(String, String)>,
    /// How the truth is computed.
    pub truth: TruthOptions,
}

impl Default for OrdersOptions {
    fn default() -> Self {
        Self {
            axes: vec![Axis::Step],
            from: None,
            halvings: 4,
            highest_floor: 2e-5,
            tolerance: 0.15,
            expected: None,
            stands_for: Vec::new(),
            truth: TruthOptions::default(),
        }
    }
}

/// What errors are taken against.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Against {
    /// The float64 reference.
    Reference,
    /// The next picture, drawn with half of the step: tells an order, but not whether the limit is right. And why.
    Next {
        /// What the reference does not compute.
        because: String,
    },
}

/// All that was measured by halving one thing.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Study {
    /// What was halved.
    pub axis: Axis,
    /// What the errors are taken against.
    pub against: Against,
    /// Colour, depth and normal, those that there are.
    pub quantities: Vec<Quantity>,
    /// What in the scene limits the order.
    pub limits: Vec<SceneLimit>,
    /// The share of pixels in the finest picture where a surface is in it or in the truth, but not in both.
    pub one_sided: f64,
    /// What the reader should know.
    pub notes: Vec<String>,
}

/// One thing that has an error.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Quantity {
    /// `colour`, `depth` or `normal`.
    pub name: &'static str,
    /// Root mean square errors, and the order that they tell.
    #[serde(flatten)]
    pub convergence: Convergence,
    /// What the order is held against; `None` where nothing is declared for it.
    pub declared: Option<Declared>,
    /// What of that this scene can show.
    pub expected: Option<f64>,
    /// Whether it holds.
    pub verdict: Verdict,
    /// Why no order is told, where none is and the quantity is not exact either.
    pub untold: Option<Untold>,
}

impl Quantity {
    /// The order in words, or why there is none.
    #[must_use]
    pub fn order_said(&self) -> String {
        match (self.convergence.order, self.untold) {
            (Some(order), _) => format!("order {order:.2}"),
            (None, Some(Untold::Absent)) => "in no pixel".to_owned(),
            (None, Some(Untold::Unchanged)) => "the same in all pictures".to_owned(),
            (None, Some(Untold::TooFew)) => "too few points for an order".to_owned(),
            (None, None) => "exact to the floor".to_owned(),
        }
    }
}

/// What was asked for and cannot be measured here.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Skipped {
    /// What would be halved.
    pub axis: Axis,
    /// Why not.
    pub because: String,
}

/// Told what is being drawn or computed.
pub type Tell<'t> = &'t (dyn Fn(&str, u64, u64) + Sync);

/// Measures along all axes that are asked for.
///
/// # Errors
/// Whatever keeps a picture from being drawn.
pub fn orders(
    target: &Target,
    session: &mut Session,
    options: &OrdersOptions,
    tell: Tell<'_>,
) -> Result<(Vec<Study>, Vec<Skipped>), Findings> {
    let (mut studies, mut skipped) = (Vec::new(), Vec::new());
    // The grid is left refined, so it comes last.
    for axis in [Axis::Step, Axis::Pixel, Axis::Grid] {
        if !options.axes.contains(&axis) {
            continue;
        }
        let study = match axis {
            Axis::Step => step::study(target, session, options, tell),
            Axis::Grid => grid::study(target, session, options, tell),
            Axis::Pixel => pixel::study(session, options, tell),
        };
        match study? {
            Ok(study) => studies.push(study),
            Err(because) => skipped.push(Skipped { axis, because }),
        }
    }
    Ok((studies, skipped))
}
