//! `volgraph gallery`: every ready graph as a picture, and a page that shows them.
//!
//! The way of the data: each graph is loaded, drawn once, timed for some frames more, and saved; what came of it is an
//! [`Exhibit`]. Graphs whose volumes are not found are left out, by name. From the exhibits come the page
//! ([`page`]) and `gallery.md`, the list that the README shows.

mod page;

use std::fs;
use std::process::ExitCode;
use std::sync::Arc;
use std::time::Instant;

use serde::Serialize;
use volgraph::methods::{middle, timed_frame, turned};
use volgraph::{Finding, Findings, ReadyGraph, Scene, Session, embedded, ready_graphs, registry};
use volgraph_gpu::Gpu;
use volgraph_measure::timing::Summary;
use volgraph_picture::SaveOptions;
use volgraph_report::did_you_mean;

use super::nodes::first_sentence;
use super::{errors, session_options, tell_warnings, write};
use crate::args::GalleryArgs;
use crate::output;
use crate::progress::Bars;

/// A graph that was drawn.
#[derive(Debug, Serialize)]
struct Exhibit {
    name: String,
    /// What it draws, one sentence.
    draws: String,
    /// The graph's text.
    graph: String,
    /// The picture's file, beside the page.
    picture: String,
    /// Milliseconds of the first picture, shaders and tables included.
    first_ms: f64,
    /// Milliseconds of a frame after that, reading back included; the median.
    frame_ms: f64,
}

/// What became of a graph.
enum Shown {
    Drawn(Exhibit),
    LeftOut(String),
}

pub fn run(args: &GalleryArgs) -> anyhow::Result<ExitCode> {
    let graphs = wanted(&args.names)?;
    write::folder(&args.output)?;
    let gpu = Arc::new(Gpu::open(&args.each.scene("").adapter_choice())?);
    let adapter = gpu.adapter().to_string();
    let mut exhibits = Vec::new();
    let mut left_out = Vec::new();
    let mut failed = Vec::new();
    for graph in &graphs {
        match draw(args, graph, &gpu) {
            Ok(Shown::Drawn(exhibit)) => {
                if !args.each.json {
                    output::print(&format!(
                        "{}: {:.1} ms a frame",
                        exhibit.name, exhibit.frame_ms
                    ));
                }
                exhibits.push(exhibit);
            }
            Ok(Shown::LeftOut(why)) => {
                output::warn(&format!("{} is left out: {why}", graph.name));
                left_out.push(graph.name.clone());
            }
            Err(findings) => {
                output::report(&findings);
                failed.push(graph.name.clone());
            }
        }
    }
    let page = page::Page {
        exhibits: &exhibits,
        left_out: &left_out,
        failed: &failed,
        size: args.each.size,
        adapter: &adapter,
    };
    for (file, text) in [("index.html", page.html()), ("gallery.md", page.markdown())] {
        write::whole(&args.output.join(file), text)?;
    }
    if args.each.json {
        output::print_json(&serde_json::json!({
            "adapter": adapter, "size": args.each.size, "exhibits": exhibits, "left_out": left_out, "failed": failed,
        }));
    } else {
        output::print(&format!(
            "{} pictures and {} on {adapter}",
            exhibits.len(),
            args.output.join("index.html").display()
        ));
    }
    Ok(if failed.is_empty() {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    })
}

/// The graphs of these names; all where there is none.
fn wanted(names: &[String]) -> Result<Vec<ReadyGraph>, Findings> {
    let graphs = ready_graphs();
    let is_known = |name: &&String| graphs.iter().any(|graph| graph.name == **name);
    let unknown: Findings = names
        .iter()
        .filter(|name| !is_known(name))
        .map(|name| {
            let known = graphs.iter().map(|graph| graph.name.as_str());
            Finding::error("unknown-graph", format!("no ready graph is named `{name}`"))
                .help_opt(did_you_mean(name, known))
        })
        .collect();
    unknown.into_result(())?;
    let is_wanted = |graph: &ReadyGraph| names.is_empty() || names.contains(&graph.name);
    Ok(graphs.into_iter().filter(is_wanted).collect())
}

fn draw(args: &GalleryArgs, graph: &ReadyGraph, gpu: &Arc<Gpu>) -> Result<Shown, Findings> {
    let scene_args = args.each.scene(graph.name.as_str());
    let path = embedded::locate(&scene_args.graph);
    let bars = Bars::new();
    let start = Instant::now();
    let loaded = Scene::load(
        &scene_args.graph,
        &scene_args.overrides(),
        &scene_args.shader_folders(),
        registry(),
        &bars,
    );
    bars.clear();
    let scene = match loaded {
        Ok(scene) => scene,
        Err(findings)
            if findings
                .clone()
                .into_iter()
                .all(|finding| finding.code == "data-missing") =>
        {
            let needs = graph.volumes().join(", ");
            return Ok(Shown::LeftOut(format!(
                "it needs {needs}; name its folder with `--data FOLDER` or in VOLGRAPH_DATA"
            )));
        }
        Err(findings) => return Err(findings),
    };
    tell_warnings(&scene_args, &scene);
    let text = fs::read_to_string(&path).unwrap_or_else(|_| graph.text.to_owned());
    let mut session = Session::start(scene, Arc::clone(gpu), &session_options(&scene_args, None))?;
    let (picture, report) = session.render()?;
    let first_ms = start.elapsed().as_secs_f64() * 1e3;
    output::report_warnings(&report.all_warnings());
    let (camera, target) = (session.view().camera, middle(session.plan()));
    let mut frames = Vec::new();
    for frame in 1..=args.frames.max(1) {
        // A frame from the same place would be remembered, and not drawn.
        let camera = turned(&camera, target, f64::from(frame));
        frames.push(timed_frame(&mut session, camera, true)?.0);
    }
    let file = format!("{}.png", graph.name);
    let target = args.output.join(&file);
    let _ = picture
        .save(&target, SaveOptions::default())
        .map_err(|error| errors::of_picture(&error, &target))?;
    let timed =
        Summary::of(&frames).map_err(|error| Finding::error("internal", error.to_string()))?;
    Ok(Shown::Drawn(Exhibit {
        name: graph.name.clone(),
        draws: first_sentence(&text),
        graph: text,
        picture: file,
        first_ms,
        frame_ms: timed.median,
    }))
}
