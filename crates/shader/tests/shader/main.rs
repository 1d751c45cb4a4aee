//! Tests of the shader crate over files in memory.

mod check;
mod fuzz;
mod guard;
mod guard_loads;
mod guard_places;
mod hoist;
mod link;
mod names;
mod params;
mod recover;
mod reflect;
mod specialise;
mod uniform;

use std::path::Path;
use std::sync::Arc;

use naga::valid::Capabilities;
use volgraph_report::{Finding, Findings, Place};
use volgraph_shader::{LinkRequest, Linked, MemoryFiles, Module, ShaderRoots, check, link};

/// Files in memory, by path, with the folder `shaders` as root.
pub struct Files(pub Vec<(&'static str, String)>);

impl Files {
    /// These files.
    pub fn new(files: &[(&'static str, &str)]) -> Self {
        Self(
            files
                .iter()
                .map(|(path, text)| (*path, (*text).to_owned()))
                .collect(),
        )
    }

    /// One file, `shaders/a.wgsl`.
    pub fn one(text: &str) -> Self {
        Self::new(&[("shaders/a.wgsl", text)])
    }

    /// Where they are looked for.
    pub fn roots(&self) -> ShaderRoots {
        let memory = self
            .0
            .iter()
            .fold(MemoryFiles::new(), |memory, (path, text)| {
                memory.with(path, text)
            });
        ShaderRoots::new(Arc::new(memory)).root("shaders")
    }

    /// Links `a.wgsl`.
    pub fn link(&self) -> Result<Linked, Findings> {
        link(&self.roots(), &LinkRequest::new("a.wgsl"))
    }

    /// Links and checks `a.wgsl`.
    pub fn check(&self) -> Result<Module, Findings> {
        check(self.link()?, Capabilities::default())
    }

    /// The place of the first `needle` in a file, of its own length.
    pub fn place(&self, path: &str, needle: &str) -> Place {
        let (_, text) = self
            .0
            .iter()
            .find(|(known, _)| *known == path)
            .expect("a file of the test");
        let start = text
            .find(needle)
            .unwrap_or_else(|| panic!("`{needle}` is not in {path}"));
        Place::in_text(Path::new(path), text, start, needle.len())
    }
}

/// The one finding there is.
pub fn only<T>(result: Result<T, Findings>) -> Finding {
    let findings = result.err().expect("findings");
    assert_eq!(findings.len(), 1, "{findings}");
    findings.sorted()[0].clone()
}

/// The codes of all findings, in the order of their places.
pub fn codes<T>(result: Result<T, Findings>) -> Vec<&'static str> {
    let findings = result.err().expect("findings");
    findings
        .sorted()
        .iter()
        .map(|finding| finding.code)
        .collect()
}

/// File, line and column; naga's lengths are its own matter.
pub fn start(place: &Place) -> (String, u32, u32) {
    (place.file.display().to_string(), place.line, place.column)
}

/// That the finding has this code and starts where `needle` first stands in the file.
#[track_caller]
pub fn assert_at(finding: &Finding, code: &str, files: &Files, path: &str, needle: &str) {
    assert_eq!(finding.code, code, "{finding}");
    let place = finding.place.as_ref().expect("a place");
    assert_eq!(start(place), start(&files.place(path, needle)), "{finding}");
}
