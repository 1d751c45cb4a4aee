//! Makes sure that building and running volgraph can work on this machine.
//!
//! The way of the data: a look at the machine gives the [`Need`]s that it does not meet; [`remedy`] decides from
//! those, the [`System`] and the packages that are there what to do: nothing, run commands, or tell the user what
//! to run. What is there is never installed again, and nothing is said to work that was not seen to.

use std::path::Path;
use std::process::Command;

use crate::steps::{Failure, Steps, output_of, tell};
use crate::system::{Family, Rights, System, find_program};

/// What a machine can lack.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Need {
    /// A C++ compiler: the FLIP metric is C++.
    Compiler,
    /// An adapter: a GPU with its driver, or software Vulkan.
    Adapter,
}

impl Need {
    /// What is missing, in a sentence.
    fn missing(self) -> &'static str {
        match self {
            Self::Compiler => {
                "there is no C++ compiler (`c++`), which the FLIP metric is built with"
            }
            Self::Adapter => {
                "there is no adapter: neither a GPU with a Vulkan or GL driver, nor a software one"
            }
        }
    }

    /// The packages that meet it.
    fn packages(self, family: Family) -> &'static [&'static str] {
        match (self, family) {
            (Self::Compiler, Family::Debian) => &["g++"],
            (Self::Compiler, Family::Fedora) => &["gcc-c++"],
            (Self::Compiler, Family::Arch) => &["gcc"],
            (Self::Adapter, Family::Debian) => &["libvulkan1", "mesa-vulkan-drivers"],
            (Self::Adapter, Family::Fedora) => &["vulkan-loader", "mesa-vulkan-drivers"],
            (Self::Adapter, Family::Arch) => &["vulkan-icd-loader", "vulkan-swrast"],
            (Self::Compiler | Self::Adapter, Family::Other) => &[],
        }
    }
}

/// What to do about a need.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Remedy {
    /// Run these, one after the other.
    Run(Vec<Vec<String>>),
    /// Tell this.
    Tell(String),
}

/// Decides what to do about a need that is not met. `has` says whether a package is installed.
pub fn remedy(need: Need, system: System, may_install: bool, has: impl Fn(&str) -> bool) -> Remedy {
    let missing = need.missing();
    let all = need.packages(system.family);
    if all.is_empty() {
        let what = match need {
            Need::Compiler => "a C++ compiler, as `c++` in the path or named by CXX",
            Need::Adapter => {
                "a Vulkan driver for your GPU, or Mesa's software Vulkan (lavapipe) and the Vulkan loader"
            }
        };
        return Remedy::Tell(format!("{missing}; install {what}"));
    }
    let packages: Vec<&str> = all
        .iter()
        .copied()
        .filter(|package| !has(package))
        .collect();
    if packages.is_empty() {
        return Remedy::Tell(format!(
            "{missing}, although these packages are installed: {}",
            all.join(" ")
        ));
    }
    let words = |line: &str| -> Vec<String> { line.split(' ').map(str::to_owned).collect() };
    let packages = packages.join(" ");
    let commands = match system.family {
        Family::Debian => vec![
            "apt-get update".to_owned(),
            format!("apt-get install --yes --no-install-recommends {packages}"),
        ],
        Family::Fedora => vec![format!("dnf install {packages}")],
        Family::Arch | Family::Other => vec![format!("pacman -S --needed {packages}")],
    };
    let installs = may_install && system.family == Family::Debian && system.rights != Rights::None;
    if installs {
        let prefix = if system.rights == Rights::Sudo {
            "sudo -n "
        } else {
            ""
        };
        let with = |command: &String| {
            words(&format!(
                "{prefix}env DEBIAN_FRONTEND=noninteractive {command}"
            ))
        };
        return Remedy::Run(commands.iter().map(with).collect());
    }
    let prefix = if system.rights == Rights::Root {
        ""
    } else {
        "sudo "
    };
    let typed: Vec<String> = commands
        .iter()
        .map(|command| format!("{prefix}{command}"))
        .collect();
    let why = match (may_install, system.family) {
        (false, _) => "nothing is installed here, as asked",
        (true, Family::Debian) => "it cannot be installed from here without a password",
        (true, _) => "on this system it is left to you",
    };
    Remedy::Tell(format!(
        "{missing}; {why}. Run this, then try again:\n  {}",
        typed.join(" && ")
    ))
}

/// Makes sure that there is a C++ compiler.
///
/// # Errors
/// Where there is none and none could be installed.
pub fn compiler(steps: &mut Steps, may_install: bool) -> Result<(), Failure> {
    let is_there = || std::env::var_os("CXX").is_some() || find_program(&["c++"]).is_some();
    // Windows has its own way to its compiler, which the build finds.
    if cfg!(windows) || is_there() {
        return Ok(());
    }
    meet(steps, Need::Compiler, may_install, is_there)
}

/// Makes sure that there is an adapter, as this volgraph sees it, and tells which.
///
/// # Errors
/// Where there is none and none could be installed.
pub fn adapter(steps: &mut Steps, may_install: bool, volgraph: &Path) -> Result<(), Failure> {
    let ask = |args: &[&str]| output_of(Command::new(volgraph).arg("adapters").args(args));
    let has_adapter = || lists_adapter(&ask(&["--json"]).unwrap_or_default());
    if !has_adapter() {
        meet(steps, Need::Adapter, may_install, has_adapter)?;
    }
    let list = ask(&[]).unwrap_or_default();
    tell(&format!(
        "xtask: adapters: {}",
        list.trim().replace('\n', "; ")
    ));
    Ok(())
}

