//! `volgraph set`: writes into a graph's file what `--set`, `--volume` and `--camera` change for one run.

use std::fs;
use std::path::Path;
use std::process::ExitCode;

use similar::TextDiff;
use volgraph::edits::{edited, save_text};
use volgraph::{Edit, Findings, Overrides, ParamOverride, Place, embedded, registry};
use volgraph_graph::read;

use super::check::graphs::Checker;
use super::write;
use crate::args::SetArgs;
use crate::output;

pub fn run(args: &SetArgs) -> anyhow::Result<ExitCode> {
    let graph = embedded::locate(&args.graph);
    let text = volgraph::edits::graph_text(&graph)?;
    let desc = read::graph(&graph, &text)?;
    let overrides = Overrides {
        params: args.set.clone(),
        volumes: args.volume.clone(),
        camera: args.camera.clone(),
        data: Vec::new(),
        time: None,
        look: None,
    };
    let mut edits: Vec<Edit> = args.unset.iter().map(taken_out).collect();
    edits.extend(overrides.edits(&graph, &desc)?);
    let to = args.output.as_deref().unwrap_or(&graph);
    let after = edited(&text, &graph, &edits, to)?;
    check(args, &graph, &text, to, &after)?;
    if args.dry_run {
        output::print(diff(&text, &after, &graph, to).trim_end());
        return Ok(ExitCode::SUCCESS);
    }
    if to == graph {
        if after == text {
            output::print(&format!("{} stays as it is", to.display()));
            return Ok(ExitCode::SUCCESS);
        }
        save_text(to, Some(&text), &after)?;
    } else if fs::symlink_metadata(to).is_ok() && args.force {
        save_text(to, None, &after)?;
    } else {
        let folder = super::folder_of(to);
        let name = to.file_name().unwrap_or_default();
        let files = [(name.into(), after.as_bytes())];
        write::files(&folder, &files, write::Existing::KeptUnlessForced)?;
    }
    output::print(&format!("wrote {}", to.display()));
    Ok(ExitCode::SUCCESS)
}

/// What `--unset` has read with a value that does not matter.
fn taken_out(set: &ParamOverride) -> Edit {
    match Edit::from(set) {
        Edit::Param { target, name, .. } => Edit::Param {
            target,
            name,
            value: None,
        },
        Edit::Slot { node, slot, .. } => Edit::Slot {
            node,
            slot,
            choice: None,
        },
        other => other,
    }
}

/// Refuses what the graph would be wrong with and was not before; the rest may be mended some other day.
fn check(args: &SetArgs, graph: &Path, text: &str, to: &Path, after: &str) -> Result<(), Findings> {
    let registry = registry();
    let folders = args.shaders.folders();
    let checker = Checker {
        registry: &registry,
        folders: &folders,
        data: &args.data.data,
    };
    let is_error =
        |finding: &volgraph::Finding| finding.severity == volgraph_report::Severity::Error;
    let found = checker.check(to, after.to_owned());
    if !found.has_errors() {
        return Ok(());
    }
    let before = checker.check(graph, text.to_owned());
    let was = |finding: &volgraph::Finding| {
        (&before)
            .into_iter()
            .any(|it| (it.code, &it.message) == (finding.code, &finding.message))
    };
    let new = found.into_iter().filter(|it| is_error(it) && !was(it));
    // They stand in a text that nobody has.
    let new = new.map(|it| it.at(Place::whole_file(to)));
    new.collect::<Findings>().into_result(())
}

/// The lines that differ, as `diff -u` writes them.
fn diff(before: &str, after: &str, from: &Path, to: &Path) -> String {
    let (from, to) = (from.display().to_string(), to.display().to_string());
    TextDiff::from_lines(before, after)
        .unified_diff()
        .header(&from, &to)
        .to_string()
}
