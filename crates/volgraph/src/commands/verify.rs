//! `volgraph verify`: the orders of convergence of a graph ([`orders`]), or a picture rendered again ([`again`]).

mod again;
mod orders;
mod plot;
mod svg;

use std::process::ExitCode;

use crate::args::VerifyArgs;

pub use again::recorded_truth;

pub fn run(args: &VerifyArgs) -> anyhow::Result<ExitCode> {
    let target = &args.scene.graph;
    let is_picture = ["png", "exr"].contains(&super::extension(target).as_str());
    if is_picture && args.orders.is_none() {
        again::run(args)
    } else {
        orders::run(args)
    }
}
