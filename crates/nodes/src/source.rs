//! The sources: volumes from files and from functions, transfer functions, images.

pub mod analytic;
pub mod bricks;
pub mod image;
mod seen_bricks;
pub mod segments;
mod series;
pub mod transfer;
pub mod volume;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use glam::{DAffine3, DVec3};
use volgraph_formats::LoadOptions;
use volgraph_graph::{EMBEDDED_GRAPHS, Folders, is_embedded, is_there};
use volgraph_report::{Finding, Findings};
use volgraph_shader::{ParamSpec, ParamValue};
use volgraph_volume::ScalarType;

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

/// The fields that name the file of a volume and say what it does not say itself.
fn volume_file_params() -> Vec<ParamSpec> {
    vec![
        ParamSpec::text(
            "path",
            "",
            "The file, folder or pattern (`slices/*.tif`), relative to the graph file.",
        ),
        ParamSpec::vector(
            "dims",
            &[0.0; 3],
            "Voxels along x, y, z of a raw file whose name does not say.",
        ),
        ParamSpec::text(
            "type",
            "",
            "Scalar type of a raw file whose name does not say, such as uint8.",
        ),
        ParamSpec::bool(
            "big_endian",
            false,
            "A raw file has its highest byte first.",
        ),
        ParamSpec::vector(
            "spacing",
            &[0.0; 3],
            "Distances between voxels in world units, instead of the file's; a negative one turns its axis around.",
        ),
        ParamSpec::vector(
            "origin",
            &[0.0; 3],
            "World position of the first voxel's centre, instead of the file's.",
        ),
        transform_param(),
        ParamSpec::bool(
            "node_centred",
            false,
            "The box spans voxel centre to voxel centre.",
        ),
        ParamSpec::text(
            "component",
            "",
            "Which of several values per voxel: its number from 0, `magnitude` or `color`.",
        ),
        ParamSpec::text(
            "part",
            "",
            "Which volume of several, by a part of its name: a series of a folder, an array of a group.",
        ),
    ]
}

/// The given fields of a source, already checked against its kind's specs.
struct Given<'a>(&'a BTreeMap<String, ParamValue>);

impl Given<'_> {
    /// The file of a volume, and what is said of it (see [`volume_file_params`]).
    fn volume_file(&self, folders: &Folders) -> Result<(PathBuf, LoadOptions), Findings> {
        let path = self.path("path", folders)?;
        if !is_there(&path) {
            // A ready graph has no folder of its own on the disk.
            let given = self.text("path").map_or(path.as_path(), Path::new);
            let file = if path.starts_with(EMBEDDED_GRAPHS) {
                given
            } else {
                &path
            };
            return Err(Finding::error("data-missing", format!("the volume file {} is not there", file.display()))
                .help("name the folder that has it with `--data FOLDER` or in VOLGRAPH_DATA, or the file with `--volume`")
                .into());
        }
        let scalar_type = match self.text("type").filter(|name| !name.is_empty()) {
            None => None,
            Some(name) => Some(ScalarType::parse(name).ok_or_else(|| {
                Finding::error("bad-param", format!("field `type`: `{name}` is not a scalar type"))
                    .help("use uint8, int8, uint16, int16, uint32, int32, uint64, int64, float32 or float64")
            })?),
        };
        let component = match self.text("component").filter(|text| !text.is_empty()) {
            None => None,
            Some(text) => Some(text.parse().map_err(|reason: String| {
                Finding::error("bad-param", format!("field `component`: {reason}"))
            })?),
        };
        let options = LoadOptions {
            dims: self.dims("dims")?,
            scalar_type,
            big_endian: self.is_set("big_endian"),
            spacing: self.vec3("spacing"),
            origin: self.vec3("origin"),
            transform: self.affine("transform"),
            node_centred: self.is_set("node_centred"),
            component,
            part: self
                .text("part")
                .filter(|part| !part.is_empty())
                .map(str::to_owned),
            ..LoadOptions::default()
        };
        Ok((path, options))
    }

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
