//! The picture, the mouse and keys over it, and what stands on top: wipe, differences, errors, scale bar, axes.

use std::sync::Arc;

use egui::{
    Align2, Color32, ColorImage, FontId, Key, PointerButton, Pos2, Rect, Response, Sense, Stroke,
    TextureHandle, TextureId, TextureOptions, Ui, Vec2, pos2, vec2,
};
use glam::DVec3;
use volgraph_engine::Picture;

use crate::blit::Shot;
use crate::handles;
use crate::histogram::first_volume;
use crate::navigate::{Axis, Navigation};
use crate::panels::transfer::srgb;
use crate::settings::{Overlay, Settings};
use crate::worker::{ErrorMap, Request, Told};

/// Share of the radius that a walker takes in a second.
const WALK: f64 = 0.5;

/// What the view remembers between frames.
#[derive(Default)]
pub(crate) struct View {
    /// Where the camera is wanted, once there is a scene.
    pub navigation: Option<Navigation>,
    /// Whether the user has moved it.
    pub has_moved: bool,
    /// Of the full picture.
    pub size: [u32; 2],
    /// Where it does not follow the window.
    pub fixed_size: Option<[u32; 2]>,
    /// What a drag asks of the transfer function: how far right and down, in heights of the view.
    pub window: Option<[f64; 2]>,
    before: Option<(usize, TextureHandle)>,
    difference: Option<(usize, f32, TextureHandle)>,
    errors: Option<(usize, TextureHandle)>,
}

impl View {
    /// Forgets the camera: another graph has its own.
    pub fn forget(&mut self) {
        self.navigation = None;
        self.has_moved = false;
        self.leave_window();
    }

    /// Lets go of textures: another window makes its own.
    pub fn leave_window(&mut self) {
        self.before = None;
        self.difference = None;
        self.errors = None;
    }

    /// Takes the session's camera, where the user has not moved it.
    pub fn follow(&mut self, told: &Told) {
        if self.has_moved && self.navigation.is_some() {
            return;
        }
        if let (Some(camera), Some(plan)) = (told.camera, &told.plan) {
            self.navigation = Some(Navigation::new(camera, &plan.corners()));
        }
    }

