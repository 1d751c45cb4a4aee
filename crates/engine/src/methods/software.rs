//! The axes of the software raycaster, where it draws what a raycast draws.

use volgraph_graph::{NodeId, Plan};
use volgraph_nodes::software_raycast::{HELP, instead_of, undrawn_choice};
use volgraph_report::{Finding, Place};
use volgraph_shader::{ParamSpec, ParamValue};

use super::filter::{Filter, Wanted};
use super::offered::{METHOD_NUMBERS, SOFTWARE_CHOICES, add, choices, number_of, numbers};
use super::space::Axis;
use crate::renderer::{DEVICE, RENDERER, SOFTWARE, is_software, software_specs};

/// The axis of renderers, and those of the software raycaster; none where it does not draw the same picture, or where
/// filters leave nothing of it.
pub(super) fn axes(plan: &Plan, id: NodeId, filters: &[Filter]) -> (Option<Axis>, Vec<Axis>) {
    let text = |word: &str| ParamValue::Text(word.to_owned());
    let wanted = filters.iter().find(|filter| filter.name == RENDERER);
    let wants = |word: &str| {
        wanted.is_none_or(|filter| {
            let mut all = filter.wanted.iter();
            all.any(|it| *it == Wanted::All || *it == Wanted::Value(word.to_owned()))
        })
    };
    let software = wants(SOFTWARE)
        .then(|| offered(plan, id, filters))
        .flatten()
        .unwrap_or_default();
    let mut values = Vec::new();
    if wants(DEVICE) && !is_software(&plan.graph.nodes[id].kind_name()) {
        values.push(text(DEVICE));
    }
    if !software.is_empty() {
        values.push(text(SOFTWARE));
    }
    let is_alone = values == [text(DEVICE)] && wanted.is_none();
    let renderer = Axis {
        name: RENDERER.to_owned(),
        is_slot: false,
        values,
        base: 0,
        is_software: false,
        of_choice: None,
    };
    let is_choice = !renderer.values.is_empty() && !is_alone;
    (is_choice.then_some(renderer), software)
}

/// Why a filter of renderers names none that there is.
pub(super) fn unoffered(plan: &Plan, id: NodeId, filter: &Filter) -> Finding {
    let node = &plan.graph.nodes[id];
    let message = format!(
        "`{}`, a `{}`, has no such renderer with what else is wanted",
        node.name,
        node.kind_name()
    );
    Finding::error("bad-methods", message)
        .at(Place::whole_file(format!("--methods {}", filter.name)))
        .help(format!("`device` is a raycast's own; `software`: {HELP}"))
}

/// Whether the software raycaster draws the same picture as a node of the device.
pub(crate) fn draws_the_same(plan: &Plan, id: NodeId) -> bool {
    // It has a colour alone.
    let is_more = |output: &volgraph_graph::Link| output.node == id && output.port != "color";
    let view = plan.view();
    !plan.graph.outputs.values().any(is_more)
        && instead_of(&plan.context(id, &view, None), &view).is_ok()
}

fn offered(plan: &Plan, id: NodeId, filters: &[Filter]) -> Option<Vec<Axis>> {
    let node = &plan.graph.nodes[id];
    if is_software(&node.kind_name()) || !draws_the_same(plan, id) {
        return None;
    }
    let choice_of = |slot: &str| node.slots.get(slot).map_or("", |it| &it.choice).to_owned();
    // Classification and its end are of emission and absorption.
    let is_matter = choice_of("technique") == "dvr";
    let is_read = |name: &&str| is_matter || ["traverse", "step"].contains(name);
    let own = |name: &str| node.params.get(name).cloned();
    let specs = software_specs();
    let spec = |name: &str| specs.iter().find(|spec| spec.name == name);
    let named = SOFTWARE_CHOICES
        .iter()
        .filter(|name| is_read(name))
        .filter_map(|name| Some((*name, choices(spec(name)?))));
    let numbered = METHOD_NUMBERS.iter().filter(|(name, _)| is_read(name));
    let numbered = numbered.filter_map(|(name, multiples)| {
        let spec = spec(name)?;
        let own = own(name).and_then(|value| spec.check(&value).ok());
        Some((*name, numbers(spec, multiples, own)))
    });
    let mut axes: Vec<Axis> = named
        .chain(numbered)
        .map(|(name, values)| axis(name, values))
        .collect();
    for filter in filters.iter().filter(|filter| filter.name != RENDERER) {
        let Some(spec) = spec(&filter.name) else {
            // Of slots that it has no parameter for it must draw one of the choices.
            let mut wanted = filter.wanted.iter();
            let is_drawn = wanted.any(|it| match it {
                Wanted::Value(choice) => {
                    let with_it = |slot: &str| {
                        if slot == filter.name {
                            choice.clone()
                        } else {
                            choice_of(slot)
                        }
                    };
                    undrawn_choice(with_it).is_none()
                }
                Wanted::All | Wanted::Doubles(..) => true,
            });
            if is_drawn {
                continue;
            }
            return None;
        };
        let values = values(spec, filter);
        match axes.iter_mut().find(|axis| axis.name == filter.name) {
            _ if values.is_empty() => return None,
            Some(axis) => axis.values = values,
            None => axes.push(axis(&filter.name, values)),
        }
    }
    for axis in &mut axes {
        let own = own(&axis.name);
        let at = own.and_then(|own| axis.values.iter().position(|value| *value == own));
        axis.base = at.unwrap_or(0);
    }
    Some(axes)
}

/// What a filter leaves of a parameter; values that it does not take are another renderer's.
fn values(spec: &ParamSpec, filter: &Filter) -> Vec<ParamValue> {
    let mut values = Vec::new();
    for wanted in &filter.wanted {
        let found = match wanted {
            Wanted::All => choices(spec),
            Wanted::Doubles(..) => {
                let numbers = wanted.doubles().into_iter();
                numbers
                    .filter_map(|number| spec.parse_cli(&number_of(spec, number)).ok())
                    .collect()
            }
            Wanted::Value(text) => spec.parse_cli(text).ok().into_iter().collect(),
        };
        for value in found {
            add(&mut values, Some(value));
        }
    }
    values
}

fn axis(name: &str, values: Vec<ParamValue>) -> Axis {
    Axis {
        name: name.to_owned(),
        is_slot: false,
        values,
        base: 0,
        is_software: true,
        of_choice: None,
    }
}
