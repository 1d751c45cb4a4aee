//! Test cases for shaders, without Rust: a RON file that names a graph and what its picture must be like.
//!
//! ```ron
//! (
//!     test: 1,                            // the version of this format
//!     graph: "../glow.ron",               // from the case's folder, or `embedded:/graphs/quickstart.ron`
//!     size: (64, 64),                     // pixels; this is the default
//!     set: ["image.step=0.5"],            // as `--set` on the command line, for all of the case's pictures
//!     expect: [
//!         finite,                                                         // no NaN, no infinite value
//!         stages_agree(max: 1e-4),                                        // fragment and compute shader
//!         halving(param: "image.step", times: 2, rmse: 0.01, order: 1.5), // the picture converges
//!         equals(graph: "other.ron", max: 1e-5),                          // another graph, or other settings
//!         differs(set: ["image.brightness=0"], rmse: 0.01),               // what must not look the same
//!     ],
//! )
//! ```
//!
//! The way of the data: [`Case::load`] reads a file, with every finding at its place; [`Case::check`] looks at the graphs
//! and names that it speaks of, without a GPU; [`Case::run`] renders what the expectations need, each picture once, and
//! gives an [`Outcome`] for each with the measured figure and its bound. A raycast runs in the fragment shader unless graph
//! or case say otherwise: figures must not depend on which stage is faster at the moment.

mod check;
mod expectations;
mod figures;
mod read;
mod run;
mod settings;

use std::path::{Path, PathBuf};

use volgraph_report::Place;

pub use run::{CaseOptions, Outcome};

/// A test case.
#[derive(Clone, Debug, PartialEq)]
pub struct Case {
    /// The case's file.
    pub file: PathBuf,
    /// The graph.
    pub graph: GraphName,
    /// Width and height of the pictures in pixels.
    pub size: [u32; 2],
    /// What is set for all of its pictures.
    pub set: Vec<Set>,
    /// What must hold, at least one.
    pub expect: Vec<Expectation>,
}

/// A graph that a case names.
#[derive(Clone, Debug, PartialEq)]
pub struct GraphName {
    /// Its path, from the current folder.
    pub path: PathBuf,
    /// Where it is named.
    pub place: Place,
}

/// A setting as on the command line, and where the case has it.
#[derive(Clone, Debug, PartialEq)]
pub struct Set {
    /// What is set.
    pub value: crate::ParamOverride,
    /// Where.
    pub place: Place,
}

/// Something that must hold of a graph's picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Expectation {
    /// What.
    pub kind: ExpectationKind,
    /// As it is written, on one line.
    pub text: String,
    /// Where it is written.
    pub place: Place,
}

/// What may be expected. Figures are of linear premultiplied RGBA: `rmse` the root of the mean squared error over all
/// components, `max` the largest error of one.
#[derive(Clone, Debug, PartialEq)]
pub enum ExpectationKind {
    /// Colour and opacity are finite and depth is a number, in every pixel.
    Finite,
    /// The graph's raycasts give the same picture in a fragment and in a compute shader.
    StagesAgree {
        /// Largest error allowed.
        max: f64,
    },
    /// The picture converges as a parameter is halved.
    Halving {
        /// Node and parameter.
        param: Param,
        /// The value that is halved; the case's or the graph's own where `None`.
        from: Option<f64>,
        /// How often, 1 to 8.
        times: u32,
        /// Largest error allowed between the last two pictures.
        rmse: f64,
        /// Least order of convergence p allowed, the error falling as step to the p: from a line fitted through the
        /// base-2 logarithms of the errors above those of f32; not looked at where fewer than two are.
        order: Option<f64>,
    },
    /// Another graph, or other settings, give the same picture.
    Equals {
        /// The other picture.
        other: Other,
        /// Largest error allowed.
        max: f64,
    },
    /// Another graph, or other settings, give another picture.
    Differs {
        /// The other picture.
        other: Other,
        /// Least error asked for.
        rmse: f64,
    },
}

/// A node's parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct Param {
    /// The node.
    pub node: String,
    /// The parameter.
    pub name: String,
    /// Where it is named.
    pub place: Place,
}

/// A picture to hold against the case's: at least one of the two is given.
#[derive(Clone, Debug, PartialEq)]
pub struct Other {
    /// Another graph; the case's own where `None`.
    pub graph: Option<GraphName>,
    /// Settings after the case's own; those of the case do not hold for another graph.
    pub set: Vec<Set>,
}

/// Whether a RON file's fields are a case's: it has the field `test`.
#[must_use]
pub fn is_case<'n>(fields: impl IntoIterator<Item = &'n str>) -> bool {
    fields.into_iter().any(|name| name == "test")
}

/// The path that a case in `file` means by a graph's name.
fn graph_path(file: &Path, name: &str) -> PathBuf {
    if volgraph_graph::is_embedded(Path::new(name)) {
        return PathBuf::from(name);
    }
    // Not `./a.ron`: findings then name a graph as its author would.
    let folder = file.parent().unwrap_or(Path::new(""));
    folder.join(name)
}
