//! The curve over the histogram, and the points under the mouse.

use egui::{Color32, Mesh, Pos2, Rect, Sense, Stroke, Ui, pos2, vec2};
use volgraph_optics::ControlPoint;

use super::{TransferSight, remove, srgb};
use crate::histogram::{Counted, Scale};
use crate::transfer::TransferEdit;
use crate::worker::Request;

/// How near to a point a click picks it, in points of the screen.
const NEAR: f32 = 9.0;

/// Where scalars and opacities lie on the screen.
struct Frame {
    rect: Rect,
    low: f64,
    high: f64,
}

impl Frame {
    fn place(&self, data: f64, opacity: f64) -> Pos2 {
        let across = ((data - self.low) / (self.high - self.low)) as f32;
        pos2(
            self.rect.left() + across * self.rect.width(),
            self.rect.bottom() - opacity as f32 * self.rect.height(),
        )
    }

    fn data(&self, at: Pos2) -> f64 {
        let across = f64::from((at.x - self.rect.left()) / self.rect.width().max(1.0));
        self.low + across * (self.high - self.low)
    }

    fn opacity(&self, at: Pos2) -> f64 {
        f64::from((self.rect.bottom() - at.y) / self.rect.height().max(1.0)).clamp(0.0, 1.0)
    }
}

pub(super) fn curve(
    ui: &mut Ui,
    edit: &mut TransferEdit,
    sight: &TransferSight<'_>,
    scale: Scale,
    is_log: bool,
) -> Vec<Request> {
    let height = (ui.available_height() - 60.0).clamp(90.0, 260.0);
    let size = vec2(ui.available_width().max(120.0), height);
    let (rect, response) = ui.allocate_exact_size(size, Sense::click_and_drag());
    response.widget_info(|| {
        egui::WidgetInfo::labeled(egui::Role::Canvas, true, "Transfer function curve")
    });
    let data = sight.volume.statistics().range().unwrap_or((0.0, 1.0));
    let (low, high) = edit.transfer.range();
    let (low, high) = (scale.data(low).min(data.0), scale.data(high).max(data.1));
    let frame = Frame {
        rect,
        low,
        high: if high > low { high } else { low + 1.0 },
    };
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, 2.0, ui.visuals().extreme_bg_color);
    if let Some(counted) = sight.counted {
        histogram(
            &painter,
            &frame,
            counted,
            is_log,
            ui.visuals().weak_text_color(),
        );
        for (percent, value) in &counted.percentiles {
            let x = frame.place(*value, 0.0).x;
            painter.vline(
                x,
                rect.y_range(),
                Stroke::new(0.5, ui.visuals().weak_text_color()),
            );
            let at = pos2(x + 2.0, rect.top() + 2.0);
            let text = format!("{percent} %");
            painter.text(
                at,
                egui::Align2::LEFT_TOP,
                text,
                egui::FontId::proportional(9.0),
                ui.visuals().weak_text_color(),
            );
        }
    }
    colors(&painter, &frame, edit, scale);
    let mut points = edit.points();
    let places: Vec<Pos2> = points
        .iter()
        .map(|point| frame.place(scale.data(point.at), point.opacity))
        .collect();
    let line = ui.visuals().strong_text_color();
    painter.line(places.clone(), Stroke::new(1.5, line));
    for (index, (place, point)) in places.iter().zip(&points).enumerate() {
        let radius = if edit.selected == Some(index) {
            6.0
        } else {
            4.5
        };
        painter.circle(*place, radius, srgb(point.color), Stroke::new(1.5, line));
    }
    let near = |at: Pos2| {
        let distances = places
            .iter()
            .enumerate()
            .map(|(index, place)| (index, place.distance(at)));
        let nearest = distances.min_by(|a, b| a.1.total_cmp(&b.1));
        nearest
            .filter(|(_, distance)| *distance < NEAR)
            .map(|(index, _)| index)
    };
    if response.drag_started()
        && let Some(at) = ui.input(|input| input.pointer.press_origin())
    {
        edit.selected = near(at);
        edit.begin_drag();
        edit.is_panel_dragging = true;
    }
    if response.drag_stopped() {
        edit.end_drag();
        edit.is_panel_dragging = false;
    }
    if response.dragged()
        && let Some(at) = response.interact_pointer_pos()
    {
        return match edit.selected.filter(|index| *index < points.len()) {
            Some(index) => {
                // A point stays between its neighbours.
                let before = index
                    .checked_sub(1)
                    .map_or(f64::NEG_INFINITY, |i| points[i].at);
                let after = points
                    .get(index + 1)
                    .map_or(f64::INFINITY, |point| point.at);
                points[index].at = scale.scalar(frame.data(at)).clamp(before, after);
                points[index].opacity = frame.opacity(at);
                edit.set_points(&points)
            }
            // Beside all points the whole of it is shifted.
            None => {
                let delta = response.drag_delta();
                let per_point = (frame.high - frame.low) / f64::from(rect.width().max(1.0));
                let shift = scale.scalar(frame.low + f64::from(delta.x) * per_point)
                    - scale.scalar(frame.low);
                edit.window(shift, 1.0 - f64::from(delta.y) / f64::from(rect.height()))
            }
        };
    }
    if response.clicked()
        && let Some(at) = response.interact_pointer_pos()
    {
        edit.selected = near(at);
    }
    if response.double_clicked()
        && let Some(at) = response.interact_pointer_pos()
        && near(at).is_none()
    {
        let scalar = scale.scalar(frame.data(at));
        let index = points.partition_point(|point| point.at <= scalar);
        points.insert(
            index,
            ControlPoint {
                at: scalar,
                color: edit.transfer.color(scalar),
                opacity: frame.opacity(at),
            },
        );
        edit.selected = Some(index);
        return edit.set_points(&points);
    }
    if response.secondary_clicked()
        && let Some(index) = response.interact_pointer_pos().and_then(near)
    {
        return remove(edit, index);
    }
    if let Some(at) = response.hover_pos() {
        let scalar = scale.scalar(frame.data(at));
        let opacity = edit.transfer.opacity(scalar);
        response.on_hover_text_at_pointer(format!(
            "{:.4}: opacity {opacity:.3} of a reference length\ndrag points; drag beside them to shift (across) and stretch (up)\ndouble-click adds a point, right-click removes one",
            frame.data(at)
        ));
    }
    Vec::new()
}

