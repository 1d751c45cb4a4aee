//! A picture rendered again from its own metadata, and compared.
//!
//! The new picture is saved in the format of the old one and read back, so that both have lost the same. PNG: each code
//! may be off by 1, which is rounding; of codes under little alpha as much less as they show. EXR: colours and opacities
//! within 1e-5, depths within as much of the largest: what f32 loses on another device.

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
use volgraph_picture::srgb::srgb_from_linear;
use volgraph_picture::{PngBits, SaveOptions};

use crate::args::VerifyArgs;
use crate::commands::reference::Rows;
use crate::commands::{errors, extension, session_options};
use crate::output;
use crate::progress::Bars;

/// What colours and opacities of an EXR may be off by.
const EXR_BOUND: f64 = 1e-5;

pub fn run(args: &VerifyArgs) -> anyhow::Result<ExitCode> {
    let file = &args.scene.graph;
    check_settings(args)?;
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
    let max = comparison.max;
    let message = format!(
        "rendered again, the picture differs by {}; the worst pixel is at ({}, {})",
        difference.said(),
        max.x,
        max.y
    );
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

/// Refuses what a picture brings with it.
fn check_settings(args: &VerifyArgs) -> Result<(), Findings> {
    let scene = &args.scene;
    let is_set = !scene.set.is_empty()
        || !scene.volume.is_empty()
        || scene.camera.is_some()
        || !args.slot.is_empty();
    if !is_set {
        return Ok(());
    }
    let message = "a picture is rendered again with its own settings: `--set`, `--slot`, `--volume` and `--camera` are for graphs";
    Err(Finding::error("own-settings", message)
        .at(Place::whole_file(&scene.graph))
        .into())
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

/// How far two pictures are apart, in the unit of their format.
struct Difference {
    largest: f64,
    bound: f64,
    bits: Option<PngBits>,
}

impl Difference {
    fn of(
        before: &Picture,
        after: &Picture,
        comparison: &Comparison,
        bits: Option<PngBits>,
    ) -> Self {
        let Some(png) = bits else {
            let scalar = |it: &Option<volgraph_measure::ScalarDifference>| {
                let max = it.as_ref().and_then(|it| it.max);
                max.map_or(0.0, |max| max.error)
            };
            let finite = before.depth.iter().flatten().filter(|it| it.is_finite());
            let deepest = finite.map(|it| f64::from(it.abs())).fold(1.0, f64::max);
            let largest = comparison
                .max
                .error
                .max(scalar(&comparison.opacity))
                .max(scalar(&comparison.depth) / deepest);
            return Self {
                largest,
                bound: EXR_BOUND,
                bits,
            };
        };
        let most = if png == PngBits::Sixteen {
            65535.0
        } else {
            255.0
        };
        let pixels = before.color.iter().zip(&after.color);
        let largest = pixels
            .map(|(a, b)| codes_apart(*a, *b, most))
            .fold(0.0, f64::max);
        Self {
            largest,
            // Codes are whole, but read as f32.
            bound: 1.01,
            bits,
        }
    }

    fn holds(&self) -> bool {
        self.largest <= self.bound
    }

    fn unit(&self) -> &'static str {
        match self.bits {
            Some(PngBits::Sixteen) => "codes of 65535",
            Some(PngBits::Eight) => "codes of 255",
            None => "linear",
        }
    }

    fn said(&self) -> String {
        match self.bits {
            Some(_) => format!("{:.1} {}", self.largest, self.unit()),
            None => format!("{:.1e}", self.largest),
        }
    }
}

/// How many codes two pixels of a PNG are apart, colours weighed by the larger of their alphas.
fn codes_apart(a: [f32; 4], b: [f32; 4], most: f64) -> f64 {
    let code = |pixel: [f32; 4], i: usize| {
        let alpha = f64::from(pixel[3]);
        let straight = if alpha > 0.0 {
            f64::from(pixel[i]) / alpha
        } else {
            0.0
        };
        most * srgb_from_linear(straight.clamp(0.0, 1.0))
    };
    let alpha = f64::from(a[3].max(b[3]));
    let colors = (0..3).map(|i| alpha * (code(a, i) - code(b, i)).abs());
    colors.fold(most * f64::from((a[3] - b[3]).abs()), f64::max)
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
        let short = |value: &String| match value.len() {
            0 => "nothing".to_owned(),
            64 => value[..12].to_owned(),
            _ => value.clone(),
        };
        let _ = writeln!(text, "{what} has changed: {} → {}", short(was), short(is));
    }
    let says = match (difference.largest == 0.0, difference.holds()) {
        (true, _) => "rendered again, it is the same".to_owned(),
        (_, true) => format!(
            "rendered again, it is the same within {}",
            difference.said()
        ),
        _ => format!("rendered again, it DIFFERS by {}", difference.said()),
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
