//! `--set NODE.renderer=software`: a node of the kind `raycast` as a `software_raycast`, which draws the same picture on the
//! processor.
//!
//! `renderer` is no parameter of a kind but of all raycasts: [`Overrides`](crate::Overrides) take it as a word of their own,
//! after all that is set beside it. What the software raycaster does not draw is refused, so that no picture changes.

use std::sync::OnceLock;

use volgraph_graph::{NodeDesc, NodeKind, ParamDesc};
use volgraph_nodes::raycast::Raycast;
use volgraph_nodes::software_raycast::{HELP, SoftwareRaycast, undrawn_choice};
use volgraph_report::{Finding, Place};
use volgraph_shader::{ParamSpec, ParamValue};

use crate::overrides::ParamOverride;

/// The word that is set.
pub const RENDERER: &str = "renderer";

/// The node's own kind.
pub const DEVICE: &str = "device";

/// The software raycaster.
pub const SOFTWARE: &str = "software";

/// The software raycaster's parameters.
pub(crate) fn software_specs() -> &'static [ParamSpec] {
    static SPECS: OnceLock<Vec<ParamSpec>> = OnceLock::new();
    SPECS.get_or_init(|| SoftwareRaycast::default().params())
}

/// Whether a kind is that of the software raycaster.
pub(crate) fn is_software(kind: &str) -> bool {
    kind == SoftwareRaycast::default().name()
}

/// Why the software raycaster cannot take the place of a node, by what is written of it.
///
/// # Errors
/// `not-covered`.
pub(crate) fn check_software(name: &str, node: &NodeDesc) -> Result<(), Finding> {
    let refused = |what: String, help: &str| {
        let message = format!("the software raycaster does not draw {what}");
        Err(Finding::error("not-covered", message).help(help))
    };
    if node.kind != Raycast.name() && !is_software(&node.kind) {
        return refused(
            format!("what `{name}` draws, a `{}`", node.kind),
            "set it for a `raycast`",
        );
    }
    if let Some((slot, choice)) = undrawn_choice(|slot| written_choice(node, slot)) {
        let what = format!("the choice `{choice}` of the slot `{slot}` of `{name}`");
        return refused(what, HELP);
    }
    Ok(())
}

/// What is written of a slot: of the software raycaster in its parameter of that name; else a raycast's default.
fn written_choice(node: &NodeDesc, slot: &str) -> String {
    let own = if is_software(&node.kind) {
        node.params.get(slot)
    } else {
        node.slots.get(slot)
    };
    if let Some(ParamValue::Text(choice)) = own.map(|desc| &desc.value) {
        return choice.clone();
    }
    let mut slots = Raycast.slots().iter();
    let default = slots.find(|it| it.name == slot);
    default.map_or_else(String::new, |it| it.default.to_owned())
}

/// Whether the software raycaster may draw for a node, or go on drawing, with what is set by name: it draws what is written
/// of the node, and none of its slots is set, which it does not have.
pub(crate) fn may_take_over(name: &str, node: &NodeDesc, sets: &[ParamOverride]) -> bool {
    let is_of_the_device = |set: &ParamOverride| {
        let is_slot = set.is_slot && ["classify", "traverse"].contains(&set.name.as_str());
        let is_device = set.name == RENDERER && set.value != ParamValue::Text(SOFTWARE.to_owned());
        set.target == name && (is_slot || is_device)
    };
    check_software(name, node).is_ok() && !sets.iter().any(is_of_the_device)
}

/// Sets the renderer of a node.
///
/// # Errors
/// `not-covered`, `bad-param` for another word than `device` or `software`.
pub(crate) fn set_renderer(
    name: &str,
    node: &mut NodeDesc,
    value: &ParamValue,
    place: &Place,
) -> Result<(), Finding> {
    match value {
        ParamValue::Text(text) if text == DEVICE && !is_software(&node.kind) => return Ok(()),
        ParamValue::Text(text) if text == SOFTWARE => {}
        _ => {
            let message = format!("`{value}` is no renderer of `{name}`, a `{}`", node.kind);
            return Err(Finding::error("bad-param", message)
                .at(place.clone())
                .help("write `device` for its own kind, or `software` for the software raycaster in place of a `raycast`"));
        }
    }
    check_software(name, node).map_err(|finding| finding.at(place.clone()))?;
    if is_software(&node.kind) {
        return Ok(());
    }
    SoftwareRaycast::default().name().clone_into(&mut node.kind);
    let slots = std::mem::take(&mut node.slots);
    for (slot, choice) in slots {
        let words = software_word(&slot, &choice.value);
        if let (Some(word), false) = (words, node.params.contains_key(&slot)) {
            let value = ParamValue::Text(word.to_owned());
            node.params.insert(slot, ParamDesc { value, ..choice });
        }
    }
    let inputs = SoftwareRaycast::default();
    node.inputs
        .retain(|port, _| inputs.inputs().iter().any(|input| input.name == port));
    node.params.retain(|param, desc| {
        let mut specs = software_specs().iter();
        specs.any(|spec| spec.name == *param && spec.check(&desc.value).is_ok())
    });
    Ok(())
}

