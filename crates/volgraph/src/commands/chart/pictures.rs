//! Each method's picture and its error map, saved beside the page.
//!
//! A map shows the largest error of a pixel's components, times a power of ten that is chosen for each picture so that the
//! 99.9th percentile is the last that fits; the page states it.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use colorgrad::{Gradient, preset};
use volgraph::methods::{Errors, Method, Yardstick};
use volgraph::{Finding, Findings, Picture};
use volgraph_picture::SaveOptions;
use volgraph_picture::srgb;

use crate::commands::errors;

/// The files of a method, from the page's folder.
#[derive(Clone, Debug)]
pub struct Files {
    /// The picture.
    pub picture: String,
    /// The error map.
    pub map: String,
    /// What errors are multiplied by; 1 of it is the map's last colour.
    pub amplification: f64,
}

/// The files of all methods.
pub type AllFiles = BTreeMap<String, Files>;

/// Saves pictures into a folder.
pub struct Pictures<'y> {
    folder: PathBuf,
    name: String,
    yardstick: &'y Yardstick,
    files: AllFiles,
}

impl<'y> Pictures<'y> {
    /// The folder `name` in `output`, with the truth in it.
    pub fn new(output: &Path, name: &str, yardstick: &'y Yardstick) -> Result<Self, Findings> {
        let pictures = Self {
            folder: output.to_path_buf(),
            name: name.to_owned(),
            yardstick,
            files: AllFiles::new(),
        };
        pictures.save(&yardstick.truth, &format!("{name}/truth.png"))?;
        Ok(pictures)
    }

    /// Saves a method's, the first time.
    pub fn add(
        &mut self,
        method: &Method,
        picture: &Picture,
        errors: &Errors,
    ) -> Result<(), Findings> {
        let key = method.to_string();
        if self.files.contains_key(&key) {
            return Ok(());
        }
        let number = self.files.len() + 1;
        let files = Files {
            picture: format!("{}/{number:03}.png", self.name),
            map: format!("{}/{number:03}-error.png", self.name),
            amplification: amplification(errors.p999),
        };
        self.save(picture, &files.picture)?;
        let map = error_map(picture, &self.yardstick.truth, files.amplification)?;
        self.save(&map, &files.map)?;
        self.files.insert(key, files);
        Ok(())
    }

    /// What was saved.
    pub fn finish(self) -> AllFiles {
        self.files
    }

    fn save(&self, picture: &Picture, file: &str) -> Result<(), Findings> {
        let path = self.folder.join(file);
        let saved = picture.save(&path, SaveOptions::default());
        let _ = saved.map_err(|error| errors::of_picture(&error, &path))?;
        Ok(())
    }
}

/// The largest power of ten, of at least 1, that leaves an error inside 0 to 1.
fn amplification(error: f64) -> f64 {
    let powers = (0..=8).rev().map(|power| 10_f64.powi(power));
    powers
        .into_iter()
        .find(|power| error * power <= 1.0)
        .unwrap_or(1.0)
}

fn error_map(picture: &Picture, truth: &Picture, times: f64) -> Result<Picture, Findings> {
    let map = preset::inferno();
    let pixels = picture.color.iter().zip(&truth.color);
    let color = pixels.map(|(ours, theirs)| {
        let errors = ours
            .iter()
            .zip(theirs)
            .map(|(a, b)| (f64::from(*a) - f64::from(*b)).abs());
        let worst = errors.fold(0.0, f64::max);
        #[expect(clippy::cast_possible_truncation, reason = "a colour")]
        let [r, g, b, _] = map.at((worst * times).min(1.0) as f32).to_array();
        #[expect(clippy::cast_possible_truncation, reason = "pictures hold f32")]
        let [r, g, b] =
            [r, g, b].map(|c| srgb::linear_from_srgb(f64::from(c).clamp(0.0, 1.0)) as f32);
        [r, g, b, 1.0]
    });
    Picture::from_color(picture.width, picture.height, color.collect())
        .map_err(|error| Finding::error("picture", error.to_string()).into())
}

/// The colours of the maps from 0 to 1, as CSS writes them.
pub fn map_colors() -> String {
    let map = preset::inferno();
    let colors = (0_u8..=8).map(|i| map.at(f32::from(i) / 8.0).to_css_hex().to_string());
    colors.collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_amplified_by_powers_of_ten_and_fit() {
        assert_eq!(amplification(0.002), 100.0);
        assert_eq!(amplification(0.01), 100.0);
        assert_eq!(amplification(0.5), 1.0);
        assert_eq!(amplification(3.0), 1.0);
        assert_eq!(amplification(0.0), 1e8);
    }

    #[test]
    fn maps_run_from_the_first_colour_to_the_last() {
        let picture = |v: f32| Picture::from_color(1, 1, vec![[v, 0.0, 0.0, 1.0]]).unwrap();
        let color = |v: f32| error_map(&picture(v), &picture(0.0), 10.0).unwrap().color[0];
        let (none, most) = (color(0.0), color(0.1));
        assert!(none[0] < 0.01 && most[0] > 0.9, "{none:?} {most:?}");
        assert_eq!(color(5.0), most);
    }
}
