//! Pictures of any size: tile after tile, each drawn as the window of the whole picture that it is.
//!
//! A second plan, of a tile's size, is installed beside the session's own and taken away after it; the session stays as
//! it is. Rays are those of the whole picture, pixel by pixel, so tiles have no seams. The last column and row begin
//! further left and above where tiles do not fit in.

use std::sync::Arc;

use volgraph_graph::{Camera, Limits, Plan, View, Window};
use volgraph_picture::{LayerValues, MAX_PIXELS, MAX_SIDE, Picture};
use volgraph_report::{Finding, Findings};

use super::{Session, Stance, picture};
use crate::metadata;

/// Most pixels along a tile's side, where nobody says: 64 MiB of colour.
pub const TILE_SIDE: u32 = 2048;

/// Bytes of a pixel's colour on the device.
const PIXEL_BYTES: u64 = 16;

/// Whether a picture of this size is beyond a device's textures, or what one resource may take.
#[must_use]
pub fn has_to_be_tiled(size: [u32; 2], limits: &Limits) -> bool {
    let [width, height] = size.map(u64::from);
    width.max(height) > limits.max_texture_2d
        || width * height * PIXEL_BYTES > limits.max_resource_bytes
}

/// Width and height of all tiles, of at most so many pixels to a side: evenly parted.
fn tile_size(whole: [u32; 2], side: u32) -> [u32; 2] {
    whole.map(|pixels| pixels.div_ceil(pixels.div_ceil(side.max(1)).max(1)))
}

/// The first pixels of all tiles, row by row.
fn corners(whole: [u32; 2], tile: [u32; 2]) -> Vec<[u32; 2]> {
    let firsts = |axis: usize| {
        let last = whole[axis] - tile[axis];
        (0..whole[axis].div_ceil(tile[axis])).map(move |at| (at * tile[axis]).min(last))
    };
    firsts(1)
        .flat_map(|y| firsts(0).map(move |x| [x, y]))
        .collect()
}

impl Session {
    /// Draws a picture of another size than the session's, in tiles of at most `side` pixels a side ([`TILE_SIDE`] where
    /// `None`, and no more than the device can have), and gives it with the hazards that shaders ran into. The camera
    /// is the session's, fitted to the whole picture where it is fitted. After each tile `progress` is told how many are
    /// done, of how many.
    ///
    /// # Errors
    /// `picture-size`; `no-window` for each node that works on the whole picture; and as [`Self::draw`].
    pub fn render_tiled(
        &mut self,
        size: [u32; 2],
        side: Option<u32>,
        progress: &mut dyn FnMut(usize, usize),
    ) -> Result<(Picture, Findings), Findings> {
        let pixels = u64::from(size[0]) * u64::from(size[1]);
        if pixels == 0 || pixels > MAX_PIXELS || size[0].max(size[1]) > MAX_SIDE {
            let [width, height] = size;
            let message = format!("a picture of {width}x{height} is refused");
            return Err(Finding::error("picture-size", message)
                .help(format!(
                    "a side has 1 to {MAX_SIDE} pixels, all at most {MAX_PIXELS}"
                ))
                .into());
        }
        self.revive()?;
        let drawn = self.tiles(size, side, progress);
        self.clean_up();
        drawn
    }

    fn tiles(
        &mut self,
        whole: [u32; 2],
        side: Option<u32>,
        progress: &mut dyn FnMut(usize, usize),
    ) -> Result<(Picture, Findings), Findings> {
        let limits = self.options.limits(self.runner.gpu());
        let side = side.unwrap_or(TILE_SIDE);
        let fitting = (limits.max_resource_bytes / PIXEL_BYTES).isqrt();
        let side = u64::from(side).min(limits.max_texture_2d).min(fitting);
        let tile = tile_size(whole, u32::try_from(side).unwrap_or(TILE_SIDE));
        let state = &self.state;
        let has_layers = self.options.with_layers;
        let plan = state
            .scene
            .plan(&state.shaders, &limits, tile, has_layers)?;
        plan.check_windows()?;
        let camera = whole_camera(&state.stance, &plan, whole);
        let mut view = View {
            camera,
            size: tile,
            window: Some(Window {
                whole,
                corner: [0; 2],
            }),
        };
        let before = Some(&state.installation);
        let mut installation = self.runner.prepare(Arc::new(plan), &view, before)?;
        let corners = corners(whole, tile);
        let mut picture = Picture::default();
        let mut hazards = Findings::new();
        for (done, corner) in corners.iter().enumerate() {
            view.window = Some(Window {
                whole,
                corner: *corner,
            });
            let report = self.runner.frame(&mut installation, &view)?;
            for warning in report.all_warnings() {
                if !(&hazards).into_iter().any(|known| known == &warning) {
                    hazards.push(warning);
                }
            }
            let scene = &self.state.scene;
            let part = self::picture(&self.runner, &installation, scene, &view, has_layers)?;
            if done == 0 {
                picture = blank(&part, whole);
            }
            put(&mut picture, &part, *corner);
            progress(done + 1, corners.len());
        }
        view.size = whole;
        view.window = None;
        let adapter = self.runner.gpu().adapter();
        picture.metadata = metadata::of(&self.state.scene, installation.plan(), &view, adapter);
        Ok((picture, hazards))
    }
}

