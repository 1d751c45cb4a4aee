//! The float64 reference of a scene, as pictures to compare with.

use volgraph_graph::View;
use volgraph_report::{Finding, Findings};

use crate::{Picture, Scene};

/// The picture that a scene has in truth, seen so.
///
/// # Errors
/// Where the reference does not know what the scene draws.
pub(super) fn picture(_scene: &Scene, _view: &View) -> Result<Picture, Findings> {
    Err(Finding::error("no-reference", "there is no float64 reference for this scene")
        .help("use `order` without `against`, `equals` or `pixel`")
        .into())
}
