//! Small Zarr folders by zarr-python.

use std::fs;
use std::path::{Path, PathBuf};

use super::{table, unhex};

/// Case, path and bytes of their files (`make_zarr.py`).
pub const FILES: &str = include_str!("../zarr_files.tsv");

/// Writes the folders of one case, or of all.
pub fn unpack(folder: &Path, case: Option<&str>) {
    for row in table(FILES) {
        if case.is_none_or(|case| case == row["case"]) {
            let path = folder.join(row["case"]).join(row["path"]);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, unhex(row["hex"])).unwrap();
        }
    }
}

pub fn one(case: &str) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    unpack(folder.path(), Some(case));
    let path = folder.path().join(case);
    (folder, path)
}
