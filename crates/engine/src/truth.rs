//! The truth of a graph's picture: the float64 reference of its raycast, kept on disk.
//!
//! A [`Truth`] is made from a plan, which needs no device. It is computed once for each scene, view and tolerance:
//! [`TruthOptions::cache`] names the folder where results are kept under the digest of all that they depend on.

use std::fs;
use std::path::{Path, PathBuf};

use naga::valid::Capabilities;
use volgraph_graph::{Limits, Plan, View, hex};
use volgraph_measure::{Comparison, MeasureError};
use volgraph_nodes::reference::raycast_scene;
use volgraph_picture::{Layer, LayerValues, Picture};
use volgraph_reference::{DEFAULT_TOLERANCE, Progress, Rendered, render};
use volgraph_report::{Finding, Findings};

use crate::scene::Scene;

/// How a truth is computed.
#[derive(Clone, Debug, PartialEq)]
pub struct TruthOptions {
    /// Absolute tolerance of linear premultiplied colours, 1e-10 to 1.
    pub tolerance: f64,
    /// Where results are kept; nowhere where it is `None`.
    pub cache: Option<PathBuf>,
}

impl Default for TruthOptions {
    fn default() -> Self {
        Self {
            tolerance: DEFAULT_TOLERANCE,
            cache: default_cache(),
        }
    }
}

/// The user's folder for files that can be made again, and in it ours: `VOLGRAPH_CACHE`, else `volgraph` in the system's
/// folder of caches.
#[must_use]
pub fn default_cache() -> Option<PathBuf> {
    match std::env::var_os("VOLGRAPH_CACHE") {
        Some(folder) if folder.is_empty() => None,
        Some(folder) => Some(folder.into()),
        None => Some(dirs::cache_dir()?.join("volgraph")),
    }
}

/// What a picture should be.
#[derive(Clone, Debug)]
pub struct Truth {
    /// The picture in float64.
    pub rendered: Rendered,
    /// Its tolerance.
    pub tolerance: f64,
    /// Digest of all that it depends on, the tolerance included.
    pub digest: String,
    /// Whether it was found on disk.
    pub is_cached: bool,
}

/// A plan that needs no device: for what WebGPU guarantees everywhere.
///
/// # Errors
/// As [`Scene::plan`].
pub fn plan_without_device(scene: &Scene, size: [u32; 2]) -> Result<Plan, Findings> {
    let shaders = scene.shader_library(Capabilities::default());
    scene.plan(&shaders, &Limits::default(), size, false)
}

impl Truth {
    /// The truth of the output `color` of a plan, in a view.
    ///
    /// # Errors
    /// `not-covered` where the reference does not compute what the graph draws; what [`Progress`] ended.
    pub fn of(
        plan: &Plan,
        view: &View,
        options: &TruthOptions,
        progress: &dyn Progress,
    ) -> Result<Self, Findings> {
        let Some(output) = plan.graph.outputs.get("color") else {
            return Err(Finding::error(
                "no-color-output",
                "the graph names no output `color`, which is the picture",
            )
            .into());
        };
        let scene = raycast_scene(&plan.context(output.node, view, None), view)?;
        let mut hasher = volgraph_graph::fingerprint::Hasher::new();
        hasher.part(&scene.digest());
        hasher.part(&options.tolerance.to_le_bytes());
        let digest = hex(&hasher.finish());
        let kept = options
            .cache
            .as_ref()
            .map(|folder| folder.join("reference").join(format!("{digest}.f64")));
        if let Some(rendered) = kept.as_deref().and_then(|file| read(file, view.size)) {
            return Ok(Self {
                rendered,
                tolerance: options.tolerance,
                digest,
                is_cached: true,
            });
        }
        let rendered = render(&scene, options.tolerance, progress)
            .map_err(|error| Finding::error("reference", error.to_string()))?;
        // A cache that cannot be written is no reason to fail.
        if let Some(file) = kept {
            let _ = write(&file, &rendered);
        }
        Ok(Self {
            rendered,
            tolerance: options.tolerance,
            digest,
            is_cached: false,
        })
    }

    /// The picture in f32, with depth, opacity, and the layers `normal` and `error` (the bound of the reference's own
    /// error).
    ///
    /// # Errors
    /// `picture`, where it is too large.
    pub fn picture(&self) -> Result<Picture, Findings> {
        let rendered = &self.rendered;
        let [width, height] = rendered.size;
        let color = rendered.color.iter().map(|pixel| pixel.map(single));
        let mut picture = Picture::from_color(width, height, color.collect())
            .map_err(|error| Finding::error("picture", error.to_string()))?;
        let singles = |values: &[f64]| values.iter().copied().map(single).collect();
        picture.depth = Some(singles(&rendered.depth));
        picture.opacity = Some(singles(&rendered.opacity));
        let normal = rendered.normal.iter().map(|normal| {
            let [x, y, z] = normal.map(single);
            [x, y, z, f32::from(u8::from([x, y, z] != [0.0; 3]))]
        });
        picture.layers = vec![
            Layer {
                name: "normal".to_owned(),
                values: LayerValues::Vector(normal.collect()),
            },
            Layer {
                name: "error".to_owned(),
                values: LayerValues::Scalar(singles(&rendered.error)),
            },
        ];
        Ok(picture)
    }

