//! How wrong a picture is, in the figures that charts and other renderers' harnesses use.

use glam::DVec3;
use serde::Serialize;
use volgraph_measure::compare_without_flip;
use volgraph_picture::Picture;
use volgraph_reference::Rays;
use volgraph_report::Finding;
use volgraph_volume::Grid;

/// Rays that cross so many voxels between voxel centres are core pixels: those at the silhouette, where renderers differ
/// by their conventions alone, are left out.
const CORE_VOXELS: f64 = 4.0;

/// Errors of a picture. Colours are linear and premultiplied, 1 is white.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Errors {
    /// Root of the mean squared error of red, green, blue and alpha over all pixels.
    pub rmse: f64,
    /// The largest absolute error of any component.
    pub max: f64,
    /// 99.9th percentile of the pixels' errors; a pixel's is its worst component's.
    pub p999: f64,
    /// Root of the mean squared error of red, green and blue over core pixels; 0 where there are none.
    pub core_rmse: f64,
    /// The same of the picture rounded to 8 bits a component, as most renderers give it.
    pub core_rmse_8bit: f64,
    /// `rmse` of the picture rounded to 8 bits.
    pub rmse_8bit: f64,
}

/// The errors of a picture against what it should be; `core` says of each pixel whether it counts as core.
///
/// # Errors
/// `compare`, where the pictures differ in size or one has values that are no numbers.
pub fn errors(picture: &Picture, truth: &Picture, core: &[bool]) -> Result<Errors, Finding> {
    let compared = |picture: &Picture| {
        compare_without_flip(picture, truth)
            .map_err(|error| Finding::error("compare", error.to_string()))
    };
    let exact = compared(picture)?;
    let mut rounded = Picture::from_color(picture.width, picture.height, picture.color.clone())
        .map_err(|error| Finding::error("picture", error.to_string()))?;
    for component in rounded.color.iter_mut().flatten() {
        *component = (component.clamp(0.0, 1.0) * 255.0).round() / 255.0;
    }
    Ok(Errors {
        rmse: exact.rmse,
        max: exact.max.error,
        p999: exact.p999,
        core_rmse: core_rmse(picture, truth, core),
        core_rmse_8bit: core_rmse(&rounded, truth, core),
        rmse_8bit: compared(&rounded)?.rmse,
    })
}

fn core_rmse(picture: &Picture, truth: &Picture, core: &[bool]) -> f64 {
    let pixels = picture.color.iter().zip(&truth.color).zip(core);
    let (mut squares, mut count) = (0.0, 0.0);
    for ((ours, theirs), _) in pixels.filter(|(_, is_core)| **is_core) {
        for channel in 0..3 {
            let error = f64::from(ours[channel]) - f64::from(theirs[channel]);
            squares += error * error;
        }
        count += 3.0;
    }
    if count > 0.0 {
        f64::sqrt(squares / count)
    } else {
        0.0
    }
}

/// Of each pixel, whether its ray crosses at least four voxels (of the smallest spacing) of the box between the outermost
/// voxel centres of a grid.
#[must_use]
pub fn core_pixels(grid: &Grid, rays: &Rays) -> Vec<bool> {
    let index_from_world = grid.world_from_index.inverse();
    let last = DVec3::from(grid.dims.map(|n| f64::from(n) - 1.0));
    let least = CORE_VOXELS * grid.min_spacing();
    let [width, height] = rays.size;
    let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    pixels
        .map(|(x, y)| {
            let ray = rays.ray(x, y);
            let from = index_from_world.transform_point3(ray.origin);
            let slope = index_from_world.transform_vector3(ray.direction);
            let (mut near, mut far) = (0.0_f64, f64::INFINITY);
            for axis in 0..3 {
                let a = -from[axis] / slope[axis];
                let b = (last[axis] - from[axis]) / slope[axis];
                // Along a face both are infinite or no numbers, which neither limits.
                near = near.max(a.min(b));
                far = far.min(a.max(b));
            }
            far - near >= least
        })
        .collect()
}