    pub fn show(
        &mut self,
        ui: &mut Ui,
        told: &Told,
        shot: Option<&Shot>,
        settings: &mut Settings,
        crosshair: Option<DVec3>,
    ) -> Vec<Request> {
        let mut requests = Vec::new();
        let (rect, response) = ui.allocate_exact_size(
            ui.available_size().max(vec2(16.0, 16.0)),
            Sense::click_and_drag(),
        );
        let name = match told.findings.is_empty() {
            true => "View",
            false => "View, with the last good picture",
        };
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, name));
        self.ask_for_size(ui, rect, settings, &mut requests);
        self.follow(told);
        if self.steer(ui, rect, &response, settings) {
            self.has_moved = true;
            if let Some(navigation) = &self.navigation {
                requests.push(Request::Camera(navigation.camera));
            }
        }
        let painter = ui.painter_at(rect);
        let picture = match shot {
            Some(shot) => {
                let place = fitted(rect, shot.size);
                if place != rect {
                    painter.rect_filled(rect, 0.0, Color32::BLACK);
                }
                shot.paint(&painter, place);
                place
            }
            None => {
                painter.rect_filled(rect, 0.0, Color32::BLACK);
                rect
            }
        };
        self.overlay(ui, &painter, picture, told, settings, &response);
        if let Some(navigation) = &self.navigation {
            if settings.has_scale_bar {
                scale_bar(&painter, picture, navigation);
            }
            if settings.has_marker {
                marker(&painter, picture, navigation);
            }
            if let Some(at) = crosshair.and_then(|world| navigation.project(world)) {
                let at = picture.center() + vec2(at[0] as f32, at[1] as f32) * picture.height();
                let stroke = Stroke::new(1.0, Color32::from_rgb(255, 200, 60));
                painter.circle_stroke(at, 5.0, stroke);
                painter.hline(at.x - 9.0..=at.x + 9.0, at.y, stroke);
                painter.vline(at.x, at.y - 9.0..=at.y + 9.0, stroke);
            }
        }
        let volume = told.scene.as_ref().and_then(first_volume);
        if let (Some(navigation), Some(plan), Some((_, _, volume)), true) =
            (&self.navigation, &told.plan, volume, settings.has_handles)
        {
            requests.extend(handles::show(ui, picture, navigation, plan, volume.grid()));
        }
        if let (None, Some(finding)) = (&told.shown, told.findings.sorted().first()) {
            note(&painter, rect, &finding.message);
        }
        if response.clicked()
            && let Some(at) = response.interact_pointer_pos()
            && picture.contains(at)
        {
            if settings.overlay == Overlay::Error {
                requests.push(Request::Compare);
            }
            let share = (at - picture.min) / picture.size();
            let [width, height] = self.size.map(f64::from);
            requests.push(Request::Ray([
                f64::from(share.x) * width,
                f64::from(share.y) * height,
            ]));
        }
        if settings.has_color_bar {
            color_bar(&painter, picture, told);
        }
        self.pick(ui, picture, &response, told);
        status(&painter, rect, told);
        requests
    }

    /// Asks for a picture as large as it is shown.
    fn ask_for_size(
        &mut self,
        ui: &Ui,
        rect: Rect,
        settings: &Settings,
        requests: &mut Vec<Request>,
    ) {
        let pixels =
            rect.size() * ui.ctx().pixels_per_point() * settings.resolution.clamp(0.1, 4.0);
        let size = [
            pixels.x.round().max(1.0) as u32,
            pixels.y.round().max(1.0) as u32,
        ];
        let size = self.fixed_size.unwrap_or(size);
        if size != self.size {
            self.size = size;
            requests.push(Request::Size(size));
        }
    }

    /// Moves the camera by mouse and keys; whether it moved.
    fn steer(&mut self, ui: &Ui, rect: Rect, response: &Response, settings: &mut Settings) -> bool {
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

    fn overlay(
        &mut self,
        ui: &Ui,
        painter: &egui::Painter,
        picture: Rect,
        told: &Told,
        settings: &Settings,
        response: &Response,
    ) {
        match settings.overlay {
            Overlay::None => {}
            Overlay::Wipe => {
                let [_, Some(before)] = &told.pictures else {
                    return note(
                        painter,
                        picture,
                        "There is no picture before the last change.",
                    );
                };
                let texture = self.before_texture(ui, before);
                let edge = picture.left() + settings.wipe * picture.width();
                let left = Rect::from_min_max(picture.min, pos2(edge, picture.max.y));
                let uv = Rect::from_min_max(pos2(0.0, 0.0), pos2(settings.wipe, 1.0));
                painter.image(texture, left, uv, Color32::WHITE);
                let is_held = near_wipe(picture, response, settings.wipe);
                let width = if is_held { 3.0 } else { 1.0 };
                painter.vline(edge, picture.y_range(), Stroke::new(width, Color32::WHITE));
            }
            Overlay::Difference => match &told.pictures {
                [Some(now), Some(before)]
                    if (now.width, now.height) == (before.width, before.height) =>
                {
                    let (texture, most) = self.difference_texture(ui, now, before);
                    painter.image(texture, picture, whole(), Color32::WHITE);
                    legend(painter, picture, most, "largest difference of a component");
                }
                _ => note(
                    painter,
                    picture,
                    "There are no two pictures of one size to compare.",
                ),
            },
            Overlay::Error => match &told.error_map {
                Some(Ok(map)) => {
                    let texture = self.error_texture(ui, map);
                    painter.image(texture, picture, whole(), Color32::WHITE);
                    let text = format!("error against the reference, RMSE {:.2e}", map.rmse);
                    legend(painter, picture, map.max, &text);
                }
                Some(Err(findings)) => {
                    let why = findings
                        .sorted()
                        .first()
                        .map_or_else(String::new, |finding| finding.message.clone());
                    note(painter, picture, &why);
                }
                None if told.is_comparing => note(painter, picture, "Computing the reference…"),
                None => note(
                    painter,
                    picture,
                    "Click into the view to compare it with its reference.",
                ),
            },
        }
    }

    fn before_texture(&mut self, ui: &Ui, before: &Arc<Picture>) -> TextureId {
        let key = Arc::as_ptr(before) as usize;
        if self.before.as_ref().is_none_or(|(known, _)| *known != key) {
            let image = image_of(before);
            self.before = Some((
                key,
                ui.ctx()
                    .load_texture("before", image, TextureOptions::LINEAR),
            ));
        }
        self.before
            .as_ref()
            .map_or(TextureId::default(), |(_, texture)| texture.id())
    }

    fn difference_texture(
        &mut self,
        ui: &Ui,
        now: &Arc<Picture>,
        before: &Arc<Picture>,
    ) -> (TextureId, f32) {
        let key = Arc::as_ptr(now) as usize ^ (Arc::as_ptr(before) as usize).rotate_left(17);
        if self
            .difference
            .as_ref()
            .is_none_or(|(known, _, _)| *known != key)
        {
            let errors: Vec<f32> = now
                .color
                .iter()
                .zip(&before.color)
                .map(|(a, b)| {
                    a.iter()
                        .zip(b)
                        .map(|(a, b)| (a - b).abs())
                        .fold(0.0, f32::max)
                })
                .collect();
            let most = errors.iter().copied().fold(0.0, f32::max);
            let image = heat_image([now.width, now.height], &errors, most);
            let texture = ui
                .ctx()
                .load_texture("difference", image, TextureOptions::NEAREST);
            self.difference = Some((key, most, texture));
        }
        self.difference
            .as_ref()
            .map_or((TextureId::default(), 0.0), |(_, most, texture)| {
                (texture.id(), *most)
            })
    }

    fn error_texture(&mut self, ui: &Ui, map: &Arc<ErrorMap>) -> TextureId {
        let key = Arc::as_ptr(map) as usize;
        if self.errors.as_ref().is_none_or(|(known, _)| *known != key) {
            let image = heat_image(map.size, &map.errors, map.max);
            self.errors = Some((
                key,
                ui.ctx()
                    .load_texture("errors", image, TextureOptions::NEAREST),
            ));
        }
        self.errors
            .as_ref()
            .map_or(TextureId::default(), |(_, texture)| texture.id())
    }

    /// Names what a pixel holds.
    fn pick(&self, ui: &Ui, picture: Rect, response: &Response, told: &Told) {
        let (Some(at), Some(refined)) = (response.hover_pos(), &told.refined) else {
            return;
        };
        if !told.is_refined || !ui.input(|input| input.modifiers.alt) {
            return;
        }
        let share = (at - picture.min) / picture.size();
        let x = (share.x * refined.width as f32).floor();
        let y = (share.y * refined.height as f32).floor();
        if let Some(color) = refined.pixel(x.max(0.0) as u32, y.max(0.0) as u32) {
            let text = format!(
                "pixel {x}, {y}: ({:.4}, {:.4}, {:.4}), opacity {:.4}",
                color[0], color[1], color[2], color[3]
            );
            response.clone().on_hover_text_at_pointer(text);
        }
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

fn near_wipe(picture: Rect, response: &Response, wipe: f32) -> bool {
    let edge = picture.left() + wipe * picture.width();
    response
        .hover_pos()
        .or_else(|| response.interact_pointer_pos())
        .is_some_and(|at| (at.x - edge).abs() < 12.0)
}

fn whole() -> Rect {
    Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0))
}

