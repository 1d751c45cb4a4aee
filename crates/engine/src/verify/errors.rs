//! How far one picture is from another, of each quantity: root mean squares in float64.
//!
//! Colour is of all pixels, linear and premultiplied; where surfaces are drawn, of those in which both pictures have one
//! or neither has: whether a ray at an outline hits or misses is no matter of orders. Depths and normals are of pixels
//! where both have them, without the worst twentieth: rays that graze a surface.

use volgraph_picture::{LayerValues, Picture};
use volgraph_reference::Rendered;

/// A picture in float64.
#[derive(Clone, Debug)]
pub(super) struct Look {
    color: Vec<[f64; 4]>,
    depth: Option<Vec<f64>>,
    normal: Option<Vec<[f64; 3]>>,
}

/// An error of a quantity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Measured {
    pub name: &'static str,
    pub error: f64,
    /// How large numbers are that it is an error of: rounding and floors are shares of it.
    pub scale: f64,
}

/// The share of depths and normals that counts.
const KEPT: f64 = 0.95;

impl From<&Picture> for Look {
    fn from(picture: &Picture) -> Self {
        let normal = picture.layer("normal").and_then(|layer| match layer {
            LayerValues::Vector(normals) => Some(
                normals
                    .iter()
                    .map(|n| [n[0], n[1], n[2]].map(f64::from))
                    .collect(),
            ),
            LayerValues::Scalar(_) => None,
        });
        let depth = picture.depth.as_ref();
        Self {
            color: picture.color.iter().map(|it| it.map(f64::from)).collect(),
            depth: depth.map(|depth| depth.iter().copied().map(f64::from).collect()),
            normal,
        }
    }
}

impl From<&Rendered> for Look {
    fn from(rendered: &Rendered) -> Self {
        Self {
            color: rendered.color.clone(),
            depth: Some(rendered.depth.clone()),
            normal: Some(rendered.normal.clone()),
        }
    }
}

impl Look {
    /// The same with all of its pixels averaged in squares of so many, colour alone.
    pub(super) fn averaged(&self, [width, height]: [usize; 2], by: usize) -> Self {
        let mut color = vec![[0.0; 4]; (width / by) * (height / by)];
        let share = 1.0 / (by * by) as f64;
        for (at, pixel) in self.color.iter().enumerate() {
            let to = &mut color[(at / width / by) * (width / by) + at % width / by];
            for (sum, value) in to.iter_mut().zip(pixel) {
                *sum += share * value;
            }
        }
        Self {
            color,
            depth: None,
            normal: None,
        }
    }

    /// The errors of this against another, and the share of pixels that have a depth in one of the two alone.
    /// `is_surface` says that depths are those of surfaces.
    pub(super) fn errors(&self, other: &Self, is_surface: bool) -> (Vec<Measured>, f64) {
        let mut measured = Vec::new();
        let depths = self.depth.as_ref().zip(other.depth.as_ref());
        let agrees = |at: usize| {
            depths.is_none_or(|(a, b)| a[at].is_finite() == b[at].is_finite()) || !is_surface
        };
        let mut squares = Vec::new();
        let mut scale = 1.0_f64;
        for (at, (a, b)) in self.color.iter().zip(&other.color).enumerate() {
            scale = b.iter().copied().fold(scale, f64::max);
            if agrees(at) {
                squares.push((0..4).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>() / 4.0);
            }
        }
        let disagree = self.color.len() - squares.len();
        measured.push(Measured {
            name: "colour",
            error: root_mean(&squares),
            scale,
        });
        if let Some((a, b)) = depths {
            let both = a.iter().zip(b);
            let both = both.filter(|(a, b)| a.is_finite() && b.is_finite());
            scale = 0.0;
            let squares: Vec<f64> = both
                .map(|(a, b)| {
                    scale = scale.max(b.abs());
                    (a - b).powi(2)
                })
                .collect();
            measured.extend(trimmed("depth", squares, scale));
        }
        if let Some((a, b)) = self.normal.as_ref().zip(other.normal.as_ref()) {
            let is_there = |normal: &[f64; 3]| normal.iter().any(|n| *n != 0.0);
            let both = a.iter().zip(b).filter(|(a, b)| is_there(a) && is_there(b));
            let squares = both
                .map(|(a, b)| (0..3).map(|i| (a[i] - b[i]).powi(2)).sum())
                .collect();
            measured.extend(trimmed("normal", squares, 1.0));
        }
        (measured, disagree as f64 / self.color.len().max(1) as f64)
    }
}

/// Without the largest; `None` where nothing is left.
fn trimmed(name: &'static str, mut squares: Vec<f64>, scale: f64) -> Option<Measured> {
    squares.sort_by(f64::total_cmp);
    let kept = &squares[..(squares.len() as f64 * KEPT) as usize];
    (!kept.is_empty()).then(|| Measured {
        name,
        error: root_mean(kept),
        scale,
    })
}

fn root_mean(squares: &[f64]) -> f64 {
    (squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn look(color: f64, depth: &[f64]) -> Look {
        Look {
            color: vec![[color; 4]; depth.len()],
            depth: Some(depth.to_vec()),
            normal: None,
        }
    }

    #[test]
    fn outlines_are_counted_and_left_out_where_there_are_surfaces() {
        let far = f64::INFINITY;
        let mut a = look(0.5, &[1.0, 2.0, far, far]);
        let b = look(0.25, &[1.5, 2.5, 3.0, far]);
        a.color[2] = [9.0; 4];
        let (errors, one_sided) = a.errors(&b, true);
        assert_eq!(one_sided, 0.25);
        let names: Vec<_> = errors.iter().map(|it| (it.name, it.error)).collect();
        assert_eq!(names, [("colour", 0.25), ("depth", 0.5)]);
        let (errors, _) = a.errors(&b, false);
        assert!(errors[0].error > 4.0, "{errors:?}");
    }

    #[test]
    fn squares_of_pixels_are_averaged() {
        let mut fine = look(0.0, &[0.0; 8]);
        for (at, pixel) in fine.color.iter_mut().enumerate() {
            *pixel = [at as f64; 4];
        }
        let coarse = fine.averaged([4, 2], 2);
        assert_eq!(coarse.color, [[2.5; 4], [4.5; 4]]);
    }
}
