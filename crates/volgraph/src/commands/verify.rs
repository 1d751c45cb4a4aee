//! `volgraph verify`: the orders of convergence of a graph ([`orders`]), or a picture rendered again ([`again`]).

mod again;
mod difference;
mod orders;
mod plot;
mod svg;

use std::process::ExitCode;

use volgraph::{Finding, Findings, Place};

use crate::args::VerifyArgs;

pub use again::recorded_truth;

pub fn run(args: &VerifyArgs) -> anyhow::Result<ExitCode> {
    let target = &args.scene.graph;
    let is_picture = ["png", "exr"].contains(&super::extension(target).as_str());
    check_options(args, is_picture)?;
    if is_picture {
        again::run(args)
    } else {
        orders::run(args)
    }
}

/// Refuses options that would have no part in what is done: whoever gives them believes that they have.
fn check_options(args: &VerifyArgs, is_picture: bool) -> Result<(), Findings> {
    let scene = &args.scene;
    let settings = [
        ("--set", !scene.set.is_empty()),
        ("--slot", !args.slot.is_empty()),
        ("--volume", !scene.volume.is_empty()),
        ("--camera", scene.camera.is_some()),
    ];
    let of_orders = [
        ("--orders", args.orders.is_some()),
        ("--as", !args.stands_for.is_empty()),
        ("--from", args.from.is_some()),
        ("--halvings", args.halvings.is_some()),
        ("--tolerance-order", args.tolerance_order.is_some()),
        ("--expect", args.expect.is_some()),
        ("--floor", args.floor.is_some()),
        ("--svg", args.svg.is_some()),
    ];
    let of_pictures = [("--against", args.against.is_some())];
    let mut findings = Findings::new();
    let mut refuse = |given: &[(&str, bool)], code, why: &str, help: &str| {
        let given: Vec<&str> = given.iter().filter(|it| it.1).map(|it| it.0).collect();
        if !given.is_empty() {
            let message = format!("`{}` cannot be given here: {why}", given.join("`, `"));
            let place = Place::whole_file(&scene.graph);
            findings.push(Finding::error(code, message).at(place).help(help));
        }
    };
    if is_picture {
        refuse(
            &settings,
            "own-settings",
            "a picture is rendered again with its own settings",
            "leave it out, or verify a graph with it",
        );
        refuse(
            &of_orders,
            "no-orders",
            "orders are those of graphs, and a picture is rendered again and compared",
            "leave it out, or name the graph that the picture is of",
        );
    } else {
        refuse(
            &of_pictures,
            "no-picture",
            "only a picture is compared as it is; the orders of a graph are measured against its truth anyway",
            "leave it out, or name a .png or .exr that volgraph has written",
        );
    }
    findings.into_result(())
}
