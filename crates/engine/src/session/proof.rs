//! What is asked of a frame before it is taken: no hazard, and finite colours.

use volgraph_gpu::FrameReport;
use volgraph_graph::{NodeId, Plan};
use volgraph_picture::Picture;
use volgraph_report::{Finding, Findings, Place, Severity};

/// What is a warning for a picture that is rendered once is reason enough not to take a change.
pub(super) fn check_hazards(frame: &FrameReport) -> Result<(), Findings> {
    let hazards: Findings = (&frame.hazards)
        .into_iter()
        .cloned()
        .map(|hazard| Finding {
            severity: Severity::Error,
            ..hazard
        })
        .collect();
    hazards.into_result(())
}

/// A colour that is no finite number would go on into everything that is made of the picture.
pub(super) fn check_finite(picture: &Picture, plan: &Plan) -> Result<(), Findings> {
    let mut bad = picture
        .color
        .iter()
        .enumerate()
        .filter(|(_, color)| !color.iter().all(|c| c.is_finite()));
    let Some((first, color)) = bad.next() else {
        return Ok(());
    };
    let what = if color.iter().any(|c| c.is_nan()) {
        "not a number"
    } else {
        "infinite"
    };
    let width = picture.width as usize;
    let finding = Finding::error(
        "not-finite",
        format!(
            "the colour of {} of {} pixels is not finite; the first, at {}, {}, is {what}",
            bad.count() + 1,
            picture.color.len(),
            first % width,
            first / width
        ),
    )
    .help("does the shader divide by zero, take the root or the logarithm of a negative number, or normalise a zero vector?");
    let writer: Option<NodeId> = plan.graph.outputs.get("color").map(|link| link.node);
    let place = writer.and_then(|id| {
        let linked = &plan.graph.nodes[id].program.as_ref()?.module.linked;
        let technique = linked.slots_used.get("technique");
        technique.or_else(|| linked.files.last().map(|file| &file.path))
    });
    Err(match place {
        Some(file) => finding.at(Place::whole_file(file)).into(),
        None => finding.into(),
    })
}
