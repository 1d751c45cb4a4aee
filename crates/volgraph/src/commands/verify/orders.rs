//! The orders of convergence of a graph, and whether they are as declared.

use std::fmt::Write;
use std::fs;
use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;

use serde_json::json;
use volgraph::verify::{
    Against, Axis, OrdersOptions, Quantity, Skipped, Study, Target, Verdict, orders, stock_for,
};
use volgraph::{Finding, Findings, Place, Scene, Session, SessionOptions, registry};
use volgraph_gpu::Gpu;
use volgraph_measure::PointRole;
use volgraph_measure::convergence::{ABOVE_FLOOR, LEAST_POINTS};

use super::{plot, svg};
use crate::args::{STOCK, VerifyArgs};
use crate::commands::{session_options, tell_warnings};
use crate::output;
use crate::progress::Bars;

pub fn run(args: &VerifyArgs) -> anyhow::Result<ExitCode> {
    let bars = Bars::new();
    let is_stock = args.scene.graph == Path::new(STOCK);
    let stock = stock_for(&args.slot);
    let graph = if is_stock {
        Path::new(stock.path)
    } else {
        &args.scene.graph
    };
    let scene = Scene::load(
        graph,
        &args.scene.overrides(),
        &args.scene.shader_folders(),
        registry(),
        &bars,
    );
    bars.clear();
    let scene = scene?;
    if !is_stock {
        tell_warnings(&args.scene, &scene);
    }
    let name = scene.path.display().to_string();
    let target = Target::new(&scene, &args.slot)?;
    let options = OrdersOptions {
        axes: axes(args, &target.scene),
        from: args.from,
        halvings: args.halvings,
        highest_floor: args.floor,
        tolerance: args.tolerance_order,
        expected: args.expect,
        stands_for: args.stands_for.clone(),
        truth: args.truth.options(),
    };
    let session = SessionOptions {
        overrides: target.scene.overrides.clone(),
        with_layers: true,
        is_as_written: true,
        ..session_options(&args.scene, None)
    };
    let gpu = Arc::new(Gpu::open(&session.adapter)?);
    // The target keeps its own: the session's changes.
    let scene = target
        .scene
        .with_overrides(&target.scene.overrides, &volgraph::NoProgress)?;
    let mut session = Session::start(scene, gpu, &session)?;
    let tell = |what: &str, done: u64, total: u64| bars.count(what, done, total);
    let measured = orders(&target, &mut session, &options, &tell);
    bars.clear();
    let (studies, skipped) = measured?;
    if let Some(folder) = &args.svg {
        write_svg(folder, &studies, &name)?;
    }
    let findings = failures(&studies, &options, &name);
    if args.json {
        output::print_json(&json!({
            "graph": name,
            "adapter": session.adapter(),
            "size": args.scene.size,
            "tolerance": options.tolerance,
            "studies": studies,
            "skipped": skipped,
            "passed": findings.is_empty(),
        }));
    } else {
        output::print(&format!("{name} on {}", session.adapter()));
        output::print(&text(&studies, &skipped));
    }
    if findings.is_empty() {
        return Ok(ExitCode::SUCCESS);
    }
    output::report(&findings);
    Ok(ExitCode::from(1))
}

/// What is asked for; of a bare graph the step, and the grid where a slot that reconstructs is tested.
fn axes(args: &VerifyArgs, scene: &Scene) -> Vec<Axis> {
    let given = args.orders.iter().flatten().map(|axis| Axis::from(*axis));
    let given: Vec<Axis> = given.collect();
    if !given.is_empty() {
        return given;
    }
    let reconstructs = args.slot.iter().any(|(slot, _)| slot == "reconstruct");
    let is_analytic = scene.desc.sources.values().any(|it| it.kind == "analytic");
    if reconstructs && is_analytic {
        vec![Axis::Step, Axis::Grid]
    } else {
        vec![Axis::Step]
    }
}

