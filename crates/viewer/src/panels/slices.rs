//! Three planes through the volume, linked with the view: their crosshair is one place, and the probe reads it.

use egui::{
    Color32, ColorImage, Rect, Sense, Stroke, TextureHandle, TextureOptions, Ui, pos2, vec2,
};
use glam::DVec3;
use volgraph_graph::Digest;
use volgraph_volume::Volume;

/// The longest side of a plane's picture in pixels; larger ones are sampled.
const LONGEST: u32 = 512;

/// What the panel remembers between frames.
#[derive(Default)]
pub(crate) struct SlicesPanel {
    of: Option<Digest>,
    /// In voxels, of the crosshair.
    index: DVec3,
    /// Smallest and largest value shown, black to white.
    window: Option<(f64, f64)>,
    textures: [Option<Slice>; 3],
}

/// A plane's number, the window of values that it is shown in, and its texture.
type Slice = (u32, (f64, f64), TextureHandle);

/// The axes of the planes: across, down, through.
const PLANES: [(usize, usize, usize, &str); 3] = [
    (0, 1, 2, "axial"),
    (0, 2, 1, "coronal"),
    (1, 2, 0, "sagittal"),
];

impl SlicesPanel {
    /// Lets go of textures: another window makes its own.
    pub fn leave_window(&mut self) {
        self.textures = Default::default();
    }

    /// World position of the crosshair, where there is one.
    pub fn crosshair(&self, digest: Digest, volume: &Volume) -> Option<DVec3> {
        let is_there = self.of == Some(digest);
        is_there.then(|| volume.grid().world_from_index.transform_point3(self.index))
    }

    /// Moves the crosshair to a world position, as of a hit in the view.
    pub fn go_to(&mut self, digest: Digest, volume: &Volume, world: DVec3) {
        self.begin(digest, volume);
        let index = volume
            .grid()
            .world_from_index
            .inverse()
            .transform_point3(world);
        let last = DVec3::from_array(volume.grid().dims.map(|n| f64::from(n - 1)));
        self.index = index.clamp(DVec3::ZERO, last);
    }

    fn begin(&mut self, digest: Digest, volume: &Volume) {
        if self.of != Some(digest) {
            *self = Self {
                of: Some(digest),
                index: DVec3::from_array(volume.grid().dims.map(|n| f64::from(n / 2))),
                ..Self::default()
            };
        }
    }

