//! Writing what was changed in the window into the graph file.

use volgraph_engine::{Findings, Scene};
use volgraph_report::Finding;

use crate::transfer::TransferEdit;

/// Writes the values that were set into the graph's file; what to say of it.
///
/// # Errors
/// Why nothing was written.
pub(crate) fn write(
    scene: &Scene,
    _transfer: Option<&mut TransferEdit>,
) -> Result<String, Findings> {
    let _ = scene;
    Err(Finding::error("write-back", "not yet").into())
}
