//! The picture that a case keeps in a file: written on demand, else held against.

use std::path::Path;
use std::sync::Arc;

use volgraph_measure::{compare, compare_without_flip};
use volgraph_picture::SaveOptions;
use volgraph_report::{Finding, Findings, Place};

use super::Expectation;
use super::kinds::PictureBound;
use super::measure::incomparable;
use super::outcome::{Measured, Shown};
use super::render::Rendered;
use super::run::Run;
use crate::Picture;

impl Run<'_> {
    pub(super) fn stored_picture(
        &self,
        own: &Rendered,
        file: &Path,
        bound: PictureBound,
        expectation: &Expectation,
    ) -> Result<Measured, Findings> {
        let told = |code, message: String, help: &str| {
            Findings::from(
                Finding::error(code, message)
                    .at(expectation.place.clone())
                    .help(help),
            )
        };
        if self.renderer.options.bless {
            let folder = file.parent().unwrap_or(Path::new(""));
            let made = if folder.as_os_str().is_empty() {
                Ok(())
            } else {
                std::fs::create_dir_all(folder)
            };
            let failed = |why: String| {
                let message = format!("{} cannot be written: {why}", file.display());
                told("io", message, "check that you may write there")
            };
            made.map_err(|error| failed(error.to_string()))?;
            let saved = own.picture.save(file, SaveOptions::default());
            let report = saved.map_err(|error| failed(error.to_string()))?;
            let mut detail = format!("written to {}", file.display());
            if report.nan_pixels > 0 {
                detail += &format!("; {} pixels are not numbers", report.nan_pixels);
            }
            return Ok(Measured::new(report.nan_pixels == 0, None, detail).with([own.shown()]));
        }
        if !file.is_file() {
            let message = format!("there is no picture {}", file.display());
            return Err(told(
                "missing-picture",
                message,
                "`volgraph test --bless` writes it: look at it before you keep it",
            ));
        }
        let there = Picture::load(file).map_err(|error| {
            Findings::from(Finding::error("picture", error.to_string()).at(Place::whole_file(file)))
        })?;
        let compared = match bound {
            PictureBound::Flip(_) => compare(&own.picture, &there),
            _ => compare_without_flip(&own.picture, &there),
        };
        let measured = match compared {
            Err(error) => incomparable(&error),
            Ok(comparison) => match bound {
                PictureBound::Flip(bound) => {
                    Measured::at_most("flip", comparison.flip.unwrap_or(f64::INFINITY), bound)
                }
                PictureBound::Rmse(bound) => Measured::at_most("rmse", comparison.rmse, bound),
                PictureBound::Max(bound) => Measured::at_most("max", comparison.max.error, bound),
            },
        };
        let stored = Shown {
            name: file.display().to_string(),
            picture: Arc::new(there),
        };
        Ok(measured.with([own.shown(), stored]))
    }
}
