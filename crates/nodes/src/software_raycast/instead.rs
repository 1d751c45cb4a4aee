//! The software raycaster in place of a `raycast`, where there is no device.

use volgraph_graph::{NodeContext, NodeKind, View};
use volgraph_report::Finding;
use volgraph_software::{Attenuation, Classify};

use super::SoftwareRaycast;
use super::drawing::{MatterDrawing, Shows, SoftwareDrawing, scalar_shows, shared_volume};
use crate::raycast::Raycast;
use crate::reference::{behind, choice_of, rays};
use crate::transfer_table;

/// What it draws, as a remedy.
pub const HELP: &str = "it draws `dvr` (`unlit`), `mip`, `minip` and `isosurface` (`unlit` or `phong`) of a whole `trilinear` volume";

/// Slots, and the choices of them that it knows.
type Covered = &'static [(&'static str, &'static [&'static str])];

/// Of all techniques.
const COVERED: Covered = &[
    ("technique", &["dvr", "mip", "minip", "isosurface"]),
    ("reconstruct", &["trilinear"]),
    ("clip", &["none"]),
    ("labels", &["none"]),
    ("traverse", &["uniform", "skip"]),
];

/// Of emission and absorption: unlit, by any quadrature.
const OF_MATTER: Covered = &[
    ("light", &["unlit"]),
    ("colors", &["transfer"]),
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

const OF_PROJECTIONS: Covered = &[("tone", &["window"])];

/// Both ways to light make the same of a surface.
const OF_SURFACES: Covered = &[("light", &["unlit", "phong", "phong_ends"])];

/// Of surfaces in light.
const OF_LIT_SURFACES: Covered = &[
    ("gradient", &["stored"]),
    ("gradient_method", &["central"]),
    ("material", &["uniform"]),
    ("shadow", &["none"]),
    ("environment", &["none"]),
];

/// The first slot of a `raycast` whose choice it does not draw, with that choice; slots that the technique does not read do
/// not matter.
#[must_use]
pub fn undrawn_choice(choice_of: impl Fn(&str) -> String) -> Option<(&'static str, String)> {
    let technique = choice_of("technique");
    let is_lit = choice_of("light") != "unlit";
    let more: &[Covered] = match technique.as_str() {
        "dvr" => &[OF_MATTER],
        "isosurface" if is_lit => &[OF_SURFACES, OF_LIT_SURFACES],
        "isosurface" => &[OF_SURFACES],
        _ => &[OF_PROJECTIONS],
    };
    let all = COVERED.iter().chain(more.iter().copied().flatten());
    all.map(|(slot, choices)| (*slot, choice_of(slot), choices))
        .find(|(_, choice, choices)| !choices.contains(&choice.as_str()))
        .map(|(slot, choice, _)| (slot, choice))
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
    let technique = choice_of(node, "technique");
    let step = format!("at a step of {} voxels", drawing.step);
    let words = match drawing.shows {
        Shows::Matter(_) => format!("`{classify}` {step}"),
        Shows::Projection {
            of_samples: true, ..
        } => format!("`{technique}` of samples {step}"),
        Shows::Isosurface {
            is_linear: true, ..
        } => format!("`{technique}`, linear {step}"),
        _ => format!("`{technique}` from cell to cell"),
    };
    Ok((drawing, words))
}

fn of_raycast<'n>(
    node: &NodeContext<'n>,
    view: &View,
) -> Result<(SoftwareDrawing, &'n str), Finding> {
    if let Some((slot, choice)) = undrawn_choice(|slot| choice_of(node, slot).to_owned()) {
        return Err(not_covered(
            node,
            &format!("the choice `{choice}` of the slot `{slot}`"),
        ));
    }
    if let Some(shows) = scalar_shows(node)? {
        let drawing = SoftwareDrawing {
            rays: rays(view),
            volume: shared_volume(node)?,
            background: behind(node, view)?,
            step: node.float("step"),
            leaps: true,
            shows,
        };
        return Ok((drawing, ""));
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
        background: behind(node, view)?,
        step,
        leaps: true,
        shows: Shows::Matter(MatterDrawing {
            transfer: transfer_table::transfer(node, "transfer")?,
            classify,
            early_termination: node.float("early_termination"),
            table_size,
        }),
    };
    Ok((drawing, name))
}

fn not_covered(node: &NodeContext<'_>, what: &str) -> Finding {
    node.error(
        "not-covered",
        format!("the software raycaster does not draw {what}"),
    )
    .help(HELP)
}
