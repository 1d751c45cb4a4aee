//! The orders of convergence of a graph, and whether they are as declared.

use std::fmt::Write;
use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;

use serde_json::json;
use volgraph::verify::{
    Against, Axis, OrdersOptions, Quantity, Skipped, Study, Target, Untold, Verdict, orders,
    stock_for,
};
use volgraph::{Finding, Findings, Place, Scene, Session, SessionOptions, registry};
use volgraph_gpu::Gpu;
use volgraph_measure::PointRole;
use volgraph_measure::convergence::{ABOVE_FLOOR, LEAST_POINTS};

use super::{plot, svg};
use crate::args::{STOCK, VerifyArgs};
use crate::commands::{session_options, tell_warnings, write};
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
    let (required, optional) = axes(args, &target.scene);
    let usual = OrdersOptions::default();
    let options = OrdersOptions {
        axes: [&required[..], &optional[..]].concat(),
        from: args.from,
        halvings: args.halvings.unwrap_or(usual.halvings),
        highest_floor: args.floor.unwrap_or(usual.highest_floor),
        tolerance: args.tolerance_order.unwrap_or(usual.tolerance),
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
    let mut findings = failures(&studies, &options, &name);
    let missed = skipped.iter().filter(|it| required.contains(&it.axis));
    findings.extend(missed.map(|it| not_measured(it, &name)));
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

/// What must be measured, and what is if it can be. Axes that are named must; else the step must, and the grid is optional
/// where `--orders` asks for all or a slot that reconstructs is tested.
fn axes(args: &VerifyArgs, scene: &Scene) -> (Vec<Axis>, Vec<Axis>) {
    let named = args.orders.iter().flatten().map(|axis| Axis::from(*axis));
    let named: Vec<Axis> = named.collect();
    if !named.is_empty() {
        return (named, Vec::new());
    }
    let reconstructs = args.slot.iter().any(|(slot, _)| slot == "reconstruct");
    let is_analytic = scene.desc.sources.values().any(|it| it.kind == "analytic");
    let is_refined = args.orders.is_some() || (reconstructs && is_analytic);
    (
        vec![Axis::Step],
        is_refined.then_some(Axis::Grid).into_iter().collect(),
    )
}

/// A finding for each order that does not hold.
fn failures(studies: &[Study], options: &OrdersOptions, name: &str) -> Findings {
    let held = studies.iter().flat_map(|study| {
        let failed = study.quantities.iter().filter(|it| it.verdict.is_failure());
        failed.map(move |quantity| failure(study, quantity, options))
    });
    held.map(|finding| finding.at(Place::whole_file(name)))
        .collect()
}

fn failure(study: &Study, quantity: &Quantity, options: &OrdersOptions) -> Finding {
    let (axis, what) = (study.axis.name(), quantity.name);
    let declared = quantity.declared.as_ref().map_or(String::new(), |it| {
        let expected = quantity.expected.unwrap_or(it.order);
        format!(", and `{}` declares {expected}", it.by)
    });
    let (because, help) = match (quantity.untold, quantity.convergence.order) {
        (Some(Untold::Absent), _) => (
            format!(
                "in the coarsest picture, no pixel has a {what} that what it is held against has as well"
            ),
            "draw what has one: other settings (`--set`), another view (`--camera`) or larger pictures (`--size`)",
        ),
        (Some(Untold::Unchanged), _) => (
            format!("the {what} is the same in all pictures, which are held against each other"),
            "does the shader use the step, and is there something to see? a truth would tell what is right (`--as`)",
        ),
        (_, None) => (
            format!("fewer than {LEAST_POINTS} errors of the {what} lie above the floor"),
            "start at a larger step (`--from`), or halve more often (`--halvings`)",
        ),
        (_, Some(order)) => {
            let message = format!("the {what} is of order {order:.2} in the {axis}{declared}");
            return Finding::error("order-below", message).help(format!(
                "orders down to {:.2} pass; does the shader drop or weigh a segment wrongly, or is the sample not where the rule has it?",
                quantity.expected.unwrap_or_default() - options.tolerance
            ));
        }
    };
    let message = format!("the order in the {axis} is not told: {because}{declared}");
    Finding::error("order-untold", message).help(help)
}

/// What was asked for by name, and cannot be measured.
fn not_measured(skipped: &Skipped, name: &str) -> Finding {
    let Skipped { axis, because } = skipped;
    let message = format!(
        "the order in the {} is not measured: {because}",
        axis.name()
    );
    Finding::error("not-measured", message)
        .at(Place::whole_file(name))
        .help("change what keeps it from being measured, or name other axes (`--orders`)")
}

fn write_svg(folder: &Path, studies: &[Study], name: &str) -> Result<(), Findings> {
    for study in studies {
        let file = folder.join(format!("{}.svg", study.axis.name()));
        write::whole(&file, svg::study(study, name)?)?;
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
    if quantity.convergence.points.is_empty() {
        return text;
    }
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
        let slope = slope
            .filter(|slope| slope.is_finite())
            .map_or(String::new(), |slope| format!("{slope:.2}"));
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
    let order = quantity.order_said();
    let Some(declared) = &quantity.declared else {
        let told = match quantity.verdict {
            Verdict::Untold => ": NOT TOLD",
            _ => "",
        };
        return format!("{order}, nothing declared{told}");
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
