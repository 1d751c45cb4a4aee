//! `volgraph adapters`: what a session can run on, the best first.

use std::process::ExitCode;

use serde_json::json;
use volgraph::list_adapters;

use crate::args::AdaptersArgs;
use crate::output;

pub fn run(args: &AdaptersArgs) -> anyhow::Result<ExitCode> {
    let adapters = list_adapters();
    if args.json {
        output::print_json(&json!(adapters));
    } else if adapters.is_empty() {
        output::print(
            "no adapter is found; on a machine without a GPU a software driver will do:\n\
             on Debian or Ubuntu `apt-get install mesa-vulkan-drivers` (Vulkan) or \
             `apt-get install libegl1 libgl1-mesa-dri` (OpenGL)",
        );
    } else {
        let lines: Vec<String> = adapters.iter().map(ToString::to_string).collect();
        output::print(&lines.join("\n"));
    }
    Ok(ExitCode::SUCCESS)
}
