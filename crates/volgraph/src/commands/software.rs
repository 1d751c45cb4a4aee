//! The software raycaster in place of a device.

use volgraph::Picture;
use volgraph_graph::{Plan, View};
use volgraph_nodes::software_raycast::{SoftwareMemory, instead_of};
use volgraph_report::Finding;

/// The picture of a plan, and in words by whom it is drawn.
///
/// # Errors
/// `not-covered` where it draws another technique, or where more than the colour is wanted.
pub fn draw(plan: &Plan, view: &View) -> Result<(Picture, String), Finding> {
    let not_covered = |what: &str| {
        let message = format!("the software raycaster draws no {what}");
        Finding::error("not-covered", message).help("name the port `color` alone as an output")
    };
    let mut outputs = plan.graph.outputs.iter();
    let (Some((_, output)), None) = (outputs.next(), outputs.next()) else {
        return Err(not_covered("outputs beside the colour"));
    };
    if output.port != "color" {
        return Err(not_covered(&format!("output `{}`", output.port)));
    }
    let (drawing, method) = instead_of(&plan.context(output.node, view, None), view)?;
    let color = drawing.render(&SoftwareMemory::default())?;
    let [width, height] = view.size;
    let picture = Picture::from_color(width, height, color)
        .map_err(|error| Finding::error("picture", error.to_string()))?;
    let who = format!("the software raycaster, on the processor, {method}");
    Ok((picture, who))
}
