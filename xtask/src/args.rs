//! The words of the command line.

/// What there is to do.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Task {
    /// Print the usage.
    Help,
    /// Make sure that building and running can work here.
    Setup {
        /// Whether what is missing may be installed.
        may_install: bool,
    },
    /// Render, after the set-up.
    Render {
        /// Whether what is missing may be installed.
        may_install: bool,
        /// What `volgraph render` gets.
        args: Vec<String>,
    },
    /// Run the tests, after the set-up.
    Test {
        /// Whether what is missing may be installed.
        may_install: bool,
        /// What the test runner gets.
        args: Vec<String>,
    },
    /// Format, lints, documentation.
    Check {
        /// Whether what is missing may be installed.
        may_install: bool,
    },
    /// Check, then test.
    Ci {
        /// Whether what is missing may be installed.
        may_install: bool,
    },
    /// Time from a save to the picture on disk, per stage.
    BenchLive {
        /// How many edits of each file.
        edits: u32,
    },
    /// The pictures and the list of ready graphs in the README, made anew.
    Gallery,
    /// Run fuzz targets.
    Fuzz {
        /// How long each runs.
        seconds: u32,
        /// Which; all where empty.
        targets: Vec<String>,
    },
}

/// The usage.
pub const USAGE: &str = "\
usage: cargo xtask COMMAND

  setup                   make sure that there are a C++ compiler and an adapter (GPU or software Vulkan)
  render GRAPH -o FILE …  set up, build, and run `volgraph render` with these arguments
  test [ARGUMENT…]        set up, build, and run all tests; arguments go to the test runner
  check                   format, clippy and documentation, warnings denied
  ci                      check, then test
  bench-live [EDITS]      time from a save to the picture on disk, per stage, over so many edits (50)
  gallery                 render the ready graphs that need no file into docs/gallery, and list them in the README
  fuzz [SECONDS] [TARGET…] run each fuzz target for so long (600 s)

`--no-install` behind setup, render, test, check or ci: install nothing, only say what is missing.";

const NO_INSTALL: &str = "--no-install";

impl Task {
    /// Reads the words behind `cargo xtask`.
    ///
    /// # Errors
    /// What is wrong with them.
    pub fn parse(words: &[String]) -> Result<Self, String> {
        let Some((command, rest)) = words.split_first() else {
            return Err("what is to be done?".to_owned());
        };
        let may_install = !rest.iter().any(|word| word == NO_INSTALL);
        let args: Vec<String> = rest
            .iter()
            .filter(|word| *word != NO_INSTALL)
            .cloned()
            .collect();
        let alone = |task: Self| match args.first() {
            None => Ok(task),
            Some(word) => Err(format!("`{command}` takes no `{word}`")),
        };
        match command.as_str() {
            "help" | "--help" | "-h" => Ok(Self::Help),
            "setup" => alone(Self::Setup { may_install }),
            "render" => Ok(Self::Render { may_install, args }),
            "test" => Ok(Self::Test { may_install, args }),
            "check" => alone(Self::Check { may_install }),
            "ci" => alone(Self::Ci { may_install }),
            "bench-live" => bench_live(&args),
            "gallery" => alone(Self::Gallery),
            "fuzz" => fuzz(&args),
            _ => Err(format!("there is no command `{command}`")),
        }
    }
}

fn bench_live(args: &[String]) -> Result<Task, String> {
    let edits = match args {
        [] => Some(50),
        [edits] => edits.parse().ok().filter(|edits| *edits > 0),
        _ => None,
    };
    let edits = edits.ok_or("behind `bench-live` comes at most a number of edits above 0")?;
    Ok(Task::BenchLive { edits })
}

fn fuzz(args: &[String]) -> Result<Task, String> {
    let (seconds, targets) = match args.split_first() {
        Some((first, rest)) if first.starts_with(|c: char| c.is_ascii_digit() || c == '-') => {
            let seconds = first.parse().ok().filter(|seconds| *seconds > 0);
            let seconds =
                seconds.ok_or_else(|| format!("`{first}` is no number of seconds above 0"))?;
            (seconds, rest)
        }
        _ => (600, args),
    };
    Ok(Task::Fuzz {
        seconds,
        targets: targets.to_vec(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(line: &str) -> Result<Task, String> {
        let words: Vec<String> = line.split_whitespace().map(str::to_owned).collect();
        Task::parse(&words)
    }

    fn words(line: &str) -> Vec<String> {
        line.split_whitespace().map(str::to_owned).collect()
    }

    #[test]
    fn arguments_go_on_to_what_is_run_and_the_own_option_does_not() {
        assert_eq!(
            parse("render graphs/quickstart.ron -o q.png"),
            Ok(Task::Render {
                may_install: true,
                args: words("graphs/quickstart.ron -o q.png")
            })
        );
        assert_eq!(
            parse("test --no-install -p volgraph-graph"),
            Ok(Task::Test {
                may_install: false,
                args: words("-p volgraph-graph")
            })
        );
        assert_eq!(
            parse("setup --no-install"),
            Ok(Task::Setup { may_install: false })
        );
    }

    #[test]
    fn fuzz_takes_seconds_and_targets() {
        let fuzz = |seconds, targets: &str| {
            Ok(Task::Fuzz {
                seconds,
                targets: words(targets),
            })
        };
        assert_eq!(parse("fuzz"), fuzz(600, ""));
        assert_eq!(parse("fuzz 5"), fuzz(5, ""));
        assert_eq!(parse("fuzz 5 nrrd graph"), fuzz(5, "nrrd graph"));
        assert_eq!(parse("fuzz nrrd"), fuzz(600, "nrrd"));
    }

    #[test]
    fn bench_live_takes_a_number_of_edits() {
        assert_eq!(parse("bench-live"), Ok(Task::BenchLive { edits: 50 }));
        assert_eq!(parse("bench-live 7"), Ok(Task::BenchLive { edits: 7 }));
    }

    #[test]
    fn wrong_words_are_refused() {
        for line in [
            "bench-live 0",
            "bench-live 5 5",
            "",
            "rander",
            "setup now",
            "check --fast",
            "ci x",
            "fuzz 0",
            "fuzz -1",
            "fuzz 5s",
        ] {
            assert!(parse(line).is_err(), "{line}");
        }
    }
}
