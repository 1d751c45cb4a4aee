//! The software raycaster in place of a `raycast`, where there is no device.

use volgraph_graph::{NodeContext, NodeKind, View};
use volgraph_report::Finding;
use volgraph_software::{Attenuation, Classify};

use super::SoftwareRaycast;
use super::drawing::{SoftwareDrawing, shared_volume};
use crate::raycast::Raycast;
use crate::reference::{behind, rays};
use crate::transfer_table;

/// The slots whose choices it knows: unlit emission and absorption of the whole trilinear field, by any quadrature.
const COVERED: &[(&str, &[&str])] = &[
    ("technique", &["dvr"]),
    ("reconstruct", &["trilinear"]),
    ("light", &["unlit"]),
    ("clip", &["none"]),
    ("labels", &["none"]),
    ("traverse", &["uniform", "skip"]),
    (
        "classify",
        &[
            "post",
            "integral_1d",
            "gauss2",
            "simpson",
            "second_order",
            "preintegrated_2d",
            "preintegrated_3d",
        ],
    ),
];

/// Whether it draws what a choice of a `raycast`'s slot draws; also of slots that it does not know of.
#[must_use]
pub fn covers(slot: &str, choice: &str) -> bool {
    let known = COVERED.iter().find(|(known, _)| *known == slot);
    known.is_none_or(|(_, choices)| choices.contains(&choice))
}

/// What it draws in place of a `raycast`, or for a `software_raycast`, and in words by which method.
///
/// # Errors
/// `not-covered` for what it does not draw; `missing-input`.
pub fn instead_of(
    node: &NodeContext<'_>,
    view: &View,
) -> Result<(SoftwareDrawing, String), Finding> {
    let kind = node.kind_name();
    let (drawing, classify) = if kind == SoftwareRaycast::default().name() {
        (SoftwareDrawing::of(node, view)?, node.text("classify"))
    } else if kind == Raycast.name() {
        of_raycast(node, view)?
    } else {
        return Err(not_covered(node, &format!("the kind `{kind}`")));
    };
    let words = format!("`{classify}` at a step of {} voxels", drawing.step);
    Ok((drawing, words))
}

fn of_raycast<'n>(
    node: &NodeContext<'n>,
    view: &View,
) -> Result<(SoftwareDrawing, &'n str), Finding> {
    for (slot, _) in COVERED {
        let choice = node.slot(slot);
        if !covers(slot, choice) {
            return Err(not_covered(
                node,
                &format!("the choice `{choice}` of the slot `{slot}`"),
            ));
        }
    }
    let exact = Classify::Integral1d(Attenuation::Exact);
    let step = node.float("step");
    // Tables over two scalars are better than those over one where colours change in dense matter: half the step.
    let (classify, name, step) = match (node.slot("classify"), node.text("attenuation")) {
        ("post", _) => (Classify::Post, "post", step),
        ("integral_1d", "four_lines") => {
            let lines = Classify::Integral1d(Attenuation::FourLines);
            (lines, "integral_1d", step)
        }
        ("integral_1d", _) => (exact, "integral_1d", step),
        _ => (exact, "integral_1d", 0.5 * step),
    };
    let table_size = match node.uint("table_size") {
        0 => 8192,
        size => size,
    };
    let drawing = SoftwareDrawing {
        rays: rays(view),
        volume: shared_volume(node)?,
        transfer: transfer_table::transfer(node, "transfer")?,
        classify,
        background: behind(node, view)?,
        step,
        early_termination: node.float("early_termination"),
        leaps: true,
        table_size,
    };
    Ok((drawing, name))
}

fn not_covered(node: &NodeContext<'_>, what: &str) -> Finding {
    node.error(
        "not-covered",
        format!("the software raycaster does not draw {what}"),
    )
    .help("it draws unlit emission and absorption of a whole volume: `dvr`, `trilinear`, `unlit`")
}
