//! Halving the width of a pixel: pictures of doubled sizes, averaged down to the first, one held against the next.
//!
//! What it measures is how fast the middles of pixels come to stand for the light of whole pixels: order 2 where a
//! picture is smooth, about 1 where outlines cross it. Nothing declares it, and it is reported alone.

use volgraph_report::Findings;

use super::errors::Look;
use super::step::Course;
use super::{Against, Axis, OrdersOptions, Study, Tell};
use crate::{Change, Outcome, Session};

/// No side of a picture is longer.
const LONGEST_SIDE: u32 = 4096;

/// The study, or why there is none.
pub(super) fn study(
    session: &mut Session,
    options: &OrdersOptions,
    tell: Tell<'_>,
) -> Result<Result<Study, String>, Findings> {
    let size = session.view().size;
    let mut course = Course {
        steps: Vec::new(),
        looks: Vec::new(),
        truth: None,
        against: Against::Next {
            because: "a reference of whole pixels would be of as many rays".to_owned(),
        },
        is_surface: false,
    };
    for halving in 0..=options.halvings {
        let by = 1_u32 << halving.min(16);
        let larger = size.map(|side| side.saturating_mul(by));
        if larger.iter().any(|side| *side > LONGEST_SIDE) {
            break;
        }
        tell(
            "drawing",
            u64::from(halving),
            u64::from(options.halvings) + 1,
        );
        let picture = match session.apply(&Change::Size(larger)) {
            Ok(Outcome::Drawn(drawn)) => drawn.picture,
            Ok(Outcome::Unchanged) => session.render_checked()?.0,
            Err(refused) => return Err(refused.findings),
        };
        course.steps.push(1.0 / f64::from(by));
        let sides = larger.map(|side| side as usize);
        course
            .looks
            .push(Look::from(&picture).averaged(sides, by as usize));
    }
    session
        .apply(&Change::Size(size))
        .map_err(|refused| refused.findings)?;
    if course.errors().0.is_empty() {
        return Ok(Err(format!(
            "pictures of twice {} × {} pixels have a side of more than {LONGEST_SIDE}",
            size[0], size[1]
        )));
    }
    let (quantities, one_sided) = course.quantities((None, "colour"), &[], options);
    Ok(Ok(Study {
        axis: Axis::Pixel,
        against: course.against,
        quantities,
        limits: Vec::new(),
        one_sided,
        notes: Vec::new(),
    }))
}