/// A finding for each order that does not hold.
fn failures(studies: &[Study], options: &OrdersOptions, name: &str) -> Findings {
    let held = studies.iter().flat_map(|study| {
        let failed = study.quantities.iter().filter(|it| it.verdict.is_failure());
        failed.map(move |quantity| (study, quantity))
    });
    let finding = |(study, quantity): (&Study, &Quantity)| {
        let axis = study.axis.name();
        let by = quantity.declared.as_ref().map_or("", |it| it.by.as_str());
        let expected = quantity.expected.unwrap_or_default();
        let finding = match quantity.convergence.order {
            Some(order) => Finding::error(
                "order-below",
                format!(
                    "the {} is of order {order:.2} in the {axis}, and `{by}` declares {expected}",
                    quantity.name
                ),
            )
            .help(format!(
                "orders down to {:.2} pass; does the shader drop or weigh a segment wrongly, or is the sample not where the rule has it?",
                expected - options.tolerance
            )),
            None => Finding::error(
                "order-untold",
                format!(
                    "fewer than {LEAST_POINTS} errors of the {} lie above the floor, so its order in the {axis} is not told, and `{by}` declares {expected}",
                    quantity.name
                ),
            )
            .help("start at a larger step (`--from`), or halve more often (`--halvings`)"),
        };
        finding.at(Place::whole_file(name))
    };
    held.map(finding).collect()
}

fn write_svg(folder: &Path, studies: &[Study], name: &str) -> Result<(), Findings> {
    let io = |path: &Path, error: std::io::Error| {
        Findings::from(Finding::error("io", error.to_string()).at(Place::whole_file(path)))
    };
    fs::create_dir_all(folder).map_err(|error| io(folder, error))?;
    for study in studies {
        let path = folder.join(format!("{}.svg", study.axis.name()));
        fs::write(&path, svg::study(study, name)?).map_err(|error| io(&path, error))?;
    }
    Ok(())
}

fn text(studies: &[Study], skipped: &[Skipped]) -> String {
    let mut text = String::new();
    // Writing to a String does not fail.
    for study in studies {
        let axis = study.axis.name();
        let _ = match &study.against {
            Against::Reference => {
                writeln!(text, "\nhalving the {axis}, against the float64 reference")
            }
            Against::Next { because } => writeln!(
                text,
                "\nhalving the {axis}, each picture against the next finer one: orders, but no limit ({because})"
            ),
        };
        for quantity in &study.quantities {
            let _ = write!(text, "\n{}", of_quantity(quantity, study));
        }
        for limit in &study.limits {
            let _ = writeln!(
                text,
                "  note: orders above {} need not show in this scene: {}",
                limit.order, limit.because
            );
        }
        for note in &study.notes {
            let _ = writeln!(text, "  note: {note}");
        }
    }
    for Skipped { axis, because } in skipped {
        let _ = writeln!(text, "\nthe {} is not halved: {because}", axis.name());
    }
    text
}

fn of_quantity(quantity: &Quantity, study: &Study) -> String {
    let mut text = format!("  {}: {}\n", quantity.name, verdict(quantity));
    if let Some(floor) = quantity.convergence.floor {
        let _ = writeln!(
            text,
            "  stops falling at {floor:.1e} (rounding, tables); errors below {:.1e} are not fitted",
            ABOVE_FLOOR * floor
        );
    }
    let _ = writeln!(text, "  {:>10}  {:>9}  order", study.axis.name(), "error");
    let mut before: Option<(f64, f64)> = None;
    for point in &quantity.convergence.points {
        let slope =
            before.map(|(step, error)| (error / point.error).ln() / (step / point.step).ln());
        let slope = slope.map_or(String::new(), |slope| format!("{slope:.2}"));
        let role = match point.role {
            PointRole::Fitted => "",
            PointRole::Floor => "floor",
            PointRole::Coarse => "coarse: not yet on the line",
        };
        let line = format!(
            "  {:>10.6}  {:>9.2e}  {slope:>5}  {role}",
            point.step, point.error
        );
        let _ = writeln!(text, "{}", line.trim_end());
        before = Some((point.step, point.error));
    }
    text.push_str(&plot::text(&quantity.convergence, study.axis.unit()));
    text
}

fn verdict(quantity: &Quantity) -> String {
    let order = match quantity.convergence.order {
        Some(order) => format!("order {order:.2}"),
        None if quantity.convergence.is_exact => "exact to the floor".to_owned(),
        None => "too few points for an order".to_owned(),
    };
    let Some(declared) = &quantity.declared else {
        return format!("{order}, nothing declared");
    };
    let here = match quantity.expected {
        Some(expected) if expected < declared.order => {
            format!(", of which this scene shows {expected}")
        }
        _ => String::new(),
    };
    let said = format!("`{}` declares {}{here}", declared.by, declared.order);
    let holds = match quantity.verdict {
        Verdict::Reported => "",
        Verdict::Holds | Verdict::Exact => ": holds",
        Verdict::Higher => ": holds, and is higher",
        Verdict::Below => ": BELOW",
        Verdict::Untold => ": NOT TOLD",
    };
    format!("{order}, {said}{holds}")
}
