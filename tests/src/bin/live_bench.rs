//! From a save to the picture on disk: drives a `volgraph watch` through edits and prints each stage's p50 and p95.
//!
//! `live_bench VOLGRAPH [EDITS]`: the binary to drive, and how many edits of each file (50). The scene is the quickstart
//! at 256², once in the fragment stage; the edited files are copies beside the graph: a technique, and the library
//! `lib/ray.wgsl`, which every technique imports. Each edit is a text that no driver has seen before.

#![expect(
    clippy::unwrap_used,
    reason = "a tool of the repository fails by panicking"
)]
#![expect(clippy::print_stdout, reason = "a table is what it is for")]

use std::io::{BufRead, BufReader, Lines};
use std::path::Path;
use std::process::{Child, ChildStdout, Command, Stdio};

use serde_json::Value;
use volgraph_tests::root;

const STAGES: [&str; 9] = [
    "read_ms",
    "link_ms",
    "validate_ms",
    "plan_ms",
    "module_ms",
    "pipeline_ms",
    "allocate_ms",
    "draw_ms",
    "read_back_ms",
];

fn main() {
    let mut args = std::env::args().skip(1);
    let volgraph = args
        .next()
        .unwrap_or_else(|| panic!("name the volgraph binary to drive"));
    let edits: usize = args.next().map_or(50, |n| n.parse().unwrap());
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let copy = |from: &str, to: &str| {
        let to = path.join(to);
        std::fs::create_dir_all(to.parent().unwrap()).unwrap();
        std::fs::copy(root().join(from), to).unwrap();
    };
    copy("graphs/quickstart.ron", "quickstart.ron");
    copy("graphs/transfer/molecule.ron", "transfer/molecule.ron");
    copy(
        "shaders/slot/technique/dvr.wgsl",
        "slot/technique/edited.wgsl",
    );
    copy("shaders/lib/ray.wgsl", "lib/ray.wgsl");
    let mut watch = Watch::start(&volgraph, path);
    println!("{}", watch.next("open")["adapter"]);
    watch.next("watching");
    for (what, file, find) in [
        (
            "a technique",
            "slot/technique/edited.wgsl",
            "light_segment(",
        ),
        (
            "a library that every technique imports",
            "lib/ray.wgsl",
            "0.5 * segment.length",
        ),
    ] {
        let text = std::fs::read_to_string(path.join(file)).unwrap();
        assert!(text.contains(find), "{file} has no `{find}`");
        let mut events = Vec::new();
        for edit in 0..edits {
            let factor = 1.0 - 1e-3 * (edit as f64 + 1.0) / edits as f64;
            let edited = text.replacen(find, &format!("{factor:.9} * {find}"), 1);
            std::fs::write(path.join(file), edited).unwrap();
            events.push(watch.next("picture"));
            watch.next("watching");
        }
        table(what, &events);
        std::fs::write(path.join(file), text).unwrap();
        watch.next("picture");
        watch.next("watching");
    }
}

fn table(what: &str, events: &[Value]) {
    println!("\n{} edits of {what}, ms", events.len());
    println!("{:<14}{:>8}{:>8}", "stage", "p50", "p95");
    let row = |name: &str, value: &dyn Fn(&Value) -> f64| {
        let mut values: Vec<f64> = events.iter().map(value).collect();
        values.sort_by(f64::total_cmp);
        // Nearest rank.
        let percentile = |p: usize| values[(values.len() * p).div_ceil(100) - 1];
        println!("{name:<14}{:>8.2}{:>8.2}", percentile(50), percentile(95));
    };
    let number = |value: &Value| value.as_f64().unwrap();
    row("settle", &|event| number(&event["settle_ms"]));
    for stage in STAGES {
        let name = stage.trim_end_matches("_ms").replace('_', " ");
        row(&name, &|event| number(&event["change"]["stages"][stage]));
    }
    row("save", &|event| number(&event["save_ms"]));
    row("volgraph's own", &|event| number(&event["own_ms"]));
    row("all", &|event| number(&event["total_ms"]));
    let built: usize = events
        .iter()
        .map(|event| event["change"]["pipelines_built"].as_array().unwrap().len())
        .sum();
    println!("{built} pipelines built");
}

struct Watch {
    child: Child,
    lines: Lines<BufReader<ChildStdout>>,
}

impl Watch {
    fn start(volgraph: &str, folder: &Path) -> Self {
        let volgraph = std::path::absolute(volgraph).unwrap();
        let mut child = Command::new(volgraph)
            .args(["watch", "quickstart.ron", "-o", "out.png", "--json"])
            .args(["--size", "256x256", "--set", "image.stage=fragment"])
            .args(["--set", "image.slots.technique=edited"])
            .current_dir(folder)
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let lines = BufReader::new(child.stdout.take().unwrap()).lines();
        Self { child, lines }
    }

    fn next(&mut self, event: &str) -> Value {
        loop {
            let line = self
                .lines
                .next()
                .unwrap_or_else(|| panic!("it ended"))
                .unwrap();
            let value: Value = serde_json::from_str(&line).unwrap();
            if value["event"] == event {
                return value;
            }
            assert_ne!(value["event"], "refused", "{value}");
        }
    }
}

impl Drop for Watch {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
