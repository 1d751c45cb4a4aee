//! The float64 reference of what a session draws, as a picture to compare with.

use volgraph_reference::Silent;
use volgraph_report::Findings;

use crate::{Picture, Session, Truth, TruthOptions};

/// Colours of the reference are this near to the truth: well below what f32 renderers reach.
const TOLERANCE: f64 = 1e-7;

/// The picture that a session draws, in truth.
///
/// # Errors
/// `not-covered` where the reference does not compute what the graph draws.
pub(super) fn picture(session: &Session) -> Result<Picture, Findings> {
    let options = TruthOptions {
        tolerance: TOLERANCE,
        ..TruthOptions::default()
    };
    Truth::of(session.plan(), session.view(), &options, &Silent)?.picture()
}
