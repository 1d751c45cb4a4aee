//! What `volgraph watch` tells: lines for people, or one JSON object a line.

use std::collections::BTreeSet;
use std::path::PathBuf;
use std::time::Duration;

use serde_json::{Value, json};
use volgraph::quality::Chosen;
use volgraph::{ChangeReport, Dependencies, Findings, Picture, Session};
use volgraph_gpu::FrameReport;
use volgraph_measure::{Comparison, compare_without_flip};
use volgraph_watch::{FileWatch, Seen};

use crate::args::WatchArgs;
use crate::commands::check::json as findings_json;
use crate::output;

/// Tells what happens.
pub struct Teller<'a> {
    args: &'a WatchArgs,
    /// What pictures are compared with: that of `--against`, else the last one.
    compared: Option<Picture>,
    /// Why there is no truth to compare with, as it was told.
    no_truth: Option<Findings>,
    /// What was told of the watching last.
    backend: Option<String>,
}

/// A picture that lies on disk.
#[derive(Clone, Copy)]
pub struct Saved<'a> {
    /// The picture.
    pub picture: &'a Picture,
    /// How many were saved, this one included.
    pub number: u64,
    /// How long saving took.
    pub save: Duration,
    /// From the first sign of the change to the picture on disk.
    pub total: Duration,
}

impl<'a> Teller<'a> {
    /// Tells in the form that the arguments ask for.
    pub fn new(args: &'a WatchArgs, compared: Option<Picture>) -> Self {
        Self {
            args,
            compared,
            no_truth: None,
            backend: None,
        }
    }

    /// A session is open.
    pub fn begins(&self, session: &Session) {
        if self.args.json {
            line(&json!({ "event": "open", "adapter": session.adapter() }));
        } else {
            output::print(&format!("on {}", session.adapter()));
        }
    }

    /// Changes are waited for from now on.
    pub fn watching(&mut self, dependencies: &Dependencies, watch: &FileWatch) {
        let backend = watch.backend().to_string();
        let is_there = |seen: &&Seen| **seen != Seen::Absent;
        let files = dependencies.files.values().filter(is_there).count();
        if self.args.json {
            line(&json!({ "event": "watching", "files": files, "by": backend }));
        } else if self.backend.as_ref() != Some(&backend) {
            let what = match files {
                0 => "no file, as nothing of this picture lies on the disk".to_owned(),
                1 => "1 file".to_owned(),
                _ => format!("{files} files"),
            };
            output::print(&format!("watching {what} ({backend}); Ctrl-C ends"));
        }
        self.backend = Some(backend);
    }

    /// The first picture of a session.
    pub fn first(&mut self, frame: &FrameReport, chosen: Option<&Chosen>, saved: Saved<'_>) {
        let difference = self.difference(saved.picture);
        if self.args.json {
            line(&json!({
                "event": "picture",
                "number": saved.number,
                "output": self.args.output.display().to_string(),
                "frame": frame,
                "quality": chosen,
                "save_ms": ms(saved.save),
                "total_ms": ms(saved.total),
                "difference": difference,
            }));
            return;
        }
        let output = self.args.output.display();
        let total = ms(saved.total);
        output::print(&format!("#{} {output} in {total:.0} ms", saved.number));
        print_chosen(chosen);
        self.print_difference(difference.as_ref());
    }

    /// A picture after a change.
    pub fn drawn(&mut self, report: &ChangeReport, settle: Duration, saved: Saved<'_>) {
        let difference = self.difference(saved.picture);
        let own = report.stages.own_ms() + ms(settle) + ms(saved.save);
        if self.args.json {
            line(&json!({
                "event": "picture",
                "number": saved.number,
                "output": self.args.output.display().to_string(),
                "change": report,
                "settle_ms": ms(settle),
                "save_ms": ms(saved.save),
                "own_ms": own,
                "total_ms": ms(saved.total),
                "difference": difference,
            }));
            return;
        }
        self.remade(report.device_remade.as_deref());
        for warning in &report.warnings {
            output::warn(warning);
        }
        let changed: Vec<String> = report
            .changed
            .iter()
            .map(|file| format!("{} ({})", file.path.display(), file.role))
            .collect();
        output::print(&format!("#{} {}", saved.number, changed.join(", ")));
        let names = |label: &str, names: &[String]| {
            if !names.is_empty() {
                output::print(&format!("   {label} {}", names.join(", ")));
            }
        };
        names("new parameters", &report.params_added);
        names("dropped parameters", &report.params_dropped);
        names(
            "set aside until their parameter is back:",
            &report.set_aside,
        );
        print_chosen(report.chosen.as_ref());
        names("built", &report.pipelines_built);
        let ran: Vec<String> = report.frame.ran().into_iter().map(str::to_owned).collect();
        names("ran", &ran);
        let s = &report.stages;
        let stages = [
            ("settle", ms(settle)),
            ("read", s.read_ms),
            ("link", s.link_ms),
            ("validate", s.validate_ms),
            ("plan", s.plan_ms),
            ("module", s.module_ms),
            ("pipeline", s.pipeline_ms),
            ("allocate", s.allocate_ms),
            ("draw", s.draw_ms),
            ("read back", s.read_back_ms),
            ("save", ms(saved.save)),
        ];
        let stages: Vec<String> = stages
            .iter()
            .filter(|(_, ms)| *ms >= 0.05)
            .map(|(name, ms)| format!("{name} {ms:.1}"))
            .collect();
        output::print(&format!(
            "   {:.0} ms from save to picture: {}; {own:.1} without pipeline and draw",
            ms(saved.total),
            stages.join(", ")
        ));
        self.print_difference(difference.as_ref());
    }

