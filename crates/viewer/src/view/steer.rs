//! The mouse and keys over the picture.

use egui::{Key, PointerButton, Rect, Response, Ui, Vec2};
use glam::DVec3;

use super::View;
use crate::navigate::{Axis, Navigation};
use crate::settings::{Overlay, Settings};

/// Share of the radius that a walker takes in a second.
const WALK: f64 = 0.5;

impl View {
    /// Moves the camera by mouse and keys; whether it moved.
    pub(super) fn steer(
        &mut self,
        ui: &Ui,
        rect: Rect,
        response: &Response,
        settings: &mut Settings,
    ) -> bool {
        let Some(navigation) = &mut self.navigation else {
            return false;
        };
        let before = navigation.camera;
        let height = f64::from(rect.height().max(1.0));
        let drag = response.drag_delta();
        let (right, down) = (f64::from(drag.x) / height, f64::from(drag.y) / height);
        let is_shift = ui.input(|input| input.modifiers.shift);
        let is_command = ui.input(|input| input.modifiers.command);
        let is_alt = ui.input(|input| input.modifiers.alt);
        let is_wiping =
            settings.overlay == Overlay::Wipe && near_wipe(rect, response, settings.wipe);
        if is_wiping && drag != Vec2::ZERO {
            settings.wipe = (settings.wipe + drag.x / rect.width().max(1.0)).clamp(0.0, 1.0);
        } else if response.dragged_by(PointerButton::Primary) && is_alt {
            self.window = Some([right, down]);
        } else if response.dragged_by(PointerButton::Middle)
            || response.dragged_by(PointerButton::Primary) && is_shift
        {
            navigation.pan(right, down);
        } else if response.dragged_by(PointerButton::Secondary) {
            navigation.zoom((4.0 * -down).exp());
        } else if response.dragged_by(PointerButton::Primary) && is_command {
            navigation.roll(std::f64::consts::PI * right);
        } else if response.dragged_by(PointerButton::Primary) && settings.is_walking {
            navigation.look(right, down);
        } else if response.dragged_by(PointerButton::Primary) {
            navigation.orbit(right, down);
        }
        if response.hovered() {
            let (turned, pinched) =
                ui.input(|input| (input.smooth_scroll_delta().y, input.zoom_delta()));
            if settings.is_walking && turned != 0.0 {
                navigation.walk(DVec3::X * f64::from(turned) * 0.002 * navigation.radius);
            } else {
                navigation.zoom(f64::from(pinched) * (f64::from(turned) * 0.004).exp());
            }
        }
        if !ui.ctx().egui_wants_keyboard_input() {
            keys(ui, rect, navigation, settings);
        }
        navigation.camera != before
    }
}

fn keys(ui: &Ui, rect: Rect, navigation: &mut Navigation, settings: &Settings) {
    let middle = navigation.middle;
    let aspect = f64::from(rect.width() / rect.height().max(1.0));
    ui.input(|input| {
        if input.modifiers.command || input.modifiers.alt {
            return;
        }
        let axes = [
            Key::Num1,
            Key::Num2,
            Key::Num3,
            Key::Num4,
            Key::Num5,
            Key::Num6,
        ];
        for (key, (axis, _)) in axes.into_iter().zip(Axis::ALL) {
            if input.key_pressed(key) {
                navigation.look_along(axis);
            }
        }
        if input.key_pressed(Key::F) && !settings.is_walking {
            navigation.fit(middle, aspect);
        }
        if input.key_pressed(Key::O) {
            navigation.toggle_orthographic();
        }
        if !settings.is_walking {
            let turn = f64::from(input.stable_dt.min(0.1)) * 0.5;
            let down = |key: Key| f64::from(u8::from(input.key_down(key)));
            let right = down(Key::ArrowRight) - down(Key::ArrowLeft);
            let lower = down(Key::ArrowDown) - down(Key::ArrowUp);
            if right != 0.0 || lower != 0.0 {
                navigation.orbit(right * turn, lower * turn);
            }
            return;
        }
        let step = f64::from(input.stable_dt.min(0.1)) * WALK * navigation.radius;
        let down = |key: Key| f64::from(u8::from(input.key_down(key)));
        let step = DVec3::new(
            down(Key::W) - down(Key::S),
            down(Key::D) - down(Key::A),
            down(Key::E) - down(Key::Q),
        ) * step;
        if step != DVec3::ZERO {
            navigation.walk(step);
        }
    });
    let is_held = ui.input(|input| !input.keys_down.is_empty());
    if is_held {
        ui.ctx().request_repaint();
    }
}

pub(super) fn near_wipe(picture: Rect, response: &Response, wipe: f32) -> bool {
    let edge = picture.left() + wipe * picture.width();
    response
        .hover_pos()
        .or_else(|| response.interact_pointer_pos())
        .is_some_and(|at| (at.x - edge).abs() < 12.0)
}