/// The largest place within `rect` with the shape of a picture.
fn fitted(rect: Rect, [width, height]: [u32; 2]) -> Rect {
    let size = vec2(width.max(1) as f32, height.max(1) as f32);
    let scale = (rect.width() / size.x).min(rect.height() / size.y);
    // A picture of a coarser size has the shape up to a pixel, and fills the view.
    let size = size * scale;
    let size = vec2(
        if rect.width() - size.x < 4.0 {
            rect.width()
        } else {
            size.x
        },
        if rect.height() - size.y < 4.0 {
            rect.height()
        } else {
            size.y
        },
    );
    Rect::from_center_size(rect.center(), size)
}

/// A picture over black, as screens want it.
fn image_of(picture: &Picture) -> ColorImage {
    let pixels = picture
        .color
        .iter()
        .map(|[red, green, blue, _]| srgb([*red, *green, *blue].map(f64::from)));
    ColorImage::new(
        [picture.width as usize, picture.height as usize],
        pixels.collect(),
    )
}

/// Black, red, yellow, white at 0, 1/3, 2/3, 1.
fn heat(share: f32) -> Color32 {
    let channel = |from: f32| ((share * 3.0 - from).clamp(0.0, 1.0) * 255.0) as u8;
    Color32::from_rgb(channel(0.0), channel(1.0), channel(2.0))
}

