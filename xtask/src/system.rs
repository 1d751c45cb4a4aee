//! What machine this is: the family of its packages, and whether they may be installed.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::steps::{output_of, succeeds};

/// How packages are installed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Family {
    /// apt-get
    Debian,
    /// dnf
    Fedora,
    /// pacman
    Arch,
    /// Not known here.
    Other,
}

/// In whose name packages are installed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rights {
    /// One is root.
    Root,
    /// sudo asks for no password.
    Sudo,
    /// Neither.
    None,
}

/// The machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct System {
    /// Its packages.
    pub family: Family,
    /// Whether they may be installed.
    pub rights: Rights,
}

impl System {
    /// Looks.
    pub fn look() -> Self {
        let text = std::fs::read_to_string("/etc/os-release");
        let text = text.or_else(|_| std::fs::read_to_string("/usr/lib/os-release"));
        let is_root = output_of(Command::new("id").arg("-u")).is_some_and(|id| id.trim() == "0");
        let rights = if is_root {
            Rights::Root
        } else if succeeds(Command::new("sudo").args(["-n", "true"])) {
            Rights::Sudo
        } else {
            Rights::None
        };
        Self {
            family: family(&text.unwrap_or_default()),
            rights,
        }
    }
}

/// The family that a text of os-release(5) tells, by `ID` and then by `ID_LIKE`.
pub fn family(os_release: &str) -> Family {
    let value = |key: &str| {
        let line = os_release
            .lines()
            .find_map(|line| line.trim().strip_prefix(key)?.strip_prefix('='));
        line.unwrap_or("")
            .trim_matches(['"', '\''])
            .to_ascii_lowercase()
    };
    let names = format!("{} {}", value("ID"), value("ID_LIKE"));
    for name in names.split_whitespace() {
        match name {
            "debian" | "ubuntu" => return Family::Debian,
            "fedora" | "rhel" | "centos" => return Family::Fedora,
            "arch" => return Family::Arch,
            _ => {}
        }
    }
    Family::Other
}

/// The first of these programs that is in the path.
pub fn find_program(names: &[&str]) -> Option<PathBuf> {
    let path = std::env::var_os("PATH")?;
    find_in(std::env::split_paths(&path), names)
}

fn find_in(folders: impl Iterator<Item = PathBuf>, names: &[&str]) -> Option<PathBuf> {
    let folders: Vec<PathBuf> = folders.collect();
    let is_there = |path: &Path| path.is_file();
    names
        .iter()
        .flat_map(|name| folders.iter().map(move |folder| folder.join(name)))
        .find(|path| is_there(path))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn families_are_told_by_id_and_by_likeness() {
        for (text, expected) in [
            ("NAME=\"Debian GNU/Linux\"\nID=debian\n", Family::Debian),
            ("ID=ubuntu\nID_LIKE=debian\n", Family::Debian),
            ("ID=linuxmint\nID_LIKE=\"ubuntu debian\"\n", Family::Debian),
            ("ID='fedora'\n", Family::Fedora),
            (
                "ID=\"rocky\"\nID_LIKE=\"rhel centos fedora\"\n",
                Family::Fedora,
            ),
            ("ID=manjaro\nID_LIKE=arch\n", Family::Arch),
            ("ID=alpine\n", Family::Other),
            // Keys that only begin alike say nothing.
            ("VERSION_ID=debian\nID_OF=debian\n", Family::Other),
            ("", Family::Other),
        ] {
            assert_eq!(family(text), expected, "{text}");
        }
    }

    #[cfg(unix)]
    #[test]
    fn programs_are_found_in_the_order_of_their_names() {
        let folders = || {
            ["/no/such/folder", "/bin", "/usr/bin"]
                .map(PathBuf::from)
                .into_iter()
        };
        let found = find_in(folders(), &["no-such-program-as-this", "sh", "ls"]);
        assert!(found.is_some_and(|path| path.ends_with("sh")));
        assert_eq!(find_in(folders(), &["no-such-program-as-this"]), None);
    }
}
