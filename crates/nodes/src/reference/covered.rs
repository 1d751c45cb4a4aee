//! What of a raycast's choices the reference computes; all others are refused by name.

use volgraph_graph::{NodeContext, NodeKind};
use volgraph_report::Finding;

use crate::raycast::Raycast;
use crate::software_raycast::SoftwareRaycast;

/// The choice of a slot: of the software raycaster its parameter of that name, of a renderer that has no such slot what a
/// raycast does by default.
pub(crate) fn choice_of<'g>(node: &NodeContext<'g>, name: &str) -> &'g str {
    let is_software = || node.kind_name() == SoftwareRaycast::default().name();
    match node.slot(name) {
        "" if !node.text(name).is_empty() && is_software() => node.text(name),
        "" => {
            let slots = Raycast.slots().iter();
            let mut own = slots.filter(|slot| slot.name == name);
            own.next().map_or("", |slot| slot.default)
        }
        choice => choice,
    }
}

/// Choices that are computed, or that all approximate what is computed, slot by slot.
const COVERED: &[(&str, &[&str])] = &[
    (
        "technique",
        &[
            "dvr",
            "mip",
            "minip",
            "average",
            "xray",
            "isosurface",
            "isosurfaces_translucent",
            "isosurface_dvr",
        ],
    ),
    (
        "reconstruct",
        &["trilinear", "nearest", "tricubic", "catmull_rom"],
    ),
    ("gradient", &["stored", "central", "analytic", "tricubic"]),
    ("gradient_method", &["central", "sobel"]),
    // The truth is that of gradients as they are: what storage loses is an error.
    ("gradient_storage", &["rgba16f", "rgba8", "rgba32f"]),
    // Quadratures of one integral.
    (
        "classify",
        &[
            "post",
            "gauss2",
            "simpson",
            "second_order",
            "integral_1d",
            "preintegrated_2d",
            "preintegrated_3d",
        ],
    ),
    // Which segments are looked into changes no picture.
    (
        "heed",
        &[
            "all",
            "isovalue",
            "absorbing",
            "absorbing_ends",
            "absorbing_centre",
        ],
    ),
    ("walk", &["segments", "pairs"]),
    ("steps", &["table", "computed"]),
    // Leaps are over what is not seen.
    ("traverse", &["uniform", "skip", "adaptive"]),
    (
        "emptiness",
        &[
            "none",
            "transfer",
            "isovalue",
            "isovalue_transfer",
            "isosurfaces",
            "maximum",
            "minimum",
        ],
    ),
    ("tone", &["window", "transfer"]),
    // Both approximate light at each point.
    ("light", &["unlit", "phong", "phong_ends"]),
    ("material", &["uniform", "transfer", "preintegrated"]),
    ("shadow", &["none", "surface", "transmittance"]),
    ("environment", &["none"]),
    ("clip", &["none", "planes", "box", "sphere", "volume"]),
    ("labels", &["none", "volume"]),
];

/// Techniques that compose light, or project scalars.
pub(super) fn is_projection(technique: &str) -> bool {
    matches!(technique, "mip" | "minip" | "average" | "xray")
}

/// Whether a technique reads a slot, given the choices of others.
fn is_read(node: &NodeContext<'_>, slot: &str) -> bool {
    let technique = choice_of(node, "technique");
    let has_surfaces = technique.starts_with("isosurface");
    let is_lit = !is_projection(technique) && choice_of(node, "light") != "unlit";
    match slot {
        "tone" => is_projection(technique) && technique != "xray",
        "classify" => matches!(technique, "dvr" | "isosurface_dvr"),
        "colors" => technique == "dvr",
        "light" => !is_projection(technique),
        "material" | "shadow" => is_lit,
        "gradient" => is_lit || has_surfaces,
        "gradient_method" | "gradient_storage" => {
            (is_lit || has_surfaces) && choice_of(node, "gradient") == "stored"
        }
        "environment" => is_lit && has_surfaces,
        _ => true,
    }
}

/// Refuses choices that the reference does not know, and slots that it has never heard of unless they are left alone.
pub(super) fn check(node: &NodeContext<'_>) -> Result<(), Finding> {
    for slot in Raycast.slots() {
        let choice = choice_of(node, slot.name);
        let known = COVERED.iter().find(|(name, _)| *name == slot.name);
        let alone = [slot.default];
        let choices = known.map_or(&alone[..], |(_, choices)| *choices);
        if choices.contains(&choice) || !is_read(node, slot.name) {
            continue;
        }
        let what = format!("the choice `{choice}` of its slot `{}`", slot.name);
        let known = choices.join("`, `");
        return Err(refusal(node, &what).help(format!(
            "compare with a choice that it computes (`{known}`), or with the same graph at a much smaller step"
        )));
    }
    // Inside of a volume each point of a ray would have a ray of its own, and light jumps along it.
    let (technique, shadow) = (choice_of(node, "technique"), choice_of(node, "shadow"));
    let is_one_solid = technique == "isosurface";
    if is_read(node, "shadow")
        && !(shadow == "none" || (is_one_solid && choice_of(node, "reconstruct") == "trilinear"))
    {
        let what = format!("the shadow `{shadow}` with this technique or reconstruction");
        return Err(refusal(node, &what)
            .help("compare with the same graph at a much smaller step, or without shadows"));
    }
    Ok(())
}

/// A finding of what the reference does not compute.
pub(super) fn refusal(node: &NodeContext<'_>, what: &str) -> Finding {
    node.error(
        "not-covered",
        format!("the reference does not compute {what}"),
    )
}