/// Whether the JSON of `volgraph adapters --json`, a list, has an entry: each has a backend.
fn lists_adapter(json: &str) -> bool {
    json.contains("\"backend\":")
}

fn meet(
    steps: &mut Steps,
    need: Need,
    may_install: bool,
    is_met: impl Fn() -> bool,
) -> Result<(), Failure> {
    let system = System::look();
    match remedy(need, system, may_install, is_installed) {
        Remedy::Tell(text) => Err(Failure::new(format!("error: {text}"))),
        Remedy::Run(commands) => {
            tell(&format!("xtask: {}", need.missing()));
            for words in &commands {
                if let Some((program, args)) = words.split_first() {
                    steps
                        .run("install", Command::new(program).args(args))
                        .map_err(|failure| {
                            // What the user can do is the same as where nothing may be installed.
                            match remedy(
                                need,
                                System {
                                    rights: Rights::None,
                                    ..system
                                },
                                true,
                                is_installed,
                            ) {
                                Remedy::Tell(text) => {
                                    Failure::new(format!("{}\nerror: {text}", failure.text))
                                }
                                Remedy::Run(_) => failure,
                            }
                        })?;
                }
            }
            if is_met() {
                return Ok(());
            }
            Err(Failure::new(format!(
                "error: {}, not even after the installation",
                need.missing()
            )))
        }
    }
}

/// Whether a Debian package is installed.
fn is_installed(package: &str) -> bool {
    let status = output_of(Command::new("dpkg-query").args([
        "--show",
        "--showformat=${db:Status-Status}",
        package,
    ]));
    status.is_some_and(|status| status.trim() == "installed")
}

#[cfg(test)]
mod tests {
    use super::*;

    const DEBIAN_ROOT: System = System {
        family: Family::Debian,
        rights: Rights::Root,
    };

    fn told(remedy: Remedy) -> String {
        match remedy {
            Remedy::Tell(text) => text,
            Remedy::Run(commands) => panic!("would run {commands:?}"),
        }
    }

    fn lines(remedy: Remedy) -> Vec<String> {
        match remedy {
            Remedy::Run(commands) => commands.iter().map(|words| words.join(" ")).collect(),
            Remedy::Tell(text) => panic!("would tell {text}"),
        }
    }

    #[test]
    fn root_on_debian_installs_what_is_missing_and_only_that() {
        assert_eq!(
            lines(remedy(Need::Adapter, DEBIAN_ROOT, true, |_| false)),
            [
                "env DEBIAN_FRONTEND=noninteractive apt-get update",
                "env DEBIAN_FRONTEND=noninteractive apt-get install --yes --no-install-recommends libvulkan1 \
                 mesa-vulkan-drivers"
            ]
        );
        let with_loader = lines(remedy(Need::Adapter, DEBIAN_ROOT, true, |package| {
            package == "libvulkan1"
        }));
        assert!(with_loader[1].ends_with("--no-install-recommends mesa-vulkan-drivers"));
    }

    #[test]
    fn sudo_without_a_password_is_used() {
        let system = System {
            rights: Rights::Sudo,
            ..DEBIAN_ROOT
        };
        let commands = lines(remedy(Need::Compiler, system, true, |_| false));
        assert!(
            commands
                .iter()
                .all(|command| command.starts_with("sudo -n env DEBIAN_FRONTEND=noninteractive "))
        );
        assert!(commands[1].ends_with(" g++"));
    }

    #[test]
    fn who_may_not_install_is_told_the_exact_command() {
        let system = System {
            rights: Rights::None,
            ..DEBIAN_ROOT
        };
        let text = told(remedy(Need::Adapter, system, true, |_| false));
        assert!(text.contains("there is no adapter"));
        let command = "\n  sudo apt-get update && sudo apt-get install --yes --no-install-recommends libvulkan1 \
                       mesa-vulkan-drivers";
        assert!(text.ends_with(command), "{text}");
        let text = told(remedy(Need::Compiler, DEBIAN_ROOT, false, |_| false));
        assert!(
            text.contains("as asked")
                && text.ends_with(
                    "\n  apt-get update && apt-get install --yes --no-install-recommends g++"
                )
        );
    }

    #[test]
    fn nothing_is_installed_twice() {
        let text = told(remedy(Need::Adapter, DEBIAN_ROOT, true, |_| true));
        assert!(
            text.ends_with("although these packages are installed: libvulkan1 mesa-vulkan-drivers"),
            "{text}"
        );
    }

    #[test]
    fn other_systems_are_told_their_own_command_or_what_is_needed() {
        for (family, expected) in [
            (
                Family::Fedora,
                "sudo dnf install vulkan-loader mesa-vulkan-drivers",
            ),
            (
                Family::Arch,
                "sudo pacman -S --needed vulkan-icd-loader vulkan-swrast",
            ),
            (
                Family::Other,
                "Mesa's software Vulkan (lavapipe) and the Vulkan loader",
            ),
        ] {
            let text = told(remedy(
                Need::Adapter,
                System {
                    family,
                    rights: Rights::None,
                },
                true,
                |_| false,
            ));
            assert!(text.ends_with(expected), "{text}");
        }
    }

    #[test]
    fn an_empty_list_or_a_failure_is_no_adapter() {
        let one = r#"[ { "name": "llvmpipe", "backend": "vulkan", "class": "software" } ]"#;
        assert!(lists_adapter(one));
        for none in ["[]\n", "", r#"[{"name": "\"backend\":"}]"#] {
            assert!(!lists_adapter(none), "{none}");
        }
    }
}
