//! `cargo xtask gallery`: the README's pictures and list of ready graphs, from `volgraph gallery`.
//!
//! The way of the data: `volgraph gallery` writes pictures and `gallery.md` into docs/gallery; what stands between two
//! marks in the README becomes that list. Graphs of scans are left out, for their data is no part of volgraph.

use std::fs;
use std::path::Path;
use std::process::Command;

use crate::steps::{Failure, Steps, cargo, root};
use crate::tasks::target_dir;

const BEGIN: &str = "<!-- The list is made by `cargo xtask gallery`. -->\n";
const END: &str = "<!-- The end of the list. -->\n";

/// Makes them anew.
///
/// # Errors
/// Where a step failed, a file cannot be written, or the README has not both marks.
pub fn run(steps: &mut Steps) -> Result<(), Failure> {
    let root = root();
    let folder = root.join("docs/gallery");
    steps.run(
        "build",
        cargo().args(["build", "--release", "-p", "volgraph"]),
    )?;
    let mut gallery = Command::new(target_dir().join("release/volgraph"));
    gallery
        .args(["gallery", "--size", "320x320", "--frames", "1", "-o"])
        .arg(&folder)
        .current_dir(root)
        .env_remove("VOLGRAPH_DATA");
    steps.run("gallery", &mut gallery)?;
    let readme = root.join("README.md");
    let list = read(&folder.join("gallery.md"))?;
    let text = listed(&read(&readme)?, &list)
        .ok_or_else(|| Failure::new("error: README.md has not both marks of the list"))?;
    for file in ["gallery.md", "index.html"] {
        fs::remove_file(folder.join(file))
            .map_err(|error| Failure::new(format!("error: {file}: {error}")))?;
    }
    fs::write(&readme, text).map_err(|error| Failure::new(format!("error: README.md: {error}")))
}

fn read(path: &Path) -> Result<String, Failure> {
    fs::read_to_string(path)
        .map_err(|error| Failure::new(format!("error: {}: {error}", path.display())))
}

/// The README with this list between its marks; `None` where it lacks one.
fn listed(readme: &str, list: &str) -> Option<String> {
    let (before, rest) = readme.split_once(BEGIN)?;
    let (_, after) = rest.split_once(END)?;
    let list = list.replace("](", "](docs/gallery/");
    Some(format!("{before}{BEGIN}{list}{END}{after}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_list_takes_the_place_of_the_old_one() {
        let readme = format!("before\n{BEGIN}old\n{END}after\n");
        let expected = format!("before\n{BEGIN}![a](docs/gallery/a.png)\n{END}after\n");
        assert_eq!(listed(&readme, "![a](a.png)\n"), Some(expected));
        assert_eq!(listed("no marks", "list"), None);
    }
}
