//! What in a scene limits the order that any method can show in it.
//!
//! A quadrature of order p needs as many derivatives along the ray. A trilinear field has none across the faces between
//! its cells, nor a transfer function at its control points; where steps do not end there, a kink costs all methods but
//! those that know of it the orders above 2, and a jump those above 1. Hits of surfaces are found as precisely beside a
//! kink, but for those in the few segments that have one.

use serde::Serialize;
use volgraph_graph::{NodeContext, View};
use volgraph_nodes::reference::raycast_scene;
use volgraph_reference::{Field, Matter, Technique};

/// What limits the order, and to what.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SceneLimit {
    /// Higher ones need not show here.
    pub order: f64,
    /// Why.
    pub because: String,
}

/// The limits of a raycast's scene, as far as the reference knows the scene.
pub(super) fn of(node: &NodeContext<'_>, view: &View) -> Vec<SceneLimit> {
    let Ok(scene) = raycast_scene(node, view) else {
        return Vec::new();
    };
    let mut limits = Vec::new();
    if has_kinks(&scene.field) {
        limits.push(SceneLimit {
            order: 2.0,
            because:
                "the field has kinks where rays cross from cell to cell, and steps do not end there"
                    .to_owned(),
        });
    }
    if let Technique::VolumeRendering = scene.technique {
        let matters = scene.looks.iter().filter_map(|look| look.matter.as_ref());
        limits.extend(matters.filter_map(|matter| of_matter(matter, scene.field.range())));
    }
    limits
}

/// Whether there is more than one cell: the box of a single one spans one unit of index space between its samples.
fn has_kinks(field: &Field) -> bool {
    let (low, high) = field.box_index();
    low.min_element() < 0.0 || (high - low).max_element() > 1.0
}

fn of_matter(matter: &Matter, (least, most): (f64, f64)) -> Option<SceneLimit> {
    let inside = |knot: &&f64| **knot > least && **knot < most;
    let knots: Vec<f64> = matter.knots().iter().filter(inside).copied().collect();
    let first = knots.first()?;
    let jump = knots.iter().find(|knot| {
        let part = matter.part_of(**knot);
        // Control points at one position: the part before the first of them ends elsewhere than this one starts.
        let before = matter.knots().partition_point(|it| it < knot);
        let ((from, below), (to, above)) = (matter.at(before, **knot), matter.at(part, **knot));
        let differs = |a: f64, b: f64| (a - b).abs() > 1e-9 * a.abs().max(b.abs());
        differs(below, above) || (0..3).any(|i| differs(from[i], to[i]))
    });
    Some(match jump {
        Some(at) => SceneLimit {
            order: 1.0,
            because: format!("the transfer function jumps at {at}, and steps do not end there"),
        },
        None => SceneLimit {
            order: 2.0,
            because: format!(
                "the transfer function has kinks (the first at {first}), and steps do not end there"
            ),
        },
    })
}