/// The software raycaster's word for a choice of a slot, where that is not its default.
fn software_word(slot: &str, choice: &ParamValue) -> Option<&'static str> {
    match (slot, choice) {
        ("classify", ParamValue::Text(choice)) if choice == "post" => Some("post"),
        ("traverse", ParamValue::Text(choice)) if choice == "uniform" => Some("uniform"),
        ("light", ParamValue::Text(choice)) if choice != "unlit" => Some("phong"),
        ("technique", ParamValue::Text(choice)) => {
            let all = ["mip", "minip", "isosurface"];
            all.into_iter().find(|word| word == choice)
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Overrides;

    fn overridden(
        graph: &str,
        sets: &[&str],
    ) -> Result<volgraph_graph::GraphDesc, volgraph_report::Findings> {
        let mut desc = volgraph_graph::read::graph("t.ron".as_ref(), graph)?;
        let sets = sets.iter().map(|set| ParamOverride::parse(set).unwrap());
        let overrides = Overrides {
            params: sets.collect(),
            ..Overrides::default()
        };
        overrides.apply(&mut desc)?;
        Ok(desc)
    }

    #[test]
    fn a_raycast_becomes_a_software_raycast_with_what_both_know() {
        let comparison = include_str!("../../../graphs/comparison.ron");
        let desc = overridden(
            comparison,
            &[
                "image.renderer=software",
                "image.stage=compute",
                "image.step=2",
            ],
        )
        .unwrap();
        let node = &desc.nodes["image"];
        assert_eq!(node.kind, "software_raycast");
        let inputs: Vec<&String> = node.inputs.keys().collect();
        assert_eq!(inputs, ["volume", "transfer", "behind"]);
        assert!(node.slots.is_empty());
        let text = |name: &str| node.params.get(name).map(|it| it.value.to_string());
        assert_eq!(text("classify").as_deref(), Some("post"));
        assert!(text("step").is_some() && text("stage").is_none());
        // Again, and what is set after it.
        let again = [
            "image.renderer=software",
            "image.renderer=software",
            "image.classify=integral_1d",
        ];
        let node = &overridden(comparison, &again).unwrap().nodes["image"];
        assert_eq!(node.params["classify"].value.to_string(), "integral_1d");
        // What a technique does not read does not matter.
        let sets = [
            "image.renderer=software",
            "image.slots.technique=isosurface",
            "image.slots.light=phong_ends",
            "image.slots.tone=transfer",
            "image.isovalue=0.25",
            "image.refinement=bisection",
        ];
        let node = &overridden(comparison, &sets).unwrap().nodes["image"];
        let text = |name: &str| node.params.get(name).map(|it| it.value.to_string());
        assert_eq!(text("technique").as_deref(), Some("isosurface"));
        assert_eq!(text("light").as_deref(), Some("phong"));
        assert_eq!(text("isovalue").as_deref(), Some("0.25"));
        assert_eq!(text("refinement"), None);
        let mip = ["image.slots.technique=mip", "image.slots.light=phong"];
        let sets = [&mip[..], &["image.renderer=software"]].concat();
        assert_eq!(
            overridden(comparison, &sets).unwrap().nodes["image"].kind,
            "software_raycast"
        );
        let device = overridden(comparison, &["image.renderer=device"]).unwrap();
        assert_eq!(device.nodes["image"].kind, "raycast");
    }

    #[test]
    fn what_it_does_not_draw_is_refused() {
        let comparison = include_str!("../../../graphs/comparison.ron");
        let code = |sets: &[&str]| {
            let findings = overridden(comparison, sets).unwrap_err();
            findings.sorted()[0].code
        };
        let software = "image.renderer=software";
        assert_eq!(code(&[software, "image.slots.light=phong"]), "not-covered");
        assert_eq!(
            code(&[software, "image.slots.technique=xray"]),
            "not-covered"
        );
        let mip = "image.slots.technique=mip";
        assert_eq!(
            code(&[software, mip, "image.slots.tone=transfer"]),
            "not-covered"
        );
        let surface = [
            "image.slots.technique=isosurface",
            "image.slots.light=phong",
        ];
        for slot in ["shadow=surface", "gradient=tricubic", "material=transfer"] {
            let slot = format!("image.slots.{slot}");
            let sets = [&[software][..], &surface, &[&slot]].concat();
            assert_eq!(code(&sets), "not-covered", "{slot}");
        }
        assert_eq!(code(&["box.renderer=software"]), "not-covered");
        assert_eq!(code(&["image.renderer=gpu"]), "bad-param");
    }
}
