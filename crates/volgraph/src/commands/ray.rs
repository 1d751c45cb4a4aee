//! `volgraph ray`: why a pixel has its value.

mod plot;
mod text;

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;

use serde_json::json;
use volgraph::{Finding, Findings, Place, RayOptions, RayTracer, Session, open_beside};

use super::{check_overwrites, extension, load, session_options, write};
use crate::args::RayArgs;
use crate::output;

pub fn run(args: &RayArgs) -> anyhow::Result<ExitCode> {
    if let Some(file) = &args.output {
        check_svg(file)?;
    }
    let options = session_options(&args.scene, None);
    let (scene, gpu) = open_beside(&options.adapter, || load(&args.scene));
    let scene = scene?;
    if let Some(file) = &args.output {
        let inputs = scene.data.keys().chain([&scene.path]);
        check_overwrites(file, inputs.map(PathBuf::as_path))?;
    }
    let session = Session::start(scene, Arc::new(gpu?), &options)?;
    let how = RayOptions {
        tolerance: args.tolerance,
        ..RayOptions::default()
    };
    let study = RayTracer::of(&session)?.study(session.view(), args.pixel, &how)?;
    if let Some(file) = &args.output {
        write::whole(file, plot::draw(&study)?)?;
    }
    if args.json {
        let mut value = json!(study);
        value["sum"] = json!(study.sum());
        value["error"] = json!(study.error());
        output::print_json(&value);
    } else {
        output::print(&text::of(&study, args.all));
        if let Some(file) = &args.output {
            output::print(&format!("\n{}", file.display()));
        }
    }
    Ok(ExitCode::SUCCESS)
}

/// Refuses a name that is no drawing's, before anything else is done.
fn check_svg(file: &Path) -> Result<(), Findings> {
    let refused = |code: &'static str, message: &str, help: &str| {
        let finding = Finding::error(code, message).at(Place::whole_file(file));
        Err(finding.help(help).into())
    };
    if extension(file) != "svg" {
        return refused(
            "drawing-format",
            "curves are drawn as SVG",
            "give the file a name that ends in .svg",
        );
    }
    if file.is_dir() {
        return refused("io", "it is a folder", "name a file");
    }
    if !super::folder_of(file).is_dir() {
        return refused("io", "there is no such folder", "make the folder first");
    }
    Ok(())
}
