//! Findings for programs: JSON, and annotations of GitHub Actions.

use serde_json::{Map, Value, json};
use volgraph::{Findings, Place};
use volgraph_report::Severity;

/// `12 files checked`, and how much was found.
pub fn summary(files: usize, findings: &Findings) -> String {
    let count = |n: usize, what: &str| format!("{n} {what}{}", if n == 1 { "" } else { "s" });
    let errors = findings
        .into_iter()
        .filter(|finding| finding.severity == Severity::Error)
        .count();
    let mut text = format!("{} checked", count(files, "file"));
    if errors > 0 {
        text += &format!(", {}", count(errors, "error"));
    }
    if findings.len() > errors {
        text += &format!(", {}", count(findings.len() - errors, "warning"));
    }
    text
}

/// One flat object a finding, sorted by place.
pub fn json(findings: &Findings) -> Value {
    let objects = findings.sorted().into_iter().map(|finding| {
        let mut object = flat(finding.place.as_ref());
        let imports = finding
            .imported_by
            .iter()
            .map(|place| (place, "imported here"));
        let related = finding
            .related
            .iter()
            .map(|(place, note)| (place, note.as_str()));
        let related = related.chain(imports).map(|(place, note)| {
            let mut related = flat(Some(place));
            related.insert("note".to_owned(), json!(note));
            Value::Object(related)
        });
        object.insert("severity".to_owned(), json!(finding.severity));
        object.insert("code".to_owned(), json!(finding.code));
        object.insert("message".to_owned(), json!(finding.message));
        object.insert("help".to_owned(), json!(finding.help));
        object.insert("related".to_owned(), related.collect());
        Value::Object(object)
    });
    objects.collect()
}

fn flat(place: Option<&Place>) -> Map<String, Value> {
    let part = |part: fn(&Place) -> Value| place.map_or(Value::Null, part);
    [
        (
            "file",
            part(|place| json!(place.file.display().to_string())),
        ),
        ("line", part(|place| json!(place.line))),
        ("column", part(|place| json!(place.column))),
        ("length", part(|place| json!(place.length))),
    ]
    .into_iter()
    .map(|(name, value)| (name.to_owned(), value))
    .collect()
}

/// One workflow command a finding, sorted by place.
pub fn github(findings: &Findings) -> String {
    let lines = findings.sorted().into_iter().map(|finding| {
        let command = match finding.severity {
            Severity::Error => "error",
            Severity::Warning => "warning",
        };
        let mut properties = Vec::new();
        if let Some(place) = &finding.place {
            properties.push(format!(
                "file={}",
                property(&place.file.display().to_string())
            ));
            if place.line > 0 {
                properties.push(format!("line={},col={}", place.line, place.column));
            }
        }
        properties.push(format!("title={}", finding.code));
        let mut message = finding.message.clone();
        if let Some(help) = &finding.help {
            message += &format!("; {help}");
        }
        for (place, note) in &finding.related {
            message += &format!("\n{place}: {note}");
        }
        if let Some(note) = finding.import_note() {
            message += &format!("\n{note}");
        }
        format!(
            "::{command} {}::{}",
            properties.join(","),
            escaped(&message)
        )
    });
    lines.collect::<Vec<_>>().join("\n")
}

fn escaped(text: &str) -> String {
    text.replace('%', "%25")
        .replace('\r', "%0D")
        .replace('\n', "%0A")
}

fn property(text: &str) -> String {
    escaped(text).replace(':', "%3A").replace(',', "%2C")
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use volgraph::Finding;

    use super::*;

    #[test]
    fn annotations_escape_what_would_end_them() {
        let place = Place {
            file: "a,b:c.wgsl".into(),
            line: 3,
            column: 7,
            length: 1,
        };
        let findings: Findings = [
            Finding::error("some-code", "100% wrong\nin two lines")
                .at(place.clone())
                .related(place.clone(), "50% here")
                .imported_by(vec![place])
                .help("do it"),
            Finding::warning("other", "of the whole").at(Place::whole_file(Path::new("z.ron"))),
        ]
        .into_iter()
        .collect();
        assert_eq!(
            github(&findings),
            "::error file=a%2Cb%3Ac.wgsl,line=3,col=7,title=some-code::100%25 wrong%0Ain two lines; do it\
             %0Aa,b:c.wgsl:3:7: 50%25 here%0Aimported by a,b:c.wgsl:3\n\
             ::warning file=z.ron,title=other::of the whole"
        );
        assert_eq!(summary(1, &findings), "1 file checked, 1 error, 1 warning");
        assert_eq!(summary(2, &Findings::new()), "2 files checked");
    }
}
