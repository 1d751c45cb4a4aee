//! The picture out of the intermediate image: an affine map, bilinear between pixels.

use rayon::prelude::*;
use volgraph_reference::Rays;

use super::shear::{Frame, Shear};

/// The image as the rays of a picture see it, over what is behind.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::cast_precision_loss,
    reason = "places inside of an image"
)]
pub(super) fn warp(
    image: &[[f32; 4]],
    frame: &Frame,
    shear: &Shear,
    rays: &Rays,
    behind: &[[f32; 4]],
) -> Vec<[f32; 4]> {
    let [width, height] = rays.size.map(|n| n as usize);
    let mut picture = behind.to_vec();
    picture.resize(width * height, [0.0; 4]);
    let last = [frame.width - 1, frame.height - 1].map(|n| n as f64);
    let place = |x: u32, y: u32| {
        let uv = shear.uv(rays.place(x, y));
        [0, 1].map(|axis| (uv[axis] - frame.first[axis]) * frame.scale)
    };
    let rows = picture.par_chunks_exact_mut(width.max(1));
    (0..rays.size[1])
        .into_par_iter()
        .zip(rows)
        .for_each(|(y, row)| {
            for (x, pixel) in (0..rays.size[0]).zip(row) {
                let at = place(x, y);
                // The outermost pixels of the image are empty.
                let is_inside = (0..2).all(|axis| at[axis] >= 0.0 && at[axis] < last[axis]);
                if !is_inside {
                    continue;
                }
                let [a, b] = at.map(|at| at as usize);
                let (u, v) = ((at[0] - a as f64) as f32, (at[1] - b as f64) as f32);
                let above = &image[b * frame.width + a..][..2];
                let below = &image[(b + 1) * frame.width + a..][..2];
                let color: [f32; 4] = std::array::from_fn(|i| {
                    let mix = |a: f32, b: f32, share: f32| (b - a) * share + a;
                    mix(
                        mix(above[0][i], above[1][i], u),
                        mix(below[0][i], below[1][i], u),
                        v,
                    )
                });
                let open = 1.0 - color[3];
                *pixel = std::array::from_fn(|i| color[i] + open * pixel[i]);
            }
        });
    picture
}