    pub fn show(&mut self, ui: &mut Ui, digest: Digest, volume: &Volume) {
        let dims = volume.grid().dims;
        self.begin(digest, volume);
        let statistics = volume.statistics();
        let data = statistics.range().unwrap_or((0.0, 1.0));
        let window = self
            .window
            .unwrap_or((statistics.percentile(1.0), statistics.percentile(99.8)));
        let window = if window.1 > window.0 {
            window
        } else {
            (data.0, data.0 + 1.0)
        };
        let mut next_window = window;
        let spacing = volume.grid().spacing();
        self.probe(ui, volume);
        let room = ((ui.available_width() - 20.0) / 3.0).min(ui.available_height() - 24.0);
        let side = room.clamp(80.0, 600.0);
        ui.horizontal(|ui| {
            for (plane, (across, down, through, name)) in PLANES.into_iter().enumerate() {
                ui.vertical(|ui| {
                    ui.small(format!("{name}, plane {}", self.index[through].round()));
                    let size = vec2(
                        (f64::from(dims[across]) * spacing[across]) as f32,
                        (f64::from(dims[down]) * spacing[down]) as f32,
                    );
                    let size = size * (side / size.max_elem().max(1e-6));
                    let (rect, response) = ui.allocate_exact_size(size, Sense::click_and_drag());
                    response
                        .widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, name));
                    let texture = self.texture(ui, plane, volume, window);
                    let all = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
                    ui.painter().image(texture.id(), rect, all, Color32::WHITE);
                    if response.dragged_by(egui::PointerButton::Secondary) {
                        let (delta, width) = (response.drag_delta(), window.1 - window.0);
                        let level = 0.5 * (window.0 + window.1)
                            - f64::from(delta.y / side) * (data.1 - data.0);
                        let width = (width * (1.0 + 2.0 * f64::from(delta.x / side))).max(1e-9);
                        next_window = (level - 0.5 * width, level + 0.5 * width);
                    } else if let Some(at) = response.interact_pointer_pos() {
                        let share = (at - rect.min) / rect.size();
                        self.index[across] = (f64::from(share.x) * f64::from(dims[across]) - 0.5)
                            .clamp(0.0, f64::from(dims[across] - 1));
                        self.index[down] = (f64::from(share.y) * f64::from(dims[down]) - 0.5)
                            .clamp(0.0, f64::from(dims[down] - 1));
                    }
                    if response.hovered() {
                        let turned = ui.input(|input| input.smooth_scroll_delta().y);
                        let moved = self.index[through] + f64::from(turned) * 0.05;
                        self.index[through] = moved.clamp(0.0, f64::from(dims[through] - 1));
                    }
                    let mark = |axis: usize, start: f32, length: f32| {
                        start + ((self.index[axis] + 0.5) / f64::from(dims[axis])) as f32 * length
                    };
                    let stroke =
                        Stroke::new(1.0, Color32::from_rgba_unmultiplied(255, 200, 60, 160));
                    ui.painter().vline(
                        mark(across, rect.left(), rect.width()),
                        rect.y_range(),
                        stroke,
                    );
                    ui.painter().hline(
                        rect.x_range(),
                        mark(down, rect.top(), rect.height()),
                        stroke,
                    );
                    response.on_hover_text(
                        "click: crosshair; wheel: plane; right drag: window and level",
                    );
                });
            }
        });
        if next_window != window {
            self.window = Some(next_window);
        }
    }

    /// What lies under the crosshair.
    fn probe(&self, ui: &mut Ui, volume: &Volume) {
        let index = self.index;
        let world = volume.grid().world_from_index.transform_point3(index);
        let voxel = index.round();
        let nearest = [voxel.x as u32, voxel.y as u32, voxel.z as u32];
        let gradient = gradient(volume, index);
        ui.horizontal_wrapped(|ui| {
            ui.label(format!("voxel {nearest:?}"));
            ui.label(format!(
                "position ({:.3}, {:.3}, {:.3})",
                world.x, world.y, world.z
            ));
            ui.strong(format!("value {}", volume.voxel(nearest)));
            ui.label(format!("interpolated {:.4}", volume.trilinear(index)));
            ui.label(format!(
                "gradient ({:.4}, {:.4}, {:.4}), {:.4} per world unit",
                gradient.x,
                gradient.y,
                gradient.z,
                gradient.length()
            ));
        });
    }

    fn texture(
        &mut self,
        ui: &Ui,
        plane: usize,
        volume: &Volume,
        window: (f64, f64),
    ) -> TextureHandle {
        let (across, down, through, name) = PLANES[plane];
        let at = self.index[through].round() as u32;
        if let Some((of, shown, texture)) = &self.textures[plane]
            && (*of, *shown) == (at, window)
        {
            return texture.clone();
        }
        let dims = volume.grid().dims;
        let size = [dims[across].min(LONGEST), dims[down].min(LONGEST)];
        let scale = 255.0 / (window.1 - window.0);
        let mut codes = Vec::with_capacity((size[0] * size[1]) as usize);
        for row in 0..size[1] {
            for column in 0..size[0] {
                let mut index = [0; 3];
                index[through] = at;
                index[across] =
                    (u64::from(column) * u64::from(dims[across]) / u64::from(size[0])) as u32;
                index[down] = (u64::from(row) * u64::from(dims[down]) / u64::from(size[1])) as u32;
                codes.push(((volume.voxel(index) - window.0) * scale).clamp(0.0, 255.0) as u8);
            }
        }
        let image = ColorImage::from_gray([size[0] as usize, size[1] as usize], &codes);
        let texture = ui.ctx().load_texture(name, image, TextureOptions::LINEAR);
        self.textures[plane] = Some((at, window, texture.clone()));
        texture
    }
}

/// Central differences of the trilinear field, per world unit, in world space.
pub(crate) fn gradient(volume: &Volume, index: DVec3) -> DVec3 {
    let difference =
        |axis: DVec3| volume.trilinear(index + 0.5 * axis) - volume.trilinear(index - 0.5 * axis);
    let of_index = DVec3::new(
        difference(DVec3::X),
        difference(DVec3::Y),
        difference(DVec3::Z),
    );
    // Gradients transform with the inverse transpose.
    let to_index = volume.grid().world_from_index.matrix3.inverse();
    to_index.transpose() * of_index
}

#[cfg(test)]
mod tests {
    use volgraph_volume::{Grid, Voxels};

    use super::*;

    #[test]
    fn the_gradient_of_a_ramp_is_its_slope_in_the_world() {
        let dims = [8, 8, 8];
        let values = (0..512_u32)
            .map(|i| (2 * (i % 8) + 3 * (i / 64)) as f32)
            .collect();
        let grid = Grid::axis_aligned(dims, DVec3::new(0.5, 1.0, 2.0), DVec3::ZERO);
        let volume = Volume::new("ramp", grid, Voxels::F32(values)).unwrap();
        let slope = gradient(&volume, DVec3::splat(3.5));
        assert!(slope.distance(DVec3::new(4.0, 0.0, 1.5)) < 1e-9, "{slope}");
    }
}
