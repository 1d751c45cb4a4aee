//! Writes a set of files into a folder: all of them or none, and nothing over what is there.
//!
//! The way of the data: all targets are looked at first, and every one that is there is a finding. The contents are
//! then written under other names beside their targets, and only when all are whole are they given their names. What
//! fails on the way takes back what was made, folders included. Pages and reports, which are made again and again, are
//! replaced one by one ([`whole`]).

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;
use volgraph::{Finding, Findings, Place};

/// Files by their paths from a folder.
pub type Files<'f> = [(PathBuf, &'f [u8])];

/// What is done with files that are there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Existing {
    /// They stay, and nothing is written.
    Kept,
    /// The same; the command has `--force`.
    KeptUnlessForced,
    /// They are replaced, file by file; folders never are.
    Replaced,
}

/// Writes them, and gives their paths.
///
/// # Errors
/// `file-exists` for each that is there, or `io`.
pub fn files(
    folder: &Path,
    files: &Files<'_>,
    existing: Existing,
) -> Result<Vec<PathBuf>, Findings> {
    let targets: Vec<PathBuf> = files
        .iter()
        .map(|(path, _)| match folder.join(path).strip_prefix(".") {
            Ok(below) => below.to_path_buf(),
            Err(_) => folder.join(path),
        })
        .collect();
    let replace = existing == Existing::Replaced;
    let findings: Findings = targets
        .iter()
        .filter(|target| fs::symlink_metadata(target).is_ok())
        .filter(|target| !replace || target.is_dir())
        .map(|target| exists(target, existing))
        .collect();
    let mut made = Made::default();
    let written = findings
        .into_result(())
        .and_then(|()| made.all(&targets, files, existing));
    if written.is_err() {
        made.take_back();
    }
    written.map(|()| targets)
}

/// Writes a file, in the place of one that is there: an interrupt leaves the old one or the new one, whole.
///
/// # Errors
/// `io`; `file-exists` for a folder of that name.
pub fn whole(file: &Path, content: impl AsRef<[u8]>) -> Result<(), Findings> {
    let name = PathBuf::from(file.file_name().unwrap_or_default());
    let folder = file.parent().unwrap_or(Path::new("."));
    files(folder, &[(name, content.as_ref())], Existing::Replaced).map(|_| ())
}

/// Makes a folder with those that it is in, where it is not there.
///
/// # Errors
/// `io`.
pub fn folder(folder: &Path) -> Result<(), Findings> {
    fs::create_dir_all(folder).map_err(|error| failed(folder, &error))
}

fn exists(target: &Path, existing: Existing) -> Finding {
    let help = match existing {
        Existing::KeptUnlessForced => {
            "use another folder, or `--force` to replace it; nothing was written"
        }
        _ => "use another name or folder, or move it away; nothing was written",
    };
    Finding::error("file-exists", "it is there already, and is left as it is")
        .at(Place::whole_file(target))
        .help(help)
}

/// What was made so far.
#[derive(Default)]
struct Made {
    folders: Vec<PathBuf>,
    files: Vec<PathBuf>,
}

impl Made {
    fn all(
        &mut self,
        targets: &[PathBuf],
        files: &Files<'_>,
        existing: Existing,
    ) -> Result<(), Findings> {
        let replace = existing == Existing::Replaced;
        let mut staged = Vec::new();
        for (target, (_, content)) in targets.iter().zip(files) {
            let stage = self.stage(target, content);
            staged.push(stage.map_err(|error| failed(target, &error))?);
        }
        for (target, stage) in targets.iter().zip(staged) {
            let persisted = if replace {
                stage.persist(target)
            } else {
                stage.persist_noclobber(target)
            };
            match persisted {
                // What was replaced cannot be taken back.
                Ok(_) if replace => {}
                Ok(_) => self.files.push(target.clone()),
                Err(error) if error.error.kind() == std::io::ErrorKind::AlreadyExists => {
                    return Err(exists(target, existing).into());
                }
                Err(error) => return Err(failed(target, &error.error)),
            }
        }
        Ok(())
    }

