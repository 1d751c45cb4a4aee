//! Finds case files in folders.

use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use volgraph_report::ron_text::Document;
use volgraph_report::{Finding, Findings};

use super::read::MAX_TEXT_BYTES;
use super::{OWN_FIELDS, is_case};
use crate::folders::{search, unreadable};

/// The case files that these paths name, sorted, each once: folders are searched for them, files must be some.
///
/// # Errors
/// `io` for what is not there, `no-case` where there is none.
pub fn find(paths: &[PathBuf]) -> Result<Vec<PathBuf>, Findings> {
    let mut findings = Findings::new();
    let mut files = Vec::new();
    for path in paths {
        match fs::metadata(path) {
            Ok(metadata) if metadata.is_dir() => {
                search(path, &is_case_file, &mut files, &mut findings);
            }
            Ok(_) => files.push(path.clone()),
            Err(error) => findings.push(unreadable(path, &error)),
        }
    }
    let mut files: Vec<PathBuf> = files
        .iter()
        .map(|path| path.strip_prefix(".").unwrap_or(path).to_path_buf())
        .collect();
    files.sort();
    files.dedup();
    if files.is_empty() && !findings.has_errors() {
        findings.push(
            Finding::error("no-case", "there is no test case here").help(
                "a case is a RON file with `test: 1`; `volgraph new technique NAME` writes one",
            ),
        );
    }
    findings.into_result(files)
}

/// Whether a file that a folder holds is a case, also where it is a broken one: what nobody runs cannot fail.
fn is_case_file(file: &Path) -> Result<bool, io::Error> {
    let is_ron = file.extension().is_some_and(|extension| extension == "ron");
    // What a link does not lead to, and what is no plain file, is no case.
    if !is_ron || !fs::metadata(file).is_ok_and(|it| it.is_file()) {
        return Ok(false);
    }
    let mut head = Vec::new();
    // A longer file may be meant as a case as well, and reading it then says that it is too long.
    let _length = File::open(file)?
        .take(MAX_TEXT_BYTES)
        .read_to_end(&mut head)?;
    let text = String::from_utf8_lossy(&head);
    let fields = Document::parse(file, &text)
        .map_err(Findings::from)
        .and_then(|document| document.fields());
    Ok(match fields {
        Ok(fields) => is_case(fields.iter().map(|field| field.name.as_str())),
        Err(_) => is_meant_as_case(&text),
    })
}

/// Whether a text that is no RON is meant as a case: one of its words outside of comments and quotes is a field that only
/// cases have, and a colon follows. Quotes are those of one line, so that one that is missing hides no other.
fn is_meant_as_case(text: &str) -> bool {
    text.lines().any(|line| {
        let code = line.split("//").next().unwrap_or_default();
        // Every other part lies between quotes.
        let mut parts = code.split('"').step_by(2);
        parts.any(|part| {
            OWN_FIELDS.iter().any(|field| {
                part.match_indices(field).any(|(at, _)| {
                    let is_in_name = |c: char| c.is_alphanumeric() || c == '_';
                    let (before, after) = (&part[..at], &part[at + field.len()..]);
                    !before.ends_with(is_in_name) && after.trim_start().starts_with(':')
                })
            })
        })
    })
}

#[cfg(test)]
mod tests {
    use super::is_meant_as_case;

    #[test]
    fn broken_cases_are_told_from_other_broken_texts() {
        for case in [
            "(\n    test: 1,\n    expect: [finite\n)",
            "( test : 1, graph: \"a.ron, expect: [finite])",
            "(graph: \"a.ron,\n test: 1)",
            "// A case.\n(/* one */ test: 1",
            "(slot: (technique: \"glow\") expect: [finite])",
        ] {
            assert!(is_meant_as_case(case), "{case}");
        }
        for other in [
            "",
            "(sources: { \"test\": volume(path: \"a.raw\") }, nodes: {",
            "// test: 1\n(points: [",
            "(contest: 1, tests: 2, test_: 3",
            "(points: [], test",
        ] {
            assert!(!is_meant_as_case(other), "{other}");
        }
    }
}