fn heat_image([width, height]: [u32; 2], errors: &[f32], most: f32) -> ColorImage {
    let scale = if most > 0.0 { most.recip() } else { 0.0 };
    let pixels = errors.iter().map(|error| heat(error * scale)).collect();
    ColorImage::new([width as usize, height as usize], pixels)
}

fn legend(painter: &egui::Painter, picture: Rect, most: f32, what: &str) {
    let bar = Rect::from_min_size(picture.left_top() + vec2(12.0, 12.0), vec2(160.0, 10.0));
    for i in 0..80 {
        let place = Rect::from_min_size(bar.min + vec2(i as f32 * 2.0, 0.0), vec2(2.0, 10.0));
        painter.rect_filled(place, 0.0, heat(i as f32 / 79.0));
    }
    let font = FontId::proportional(12.0);
    label(
        painter,
        bar.left_bottom() + vec2(0.0, 2.0),
        Align2::LEFT_TOP,
        "0",
        &font,
    );
    label(
        painter,
        bar.right_bottom() + vec2(0.0, 2.0),
        Align2::RIGHT_TOP,
        &format!("{most:.2e}"),
        &font,
    );
    label(
        painter,
        bar.left_bottom() + vec2(0.0, 18.0),
        Align2::LEFT_TOP,
        what,
        &font,
    );
}

/// White text that is read on any ground.
fn label(painter: &egui::Painter, at: Pos2, anchor: Align2, text: &str, font: &FontId) {
    painter.text(
        at + vec2(1.0, 1.0),
        anchor,
        text,
        font.clone(),
        Color32::BLACK,
    );
    painter.text(at, anchor, text, font.clone(), Color32::WHITE);
}

fn note(painter: &egui::Painter, picture: Rect, text: &str) {
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

fn scale_bar(painter: &egui::Painter, picture: Rect, navigation: &Navigation) {
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

fn marker(painter: &egui::Painter, picture: Rect, navigation: &Navigation) {
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
fn color_bar(painter: &egui::Painter, picture: Rect, told: &Told) {
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
fn status(painter: &egui::Painter, rect: Rect, told: &Told) {
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

    #[test]
    fn pictures_keep_their_shape_and_coarse_ones_fill_the_view() {
        let rect = Rect::from_min_size(pos2(0.0, 0.0), vec2(400.0, 300.0));
        assert_eq!(fitted(rect, [100, 100]).size(), vec2(300.0, 300.0));
        assert_eq!(fitted(rect, [67, 50]), rect);
    }

    #[test]
    fn heat_goes_from_black_to_white() {
        assert_eq!(heat(0.0), Color32::BLACK);
        assert_eq!(heat(1.0), Color32::WHITE);
    }
}