    /// How a picture differs from it.
    ///
    /// # Errors
    /// Where it has another size, or values that are no numbers.
    pub fn compare(&self, picture: &Picture) -> Result<Comparison, Findings> {
        let truth = self.picture()?;
        volgraph_measure::compare_without_flip(picture, &truth)
            .map_err(|error: MeasureError| Finding::error("compare", error.to_string()).into())
    }
}

#[expect(clippy::cast_possible_truncation, reason = "pictures hold f32")]
fn single(value: f64) -> f32 {
    value as f32
}

/// The numbers of a pixel in a file: colour, opacity, depth, normal, error.
const NUMBERS: usize = 10;

fn write(file: &Path, rendered: &Rendered) -> std::io::Result<()> {
    let folder = file.parent().unwrap_or(Path::new("."));
    fs::create_dir_all(folder)?;
    let mut bytes = Vec::with_capacity(rendered.color.len() * NUMBERS * 8 + 32);
    for at in 0..rendered.color.len() {
        let pixel = rendered.color[at]
            .iter()
            .chain([&rendered.opacity[at], &rendered.depth[at]])
            .chain(&rendered.normal[at])
            .chain([&rendered.error[at]]);
        bytes.extend(pixel.flat_map(|number| number.to_le_bytes()));
    }
    // A file that is not whole is not taken.
    let digest = blake3::hash(&bytes);
    bytes.extend(digest.as_bytes());
    let mut part = tempfile::NamedTempFile::new_in(folder)?;
    std::io::Write::write_all(&mut part, &bytes)?;
    part.persist(file)?;
    prune(folder, "f64", MAX_CACHE_BYTES)
}

/// Most bytes that are kept.
const MAX_CACHE_BYTES: u64 = 1 << 30;

/// Removes the files of an extension that were written first until the others are no more than `most` bytes.
pub(crate) fn prune(folder: &Path, extension: &str, most: u64) -> std::io::Result<()> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        let metadata = entry.metadata()?;
        if metadata.is_file() && entry.path().extension().is_some_and(|it| it == extension) {
            files.push((metadata.modified()?, metadata.len(), entry.path()));
        }
    }
    files.sort();
    let mut bytes: u64 = files.iter().map(|(_, bytes, _)| bytes).sum();
    for (_, size, file) in files {
        if bytes <= most {
            break;
        }
        fs::remove_file(file)?;
        bytes -= size;
    }
    Ok(())
}

fn read(file: &Path, size: [u32; 2]) -> Option<Rendered> {
    let bytes = fs::read(file).ok()?;
    let pixels = size[0] as usize * size[1] as usize;
    let (numbers, digest) = bytes.split_at_checked(pixels * NUMBERS * 8)?;
    if blake3::hash(numbers).as_bytes() != digest {
        return None;
    }
    let numbers: Vec<f64> = numbers
        .chunks_exact(8)
        .map(|chunk| f64::from_le_bytes(std::array::from_fn(|i| chunk[i])))
        .collect();
    let pixels = || numbers.chunks_exact(NUMBERS);
    Some(Rendered {
        size,
        color: pixels().map(|p| [p[0], p[1], p[2], p[3]]).collect(),
        opacity: pixels().map(|p| p[4]).collect(),
        depth: pixels().map(|p| p[5]).collect(),
        normal: pixels().map(|p| [p[6], p[7], p[8]]).collect(),
        error: pixels().map(|p| p[9]).collect(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rendered(value: f64) -> Rendered {
        Rendered {
            size: [2, 1],
            color: vec![[value, 0.25, 1e-300, 1.0]; 2],
            opacity: vec![0.5; 2],
            depth: vec![f64::INFINITY, 3.0],
            normal: vec![[0.0, 0.0, 1.0]; 2],
            error: vec![1e-9; 2],
        }
    }

    #[test]
    fn what_is_kept_comes_back_to_the_last_bit_and_nothing_else_does() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("reference").join("a.f64");
        let kept = rendered(0.1);
        write(&file, &kept).unwrap();
        assert_eq!(read(&file, [2, 1]), Some(kept));
        assert_eq!(read(&file, [1, 1]), None, "of another size");
        let mut bytes = fs::read(&file).unwrap();
        bytes[9] ^= 1;
        fs::write(&file, &bytes).unwrap();
        assert_eq!(read(&file, [2, 1]), None, "a bit is wrong");
        fs::write(&file, &bytes[..40]).unwrap();
        assert_eq!(read(&file, [2, 1]), None, "the end is missing");
    }

    #[test]
    fn the_oldest_files_go_first() {
        let folder = tempfile::tempdir().unwrap();
        let names = ["a", "b", "c"].map(|name| folder.path().join(name).with_extension("f64"));
        for (age, file) in names.iter().enumerate() {
            write(file, &rendered(0.0)).unwrap();
            let opened = fs::File::options().write(true).open(file).unwrap();
            let time =
                std::time::SystemTime::UNIX_EPOCH + std::time::Duration::from_secs(age as u64);
            opened.set_modified(time).unwrap();
        }
        let size = fs::metadata(&names[0]).unwrap().len();
        prune(folder.path(), "f64", 2 * size).unwrap();
        assert_eq!(names.map(|file| file.exists()), [false, true, true]);
    }
}
