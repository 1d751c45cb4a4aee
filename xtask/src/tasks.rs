//! The tasks, each a list of steps.

use std::path::Path;
use std::process::Command;

use crate::args::{Task, USAGE};
use crate::fuzz;
use crate::gallery;
use crate::setup;
use crate::steps::{Failure, Steps, cargo, root, succeeds, tell, volgraph};

/// What makes volgraph. The whole workspace, so that features of dependencies are those of the tests' build, which
/// then finds all of them compiled.
const BUILD: &[&str] = &["build", "--workspace"];

/// Runs a task.
///
/// # Errors
/// Where a step failed.
pub fn run(task: Task) -> Result<(), Failure> {
    let mut steps = Steps::default();
    match task {
        Task::Help => {
            tell(USAGE);
            Ok(())
        }
        Task::Setup { may_install } => set_up(&mut steps, may_install, BUILD),
        Task::Render { may_install, args } => render(&mut steps, may_install, &args),
        Task::Test { may_install, args } => test(&mut steps, may_install, &args),
        Task::Check { may_install } => {
            check(&mut steps, may_install)?;
            tell(&steps.times());
            Ok(())
        }
        Task::Ci { may_install } => {
            check(&mut steps, may_install)?;
            test(&mut steps, may_install, &[])
        }
        Task::BenchLive { edits } => bench_live(&mut steps, edits),
        Task::Gallery => gallery::run(&mut steps),
        Task::Fuzz { seconds, targets } => fuzz::run(&mut steps, seconds, &targets),
    }
}

/// A compiler, then a build, which must make volgraph, then an adapter.
fn set_up(steps: &mut Steps, may_install: bool, build: &[&str]) -> Result<(), Failure> {
    setup::compiler(steps, may_install)?;
    steps.run("build", cargo().args(build))?;
    let volgraph = volgraph()
        .ok_or_else(|| Failure::new("error: the build made no volgraph beside this program"))?;
    setup::adapter(steps, may_install, &volgraph)
}

/// The development profile is enough: dependencies are optimised in full there, so that a frame takes as long as in
/// a release build, and the tests share the build.
fn render(steps: &mut Steps, may_install: bool, args: &[String]) -> Result<(), Failure> {
    set_up(steps, may_install, BUILD)?;
    let volgraph = volgraph().ok_or_else(|| Failure::new("error: there is no volgraph to run"))?;
    // In the user's folder: the arguments are paths from there.
    let mut command = Command::new(volgraph);
    match steps.run("render", command.arg("render").args(args)) {
        // volgraph has told why.
        Err(failure) => Err(Failure {
            text: String::new(),
            ..failure
        }),
        Ok(()) => Ok(()),
    }
}

/// With the release profile, as people run it.
fn bench_live(steps: &mut Steps, edits: u32) -> Result<(), Failure> {
    let packages = ["-p", "volgraph", "-p", "volgraph-tests"];
    let build = [
        "build",
        "--release",
        "--bin",
        "volgraph",
        "--bin",
        "live_bench",
    ];
    steps.run("build", cargo().args(build).args(packages))?;
    let built = target_dir().join("release");
    let mut bench = Command::new(built.join("live_bench"));
    bench.arg(built.join("volgraph")).arg(edits.to_string());
    steps.run("bench", &mut bench)
}

/// The documentation's examples first and the runner last, so that its summary is what one sees at the end.
fn test(steps: &mut Steps, may_install: bool, args: &[String]) -> Result<(), Failure> {
    set_up(
        steps,
        may_install,
        &["build", "--workspace", "--all-targets"],
    )?;
    if args.is_empty() {
        steps.run(
            "doc tests",
            cargo().args(["test", "--quiet", "--workspace", "--doc"]),
        )?;
    }
    tell(&steps.times());
    let has_nextest = succeeds(cargo().args(["nextest", "--version"]));
    steps.run("tests", cargo().args(runner(has_nextest, args)))
}

/// The arguments that make cargo run the tests. Packages that are named stand for the workspace.
fn runner(has_nextest: bool, args: &[String]) -> Vec<String> {
    let mut words = if has_nextest {
        vec!["nextest", "run"]
    } else {
        vec!["test"]
    };
    let names_package = |arg: &String| {
        arg.starts_with("--package") || (arg.starts_with("-p") && !arg.starts_with("--"))
    };
    if !args
        .iter()
        .take_while(|arg| *arg != "--")
        .any(names_package)
    {
        words.push("--workspace");
    }
    let has_targets = args
        .iter()
        .any(|arg| ["--test", "--lib", "--bin", "--bins", "--tests"].contains(&arg.as_str()));
    if !has_nextest && !has_targets {
        words.push("--all-targets");
    }
    if args.is_empty() {
        // All that is wrong in one run.
        words.push("--no-fail-fast");
    }
    words
        .into_iter()
        .map(str::to_owned)
        .chain(args.iter().cloned())
        .collect()
}

/// All that a compiler can say without running anything.
fn check(steps: &mut Steps, may_install: bool) -> Result<(), Failure> {
    steps.run("format", cargo().args(["fmt", "--all", "--check"]))?;
    steps.run(
        "fuzz format",
        cargo().args(["fmt", "--manifest-path", "fuzz/Cargo.toml", "--check"]),
    )?;
    setup::compiler(steps, may_install)?;
    let lints = ["--all-targets", "--", "-D", "warnings"];
    steps.run(
        "clippy",
        cargo().args(["clippy", "--workspace"]).args(lints),
    )?;
    // Their own workspace, the same build folder: most dependencies are compiled already.
    let fuzz = [
        "clippy",
        "--manifest-path",
        "fuzz/Cargo.toml",
        "--target-dir",
    ];
    steps.run(
        "fuzz clippy",
        cargo().args(fuzz).arg(target_dir()).args(lints),
    )?;
    let mut documentation = cargo();
    documentation
        .args(["doc", "--workspace", "--no-deps"])
        .env("RUSTDOCFLAGS", "-D warnings");
    steps.run("documentation", &mut documentation)
}

/// The build folder: this program lies in a profile's folder of it.
pub(crate) fn target_dir() -> std::path::PathBuf {
    let own = std::env::current_exe().ok();
    let folder = own.as_deref().and_then(Path::parent).and_then(Path::parent);
    folder.map_or_else(|| root().join("target"), Path::to_path_buf)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(has_nextest: bool, args: &str) -> String {
        let args: Vec<String> = args.split_whitespace().map(str::to_owned).collect();
        runner(has_nextest, &args).join(" ")
    }

    #[test]
    fn the_runner_is_nextest_where_it_is_there() {
        assert_eq!(line(true, ""), "nextest run --workspace --no-fail-fast");
        assert_eq!(
            line(false, ""),
            "test --workspace --all-targets --no-fail-fast"
        );
    }

    #[test]
    fn arguments_choose_packages_and_tests() {
        assert_eq!(
            line(true, "-p volgraph-graph camera"),
            "nextest run -p volgraph-graph camera"
        );
        assert_eq!(
            line(false, "--package=volgraph-graph"),
            "test --all-targets --package=volgraph-graph"
        );
        assert_eq!(line(true, "camera"), "nextest run --workspace camera");
        assert_eq!(line(false, "--lib -- -p"), "test --workspace --lib -- -p");
    }

    #[test]
    fn the_build_folder_is_that_of_this_program() {
        assert!(std::env::current_exe().is_ok_and(|own| own.starts_with(target_dir())));
    }
}
