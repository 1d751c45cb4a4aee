//! A picture rendered again from its own metadata, and compared.
//!
//! The new picture is saved in the format of the old one and read back, so that both have lost the same; how far apart they
//! may be then is said by [`Difference`].

use std::fmt::Write;
use std::fs::File;
use std::io::Read;
use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;

use serde_json::json;
use volgraph::recorded::Changed;
use volgraph::verify::integral_truth;
use volgraph::{
    Finding, Findings, Picture, Place, Recorded, Scene, Session, SessionOptions, ShaderFolders,
    Truth, TruthOptions,
};
use volgraph_gpu::Gpu;
use volgraph_measure::{Comparison, compare_without_flip};
use volgraph_picture::{PngBits, SaveOptions};

use super::difference::Difference;
use crate::args::VerifyArgs;
use crate::commands::reference::Rows;
use crate::commands::{errors, extension, session_options};
use crate::output;
use crate::progress::Bars;

pub fn run(args: &VerifyArgs) -> anyhow::Result<ExitCode> {
    let file = &args.scene.graph;
    let before = load(file)?;
    let recorded = Recorded::of(&before, file)?;
    let bars = Bars::new();
    let scene = recorded.scene(&args.scene.data.data, &args.scene.shader_folders(), &bars);
    bars.clear();
    let scene = scene?;
    let options = SessionOptions {
        size: recorded.view.size,
        overrides: scene.overrides.clone(),
        shader_folders: scene.shader_folders.clone(),
        // What was chosen for a budget is recorded.
        is_as_written: true,
        ..session_options(&args.scene, Some(file))
    };
    let gpu = Arc::new(Gpu::open(&options.adapter)?);
    let mut session = Session::start(scene, gpu, &options)?;
    session.place_camera(recorded.view.camera);
    let (drawn, _) = session.render()?;
    let changes = recorded.changes(&drawn.metadata);
    let bits = png_bits(file)?;
    let after = through_file(&drawn, file, bits)?;
    let comparison = compare_without_flip(&after, &before)
        .map_err(|error| Findings::from(errors::of_comparison(&error, file, file)))?;
    let difference = Difference::of(&before, &after, &comparison, bits);
    let against = match &args.against {
        Some(_) => {
            let truth = truth(&recorded, session.scene(), &args.truth.options())?;
            Some(truth.compare(&before)?)
        }
        None => None,
    };
    if args.json {
        output::print_json(&json!({
            "picture": file.display().to_string(),
            "adapter": session.adapter(),
            "changed": changes,
            "unit": difference.unit(),
            "difference": difference.largest,
            "bound": difference.bound,
            "unlike": difference.unlike,
            "passed": difference.holds(),
            "comparison": comparison,
            "reference": against,
        }));
    } else {
        output::print(&text(file, &changes, &difference, against.as_ref()));
    }
    if difference.holds() {
        return Ok(ExitCode::SUCCESS);
    }
    let message = format!("rendered again, the picture differs: {}", difference.said());
    let finding = Finding::error("picture-differs", message).at(Place::whole_file(file));
    let names: Vec<&str> = changes.iter().map(|it| it.what.as_str()).collect();
    let finding = if names.is_empty() {
        finding.help("nothing that it records has changed: the file was edited, or the device draws differently from time to time")
    } else {
        finding.help(format!("changed since: {}", names.join(", ")))
    };
    output::report(&finding.into());
    Ok(ExitCode::from(1))
}

fn load(file: &Path) -> Result<Picture, Findings> {
    Picture::load(file).map_err(|error| errors::of_picture(&error, file).into())
}

/// The bits of a PNG's components: byte 24 of the file, in its header.
fn png_bits(file: &Path) -> Result<Option<PngBits>, Findings> {
    let mut head = [0; 25];
    File::open(file)
        .and_then(|mut file| file.read_exact(&mut head))
        .map_err(|error| Finding::error("io", error.to_string()).at(Place::whole_file(file)))?;
    Ok(match (head.starts_with(b"\x89PNG"), head[24]) {
        (false, _) => None,
        (true, 16) => Some(PngBits::Sixteen),
        (true, _) => Some(PngBits::Eight),
    })
}

/// The picture as a file of that kind holds it.
fn through_file(picture: &Picture, like: &Path, bits: Option<PngBits>) -> anyhow::Result<Picture> {
    let folder = tempfile::tempdir()?;
    let kind = if bits.is_some() { "png" } else { "exr" };
    let file = folder.path().join(format!("again.{kind}"));
    let options = SaveOptions::default().with_png_bits(bits.unwrap_or_default());
    let _saved = picture
        .save(&file, options)
        .map_err(|error| Findings::from(errors::of_picture(&error, like)))?;
    Ok(load(&file)?)
}

fn text(
    file: &Path,
    changes: &[Changed],
    difference: &Difference,
    against: Option<&Comparison>,
) -> String {
    let mut text = String::new();
    // Writing to a String does not fail.
    if changes.is_empty() {
        let _ = writeln!(
            text,
            "graph, sources, shaders, adapter and version are as they were"
        );
    }
    for Changed { what, was, is } in changes {
        let _ = writeln!(text, "{what} has changed: {} → {}", short(was), short(is));
    }
    let says = match (difference.holds(), difference.largest == 0.0) {
        (true, true) => "rendered again, it is the same".to_owned(),
        (true, false) => format!(
            "rendered again, it is the same within {}",
            difference.said()
        ),
        _ => format!("rendered again, it DIFFERS: {}", difference.said()),
    };
    let _ = writeln!(text, "{}: {says}", file.display());
    if let Some(against) = against {
        let _ = writeln!(
            text,
            "from its truth it is off by RMSE {:.3e}, at most {:.3e} at ({}, {})",
            against.rmse, against.max.error, against.max.x, against.max.y
        );
    }
    text
}

/// A value in a line: of a digest its first digits.
fn short(value: &str) -> &str {
    let is_digest = value.len() == 64 && value.bytes().all(|byte| byte.is_ascii_hexdigit());
    match value {
        "" => "nothing",
        _ if is_digest => &value[..12],
        _ => value,
    }
}

fn truth(recorded: &Recorded, scene: &Scene, options: &TruthOptions) -> Result<Truth, Findings> {
    let bars = Bars::new();
    let truth = integral_truth(scene, &recorded.view, &[], options, &Rows(&bars));
    bars.clear();
    truth
}

/// The truth of a picture in a file, as its metadata tells it; no device is needed.
pub fn recorded_truth(picture: &Picture, file: &Path) -> Result<Picture, Findings> {
    let recorded = Recorded::of(picture, file)?;
    let bars = Bars::new();
    let scene = recorded.scene(&[], &ShaderFolders::default(), &bars);
    bars.clear();
    let mut picture = truth(&recorded, &scene?, &TruthOptions::default())?.picture()?;
    // PNGs hold neither.
    if extension(file) == "png" {
        picture.depth = None;
        picture.opacity = None;
    }
    Ok(picture)
}

#[cfg(test)]
mod tests {
    use super::short;

    #[test]
    fn digests_alone_are_shortened() {
        let digest = "0123456789abcdef".repeat(4);
        assert_eq!(short(&digest), "0123456789ab");
        // As long as a digest, and its twelfth byte is within a character.
        let name = format!("llvmpipe 12é{}", "x".repeat(51));
        assert_eq!(name.len(), 64);
        assert_eq!(short(&name), name);
        assert_eq!((short(""), short("abc")), ("nothing", "abc"));
    }
}
