//! What stands over the picture: the one before, differences, errors.

use std::sync::Arc;

use egui::{
    Align2, Color32, ColorImage, FontId, Rect, Response, Stroke, TextureId, TextureOptions, Ui,
    pos2, vec2,
};
use volgraph_engine::Picture;

use super::marks::{label, note};
use super::steer::near_wipe;
use super::{View, whole};
use crate::panels::transfer::srgb;
use crate::settings::{Overlay, Settings};
use crate::worker::{ErrorMap, Told};

impl View {
    pub(super) fn overlay(
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn heat_goes_from_black_to_white() {
        assert_eq!(heat(0.0), Color32::BLACK);
        assert_eq!(heat(1.0), Color32::WHITE);
    }
}