fn histogram(
    painter: &egui::Painter,
    frame: &Frame,
    counted: &Counted,
    is_log: bool,
    color: Color32,
) {
    let histogram = &counted.histogram;
    let height = |count: u64| {
        if is_log {
            (count as f64).ln_1p()
        } else {
            count as f64
        }
    };
    let most = histogram
        .counts
        .iter()
        .map(|count| height(*count))
        .fold(0.0, f64::max)
        .max(1e-9);
    let width = (histogram.hi - histogram.lo) / histogram.counts.len().max(1) as f64;
    // One mesh without soft edges: drivers on the processor pay for each vertex.
    let mut mesh = Mesh::default();
    for (bin, count) in histogram.counts.iter().enumerate() {
        let low = histogram.lo + bin as f64 * width;
        let top = frame.place(low, height(*count) / most * 0.95);
        let foot = frame.place(low + width, 0.0);
        mesh.add_colored_rect(Rect::from_two_pos(top, foot), color.gamma_multiply(0.45));
    }
    painter.add(mesh);
}

/// The colours along the scalars, at the foot of the curve.
fn colors(painter: &egui::Painter, frame: &Frame, edit: &TransferEdit, scale: Scale) {
    let columns = (frame.rect.width() / 4.0).max(1.0) as u32;
    let mut mesh = Mesh::default();
    for column in 0..=columns {
        let share = column as f32 / columns as f32;
        let x = frame.rect.left() + share * frame.rect.width();
        let scalar = scale.scalar(frame.data(pos2(x, 0.0)));
        let color = srgb(edit.transfer.color(scalar));
        mesh.colored_vertex(pos2(x, frame.rect.bottom() - 8.0), color);
        mesh.colored_vertex(pos2(x, frame.rect.bottom()), color);
        if column > 0 {
            let last = 2 * column + 1;
            mesh.add_triangle(last - 3, last - 2, last - 1);
            mesh.add_triangle(last - 2, last - 1, last);
        }
    }
    painter.add(mesh);
}
