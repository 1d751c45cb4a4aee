//! The command line as people and machines meet it: exit codes, what is printed where, and that it always ends.

#![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

mod animate;
mod bad_input;
mod bench;
mod breaks;
mod bricks;
mod cases;
mod chart;
mod commands;
mod convert;
mod gallery;
mod link;
mod new;
mod planted;
mod ray;
mod reference;
mod set;
mod stress;
mod time;
mod verify;
mod view;
mod watch;

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::mpsc;
use std::time::Duration;

/// A run that takes longer hangs.
const PATIENCE: Duration = Duration::from_secs(120);

/// A folder of its own for a case.
struct Scratch(tempfile::TempDir);

impl Scratch {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn path(&self) -> &Path {
        self.0.path()
    }

    fn write(&self, name: &str, content: impl AsRef<[u8]>) -> PathBuf {
        let path = self.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(&path, content).unwrap();
        path
    }

    /// Runs volgraph in this folder.
    fn run(&self, args: &[&str]) -> Run {
        self.run_in(args, &[])
    }

    /// The same with these environment variables.
    fn run_in(&self, args: &[&str], variables: &[(&str, &str)]) -> Run {
        let child = Command::new(env!("CARGO_BIN_EXE_volgraph"))
            .args(args)
            .current_dir(self.path())
            .env_remove("VOLGRAPH_SHADERS")
            .env_remove("VOLGRAPH_DATA")
            .env_remove("VOLGRAPH_ADAPTER")
            .env("VOLGRAPH_CACHE", self.path().join("cache"))
            .envs(variables.iter().copied())
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let (sender, receiver) = mpsc::channel();
        std::thread::spawn(move || sender.send(child.wait_with_output()));
        let output = receiver
            .recv_timeout(PATIENCE)
            .unwrap_or_else(|_| panic!("{args:?} hangs"))
            .unwrap();
        let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
        let run = Run {
            code: output.status.code(),
            stdout: text(output.stdout),
            stderr: text(output.stderr),
        };
        assert!(!run.stderr.contains("panicked"), "{args:?}: {}", run.stderr);
        run
    }
}

/// What a run came to.
#[derive(Debug)]
struct Run {
    code: Option<i32>,
    stdout: String,
    stderr: String,
}

impl Run {
    fn json(&self) -> serde_json::Value {
        serde_json::from_str(&self.stdout).unwrap_or_else(|error| panic!("{error} in {self:?}"))
    }
}

/// The repository's root.
fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../..")
        .canonicalize()
        .unwrap()
}

/// The ready graphs that lie in this folder of the repository, by name.
fn graphs_in(folder: &str) -> Vec<String> {
    let files = std::fs::read_dir(root().join(folder)).unwrap();
    let files = files.map(|entry| entry.unwrap().path());
    let mut names: Vec<String> = files
        .filter(|path| path.is_file())
        .map(|path| path.file_stem().unwrap().to_str().unwrap().to_owned())
        .collect();
    names.sort();
    names
}

/// Copies a folder of the repository.
fn copy(name: &str, to: &Path) {
    fn copy_folder(from: &Path, to: &Path) {
        std::fs::create_dir_all(to).unwrap();
        for entry in std::fs::read_dir(from).unwrap() {
            let entry = entry.unwrap();
            let target = to.join(entry.file_name());
            if entry.file_type().unwrap().is_dir() {
                copy_folder(&entry.path(), &target);
            } else {
                std::fs::copy(entry.path(), target).unwrap();
            }
        }
    }
    copy_folder(&root().join(name), &to.join(name));
}

/// A transfer function that fits anything.
const TRANSFER: &str = "(color: (1, 1, 1), opacity: [(0, 0), (1, 0.5)])\n";

/// A graph of one raycast over the source `"v"`, given as RON.
fn graph(volume: &str) -> String {
    format!(
        r#"(
    sources: {{
        "v": {volume},
        "t": transfer(path: "t.ron"),
    }},
    nodes: {{
        "box": (kind: "proxy_box", in: {{ "volume": "v" }}),
        "image": (kind: "raycast", in: {{ "volume": "v", "transfer": "t", "rays": "box" }}),
    }},
    outputs: {{ "color": "image.color" }},
)
"#
    )
}

/// A volume that needs no file.
const SPHERE: &str = r#"analytic(field: "sphere", dims: (8, 8, 8))"#;
