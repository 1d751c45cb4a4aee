//! All pixels of a scene, in parallel.

use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;

use crate::projection;
use crate::rays::Ray;
use crate::scene::{Scene, Technique};
use crate::sight::Sight;
use crate::volume_rendering::light;

/// Told how far a picture is.
pub trait Progress: Sync {
    /// Rows done, and rows in all; false ends the work.
    fn rows(&self, done: usize, total: usize) -> bool;
}

/// Tells nobody.
#[derive(Clone, Copy, Debug, Default)]
pub struct Silent;

impl Progress for Silent {
    fn rows(&self, _done: usize, _total: usize) -> bool {
        true
    }
}

/// Why there is no picture.
#[derive(Debug, thiserror::Error)]
pub enum ReferenceError {
    /// The tolerance is no number above 0.
    #[error("a tolerance of {0} cannot be kept: give one between 1e-10 and 1")]
    Tolerance(f64),
    /// The caller wanted no more.
    #[error("the work was ended")]
    Ended,
}

/// A picture in float64, in rows from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Rendered {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Linear premultiplied colour, over the background.
    pub color: Vec<[f64; 4]>,
    /// Opacity of what the rays met.
    pub opacity: Vec<f64>,
    /// World distance from the ray's origin to what it shows; infinite where it shows nothing.
    pub depth: Vec<f64>,
    /// World normal towards the eye of the surface that is shown; zeros where none is.
    pub normal: Vec<[f64; 3]>,
    /// Bound of the absolute error of each pixel's colour.
    pub error: Vec<f64>,
}

/// What one ray shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Pixel {
    pub(crate) color: [f64; 4],
    pub(crate) depth: f64,
    pub(crate) normal: [f64; 3],
    pub(crate) error: f64,
}

impl Pixel {
    pub(crate) const NOTHING: Self = Self {
        color: [0.0; 4],
        depth: f64::INFINITY,
        normal: [0.0; 3],
        error: 0.0,
    };
}

/// Computes a scene's picture to an absolute tolerance of linear premultiplied colours, on all cores.
///
/// # Errors
/// [`ReferenceError`].
pub fn render(
    scene: &Scene,
    tolerance: f64,
    progress: &dyn Progress,
) -> Result<Rendered, ReferenceError> {
    check(tolerance)?;
    let [width, height] = scene.rays.size;
    let done = AtomicUsize::new(0);
    type Row = Vec<(Pixel, [f64; 4])>;
    let rows: Option<Vec<Row>> = (0..height)
        .into_par_iter()
        .map(|y| {
            let row = (0..width)
                .map(|x| {
                    let pixel = pixel(scene, x, y, tolerance);
                    (pixel, over(scene, &pixel, x, y))
                })
                .collect();
            let done = 1 + done.fetch_add(1, Ordering::Relaxed);
            progress.rows(done, height as usize).then_some(row)
        })
        .collect();
    let pixels: Vec<_> = rows
        .ok_or(ReferenceError::Ended)?
        .into_iter()
        .flatten()
        .collect();
    Ok(Rendered {
        size: scene.rays.size,
        color: pixels.iter().map(|(_, over)| *over).collect(),
        opacity: pixels.iter().map(|(pixel, _)| pixel.color[3]).collect(),
        depth: pixels.iter().map(|(pixel, _)| pixel.depth).collect(),
        normal: pixels.iter().map(|(pixel, _)| pixel.normal).collect(),
        error: pixels.iter().map(|(pixel, _)| pixel.error).collect(),
    })
}

/// The colours of some pixels (column and row, from the top), over the background, to an absolute tolerance.
///
/// # Errors
/// [`ReferenceError::Tolerance`].
pub fn render_pixels(
    scene: &Scene,
    pixels: &[[u32; 2]],
    tolerance: f64,
) -> Result<Vec<[f64; 4]>, ReferenceError> {
    check(tolerance)?;
    let colors = pixels.par_iter().map(|[x, y]| {
        let pixel = pixel(scene, *x, *y, tolerance);
        over(scene, &pixel, *x, *y)
    });
    Ok(colors.collect())
}

pub(crate) fn check(tolerance: f64) -> Result<(), ReferenceError> {
    if (1e-10..=1.0).contains(&tolerance) {
        Ok(())
    } else {
        Err(ReferenceError::Tolerance(tolerance))
    }
}

/// The colour of a pixel over the background.
pub(crate) fn over(scene: &Scene, pixel: &Pixel, x: u32, y: u32) -> [f64; 4] {
    let behind = scene.background.at(&scene.rays, x, y);
    let open = 1.0 - pixel.color[3];
    std::array::from_fn(|i| pixel.color[i] + open * behind[i])
}

/// The distances between which a pixel's ray is in the volume's box, and its parts. Their distances count from where the
/// box begins: from an eye far away they would have no digits left.
pub(crate) fn sight(scene: &Scene, x: u32, y: u32) -> Option<([f64; 2], Sight<'_>)> {
    let ray = scene.rays.ray(x, y);
    let (near, far) = scene.field.interval(&ray)?;
    let ray = Ray {
        origin: ray.at(near),
        ..ray
    };
    let sight = Sight::new(scene, ray, (0.0, far - near), near > 0.0);
    Some(([near, far], sight))
}

pub(crate) fn pixel(scene: &Scene, x: u32, y: u32, tolerance: f64) -> Pixel {
    let Some(([near, _], sight)) = sight(scene, x, y) else {
        return Pixel::NOTHING;
    };
    let Some(own) = scene.looks.first() else {
        return Pixel::NOTHING;
    };
    let extreme = |is_largest| {
        projection::extreme(&sight, is_largest).map_or(Pixel::NOTHING, |extreme| Pixel {
            color: scene
                .looks
                .get(extreme.look)
                .unwrap_or(own)
                .toned(extreme.scalar),
            depth: near + extreme.distance,
            ..Pixel::NOTHING
        })
    };
    let composited = |with_matter, surfaces| {
        let behind = scene.background.at(&scene.rays, x, y);
        let behind = behind.into_iter().fold(0.0, f64::max);
        let walk = light(&sight, tolerance, with_matter, surfaces, behind);
        let [r, g, b] = walk.light.color;
        Pixel {
            color: [r, g, b, 1.0 - walk.light.transmittance],
            depth: near + walk.light.half.unwrap_or(f64::INFINITY),
            normal: walk.normal.to_array(),
            error: walk.light.error,
        }
    };
    match &scene.technique {
        Technique::VolumeRendering => composited(true, None),
        Technique::Surfaces {
            has_faces,
            with_matter,
        } => composited(*with_matter, Some(*has_faces)),
        Technique::Maximum => extreme(true),
        Technique::Minimum => extreme(false),
        Technique::Average => projection::mean(&sight).map_or(Pixel::NOTHING, |mean| Pixel {
            color: own.toned(mean),
            ..Pixel::NOTHING
        }),
        Technique::Xray {
            windows,
            absorption,
            film,
        } => {
            let opacity = -(-absorption * projection::shares(&sight, windows)).exp_m1();
            let [r, g, b] = film.map(|channel| channel * opacity);
            Pixel {
                color: [r, g, b, opacity],
                ..Pixel::NOTHING
            }
        }
    }
}
