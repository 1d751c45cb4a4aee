//! The sources: volumes from files and from functions, transfer functions, images.

pub mod analytic;
pub mod image;
mod seen_bricks;
pub mod segments;
mod series;
pub mod transfer;
pub mod volume;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use glam::{DAffine3, DVec3};
use volgraph_graph::{Folders, is_embedded};
use volgraph_report::{Finding, Findings};
use volgraph_shader::{ParamSpec, ParamValue};

/// The field that names a source's file.
fn path_param() -> ParamSpec {
    ParamSpec::text("path", "", "The file, relative to the graph file.")
}

/// The field that moves a volume.
fn transform_param() -> ParamSpec {
    let identity = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    ParamSpec::vector(
        "transform",
        &identity,
        "Moves the volume from its own world to the scene's: the three rows of four numbers of an affine matrix.",
    )
}

/// The given fields of a source, already checked against its kind's specs.
struct Given<'a>(&'a BTreeMap<String, ParamValue>);

impl Given<'_> {
    fn text(&self, name: &str) -> Option<&str> {
        match self.0.get(name) {
            Some(ParamValue::Text(text)) => Some(text),
            _ => None,
        }
    }

    fn path(&self, name: &str, folders: &Folders) -> Result<PathBuf, Finding> {
        match self.text(name) {
            Some(path) if is_embedded(Path::new(path)) => self.embedded(path, folders),
            Some(path) if !path.is_empty() => Ok(folders.find(path)),
            _ => Err(
                Finding::error("missing-field", format!("the field `{name}` is missing")).help(
                    format!(
                        "add `{name}: \"…\"`, relative to the graph file or to a folder of data"
                    ),
                ),
            ),
        }
    }

    fn embedded(&self, path: &str, folders: &Folders) -> Result<PathBuf, Finding> {
        let file = folders.find(path);
        match folders.embedded_bytes(&file) {
            Some(_) => Ok(file),
            None => Err(Finding::error("io", format!("volgraph carries no file `{path}`"))
                .help("`volgraph graphs` lists the ready graphs, and `volgraph graphs NAME` shows which files one reads")),
        }
    }

    /// Where the file is missing and volgraph carries one of its name, that one is the remedy, and never the file.
    fn with_twin(
        &self,
        findings: Findings,
        name: &str,
        file: &Path,
        folders: &Folders,
    ) -> Findings {
        let twin = self
            .text(name)
            .filter(|_| !file.exists())
            .and_then(|path| folders.embedded_twin(path));
        let Some(twin) = twin else { return findings };
        let help = format!(
            "put the file there, or write `{name}: \"{}\"` for the one that volgraph carries",
            twin.display()
        );
        findings
            .into_iter()
            .map(|finding| finding.help(help.as_str()))
            .collect()
    }

    fn is_set(&self, name: &str) -> bool {
        matches!(self.0.get(name), Some(ParamValue::Bool(true)))
    }

    fn uint(&self, name: &str) -> Option<u32> {
        match self.0.get(name) {
            Some(ParamValue::Int(value)) => u32::try_from(*value).ok(),
            _ => None,
        }
    }

    fn vec3(&self, name: &str) -> Option<DVec3> {
        match self.0.get(name) {
            Some(ParamValue::Vector(v)) if v.len() == 3 => Some(DVec3::new(v[0], v[1], v[2])),
            _ => None,
        }
    }

    /// Twelve numbers, the rows of a 3×4 matrix.
    fn affine(&self, name: &str) -> Option<DAffine3> {
        match self.0.get(name) {
            Some(ParamValue::Vector(v)) if v.len() == 12 => {
                let column = |at: usize| DVec3::new(v[at], v[at + 4], v[at + 8]);
                Some(DAffine3::from_cols(
                    column(0),
                    column(1),
                    column(2),
                    column(3),
                ))
            }
            _ => None,
        }
    }

    /// Three whole numbers of at least 1.
    fn dims(&self, name: &str) -> Result<Option<[u32; 3]>, Finding> {
        let Some(v) = self.vec3(name) else {
            return Ok(None);
        };
        let mut dims = [0_u32; 3];
        for (dim, value) in dims.iter_mut().zip(v.to_array()) {
            if value.fract() != 0.0 || !(1.0..=f64::from(u32::MAX)).contains(&value) {
                return Err(Finding::error(
                    "bad-param",
                    format!("field `{name}`: {value} is not a whole number of at least 1"),
                ));
            }
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "checked above"
            )]
            {
                *dim = value as u32;
            }
        }
        Ok(Some(dims))
    }
}
