//! `volgraph advise`: the step that a graph asks for, by Carson's rule and as measured.

use std::fmt::Write as _;
use std::process::ExitCode;

use serde_json::json;
use volgraph::advise::spectrum::{ENERGY_SHARE, TRANSFER_SAMPLES};
use volgraph::advise::{Advice, Rule, measure};

use super::reference::Rows;
use super::{load, session_options};
use crate::args::AdviseArgs;
use crate::output;
use crate::progress::Bars;

pub fn run(args: &AdviseArgs) -> anyhow::Result<ExitCode> {
    let scene = load(&args.scene)?;
    let mut advice = Advice::of(&scene)?;
    if args.measure {
        let bars = Bars::new();
        let mut options = session_options(&args.scene, None);
        options.size = args.measure_size;
        let measured = measure(
            &mut advice,
            &scene,
            &options,
            &args.truth.options(),
            &Rows(&bars),
        );
        bars.clear();
        measured?;
    }
    if args.json {
        let mut value = json!(advice);
        value["energy_share"] = json!(ENERGY_SHARE);
        value["advice"] = json!(advice.sentence());
        output::print_json(&value);
    } else {
        output::print(&text(&advice));
    }
    Ok(ExitCode::SUCCESS)
}

fn text(advice: &Advice) -> String {
    let volume = &advice.volume;
    let [x, y, z] = volume.dims;
    let (low, high) = volume.range;
    let share = 100.0 * ENERGY_SHARE;
    let mut text = format!(
        "node `{}`: technique {}, classify {}\n\
         volume           {x} × {y} × {z} {}, scalars {} to {}, voxel {} world units\n\
         highest relevant frequencies: those below which {share} % of the energy lies; lines mirrored at their ends, \
         mean removed, no window\n",
        advice.node,
        advice.technique,
        advice.classify,
        volume.scalar_type,
        short(low),
        short(high),
        short(volume.voxel)
    );
    // Writing to a String does not fail.
    for (name, axis) in ["x", "y", "z"].iter().zip(&volume.axes) {
        let _ = writeln!(
            text,
            "nu_S along {name}     {:.3} cycles per voxel ({} of {} lines)",
            axis.cycles_per_voxel, axis.lines, axis.lines_in_all
        );
    }
    let _ = writeln!(
        text,
        "gradients        largest {}, 99.9 % below {}, median {} data units per voxel",
        short(volume.gradient_max),
        short(volume.gradient_999),
        short(volume.gradient_median)
    );
    match &advice.transfer {
        Some(transfer) => {
            let _ = writeln!(
                text,
                "nu_U             {:.4} cycles per data unit, {:.1} over the data's range (extinction alone {:.1}; {} \
                 samples)",
                transfer.all,
                transfer.all * (high - low),
                transfer.extinction * (high - low),
                TRANSFER_SAMPLES
            );
        }
        None => text.push_str("nu_U             no transfer function is read\n"),
    }
    let rules: [(&str, Option<Rule>); 3] = [
        ("pi nu_U nu_S A", advice.by_spectra),
        ("nu_U max slope", advice.by_largest_gradient),
        ("nu_U 99.9 %", advice.by_common_gradient),
    ];
    for (name, rule) in rules {
        if let Some(rule) = rule {
            let _ = writeln!(
                text,
                "{name:<16} {:.2} cycles per voxel: a step of {:.3} voxels",
                rule.cycles_per_voxel, rule.step
            );
        }
    }
    let _ = writeln!(
        text,
        "field alone      a step of {:.3} voxels, half a cycle of nu_S",
        advice.field_step
    );
    if !advice.measured.is_empty() {
        let _ = writeln!(
            text,
            "\n{:<18} {:>6} {:>10} {:>10}   against the float64 reference",
            "classify", "step", "rmse", "largest"
        );
        for it in &advice.measured {
            let _ = writeln!(
                text,
                "{:<18} {:>6} {:>10.2e} {:>10.2e}",
                it.classify, it.step, it.rmse, it.max
            );
        }
    }
    for note in &advice.notes {
        let _ = writeln!(text, "note: {note}");
    }
    let _ = write!(text, "\n{}", advice.sentence());
    text
}

/// A number with four digits.
fn short(value: f64) -> String {
    let size = value.abs();
    if value == 0.0 || value.fract() == 0.0 && size < 1e7 {
        format!("{value}")
    } else if (1e-3..1e6).contains(&size) {
        let digits = (3.0 - size.log10().floor()).clamp(0.0, 6.0) as usize;
        format!("{value:.digits$}")
    } else {
        format!("{value:.3e}")
    }
}
