//! `volgraph transfer`: a transfer function for a volume, from a preset.

use std::fs;
use std::process::ExitCode;

use volgraph::edits::save_text;
use volgraph::presets::{Scale, leading_comments, preset, presets, visible_share};
use volgraph::{Finding, Findings};
use volgraph_formats::LoadOptions;
use volgraph_optics::{TransferFunction, color_map_names};

use super::write;
use crate::args::TransferArgs;
use crate::output;

pub fn run(args: &TransferArgs) -> anyhow::Result<ExitCode> {
    let (Some(name), Some(volume)) = (&args.preset, &args.volume) else {
        output::print(list().trim_end());
        return Ok(ExitCode::SUCCESS);
    };
    let preset = preset(name).map_err(Findings::from)?;
    let volume = volgraph_formats::load(volume, &LoadOptions::default())
        .map_err(|error| Findings::from(Finding::from(error)))?;
    let mut text = preset.text(&volume).map_err(Findings::from)?;
    let transfer = TransferFunction::parse(name.as_ref(), &text)?;
    let share = visible_share(&volume, &volume.histogram(4096), &transfer);
    let Some(file) = &args.output else {
        output::print(text.trim_end());
        return Ok(ExitCode::SUCCESS);
    };
    if args.force && fs::symlink_metadata(file).is_ok() {
        let before = fs::read_to_string(file).unwrap_or_default();
        let comments = leading_comments(&before);
        if !comments.is_empty() {
            text = format!("{comments}{}", &text[leading_comments(&text).len()..]);
        }
        save_text(file, None, &text)?;
    } else {
        let name = file.file_name().unwrap_or_default();
        let files = [(name.into(), text.as_bytes())];
        write::files(
            &super::folder_of(file),
            &files,
            write::Existing::KeptUnlessForced,
        )?;
    }
    output::print(&format!(
        "wrote {}; about {:.1} % of the voxels are seen",
        file.display(),
        100.0 * share
    ));
    Ok(ExitCode::SUCCESS)
}

fn list() -> String {
    let rows = presets().iter().map(|preset| {
        let scale = match preset.scale {
            Scale::Hounsfield => "in Hounsfield units",
            Scale::Foreground => "over the values above the background",
        };
        format!("{:16}{} [{scale}]\n", preset.name, preset.shows)
    });
    let maps: Vec<&str> = color_map_names().collect();
    format!(
        "{}colour maps: {}",
        rows.collect::<String>(),
        maps.join(", ")
    )
}
