//! All breaking points that are known, in groups.

mod grids;
mod light;
mod numbers;
mod parts;
mod rays;
mod sampling;
mod surfaces;
mod transfer;

use std::sync::Arc;

use volgraph_shader::DiskFiles;

use super::case::{Bound, Case, Expect, Method};
use super::scene_text::{SceneText, VolumeText};
use crate::shaders::ShaderFolders;

/// Pictures are so large.
const SIZE: [u32; 2] = [40, 40];

/// From a side that is no axis, and no diagonal.
const ASLANT: &str = "orbit(azimuth: 33, elevation: 21, fov_y: 30)";

/// The classification that most cases are drawn with; a smaller table than by default costs less time.
const INTEGRATED: &[(&str, &str)] = &[
    ("slots.classify", "preintegrated_2d"),
    ("preintegration_size", "512"),
];

/// All cases; choices of the slot `classify` are those that lie in the folders.
#[must_use]
pub fn cases(folders: &ShaderFolders) -> Vec<Case> {
    let classify = folders
        .roots_in(Arc::new(DiskFiles), None)
        .choices("classify");
    let mut all = transfer::cases(&classify);
    all.extend(sampling::cases(&classify));
    all.extend(surfaces::cases());
    all.extend(rays::cases());
    all.extend(grids::cases());
    all.extend(numbers::cases());
    all.extend(light::cases());
    all.extend(parts::cases());
    all
}

/// How a choice of `classify` comes to the colour of a segment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ClassifyKind {
    /// It looks at the transfer function at places of the segment.
    Sampled,
    /// It knows the integral over all scalars in between.
    Integrated,
    /// It is not known here: it is measured, and not judged.
    Unknown,
}

/// The kind of a choice of the slot `classify`.
#[must_use]
pub fn kind_of_classify(choice: &str) -> ClassifyKind {
    match choice {
        "post" | "gauss2" | "simpson" => ClassifyKind::Sampled,
        "preintegrated_2d" | "preintegrated_3d" | "integral_1d" | "second_order" => {
            ClassifyKind::Integrated
        }
        _ => ClassifyKind::Unknown,
    }
}

/// A method for each choice of `classify`.
fn classify_methods(
    choices: &[String],
    sampled: Expect,
    integrated: Expect,
    bound: impl Fn(&str) -> Bound,
) -> Vec<Method> {
    let method = |choice: &String| {
        let expect = match kind_of_classify(choice) {
            ClassifyKind::Sampled => sampled,
            ClassifyKind::Integrated => integrated,
            ClassifyKind::Unknown => Expect::Reported,
        };
        Method::new(choice, &[("slots.classify", choice)], expect, bound(choice))
    };
    choices.iter().map(method).collect()
}

/// A ball that fades out, of 24³ voxels: 1 in its middle, 1e-3 at the faces of the box, and twice differentiable.
fn blob(scale: f64) -> impl Fn([f64; 3]) -> f64 {
    move |[x, y, z]| {
        let square = (x - 11.2).powi(2) + (y - 11.9).powi(2) + (z - 12.1).powi(2);
        scale * (-square / (2.0 * 3.2 * 3.2)).exp()
    }
}

/// The grid of [`blob`].
const BLOB: [u32; 3] = [24; 3];

/// A smooth transfer function that is nothing where a [`blob`] meets the faces of its box.
const SOFT: &str = "(domain: range, color: [(0.0, (0.1, 0.3, 0.9)), (1.0, (1.0, 0.7, 0.2))], \
                    extinction: [(0.02, 0.0), (1.0, 0.5)])";

fn blob_scene(name: &str, camera: &str) -> SceneText {
    SceneText::new(
        name,
        VolumeText::floats("blob", BLOB, blob(1.0)),
        SOFT,
        camera,
    )
}

/// What order 2 leaves of [`blob`] under [`SOFT`] at a step of `h` voxels: a chord leaves s'' h² / 12 of the scalar on the
/// mean, and the sum of s'' up to any place is s', 0.61 / 3.2 at most; the extinction is half of it.
fn soft_bound(step: f64) -> f64 {
    0.5 * (0.61 / 3.2) / 12.0 * step * step
}

/// Why [`soft_bound`] is that.
const SOFT_WHY: &str = "order 2: chords leave s'' h²/12 of the scalar, which sum up to 0.5 s' h²/12; early termination (1/4096)";
