//! Runs the fuzz targets, each for so long, with cargo-fuzz.

use std::path::Path;
use std::process::Command;

use crate::steps::{Failure, Steps, cargo, root, succeeds, tell};

/// An input that takes longer hangs, though sanitiser and debug assertions make a target several times slower than
/// it is.
const HANG_SECONDS: u32 = 5;

/// One allocation that no input of some KiB is worth.
const MALLOC_LIMIT_MB: u32 = 256;

/// The longest input, in bytes.
const LONGEST_INPUT: u32 = 4096;

/// Runs these targets, or all.
///
/// # Errors
/// Where cargo-fuzz is missing, a target is unknown, or an input made one fail.
pub fn run(steps: &mut Steps, seconds: u32, wanted: &[String]) -> Result<(), Failure> {
    if !succeeds(cargo().args(["fuzz", "--version"])) {
        return Err(Failure::new(
            "error: cargo-fuzz is missing. Run this, then try again:\n  cargo install cargo-fuzz",
        ));
    }
    let folder = root().join("fuzz");
    let targets = choose(&target_names(&folder)?, wanted)?;
    let has_nightly = succeeds(Command::new("cargo").args(["+nightly", "--version"]));
    let mut failed = Vec::new();
    for target in &targets {
        let corpus = folder.join("corpus").join(target);
        std::fs::create_dir_all(&corpus).map_err(|error| {
            Failure::new(format!(
                "error: {} cannot be made: {error}",
                corpus.display()
            ))
        })?;
        let mut command = Command::new("cargo");
        if has_nightly {
            command.arg("+nightly");
        } else {
            // The sanitiser's flags are unstable; the stable compiler knows them all the same.
            command.env("RUSTC_BOOTSTRAP", "1");
        }
        command.current_dir(root()).args(arguments(target, seconds));
        if steps.run("fuzz", &mut command).is_err() {
            failed.push(target.as_str());
        }
    }
    tell(&steps.times());
    if failed.is_empty() {
        tell(&format!(
            "xtask: no input made a target fail: {}",
            targets.join(", ")
        ));
        return Ok(());
    }
    Err(Failure::new(format!(
        "error: inputs made these targets fail: {}; they lie in fuzz/artifacts/TARGET",
        failed.join(", ")
    )))
}

/// What cargo-fuzz gets. New inputs go to the first folder, the corpus; the seeds are only read.
fn arguments(target: &str, seconds: u32) -> Vec<String> {
    let words = format!(
        "fuzz run {target} fuzz/corpus/{target} fuzz/seeds/{target} -- -max_total_time={seconds} \
         -timeout={HANG_SECONDS} -malloc_limit_mb={MALLOC_LIMIT_MB} -max_len={LONGEST_INPUT} \
         -dict=fuzz/dictionaries/{target}.dict -print_final_stats=1"
    );
    words.split(' ').map(str::to_owned).collect()
}

/// The targets that there are, sorted.
fn target_names(folder: &Path) -> Result<Vec<String>, Failure> {
    let folder = folder.join("fuzz_targets");
    let files = std::fs::read_dir(&folder).map_err(|error| {
        Failure::new(format!(
            "error: {} cannot be read: {error}",
            folder.display()
        ))
    })?;
    let mut names: Vec<String> = files
        .filter_map(|file| {
            Some(
                file.ok()?
                    .file_name()
                    .to_str()?
                    .strip_suffix(".rs")?
                    .to_owned(),
            )
        })
        .collect();
    names.sort();
    Ok(names)
}

fn choose(all: &[String], wanted: &[String]) -> Result<Vec<String>, Failure> {
    if let Some(unknown) = wanted.iter().find(|name| !all.contains(name)) {
        let text = format!(
            "error: there is no fuzz target `{unknown}`; there are {}",
            all.join(", ")
        );
        return Err(Failure { text, code: 2 });
    }
    Ok(if wanted.is_empty() {
        all.to_vec()
    } else {
        wanted.to_vec()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_target_has_seeds_and_words() {
        let folder = root().join("fuzz");
        let names = target_names(&folder).unwrap_or_default();
        assert!(names.len() >= 5, "{names:?}");
        for name in &names {
            let seeds = std::fs::read_dir(folder.join("seeds").join(name));
            assert!(
                seeds.is_ok_and(|files| files.count() > 0),
                "{name} has no seeds"
            );
            assert!(
                folder
                    .join("dictionaries")
                    .join(format!("{name}.dict"))
                    .is_file(),
                "{name} has no words"
            );
        }
    }

    #[test]
    fn targets_are_chosen_by_name() {
        let all = ["graph", "nrrd"].map(str::to_owned);
        assert_eq!(choose(&all, &[]), Ok(all.to_vec()));
        assert_eq!(choose(&all, &all[1..]), Ok(vec!["nrrd".to_owned()]));
        let unknown = choose(&all, &["nrd".to_owned()]);
        assert!(unknown.is_err_and(
            |failure| failure.text.ends_with("there are graph, nrrd") && failure.code == 2
        ));
    }

    #[test]
    fn each_run_has_its_limits() {
        let words = arguments("nrrd", 7);
        for limit in ["-max_total_time=7", "-timeout=5", "-malloc_limit_mb=256"] {
            assert!(words.iter().any(|word| word == limit), "{limit}");
        }
    }
}
