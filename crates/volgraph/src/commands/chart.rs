//! `volgraph chart`: the methods of a graph's raycast, by speed and accuracy.
//!
//! The way of the data: each graph is loaded, its truth is computed ([`truth`]), and its methods are surveyed
//! ([`volgraph::methods`]); every picture and its error map is saved on the way ([`pictures`]). What was found is an
//! [`Exhibit`], from which come a table ([`table`]), a chart ([`plot`]) and a page ([`page`]).

mod exhibit;
mod page;
mod pictures;
mod plot;
mod table;
#[cfg(test)]
mod tests;
mod truth;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::time::Instant;

use serde_json::json;
use volgraph::methods::peers::Peers;
use volgraph::methods::{MethodSpace, SessionStand, SurveyProgress, fine_step, survey};
use volgraph::truth::plan_without_device;
use volgraph::{Finding, Findings, Place};
use volgraph_gpu::Gpu;
use volgraph_shader::DiskFiles;

use self::exhibit::Exhibit;
use self::pictures::Pictures;
use super::{load, session_options, write};
use crate::args::ChartArgs;
use crate::commands::nodes::first_sentence;
use crate::output;
use crate::progress::Bars;

impl SurveyProgress for Bars {
    fn progress(&self, what: &str, done: usize, total: usize) {
        self.count(what, done as u64, total as u64);
    }
}

pub fn run(args: &ChartArgs) -> anyhow::Result<ExitCode> {
    let peers = match &args.peers {
        Some(file) => Some(read_peers(file)?),
        None => None,
    };
    let names = names(&args.graphs)?;
    write::folder(&args.output)?;
    let gpu = Arc::new(Gpu::open(
        &args.each.scene(PathBuf::new()).adapter_choice(),
    )?);
    let mut exhibits = Vec::new();
    for (graph, name) in args.graphs.iter().zip(names) {
        let exhibit = measure(args, graph, name, &gpu, peers.as_ref())?;
        exhibit.write(&args.output)?;
        let page = if args.graphs.len() == 1 {
            "index.html".to_owned()
        } else {
            format!("{}.html", exhibit.name)
        };
        write::whole(&args.output.join(page), &page::of(&exhibit)?)?;
        if !args.each.json {
            output::print(&exhibit.to_text());
        }
        exhibits.push(exhibit);
    }
    let index = args.output.join("index.html");
    if exhibits.len() > 1 {
        write::whole(&index, &page::index(&exhibits)?)?;
    }
    if args.each.json {
        let charts = exhibits.iter().map(Exhibit::to_json);
        output::print_json(&json!({
            "adapter": gpu.adapter(), "size": args.each.size, "charts": charts.collect::<Vec<_>>(),
        }));
    } else {
        output::print(&format!("{}", index.display()));
    }
    Ok(ExitCode::SUCCESS)
}

/// A name for the files of each graph: that of its file.
fn names(graphs: &[PathBuf]) -> Result<Vec<String>, Findings> {
    let mut names: Vec<String> = Vec::new();
    for graph in graphs {
        let stem = graph.file_stem().unwrap_or_default().to_string_lossy();
        let is_plain = |c: char| c.is_alphanumeric() || "-_".contains(c);
        let name: String = stem
            .chars()
            .map(|c| if is_plain(c) { c } else { '_' })
            .collect();
        if name.is_empty() || name == "index" || names.contains(&name) {
            let message = format!("two charts cannot both be called `{name}`");
            return Err(Finding::error("chart-names", message)
                .at(Place::whole_file(graph))
                .help("give one of the graphs another file name, or chart it into another folder")
                .into());
        }
        names.push(name);
    }
    Ok(names)
}

fn read_peers(file: &Path) -> Result<Peers, Findings> {
    let text = fs::read_to_string(file).map_err(|error| {
        Finding::error("io", format!("the table of peers cannot be read: {error}"))
            .at(Place::whole_file(file))
    })?;
    let peers = Peers::parse(&text).map_err(|findings| {
        let findings = findings.into_iter();
        let placed = findings.map(|finding| finding.or_at(|| Place::whole_file(file)));
        placed.collect::<Findings>()
    })?;
    Ok(peers)
}

fn measure(
    args: &ChartArgs,
    graph: &Path,
    name: String,
    gpu: &Arc<Gpu>,
    peers: Option<&Peers>,
) -> anyhow::Result<Exhibit> {
    let scene_args = args.each.scene(graph.to_path_buf());
    let scene = load(&scene_args)?;
    let options = session_options(&scene_args, None);
    let plan = plan_without_device(&scene, args.each.size)?;
    let roots = scene.shader_roots(Arc::new(DiskFiles));
    let space = MethodSpace::of(&plan, &roots, &scene.registry, &args.methods.filters)?;
    let bars = Bars::new();
    let started = Instant::now();
    let yardstick = truth::of(args, &scene, gpu, &options, &plan, &bars);
    bars.clear();
    let yardstick = yardstick?;
    let truth_seconds = started.elapsed().as_secs_f64();
    write::folder(&args.output.join(&name))?;
    let mut pictures = Pictures::new(&args.output, &name, &yardstick)?;
    let mut stand = SessionStand {
        scene: &scene,
        gpu: Arc::clone(gpu),
        options,
        node: space.node.clone(),
        yardstick: &yardstick,
        on_picture: Box::new(|method, picture, errors| pictures.add(method, picture, errors)),
        started: Instant::now(),
    };
    let found = survey(&mut stand, &space, &args.survey(), &bars);
    bars.clear();
    drop(stand);
    let found = found?;
    let others = peers.map(|peers| peers.of(&scene.desc, args.each.size));
    Ok(Exhibit {
        draws: first_sentence(&scene.text),
        graph: scene.text.clone(),
        size: args.each.size,
        adapter: gpu.adapter().to_string(),
        filters: args.methods.typed.clone(),
        set: scene
            .overrides
            .params
            .iter()
            .map(|set| set.typed.clone())
            .collect(),
        others: others.unwrap_or_default(),
        truth: yardstick.kind,
        truth_bound: yardstick.bound,
        fine_step: fine_step(&plan).map_err(Findings::from)?,
        truth_seconds,
        core_pixels: yardstick.core.iter().filter(|is_core| **is_core).count(),
        pictures: pictures.finish(),
        survey: found,
        space,
        name,
    })
}
