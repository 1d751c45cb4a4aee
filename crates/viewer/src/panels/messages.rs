//! What is wrong with what was tried, with excerpts and places, and what was done lately.

use std::path::Path;
use std::process::Command;

use egui::{RichText, ScrollArea, Ui};
use volgraph_engine::{Findings, Place};
use volgraph_report::{Severity, excerpt};

use crate::worker::Told;

pub(crate) fn show(ui: &mut Ui, told: &Told) {
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        findings(ui, &told.findings);
        for note in told.notes.iter().rev() {
            ui.label(RichText::new(&note.text).small());
        }
    });
}

/// Findings with what can be done about each.
pub(crate) fn findings(ui: &mut Ui, findings: &Findings) {
    if findings.is_empty() {
        ui.weak("Nothing is wrong.");
        return;
    }
    ui.horizontal(|ui| {
        let count = findings.len();
        let what = if count == 1 { "finding" } else { "findings" };
        ui.strong(format!("{count} {what}; the last good picture stays"));
        if ui.button("Copy all").clicked() {
            ui.ctx()
                .copy_text(excerpt::render(findings, excerpt::from_disk, false));
        }
    });
    for finding in findings.sorted() {
        let color = match finding.severity {
            Severity::Error => ui.visuals().error_fg_color,
            _ => ui.visuals().warn_fg_color,
        };
        ui.separator();
        ui.horizontal(|ui| {
            ui.colored_label(color, finding.code);
            if let Some(place) = &finding.place {
                let shown = format!("{}:{}:{}", place.file.display(), place.line, place.column);
                let link = ui.link(&shown).on_hover_text("Copy the place");
                if link.clicked() {
                    ui.ctx().copy_text(shown);
                }
                if place.file.is_file()
                    && ui
                        .small_button("Edit")
                        .on_hover_text("Open in $VISUAL or $EDITOR")
                        .clicked()
                {
                    edit(place);
                }
            }
        });
        let one: Findings = finding.clone().into();
        let text = excerpt::render(&one, excerpt::from_disk, false);
        let response = ui.add(
            egui::Label::new(RichText::new(text.trim_end()).monospace())
                .sense(egui::Sense::click()),
        );
        if response.on_hover_text("Click to copy").clicked() {
            ui.ctx().copy_text(text);
        }
    }
}

/// Opens a place in the user's editor. Editors that are known to take a line get it in their own way.
fn edit(place: &Place) {
    let editor = ["VISUAL", "EDITOR"].into_iter().find_map(std::env::var_os);
    let editor = editor.unwrap_or_else(|| "xdg-open".into());
    let line = editor.to_string_lossy().into_owned();
    let mut words = line.split_whitespace();
    let Some(program) = words.next() else {
        return;
    };
    let mut command = Command::new(program);
    command.args(words);
    command.args(arguments(program, place));
    // An editor that is not there is found out by its user.
    let _ = command.spawn();
}

fn arguments(program: &str, place: &Place) -> Vec<String> {
    let name = Path::new(program)
        .file_stem()
        .map(|name| name.to_string_lossy().into_owned());
    let file = place.file.display().to_string();
    let (line, column) = (place.line.max(1), place.column.max(1));
    match name.as_deref() {
        Some("code" | "codium" | "code-insiders" | "cursor") => {
            vec!["--goto".to_owned(), format!("{file}:{line}:{column}")]
        }
        Some("hx" | "helix" | "subl" | "zed") => vec![format!("{file}:{line}:{column}")],
        Some(
            "vi" | "vim" | "nvim" | "gvim" | "nano" | "emacs" | "emacsclient" | "kak" | "gedit"
            | "micro",
        ) => {
            vec![format!("+{line}"), file]
        }
        _ => vec![file],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn editors_get_the_line_in_their_own_way() {
        let place = Place::in_text(Path::new("/a.wgsl"), "one\ntwo three\n", 8, 5);
        assert_eq!(arguments("/usr/bin/vim", &place), ["+2", "/a.wgsl"]);
        assert_eq!(arguments("code", &place), ["--goto", "/a.wgsl:2:5"]);
        assert_eq!(arguments("unheard-of", &place), ["/a.wgsl"]);
    }
}