    fn stage(&mut self, target: &Path, content: &[u8]) -> std::io::Result<NamedTempFile> {
        let folder = match target.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder,
            _ => Path::new("."),
        };
        let missing: Vec<&Path> = folder
            .ancestors()
            .take_while(|folder| !folder.as_os_str().is_empty() && !folder.exists())
            .collect();
        for folder in missing.into_iter().rev() {
            fs::create_dir(folder)?;
            self.folders.push(folder.to_path_buf());
        }
        let mut builder = tempfile::Builder::new();
        // As any new file: what the user's mask leaves of this.
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        let mut file = builder.prefix(".volgraph-").tempfile_in(folder)?;
        file.write_all(content)?;
        file.as_file().sync_all()?;
        Ok(file)
    }

    /// The first error is the one to tell; a folder that others have used meanwhile stays.
    fn take_back(&self) {
        for file in &self.files {
            let _ = fs::remove_file(file);
        }
        for folder in self.folders.iter().rev() {
            let _ = fs::remove_dir(folder);
        }
    }
}

fn failed(target: &Path, error: &std::io::Error) -> Findings {
    Finding::error("io", format!("it cannot be written: {error}"))
        .at(Place::whole_file(target))
        .help("check the folder and your permissions")
        .into()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn set() -> [(PathBuf, &'static [u8]); 3] {
        [
            (PathBuf::from("a.ron"), b"a"),
            (PathBuf::from("deep/er/b.ron"), b"b"),
            (PathBuf::from("deep/c.ron"), b"c"),
        ]
    }

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap();
        let mut names: Vec<String> = entries
            .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn all_files_are_written_with_their_folders() {
        let scratch = tempfile::tempdir().unwrap();
        let folder = scratch.path().join("new");
        let written = files(&folder, &set(), Existing::Kept).unwrap();
        assert_eq!(written[1], folder.join("deep/er/b.ron"));
        assert_eq!(fs::read(&written[1]).unwrap(), b"b");
        assert_eq!(names(&folder), ["a.ron", "deep"], "no other file is left");
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            let plain = scratch.path().join("plain");
            fs::write(&plain, "").unwrap();
            let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode();
            assert_eq!(mode(&written[0]), mode(&plain));
        }
    }

    #[test]
    fn what_is_there_is_told_in_full_and_nothing_is_written() {
        let scratch = tempfile::tempdir().unwrap();
        fs::write(scratch.path().join("a.ron"), "mine").unwrap();
        fs::create_dir(scratch.path().join("deep")).unwrap();
        // A folder of the name is in the way as well, and so is a link that leads nowhere.
        fs::create_dir(scratch.path().join("deep/c.ron")).unwrap();
        let findings = files(scratch.path(), &set(), Existing::Kept).unwrap_err();
        let told: Vec<_> = findings
            .sorted()
            .iter()
            .map(|finding| finding.code)
            .collect();
        assert_eq!(told, ["file-exists", "file-exists"], "{findings}");
        assert_eq!(fs::read(scratch.path().join("a.ron")).unwrap(), b"mine");
        assert_eq!(names(scratch.path()), ["a.ron", "deep"]);
        assert_eq!(names(&scratch.path().join("deep")), ["c.ron"]);
        // Forced, a file is replaced; a folder never is.
        assert!(files(scratch.path(), &set(), Existing::Replaced).is_err());
        fs::remove_dir(scratch.path().join("deep/c.ron")).unwrap();
        files(scratch.path(), &set(), Existing::Replaced).unwrap();
        assert_eq!(fs::read(scratch.path().join("a.ron")).unwrap(), b"a");
    }

    #[test]
    fn what_fails_on_the_way_leaves_nothing() {
        let scratch = tempfile::tempdir().unwrap();
        // The second file's folder cannot be made: a file is in its place.
        fs::write(scratch.path().join("file"), "").unwrap();
        let set: [(PathBuf, &[u8]); 2] = [
            (PathBuf::from("new/a.ron"), b"a"),
            (PathBuf::from("file/b.ron"), b"b"),
        ];
        let findings = files(scratch.path(), &set, Existing::Kept).unwrap_err();
        assert_eq!(findings.sorted()[0].code, "io", "{findings}");
        assert_eq!(names(scratch.path()), ["file"]);
    }
}
