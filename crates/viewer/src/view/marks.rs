//! What stands in the picture's corners: lengths, axes, colours, costs.

use egui::{Align2, Color32, FontId, Pos2, Rect, Stroke, Vec2, pos2, vec2};
use glam::DVec3;

use crate::navigate::Navigation;
use crate::panels::transfer::srgb;
use crate::worker::Told;

/// White text that is read on any ground.
pub(super) fn label(painter: &egui::Painter, at: Pos2, anchor: Align2, text: &str, font: &FontId) {
    painter.text(
        at + vec2(1.0, 1.0),
        anchor,
        text,
        font.clone(),
        Color32::BLACK,
    );
    painter.text(at, anchor, text, font.clone(), Color32::WHITE);
}

pub(super) fn note(painter: &egui::Painter, picture: Rect, text: &str) {
    label(
        painter,
        picture.center_top() + vec2(0.0, 16.0),
        Align2::CENTER_TOP,
        text,
        &FontId::proportional(14.0),
    );
}

/// The largest of 1, 2, 5 times a power of ten that is at most `length`.
fn round_length(length: f64) -> f64 {
    if !(length.is_finite() && length > 0.0) {
        return 1.0;
    }
    let power = 10_f64.powf(length.log10().floor());
    let digit = length / power;
    power
        * if digit >= 5.0 {
            5.0
        } else if digit >= 2.0 {
            2.0
        } else {
            1.0
        }
}

pub(super) fn scale_bar(painter: &egui::Painter, picture: Rect, navigation: &Navigation) {
    let per_point = navigation.height_at_pivot() / f64::from(picture.height().max(1.0));
    let length = round_length(per_point * f64::from((0.3 * picture.width()).min(180.0)));
    let points = (length / per_point) as f32;
    let right = picture.right_bottom() + vec2(-16.0, -14.0);
    let left = right - vec2(points, 0.0);
    for (offset, color) in [
        (vec2(1.0, 1.0), Color32::BLACK),
        (Vec2::ZERO, Color32::WHITE),
    ] {
        let stroke = Stroke::new(2.0, color);
        painter.line_segment([left + offset, right + offset], stroke);
        for end in [left, right] {
            painter.line_segment(
                [end + offset - vec2(0.0, 4.0), end + offset + vec2(0.0, 4.0)],
                stroke,
            );
        }
    }
    let middle = left + vec2(0.5 * points, -6.0);
    label(
        painter,
        middle,
        Align2::CENTER_BOTTOM,
        &format!("{length}"),
        &FontId::proportional(12.0),
    );
}

pub(super) fn marker(painter: &egui::Painter, picture: Rect, navigation: &Navigation) {
    let middle = picture.left_bottom() + vec2(38.0, -38.0);
    let camera = &navigation.camera;
    let axes = [
        (DVec3::X, "x", Color32::from_rgb(255, 90, 90)),
        (DVec3::Y, "y", Color32::from_rgb(100, 220, 100)),
        (DVec3::Z, "z", Color32::from_rgb(110, 150, 255)),
    ];
    let mut seen = axes.map(|(axis, name, color)| {
        let end = vec2(axis.dot(camera.right) as f32, -axis.dot(camera.up) as f32) * 26.0;
        (axis.dot(camera.forward), end, name, color)
    });
    // What is nearer is drawn over what is farther.
    seen.sort_by(|a, b| b.0.total_cmp(&a.0));
    for (_, end, name, color) in seen {
        painter.line_segment([middle, middle + end], Stroke::new(2.5, color));
        label(
            painter,
            middle + end * 1.25,
            Align2::CENTER_CENTER,
            name,
            &FontId::proportional(12.0),
        );
    }
}

/// Colours of the transfer function beside their values.
pub(super) fn color_bar(painter: &egui::Painter, picture: Rect, told: &Told) {
    let Some(scene) = &told.scene else {
        return;
    };
    let Some(edit) = crate::transfer::TransferEdit::of(scene) else {
        return;
    };
    let (low, high) = edit.transfer.range();
    let height = (0.5 * picture.height()).min(220.0);
    let bar = Rect::from_min_size(
        pos2(picture.right() - 64.0, picture.center().y - 0.5 * height),
        vec2(14.0, height),
    );
    let rows = height as usize;
    for row in 0..rows {
        let share = 1.0 - row as f64 / rows.max(1) as f64;
        let color = srgb(edit.transfer.color(low + share * (high - low)));
        let place = Rect::from_min_size(bar.min + vec2(0.0, row as f32), vec2(14.0, 1.5));
        painter.rect_filled(place, 0.0, color);
    }
    let font = FontId::proportional(11.0);
    for (share, value) in [(0.0, high), (0.5, 0.5 * (low + high)), (1.0, low)] {
        let at = pos2(bar.right() + 4.0, bar.top() + share * height);
        label(
            painter,
            at,
            Align2::LEFT_CENTER,
            &format!("{value:.4}"),
            &font,
        );
    }
}

/// What the last frame cost, and whether there is more to come.
pub(super) fn status(painter: &egui::Painter, rect: Rect, told: &Told) {
    let [width, height] = told.shown.as_ref().map_or([0; 2], |shown| shown.size);
    let state = match (told.is_paused, told.is_refined) {
        (true, _) => " · paused",
        (false, true) => "",
        (false, false) => " · coarse",
    };
    let text = match &told.reading {
        Some((source, share)) => format!("reading {source}: {:.0} %", 100.0 * share),
        None => format!("{width} × {height} · {:.1} ms{state}", told.frame_ms),
    };
    label(
        painter,
        rect.right_top() + vec2(-10.0, 8.0),
        Align2::RIGHT_TOP,
        &text,
        &FontId::proportional(12.0),
    );
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_round() {
        for (length, round) in [
            (0.7, 0.5),
            (1.9, 1.0),
            (23.0, 20.0),
            (99.0, 50.0),
            (f64::NAN, 1.0),
        ] {
            assert!((round_length(length) - round).abs() < 1e-12 * round);
        }
    }
}
