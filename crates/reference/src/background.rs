//! What lies behind the volume: patterns of the picture's plane.

use crate::rays::Rays;

/// A pattern, in linear premultiplied colours.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Background {
    /// Nothing: the picture is transparent there.
    #[default]
    Nothing,
    /// One colour.
    Uniform([f64; 4]),
    /// From one colour at the bottom to another at the top.
    Gradient {
        /// At the bottom.
        bottom: [f64; 4],
        /// At the top.
        top: [f64; 4],
    },
    /// Squares of two colours.
    Checker {
        /// One half of the squares.
        color: [f64; 4],
        /// The other half.
        other_color: [f64; 4],
        /// Squares over the height of the picture.
        squares: f64,
    },
    /// A colour for each pixel, in rows from the top.
    Picture(Vec<[f64; 4]>),
}

impl Background {
    /// The colour of a pixel.
    #[must_use]
    pub fn at(&self, rays: &Rays, x: u32, y: u32) -> [f64; 4] {
        let [across, up] = rays.place(x, y);
        match self {
            Self::Nothing => [0.0; 4],
            Self::Uniform(color) => *color,
            Self::Gradient { bottom, top } => {
                let share = 0.5 * up + 0.5;
                std::array::from_fn(|i| bottom[i] + share * (top[i] - bottom[i]))
            }
            Self::Checker {
                color,
                other_color,
                squares,
            } => {
                let aspect = rays.half_extent[0] / rays.half_extent[1];
                let column = (across * aspect * 0.5 * squares).floor();
                let row = (up * 0.5 * squares).floor();
                let is_other = (0.5 * (column + row)).rem_euclid(1.0) > 0.25;
                if is_other { *other_color } else { *color }
            }
            Self::Picture(pixels) => {
                let at = y as usize * rays.size[0] as usize + x as usize;
                pixels.get(at).copied().unwrap_or_default()
            }
        }
    }
}
