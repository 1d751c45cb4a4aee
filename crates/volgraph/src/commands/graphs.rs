//! `volgraph graphs`: the graphs that volgraph carries, to draw as they are or to start from.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use serde_json::json;
use volgraph::{Finding, Findings, ReadyGraph, alone, ready_graphs};
use volgraph_report::did_you_mean;

use super::nodes::first_sentence;
use super::write;
use crate::args::GraphsArgs;
use crate::output;

pub fn run(args: &GraphsArgs) -> anyhow::Result<ExitCode> {
    if let Some(volume) = &args.volume {
        for_volume(args, volume)?;
        return Ok(ExitCode::SUCCESS);
    }
    let graphs = ready_graphs();
    let Some(name) = &args.name else {
        if args.json {
            output::print_json(&graphs.iter().map(json).collect());
        } else {
            output::print(&text(&graphs));
        }
        return Ok(ExitCode::SUCCESS);
    };
    let wanted = name.strip_suffix(".ron").unwrap_or(name);
    let Some(graph) = graphs.iter().find(|graph| graph.name == wanted) else {
        let known = graphs.iter().map(|graph| graph.name.as_str());
        let finding = Finding::error("unknown-graph", format!("no ready graph is named `{name}`"))
            .help_opt(did_you_mean(wanted, known));
        return Err(Findings::from(finding).into());
    };
    if args.write {
        let existing = if args.force {
            write::Existing::Replaced
        } else {
            write::Existing::KeptUnlessForced
        };
        for path in write::files(&args.folder, &graph.files(), existing)? {
            output::print(&format!("wrote {}", path.display()));
        }
    } else if args.json {
        output::print_json(&json(graph));
    } else {
        output::print(graph.text);
    }
    Ok(ExitCode::SUCCESS)
}

/// The graph that is picked for a volume: printed, or written with its transfer function beside it.
fn for_volume(args: &GraphsArgs, volume: &Path) -> Result<(), Findings> {
    let path = std::path::absolute(volume).unwrap_or_else(|_| volume.to_path_buf());
    let picked = alone::graph_for(&path)?;
    let Some(output) = &args.output else {
        output::print(picked.graph.trim_end());
        return Ok(());
    };
    let stem = output.file_stem().unwrap_or_default().to_string_lossy();
    let beside = format!("{stem}_transfer.ron");
    let (graph, transfer) = picked.files(&beside);
    let existing = if args.force {
        write::Existing::Replaced
    } else {
        write::Existing::KeptUnlessForced
    };
    let name = PathBuf::from(output.file_name().unwrap_or_default());
    let mut files = vec![(name, graph.as_bytes())];
    files.extend(
        transfer
            .iter()
            .map(|text| (PathBuf::from(&beside), text.as_bytes())),
    );
    for path in write::files(&super::folder_of(output), &files, existing)? {
        output::print(&format!("wrote {}", path.display()));
    }
    output::note(&picked.why);
    Ok(())
}

fn json(graph: &ReadyGraph) -> serde_json::Value {
    let files = graph.files();
    json!({
        "name": graph.name,
        "path": graph.path.display().to_string(),
        "draws": first_sentence(graph.text),
        "files": files.iter().map(|(path, _)| path.display().to_string()).collect::<Vec<_>>(),
        "needs": graph.volumes(),
    })
}

/// One line each: its name, what it draws, and the volume files that it needs.
fn text(graphs: &[ReadyGraph]) -> String {
    let width = graphs
        .iter()
        .map(|graph| graph.name.len())
        .max()
        .unwrap_or(0);
    let lines = graphs.iter().map(|graph| {
        let volumes = graph.volumes();
        let needs = if volumes.is_empty() {
            "needs no file".to_owned()
        } else {
            format!("needs {}", volumes.join(", "))
        };
        format!(
            "{:width$}  {} [{needs}]",
            graph.name,
            first_sentence(graph.text)
        )
    });
    lines.collect::<Vec<_>>().join("\n")
}