/// The camera for the whole picture: a plan fits its own to the form of a tile.
fn whole_camera(stance: &Stance, plan: &Plan, whole: [u32; 2]) -> Camera {
    let desc = match stance {
        Stance::Graph => &plan.camera,
        Stance::Fitted(camera) => camera,
        Stance::Exact(camera) => return *camera,
    };
    let aspect = f64::from(whole[0]) / f64::from(whole[1].max(1));
    desc.fit(&plan.corners(), aspect)
}

/// A picture of that size with the buffers that a tile has.
fn blank(part: &Picture, [width, height]: [u32; 2]) -> Picture {
    let pixels = width as usize * height as usize;
    let scalars = |buffer: &Option<Vec<f32>>| buffer.as_ref().map(|_| vec![0.0; pixels]);
    let mut layers = part.layers.clone();
    for layer in &mut layers {
        layer.values = match layer.values {
            LayerValues::Scalar(_) => LayerValues::Scalar(vec![0.0; pixels]),
            LayerValues::Vector(_) => LayerValues::Vector(vec![[0.0; 4]; pixels]),
        };
    }
    Picture {
        width,
        height,
        color: vec![[0.0; 4]; pixels],
        depth: scalars(&part.depth),
        opacity: scalars(&part.opacity),
        layers,
        metadata: Vec::new(),
    }
}

/// Copies a tile into the whole picture.
fn put(picture: &mut Picture, part: &Picture, corner: [u32; 2]) {
    fn rows<T: Copy>(to: &mut [T], width: u32, from: &[T], tile_width: u32, corner: [u32; 2]) {
        let (width, tile_width) = (width as usize, tile_width as usize);
        let [x, y] = corner.map(|at| at as usize);
        let rows = to.chunks_exact_mut(width).skip(y);
        for (row, of_tile) in rows.zip(from.chunks_exact(tile_width)) {
            row[x..x + tile_width].copy_from_slice(of_tile);
        }
    }
    let (width, tile_width) = (picture.width, part.width);
    rows(&mut picture.color, width, &part.color, tile_width, corner);
    for (to, from) in [
        (&mut picture.depth, &part.depth),
        (&mut picture.opacity, &part.opacity),
    ] {
        if let (Some(to), Some(from)) = (to, from) {
            rows(to, width, from, tile_width, corner);
        }
    }
    for (to, from) in picture.layers.iter_mut().zip(&part.layers) {
        match (&mut to.values, &from.values) {
            (LayerValues::Scalar(to), LayerValues::Scalar(from)) => {
                rows(to, width, from, tile_width, corner);
            }
            (LayerValues::Vector(to), LayerValues::Vector(from)) => {
                rows(to, width, from, tile_width, corner);
            }
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_cover_every_pixel_and_none_beyond() {
        for (whole, side) in [
            ([7, 5], 3),
            ([6, 6], 3),
            ([1, 9], 4),
            ([5, 4], 100),
            ([3, 2], 1),
        ] {
            let tile = tile_size(whole, side);
            assert!(tile[0] <= side && tile[1] <= side);
            let mut seen = vec![false; (whole[0] * whole[1]) as usize];
            for [x, y] in corners(whole, tile) {
                assert!(x + tile[0] <= whole[0] && y + tile[1] <= whole[1]);
                for at in 0..tile[0] * tile[1] {
                    let (x, y) = (x + at % tile[0], y + at / tile[0]);
                    seen[(y * whole[0] + x) as usize] = true;
                }
            }
            assert!(seen.iter().all(|seen| *seen), "{whole:?} {side}");
        }
        assert_eq!(corners([5, 4], tile_size([5, 4], 100)), [[0, 0]]);
    }

    #[test]
    fn sizes_beyond_a_device_are_tiled() {
        let limits = Limits {
            max_texture_2d: 100,
            max_resource_bytes: 16 * 5000,
            ..Limits::default()
        };
        assert!(!has_to_be_tiled([100, 50], &limits));
        assert!(has_to_be_tiled([101, 1], &limits));
        assert!(has_to_be_tiled([100, 51], &limits));
    }
}
