//! Pictures of a page: written once each, and differences with their scale.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use volgraph::{Findings, Picture};
use volgraph_picture::SaveOptions;

use crate::commands::errors;

/// The largest factor by which a difference is amplified: errors below are those of f32.
const MAX_SCALE: f64 = 1_048_576.0;

/// The pictures that a page shows, by what they are of, in files beside it.
pub struct Pictures<'p> {
    folder: &'p Path,
    /// By the address of a picture that lives as long as the page is written.
    written: HashMap<*const Picture, String>,
    count: usize,
}

impl<'p> Pictures<'p> {
    pub fn new(folder: &'p Path) -> Self {
        Self {
            folder,
            written: HashMap::new(),
            count: 0,
        }
    }

    /// The file of a picture.
    pub fn file(&mut self, picture: &Arc<Picture>) -> Result<String, Findings> {
        let key = Arc::as_ptr(picture);
        if let Some(file) = self.written.get(&key) {
            return Ok(file.clone());
        }
        let file = self.save(picture)?;
        self.written.insert(key, file.clone());
        Ok(file)
    }

    /// The file of a difference.
    pub fn difference(&mut self, difference: &Picture) -> Result<String, Findings> {
        self.save(difference)
    }

    fn save(&mut self, picture: &Picture) -> Result<String, Findings> {
        self.count += 1;
        let file = format!("{}.png", self.count);
        let path: PathBuf = self.folder.join(&file);
        // Values that a screen cannot show are told by `finite`, not here.
        let _ = picture
            .save(&path, SaveOptions::default())
            .map_err(|error| errors::of_picture(&error, &path))?;
        Ok(file)
    }
}

/// Where two pictures differ, and the power of two by which that is amplified, so that the largest error is between one
/// half and 1 of white; `None` where they are equal or cannot be compared.
pub fn difference(a: &Picture, b: &Picture) -> Option<(Picture, f64)> {
    if (a.width, a.height) != (b.width, b.height) {
        return None;
    }
    let pairs = || a.color.iter().zip(&b.color);
    let error =
        |(a, b): (&[f32; 4], &[f32; 4]), at: usize| (f64::from(a[at]) - f64::from(b[at])).abs();
    let worst = pairs()
        .flat_map(|pair| (0..4).map(move |at| error(pair, at)))
        .filter(|error| error.is_finite())
        .fold(0.0, f64::max);
    if worst == 0.0 {
        return None;
    }
    let scale = (-worst.log2()).floor().exp2().min(MAX_SCALE);
    #[expect(clippy::cast_possible_truncation, reason = "pictures hold f32")]
    let shown = |value: f64| {
        if value.is_finite() {
            value.min(1.0) as f32
        } else {
            1.0
        }
    };
    let color = pairs().map(|pair| {
        // What alpha differs by is seen as grey.
        let alpha = error(pair, 3);
        let color = |at| {
            let own = error(pair, at);
            // The larger of a number and of no number would be the number.
            shown(if own.is_nan() {
                own
            } else {
                scale * own.max(alpha)
            })
        };
        [color(0), color(1), color(2), 1.0]
    });
    let picture = Picture::from_color(a.width, a.height, color.collect()).ok()?;
    Some((picture, scale))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_difference_is_amplified_by_a_power_of_two() {
        let of = |value: f32| Picture::from_color(1, 1, vec![[value, 0.5, 0.5, 1.0]]).unwrap();
        let (picture, scale) = difference(&of(0.5), &of(0.4)).unwrap();
        assert_eq!(scale, 8.0);
        let [red, green, ..] = picture.color[0];
        assert!((red - 0.8).abs() < 1e-6 && green == 0.0);
        assert!(difference(&of(0.5), &of(0.5)).is_none());
        let (picture, _) = difference(
            &of(f32::NAN),
            &Picture::from_color(1, 1, vec![[0.5, 0.0, 0.5, 1.0]]).unwrap(),
        )
        .unwrap();
        assert_eq!(picture.color[0][0], 1.0, "what is no number is white");
    }
}
