//! The picture, and what is done over it.

mod marks;
mod overlay;
mod steer;

use egui::{Color32, Rect, Response, Sense, Stroke, TextureHandle, Ui, pos2, vec2};
use glam::DVec3;

use self::marks::{color_bar, marker, note, scale_bar, status};
use crate::blit::Shot;
use crate::handles;
use crate::histogram::first_volume;
use crate::navigate::Navigation;
use crate::settings::{Overlay, Settings};
use crate::worker::{Request, Told};

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_keep_their_shape_and_coarse_ones_fill_the_view() {
        let rect = Rect::from_min_size(pos2(0.0, 0.0), vec2(400.0, 300.0));
        assert_eq!(fitted(rect, [100, 100]).size(), vec2(300.0, 300.0));
        assert_eq!(fitted(rect, [67, 50]), rect);
    }
}
