//! One finding, and all of them.

use std::fmt;

use serde::Serialize;

use crate::Place;

/// How bad a finding is. Only errors stop the work.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Severity {
    /// The work cannot go on.
    Error,
    /// The work goes on; the user should know.
    Warning,
}

/// Something wrong with what a user gave us: what, where, and what to do about it.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize)]
pub struct Finding {
    /// Error or warning.
    pub severity: Severity,
    /// A stable short name in kebab case, such as `unknown-port`; tests and editors rely on it.
    pub code: &'static str,
    /// The cause, one sentence without a full stop.
    pub message: String,
    /// Where it is; `None` only where no file is involved.
    pub place: Option<Place>,
    /// Other places that belong to it (the first declaration, say), each with a note.
    pub related: Vec<(Place, String)>,
    /// How its file came in: the import of it, the import of that one's file, and so on to the root.
    pub imported_by: Vec<Place>,
    /// The remedy, one sentence without a full stop.
    pub help: Option<String>,
}

impl Finding {
    /// An error without a place yet.
    #[must_use]
    pub fn error(code: &'static str, message: impl Into<String>) -> Self {
        Self {
            severity: Severity::Error,
            code,
            message: message.into(),
            place: None,
            related: Vec::new(),
            imported_by: Vec::new(),
            help: None,
        }
    }

    /// A warning without a place yet.
    #[must_use]
    pub fn warning(code: &'static str, message: impl Into<String>) -> Self {
        Self {
            severity: Severity::Warning,
            ..Self::error(code, message)
        }
    }

    /// Sets the place.
    #[must_use]
    pub fn at(mut self, place: Place) -> Self {
        self.place = Some(place);
        self
    }

    /// Sets the place unless there is one.
    #[must_use]
    pub fn or_at(mut self, place: impl FnOnce() -> Place) -> Self {
        self.place.get_or_insert_with(place);
        self
    }

    /// Sets the remedy.
    #[must_use]
    pub fn help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }

    /// Sets the remedy if there is one.
    #[must_use]
    pub fn help_opt(mut self, help: Option<String>) -> Self {
        self.help = help.or(self.help);
        self
    }

    /// Adds another place that belongs to it.
    #[must_use]
    pub fn related(mut self, place: Place, note: impl Into<String>) -> Self {
        self.related.push((place, note.into()));
        self
    }

    /// Sets how its file came in, the nearest import first.
    #[must_use]
    pub fn imported_by(mut self, chain: Vec<Place>) -> Self {
        self.imported_by = chain;
        self
    }

    /// How its file came in, as one line: `imported by b.wgsl:3, imported by a.wgsl:1`; `None` for a root.
    #[must_use]
    pub fn import_note(&self) -> Option<String> {
        let shown = self
            .imported_by
            .iter()
            .take(MAX_IMPORTS_SHOWN)
            .map(|place| format!("imported by {}:{}", place.file.display(), place.line))
            .collect::<Vec<_>>()
            .join(", ");
        match self.imported_by.len() {
            0 => None,
            count if count > MAX_IMPORTS_SHOWN => {
                Some(format!("{shown}, … and {} more", count - MAX_IMPORTS_SHOWN))
            }
            _ => Some(shown),
        }
    }
}

/// Longer chains of imports are cut.
const MAX_IMPORTS_SHOWN: usize = 8;

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(place) = &self.place {
            write!(f, "{place}: ")?;
        }
        let word = match self.severity {
            Severity::Error => "error",
            Severity::Warning => "warning",
        };
        write!(f, "{word}[{}]: {}", self.code, self.message)?;
        for (place, note) in &self.related {
            write!(f, "; {place}: {note}")?;
        }
        if let Some(note) = self.import_note() {
            write!(f, "; {note}")?;
        }
        if let Some(help) = &self.help {
            write!(f, "; {help}")?;
        }
        Ok(())
    }
}

/// Everything found in one run. As an error it displays one finding a line, sorted by place.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, thiserror::Error)]
pub struct Findings(Vec<Finding>);

impl Findings {
    /// Nothing found yet.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds one.
    pub fn push(&mut self, finding: Finding) {
        self.0.push(finding);
    }