    /// A picture that could be saved only now.
    pub fn saved_later(&mut self, saved: Saved<'_>) {
        let difference = self.difference(saved.picture);
        if self.args.json {
            line(&json!({
                "event": "picture",
                "number": saved.number,
                "output": self.args.output.display().to_string(),
                "save_ms": ms(saved.save),
                "total_ms": ms(saved.total),
                "difference": difference,
            }));
            return;
        }
        let output = self.args.output.display();
        output::print(&format!("#{} {output}, saved at last", saved.number));
        self.print_difference(difference.as_ref());
    }

    /// A change that makes no difference; whether it takes back what was refused.
    pub fn unchanged(&self, paths: &BTreeSet<PathBuf>, is_mended: bool, remade: Option<&str>) {
        if self.args.json {
            line(&json!({
                "event": "unchanged",
                "changed": shown(paths),
                "is_mended": is_mended,
                "device_remade": remade,
            }));
            return;
        }
        self.remade(remade);
        if is_mended {
            let output = self.args.output.display();
            output::print(&format!("   mended: {output} is right as it is"));
        }
    }

    /// A change that was refused; whether for reasons that were not told before.
    pub fn refused(
        &self,
        findings: &Findings,
        changed: &[PathBuf],
        device_remade: Option<&str>,
        is_new: bool,
    ) {
        if self.args.json {
            line(&json!({
                "event": "refused",
                "changed": shown(changed),
                "findings": findings_json(findings),
                "is_new": is_new,
                "device_remade": device_remade,
            }));
            return;
        }
        self.remade(device_remade);
        if is_new {
            output::report(findings);
        }
        if !changed.is_empty() {
            let still = if is_new { "" } else { "refused as before; " };
            let output = self.args.output.display();
            output::print(&format!("   {still}{output} stays as it was"));
        }
    }

    /// The truth of what is drawn, that pictures are compared with; why there is none is told once.
    pub fn hold_against(&mut self, truth: Result<Picture, Findings>) {
        match truth {
            Ok(truth) => {
                self.compared = Some(truth);
                self.no_truth = None;
            }
            Err(findings) => {
                self.compared = None;
                if self.no_truth.as_ref() != Some(&findings) {
                    output::report(&findings);
                }
                self.no_truth = Some(findings);
            }
        }
    }

    /// The picture that the next one is compared with.
    pub fn keep(&mut self, picture: Picture) {
        if self.args.against.is_none() {
            self.compared = Some(picture);
        }
    }

    fn remade(&self, reason: Option<&str>) {
        if let Some(reason) = reason {
            output::warn(&format!("the device was lost ({reason}) and opened again"));
        }
    }

    /// How the picture differs from the one it is compared with; `None` where there is none of its size.
    fn difference(&self, picture: &Picture) -> Option<Comparison> {
        compare_without_flip(picture, self.compared.as_ref()?).ok()
    }

    fn print_difference(&self, difference: Option<&Comparison>) {
        let Some(difference) = difference else {
            return;
        };
        let from = match &self.args.against {
            Some(file) => file.display().to_string(),
            None => "the last picture".to_owned(),
        };
        if difference.max.error == 0.0 {
            output::print(&format!("   equal to {from}"));
            return;
        }
        let max = &difference.max;
        let channel = format!("{:?}", max.channel).to_lowercase();
        output::print(&format!(
            "   differs from {from} by RMSE {:.3e}, at most {:.3e} in {} at {}, {}",
            difference.rmse, max.error, channel, max.x, max.y
        ));
    }
}

fn line(value: &Value) {
    output::print(&value.to_string());
}

fn shown<'p>(paths: impl IntoIterator<Item = &'p PathBuf>) -> Vec<String> {
    paths
        .into_iter()
        .map(|path| path.display().to_string())
        .collect()
}

fn ms(duration: Duration) -> f64 {
    duration.as_secs_f64() * 1e3
}

/// What was chosen for the graph's budget.
fn print_chosen(chosen: Option<&Chosen>) {
    if let Some(chosen) = chosen {
        output::print(&format!("   {chosen}"));
    }
}
