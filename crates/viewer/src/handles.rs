//! Clip shapes under the mouse: the faces of a clip box and clip planes, dragged along their normals.

use egui::{Color32, CursorIcon, Rect, Sense, Stroke, Ui, Vec2, vec2};
use glam::{DAffine3, DVec3};
use volgraph_engine::{ParamOverride, Plan};
use volgraph_graph::Node;
use volgraph_shader::ParamValue;
use volgraph_volume::Grid;

use crate::navigate::Navigation;
use crate::worker::Request;

/// Something to drag: where it is, where it goes, and what it changes.
#[derive(Clone, Debug, PartialEq)]
struct Handle {
    /// World position.
    at: DVec3,
    /// World shift for a growth of the number by 1.
    along: DVec3,
    /// The parameter and the index of its number.
    param: String,
    index: usize,
    /// Least and most.
    range: (f64, f64),
}

/// Draws the handles of the node that makes the picture, and gives what they ask for.
pub(crate) fn show(
    ui: &Ui,
    picture: Rect,
    navigation: &Navigation,
    plan: &Plan,
    grid: &Grid,
) -> Vec<Request> {
    let Some(node) = plan
        .graph
        .outputs
        .get("color")
        .map(|link| &plan.graph.nodes[link.node])
    else {
        return Vec::new();
    };
    let mut sets = Vec::new();
    let on_screen = |world: DVec3| {
        let [right, down] = navigation.project(world)?;
        Some(picture.center() + vec2(right as f32, down as f32) * picture.height())
    };
    for handle in handles(node, grid) {
        // A small part of the way tells the direction and the scale on the screen.
        let part = 0.01;
        let (Some(at), Some(next)) = (
            on_screen(handle.at),
            on_screen(handle.at + handle.along * part),
        ) else {
            continue;
        };
        let direction = (next - at) / part as f32;
        let id = ui.scope_id().with(("clip", &handle.param, handle.index));
        let response = ui.interact(
            Rect::from_center_size(at, Vec2::splat(18.0)),
            id,
            Sense::drag(),
        );
        let name = format!("{} {}", handle.param, handle.index);
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &name));
        let is_held = response.hovered() || response.dragged();
        let color = if is_held {
            Color32::WHITE
        } else {
            Color32::from_rgb(255, 120, 200)
        };
        let painter = ui.painter_at(picture);
        let arrow = direction.normalized() * 22.0;
        painter.arrow(at - 0.5 * arrow, arrow, Stroke::new(2.0, color));
        painter.circle(at, 5.0, color, Stroke::new(1.0, Color32::BLACK));
        if is_held {
            ui.set_cursor_icon(CursorIcon::Grab);
        }
        let moved = growth(response.drag_delta(), direction);
        if response.dragged() && moved != 0.0 {
            sets.extend(set(node, &handle, moved));
        }
    }
    if sets.is_empty() {
        Vec::new()
    } else {
        vec![Request::Set(sets)]
    }
}

/// How much a number grows by a drag, where its growth by 1 moves the handle by `direction`.
fn growth(drag: Vec2, direction: Vec2) -> f64 {
    let length = direction.length_sq();
    // A handle that is seen from its end is not dragged.
    if length < 1.0 {
        0.0
    } else {
        f64::from(drag.dot(direction) / length)
    }
}

fn set(node: &Node, handle: &Handle, moved: f64) -> Option<ParamOverride> {
    let Some(ParamValue::Vector(numbers)) = node.params.get(&handle.param) else {
        return None;
    };
    let mut numbers = numbers.clone();
    let number = numbers.get_mut(handle.index)?;
    *number = (*number + moved).clamp(handle.range.0, handle.range.1);
    let numbers: Vec<String> = numbers.iter().map(|number| format!("{number:?}")).collect();
    ParamOverride::parse(&format!(
        "{}.{}=({})",
        node.name,
        handle.param,
        numbers.join(", ")
    ))
    .ok()
}

