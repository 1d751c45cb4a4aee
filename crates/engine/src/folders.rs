//! Files below folders: what commands find that are given one.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use volgraph_report::{Finding, Findings, Place};

/// Folders deeper than this are not searched.
const MAX_DEPTH: usize = 64;

/// Adds the files below a folder that are wanted, in no order. Hidden folders are passed over, and links to folders: they
/// may lead back to where they lie. What cannot be read is told (`io`).
pub fn search(
    folder: &Path,
    is_wanted: &dyn Fn(&Path) -> io::Result<bool>,
    files: &mut Vec<PathBuf>,
    findings: &mut Findings,
) {
    search_to(folder, MAX_DEPTH, is_wanted, files, findings);
}

fn search_to(
    folder: &Path,
    depth: usize,
    is_wanted: &dyn Fn(&Path) -> io::Result<bool>,
    files: &mut Vec<PathBuf>,
    findings: &mut Findings,
) {
    let entries = match fs::read_dir(folder) {
        Ok(entries) => entries,
        Err(error) => return findings.push(unreadable(folder, &error)),
    };
    for entry in entries.flatten() {
        let path = entry.path();
        let is_hidden = entry.file_name().to_string_lossy().starts_with('.');
        let is_folder = entry.file_type().is_ok_and(|kind| kind.is_dir());
        if is_folder && !is_hidden && depth > 0 {
            search_to(&path, depth - 1, is_wanted, files, findings);
        } else if !is_folder {
            match is_wanted(&path) {
                Ok(true) => files.push(path),
                Ok(false) => {}
                Err(error) => findings.push(unreadable(&path, &error)),
            }
        }
    }
}

/// Why a file or folder is left out.
#[must_use]
pub fn unreadable(path: &Path, error: &io::Error) -> Finding {
    Finding::error("io", format!("it cannot be read: {error}"))
        .at(Place::whole_file(path))
        .help("check that the path is right and that you may read it")
}
