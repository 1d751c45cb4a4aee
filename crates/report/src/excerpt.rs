//! Findings with the lines they speak of, a caret under the place, for people at a terminal.

use std::fs;
use std::path::Path;

use annotate_snippets::{AnnotationKind, Group, Level, Renderer, Snippet};

use crate::{Finding, Findings, Place, Severity};

/// Renders all findings, sorted by place, each with an excerpt of its file where that file can be read as
/// text. `read` gives the text of a file (an editor's unsaved buffer, say); [`from_disk`] reads the disk.
#[must_use]
pub fn render(findings: &Findings, read: impl Fn(&Path) -> Option<String>, color: bool) -> String {
    let renderer = if color {
        Renderer::styled()
    } else {
        Renderer::plain()
    };
    let rendered: Vec<String> = findings
        .sorted()
        .into_iter()
        .map(|finding| render_one(finding, &read, &renderer))
        .collect();
    rendered.join("\n\n")
}

/// Reads a text file from the disk, of at most 1 MiB, for an excerpt.
#[must_use]
pub fn from_disk(file: &Path) -> Option<String> {
    let is_small = fs::metadata(file).is_ok_and(|meta| meta.is_file() && meta.len() <= 1 << 20);
    if is_small {
        fs::read_to_string(file).ok()
    } else {
        None
    }
}

fn render_one(
    finding: &Finding,
    read: &impl Fn(&Path) -> Option<String>,
    renderer: &Renderer,
) -> String {
    let level = match finding.severity {
        Severity::Error => Level::ERROR,
        Severity::Warning => Level::WARNING,
    };
    let places = finding
        .place
        .iter()
        .map(|place| (place, "", AnnotationKind::Primary))
        .chain(
            finding
                .related
                .iter()
                .map(|(place, note)| (place, note.as_str(), AnnotationKind::Context)),
        );
    let mut sources = Vec::new();
    let mut without_text = Vec::new();
    for (place, note, kind) in places {
        match read(&place.file).filter(|_| place.line > 0) {
            Some(text) => sources.push((place, note, kind, text)),
            None => without_text.push((place, note)),
        }
    }
    let mut message = finding.message.clone();
    for (place, note) in without_text {
        message = if note.is_empty() {
            format!("{place}: {message}")
        } else {
            format!("{message}\n{place}: {note}")
        };
    }
    let paths: Vec<String> = sources
        .iter()
        .map(|(place, ..)| place.file.display().to_string())
        .collect();
    let mut group = Group::with_title(level.primary_title(&message).id(finding.code));
    for ((place, note, kind, text), path) in sources.iter().zip(&paths) {
        let span = byte_span(text, place);
        let mut annotation = kind.span(span);
        if !note.is_empty() {
            annotation = annotation.label(*note);
        }
        group = group.element(
            Snippet::source(text.as_str())
                .path(path.as_str())
                .annotation(annotation),
        );
    }
    let import_note = finding.import_note();
    if let Some(note) = &import_note {
        group = group.element(Level::NOTE.message(note.as_str()));
    }
    if let Some(help) = &finding.help {
        group = group.element(Level::HELP.message(help.as_str()));
    }
    renderer.render(&[group])
}

fn byte_span(text: &str, place: &Place) -> std::ops::Range<usize> {
    let line_start = text
        .split_inclusive('\n')
        .take(place.line.saturating_sub(1) as usize)
        .map(str::len)
        .sum::<usize>()
        .min(text.len());
    let line = text[line_start..].lines().next().unwrap_or("");
    let byte_of = |chars: u32| {
        line.char_indices()
            .nth(chars as usize)
            .map_or(line.len(), |(at, _)| at)
    };
    let start = byte_of(place.column.saturating_sub(1));
    let end = byte_of(place.column.saturating_sub(1).saturating_add(place.length));
    line_start + start..line_start + end.max(start)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_excerpt_shows_the_line_and_the_caret() {
        let text = "first\nlet x = yy;\n";
        let place = Place::in_text(Path::new("a.wgsl"), text, text.find("yy").unwrap(), 2);
        let findings = Finding::error("unknown-name", "unknown name `yy`")
            .at(place)
            .help("declare it")
            .into();
        let shown = render(&findings, |_| Some(text.to_owned()), false);
        assert!(shown.contains("a.wgsl:2:9"), "{shown}");
        assert!(shown.contains("let x = yy;"), "{shown}");
        assert!(shown.contains("^^"), "{shown}");
        assert!(shown.contains("declare it"), "{shown}");
    }

    #[test]
    fn a_file_that_is_gone_is_named_all_the_same() {
        let findings = Finding::error("io", "cannot be read")
            .at(Place::whole_file("no/such"))
            .into();
        assert!(render(&findings, |_| None, false).contains("no/such: cannot be read"));
    }
}