fn handles(node: &Node, grid: &Grid) -> Vec<Handle> {
    let vector = |name: &str| match node.params.get(name) {
        Some(ParamValue::Vector(numbers)) => Some(numbers.clone()),
        _ => None,
    };
    let mut handles = Vec::new();
    if let (Some(low), Some(high)) = (vector("clip_low"), vector("clip_high")) {
        box_handles(
            DVec3::from_slice(&low),
            DVec3::from_slice(&high),
            grid,
            &mut handles,
        );
    }
    if let Some(ParamValue::Int(count)) = node.params.get("planes") {
        let is_world = node.params.get("space") == Some(&ParamValue::Text("world".to_owned()));
        for number in 1..=*count {
            let name = format!("plane_{number}");
            if let Some(plane) = vector(&name) {
                handles.extend(plane_handle(&plane, name, grid, is_world));
            }
        }
    }
    handles
}

/// World from shares of the volume's box.
fn world_from_share(grid: &Grid) -> DAffine3 {
    let (low, high) = grid.box_index();
    grid.world_from_index * DAffine3::from_translation(low) * DAffine3::from_scale(high - low)
}

fn box_handles(low: DVec3, high: DVec3, grid: &Grid, handles: &mut Vec<Handle>) {
    let world = world_from_share(grid);
    let middle = 0.5 * (low + high);
    for index in 0..3 {
        for (param, share, range) in [
            ("clip_low", low[index], (0.0, high[index])),
            ("clip_high", high[index], (low[index], 1.0)),
        ] {
            let mut at = middle;
            at[index] = share;
            handles.push(Handle {
                at: world.transform_point3(at),
                along: world.matrix3.col(index),
                param: param.to_owned(),
                index,
                range,
            });
        }
    }
}

/// The handle of a plane, at its point nearest to where positions count from.
fn plane_handle(plane: &[f64], param: String, grid: &Grid, is_world: bool) -> Option<Handle> {
    let &[x, y, z, offset] = plane else {
        return None;
    };
    let normal = DVec3::new(x, y, z).try_normalize()?;
    let world = world_from_share(grid);
    let half = [0, 1, 2].map(|axis| 0.5 * world.matrix3.col(axis).length());
    let half_side = half.into_iter().fold(f64::INFINITY, f64::min);
    let (from, scale) = match is_world {
        true => (DVec3::ZERO, 1.0),
        false => (world.transform_point3(DVec3::splat(0.5)), half_side),
    };
    Some(Handle {
        at: from + normal * offset * scale,
        along: normal * scale,
        param,
        index: 3,
        range: (-1e9, 1e9),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faces_of_a_box_are_dragged_along_the_axes_of_the_volume() {
        let grid = Grid::axis_aligned([10, 20, 40], DVec3::new(2.0, 1.0, 1.0), DVec3::ZERO);
        let mut handles = Vec::new();
        box_handles(DVec3::ZERO, DVec3::new(1.0, 1.0, 0.5), &grid, &mut handles);
        assert_eq!(handles.len(), 6);
        // The upper face across z, in the middle of the others: voxels are whole, so the box starts at -0.5.
        let top = &handles[5];
        assert!(
            top.at.distance(DVec3::new(9.0, 9.5, 19.5)) < 1e-9,
            "{}",
            top.at
        );
        assert!(top.along.distance(DVec3::Z * 40.0) < 1e-9);
        assert_eq!(growth(vec2(3.0, 4.0), vec2(30.0, 40.0)), f64::from(0.1_f32));
        assert_eq!(growth(vec2(3.0, 4.0), Vec2::ZERO), 0.0);
    }

    #[test]
    fn planes_count_from_where_their_space_says() {
        let grid = Grid::axis_aligned([10, 20, 40], DVec3::ONE, DVec3::splat(0.5));
        let plane =
            |is_world| plane_handle(&[0.0, 0.0, 2.0, 0.5], "plane_1".to_owned(), &grid, is_world);
        assert!(plane(true).unwrap().at.distance(DVec3::Z * 0.5) < 1e-9);
        assert!(
            plane(false)
                .unwrap()
                .at
                .distance(DVec3::new(5.0, 10.0, 22.5))
                < 1e-9
        );
        assert_eq!(
            plane_handle(&[0.0; 4], "plane_1".to_owned(), &grid, true),
            None
        );
    }
}
