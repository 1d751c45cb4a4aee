//! Test cases for shaders, without Rust: a RON file that names a graph, or a slot's choice in one of volgraph's own small
//! [scenes](STOCK_SCENES), and what its picture must be like.
//!
//! ```ron
//! (
//!     test: 1,                                    // the version of this format
//!     slot: (technique: "glow"),                  // what is tested, in the scene `gyroid`; or `graph: "../glow.ron"`
//!     sweep: { "image.step": [0.5, 1, 2] },       // every expectation of `expect` holds at each of these
//!     expect: [
//!         finite,                                 // no NaN, no infinite value
//!         stages_agree(max: 1e-4),                // fragment and compute shader
//!     ],
//!     once: [                                     // what is looked at with the case's own settings alone
//!         order(param: "image.step", halvings: 4, at_least: 1.85),
//!         differs(set: ["image.brightness=0"], rmse: 0.01),
//!     ],
//! )
//! ```
//!
//! The way of the data: [`Case::load`] reads a file, with every finding at its place; [`Case::check`] looks at the graphs
//! and names that it speaks of, without a GPU; [`Case::points`] are the settings to try, from sweep, volumes and cameras;
//! [`Case::run`] renders what the expectations need, each picture once, and gives an [`Outcome`] for each of them at each
//! point, with the measured figure and its bound. [`run_files`] does so for many files at once, [`find`] finds them in
//! folders, and [`assert_folder`] is a test of its own. A raycast runs in the fragment shader unless graph or case say
//! otherwise: figures must not depend on which stage is faster at the moment.
//!
//! Under `#[test]`, a folder of cases takes one line:
//!
//! ```
//! # let folder = tempfile::tempdir()?;
//! # let folder = folder.path();
//! # std::fs::write(folder.join("fog.ron"), r#"(test: 1, scene: "fog", size: (16, 16), expect: [finite])"#)?;
//! volgraph_engine::case::assert_folder(folder);
//!
//! use volgraph_engine::case::{Case, CaseOptions};
//! let outcomes = Case::load(&folder.join("fog.ron"))?.run(&CaseOptions::default())?;
//! assert!(outcomes.iter().all(|outcome| outcome.passed()));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod check;
mod choice;
mod expectations;
mod figures;
mod files;
mod find;
mod invariance;
mod kinds;
mod measure;
mod orders;
mod outcome;
mod points;
mod read;
mod reference;
mod render;
mod run;
mod scenes;
mod settings;
mod stored_picture;
mod timing;
mod values;

use std::path::{Path, PathBuf};

use volgraph_graph::{CameraDesc, SourceDesc};
use volgraph_report::Place;

pub use files::{CaseReport, RunOptions, assert_folder, assert_folder_with, run_files};
pub use find::find;
pub use kinds::{Area, Axis, ExpectationKind, OrderAgainst, Other, Param, PictureBound, Values};
pub use outcome::{Curve, Outcome, Shown, Verdict};
pub use points::{Point, Unswept};
pub use run::{CaseOptions, Selection};
pub use scenes::{STOCK_SCENES, StockScene};

/// A test case.
#[derive(Clone, Debug, PartialEq)]
pub struct Case {
    /// The case's file.
    pub file: PathBuf,
    /// The graph.
    pub graph: GraphName,
    /// The slots that are under test, the first of which gives `sweep: all_params` its parameters.
    pub slots: Vec<SlotUnderTest>,
    /// The node that they belong to.
    pub node: String,
    /// Width and height of the pictures in pixels.
    pub size: [u32; 2],
    /// What is set for all of its pictures.
    pub set: Vec<Set>,
    /// What is drawn in the place of the graph's volume, one after the other; the graph's own where there is none.
    pub volumes: Vec<Drawn>,
    /// Where the camera stands, one after the other; where the graph says where there is none.
    pub cameras: Vec<Stand>,
    /// The settings to try.
    pub sweep: Sweep,
    /// What must hold at each of them.
    pub expect: Vec<Expectation>,
    /// What must hold with the first volume and camera, and with nothing swept.
    pub once: Vec<Expectation>,
}

/// A graph that a case names.
#[derive(Clone, Debug, PartialEq)]
pub struct GraphName {
    /// Its path, from the current folder.
    pub path: PathBuf,
    /// Where it is named.
    pub place: Place,
}

/// A slot's choice that a case tests.
#[derive(Clone, Debug, PartialEq)]
pub struct SlotUnderTest {
    /// The slot.
    pub slot: String,
    /// The choice.
    pub choice: String,
    /// Where it is named.
    pub place: Place,
}

/// A volume to draw.
#[derive(Clone, Debug, PartialEq)]
pub struct Drawn {
    /// As it is written, on one line.
    pub text: String,
    /// What it is.
    pub source: SourceDesc,
}

/// A camera to look with.
#[derive(Clone, Debug, PartialEq)]
pub struct Stand {
    /// As it is written, on one line.
    pub text: String,
    /// Where it stands.
    pub camera: CameraDesc,
}

/// The settings to try.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Sweep {
    /// The case's own alone.
    #[default]
    None,
    /// All combinations of these values, each a setting.
    Product(Vec<Vec<Set>>),
    /// Each parameter of the slot under test by itself, over its documented range or choices.
    AllParams {
        /// Parameters that are left out.
        except: Vec<String>,
        /// Where it is asked for.
        place: Place,
    },
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

/// The fields that only cases have.
const OWN_FIELDS: [&str; 2] = ["test", "expect"];

/// Whether a RON file's fields are a case's: it has the field `test`, or `expect` where that was forgotten.
#[must_use]
pub fn is_case<'n>(fields: impl IntoIterator<Item = &'n str>) -> bool {
    fields.into_iter().any(|name| OWN_FIELDS.contains(&name))
}

/// The path that a case in `file` means by a graph's or a picture's name.
fn beside(file: &Path, name: &str) -> PathBuf {
    if volgraph_graph::is_embedded(Path::new(name)) {
        return PathBuf::from(name);
    }
    // Not `./a.ron`: findings then name a graph as its author would.
    let folder = file.parent().unwrap_or(Path::new(""));
    folder.join(name)
}

/// A value's text on one line.
fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}
