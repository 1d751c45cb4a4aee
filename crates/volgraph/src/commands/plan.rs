//! `volgraph plan`: what a graph comes to.

use std::process::ExitCode;

use volgraph::Limits;
use volgraph_gpu::Gpu;

use super::{load, session_options};
use crate::args::PlanArgs;
use crate::output;

pub fn run(args: &PlanArgs) -> anyhow::Result<ExitCode> {
    let scene = load(&args.scene)?;
    let (limits, capabilities) = match &args.scene.adapter {
        Some(_) => {
            let gpu = Gpu::open(&args.scene.adapter_choice())?;
            let options = session_options(&args.scene, None);
            (options.limits(&gpu), gpu.capabilities())
        }
        None => {
            let limits = Limits::default();
            let most = session_options(&args.scene, None).max_resource_bytes;
            let limits = Limits {
                max_resource_bytes: most.unwrap_or(limits.max_resource_bytes),
                ..limits
            };
            (limits, naga::valid::Capabilities::default())
        }
    };
    let plan = scene.plan(
        &scene.shader_library(capabilities),
        &limits,
        args.scene.size,
        false,
    )?;
    if args.json {
        output::print_json(&plan.to_json());
    } else if args.dot {
        output::print(&plan.to_dot());
    } else {
        output::print(&plan.to_text());
    }
    Ok(ExitCode::SUCCESS)
}
