//! What the slots of a raycast declare about their order, and which quantity it is said of.

use serde::Serialize;
use volgraph_graph::Node;
use volgraph_report::Findings;
use volgraph_shader::ParamValue;
use volgraph_shader::order::order_where;

use super::Axis;

/// An order that a slot's choice declares.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Declared {
    /// The order.
    pub order: f64,
    /// The slot and its choice, `classify post`; or the option.
    pub by: String,
}

/// The slots whose orders are in the step, and the one whose order is in the spacing of the grid.
const OF_STEP: [&str; 3] = ["technique", "classify", "traverse"];
const OF_GRID: [&str; 1] = ["reconstruct"];

/// What the choices of a raycast declare: the lowest of their orders. `None` where none says anything.
///
/// # Errors
/// `order-doc` where a file's declaration cannot be read.
pub(super) fn of(node: &Node, axis: Axis) -> Result<Option<Declared>, Findings> {
    let slots: &[&str] = match axis {
        Axis::Step => &OF_STEP,
        Axis::Grid => &OF_GRID,
        Axis::Pixel => &[],
    };
    let Some(program) = &node.program else {
        return Ok(None);
    };
    let mut lowest: Option<Declared> = None;
    for slot in slots {
        let orders = program.module.linked.declared_orders(slot)?;
        let choice = |param: &str| match node.params.get(param) {
            Some(ParamValue::Text(choice)) => Some(choice.clone()),
            _ => None,
        };
        let Some(order) = order_where(&orders, choice) else {
            continue;
        };
        if lowest.as_ref().is_none_or(|lowest| order < lowest.order) {
            let choice = node.slots.get(*slot).map_or("", |it| it.choice.as_str());
            lowest = Some(Declared {
                order,
                by: format!("{slot} {choice}"),
            });
        }
    }
    Ok(lowest)
}

/// The quantity that a raycast's order is said of: colour where segments are classified, else the depth of the hit.
/// Colours of lit surfaces depend on how gradients are taken as well, and are reported alone.
pub(super) fn quantity(node: &Node) -> &'static str {
    let is_classified = node.program.as_ref().is_some_and(|program| {
        let slots = &program.module.linked.slots_used;
        slots.contains_key("classify") || slots.contains_key("tone")
    });
    if is_classified { "colour" } else { "depth" }
}