    /// Takes the value of `result`, or keeps its finding and gives `None`.
    pub fn take<T>(&mut self, result: Result<T, Finding>) -> Option<T> {
        result.map_err(|finding| self.push(finding)).ok()
    }

    /// Takes the value of `result`, or keeps its findings and gives `None`.
    pub fn take_all<T>(&mut self, result: Result<T, Findings>) -> Option<T> {
        result.map_err(|findings| self.extend(findings)).ok()
    }

    /// All of them, in the order of their places, each once: a file that several roots import has its faults once,
    /// told with the first root's imports.
    #[must_use]
    pub fn sorted(&self) -> Vec<&Finding> {
        let mut all: Vec<_> = self.0.iter().collect();
        all.sort_by(|a, b| a.place.cmp(&b.place));
        let mut seen = std::collections::HashSet::new();
        all.retain(|finding| {
            let Finding {
                severity,
                code,
                message,
                place,
                related,
                imported_by: _,
                help,
            } = finding;
            seen.insert((severity, code, message, place, related, help))
        });
        all
    }

    /// How many.
    #[must_use]
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Whether there is none, not even a warning.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Whether any of them is an error.
    #[must_use]
    pub fn has_errors(&self) -> bool {
        self.0
            .iter()
            .any(|finding| finding.severity == Severity::Error)
    }

    /// `Err(self)` where there is an error; otherwise the value, with the warnings dropped.
    ///
    /// # Errors
    /// All findings, where at least one is an error.
    pub fn into_result<T>(self, value: T) -> Result<T, Findings> {
        if self.has_errors() {
            Err(self)
        } else {
            Ok(value)
        }
    }
}

impl Extend<Finding> for Findings {
    fn extend<I: IntoIterator<Item = Finding>>(&mut self, iter: I) {
        self.0.extend(iter);
    }
}

impl IntoIterator for Findings {
    type Item = Finding;
    type IntoIter = std::vec::IntoIter<Finding>;

    fn into_iter(self) -> Self::IntoIter {
        self.0.into_iter()
    }
}

impl<'a> IntoIterator for &'a Findings {
    type Item = &'a Finding;
    type IntoIter = std::slice::Iter<'a, Finding>;

    fn into_iter(self) -> Self::IntoIter {
        self.0.iter()
    }
}

impl FromIterator<Finding> for Findings {
    fn from_iter<I: IntoIterator<Item = Finding>>(iter: I) -> Self {
        Self(iter.into_iter().collect())
    }
}

impl From<Finding> for Findings {
    fn from(finding: Finding) -> Self {
        Self(vec![finding])
    }
}

impl fmt::Display for Findings {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, finding) in self.sorted().into_iter().enumerate() {
            if i > 0 {
                writeln!(f)?;
            }
            write!(f, "{finding}")?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(file: &str, line: u32) -> Place {
        Place {
            file: file.into(),
            line,
            column: 1,
            length: 1,
        }
    }

    #[test]
    fn one_fault_that_came_in_by_two_ways_is_told_once() {
        let fault = Finding::error("some-code", "wrong").at(at("c.wgsl", 7));
        let ways = [
            vec![at("b.wgsl", 3), at("a.wgsl", 1)],
            vec![at("d.wgsl", 2)],
        ];
        let findings: Findings = ways
            .into_iter()
            .map(|way| fault.clone().imported_by(way))
            .collect();
        assert_eq!(
            findings.to_string(),
            "c.wgsl:7:1: error[some-code]: wrong; imported by b.wgsl:3, imported by a.wgsl:1"
        );
        let other = fault.clone().help("do it");
        let findings: Findings = [fault, other].into_iter().collect();
        assert_eq!(findings.sorted().len(), 2);
    }

    #[test]
    fn a_long_way_is_cut() {
        let way = (1..=10).map(|line| at("a.wgsl", line)).collect();
        let note = Finding::error("x", "y").imported_by(way).import_note();
        assert!(
            note.unwrap()
                .ends_with("imported by a.wgsl:8, … and 2 more")
        );
        assert_eq!(Finding::error("x", "y").import_note(), None);
    }
}
