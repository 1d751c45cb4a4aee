//! `volgraph watch` as a process of its own, driven through the files alone: whatever way a file is saved, the picture
//! becomes what a fresh `volgraph render` makes of the same files, bit for bit (EXR: f32 colour, opacity, depth).

mod hazards;
mod truth;

use std::fs;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError};
use std::thread::sleep;
use std::time::Duration;

use serde_json::Value;
use volgraph_picture::Picture;

use crate::{PATIENCE, Scratch};

/// Longer than an editor takes between the two steps of a save, and shorter than the grace that it is given.
const PAUSE: Duration = Duration::from_millis(30);

/// A time in which nothing may happen where nothing changes.
const QUIET: Duration = Duration::from_millis(400);

const GRAPH: &str = r#"(
    sources: { "v": volume(path: "v_6x5x4_uint8.raw"), "t": transfer(path: "t.ron") },
    camera: orbit(azimuth: AZIMUTH, elevation: 20),
    nodes: {
        "box": (kind: "proxy_box", in: { "volume": "v" }),
        "image": (kind: "raycast", in: { "volume": "v", "transfer": "t", "rays": "box" },
                  slots: { "technique": "live" }, params: { "stage": "fragment" }),
    },
    outputs: { "color": "image.color" },
)
"#;

const TECHNIQUE: &str = r#"// A technique that is edited.
#import "lib/ray.wgsl"
#import "mine/near.wgsl"
// IMPORT
#import slot "classify"

struct TechniqueState { color: vec3f, transmittance: f32, }

fn technique_begin(ray: Ray) -> TechniqueState {
    return TechniqueState(vec3f(0.0), 1.0);
}

fn technique_segment(state: ptr<function, TechniqueState>, ray: ptr<function, Ray>, segment: Segment) -> bool {
    let classified = classify_segment(*ray, segment);
    (*state).color += FACTOR * near_factor() * (*state).transmittance * classified.color;
    (*state).transmittance *= classified.transmittance;
    return false;
}

fn technique_finish(state: TechniqueState, ray: Ray) -> RayResult {
    return RayResult(vec4f(state.color, 1.0 - state.transmittance), RAY_NO_DEPTH);
}
"#;

/// The files that are edited, and the content of each after so many edits.
const FILES: [&str; 6] = [
    "live",
    "mine/near.wgsl",
    "mine/new.wgsl",
    "graph.ron",
    "t.ron",
    "v_6x5x4_uint8.raw",
];

const TECHNIQUE_FILE: &str = "slot/technique/live.wgsl";

fn content(file: &str, edits: usize) -> Vec<u8> {
    let factor = format!("{:.3}", 0.5 + 0.037 * (edits % 13) as f64);
    match file {
        "live" => TECHNIQUE.replace("FACTOR", &factor).into_bytes(),
        // The edit that brings a new import.
        "live and new" => TECHNIQUE
            .replace("// IMPORT", "#import \"mine/new.wgsl\"")
            .replace("FACTOR", &format!("{factor} * new_factor()"))
            .into_bytes(),
        "mine/near.wgsl" => {
            format!("// Near.\nfn near_factor() -> f32 {{\n    return {factor};\n}}\n").into_bytes()
        }
        "mine/new.wgsl" => {
            format!("// New.\nfn new_factor() -> f32 {{\n    return {factor};\n}}\n").into_bytes()
        }
        "graph.ron" => GRAPH
            .replace("AZIMUTH", &format!("{}", 7 * (edits % 50)))
            .into_bytes(),
        "t.ron" => {
            format!("(color: (1, {factor}, 0.2), opacity: [(0, 0), (1, 0.5)])\n").into_bytes()
        }
        _ => (0..120)
            .map(|i| ((i * 37 + edits * 11) % 256) as u8)
            .collect(),
    }
}

/// The ways in which editors save.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Save {
    InPlace,
    TruncateThenWrite,
    RenameOver,
    DeleteAndCreate,
    Burst,
}

const SAVES: [Save; 5] = [
    Save::InPlace,
    Save::TruncateThenWrite,
    Save::RenameOver,
    Save::DeleteAndCreate,
    Save::Burst,
];

fn save(path: &Path, how: Save, content: &[u8]) {
    match how {
        Save::InPlace => fs::write(path, content).unwrap(),
        Save::TruncateThenWrite => {
            fs::write(path, []).unwrap();
            sleep(PAUSE);
            fs::write(path, content).unwrap();
        }
        Save::RenameOver => {
            let temporary = path.with_extension("swp");
            fs::write(&temporary, content).unwrap();
            fs::rename(&temporary, path).unwrap();
        }
        Save::DeleteAndCreate => {
            fs::remove_file(path).unwrap();
            sleep(PAUSE);
            fs::write(path, content).unwrap();
        }
        Save::Burst => {
            for cut in [content.len() / 3, content.len() / 2, content.len() - 1] {
                fs::write(path, &content[..cut]).unwrap();
                sleep(Duration::from_millis(2));
            }
            fs::write(path, content).unwrap();
        }
    }
}

/// A `volgraph watch` that runs; it ends with this.
struct Watch {
    child: Child,
    lines: Receiver<Value>,
    folder: PathBuf,
}

impl Watch {
    fn start(folder: &Path, more: &[&str]) -> Self {
        Self::start_text(folder, "graph.ron", &[&["--json"], more].concat())
    }

    /// Without JSON: what is told on standard output, line for line.
    fn start_text(folder: &Path, graph: &str, more: &[&str]) -> Self {
        let mut child = Command::new(env!("CARGO_BIN_EXE_volgraph"))
            .args(["watch", graph, "-o", "out.exr", "--size", "40x30"])
            .args(more)
            .current_dir(folder)
            // No truth is kept: each test's own folder is watched.
            .env("VOLGRAPH_CACHE", "")
            .env_remove("VOLGRAPH_SHADERS")
            .env_remove("VOLGRAPH_DATA")
            .env_remove("VOLGRAPH_ADAPTER")
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::inherit())
            .spawn()
            .unwrap();
        let stdout = BufReader::new(child.stdout.take().unwrap());
        let (sender, lines) = mpsc::channel();
        std::thread::spawn(move || {
            for line in stdout.lines().map_while(Result::ok) {
                let value = serde_json::from_str(&line).unwrap_or(Value::String(line));
                if sender.send(value).is_err() {
                    break;
                }
            }
        });
        Self {
            child,
            lines,
            folder: folder.to_path_buf(),
        }
    }

    /// The next event of this name.
    fn next(&self, event: &str) -> Value {
        self.next_of(event, "")
    }

    fn next_of(&self, event: &str, what: &str) -> Value {
        loop {
            let line = self
                .lines
                .recv_timeout(PATIENCE)
                .unwrap_or_else(|error| panic!("no `{event}` comes: {error}; {what}"));
            if line["event"] == event {
                return line;
            }
        }
    }

    /// Waits until the first picture is there and files are watched.
    fn begin(folder: &Path, more: &[&str]) -> Self {
        let watch = Self::start(folder, more);
        watch.next("watching");
        watch
    }

    /// Nothing is drawn or refused for a while, and nothing is looked at again and again.
    fn is_quiet(&self) {
        let mut heard = Vec::new();
        while heard.len() < 10 {
            match self.lines.recv_timeout(QUIET) {
                Err(RecvTimeoutError::Timeout) => return,
                Ok(line) if line["event"] == "unchanged" || line["event"] == "watching" => {
                    heard.push(line.to_string());
                }
                other => panic!("nothing changed, and yet {other:?}"),
            }
        }
        panic!("files are looked at again and again: {heard:?}");
    }

    /// Waits until the picture is that of a fresh render of what lies on disk. The last picture's event.
    fn draws_what_is_there(&self, what: &str, more: &[&str]) -> Value {
        let fresh = fresh(&self.folder, more);
        loop {
            let event = self.next_of("picture", what);
            let picture = Picture::load(&self.folder.join("out.exr")).unwrap();
            if picture.color == fresh.color
                && picture.depth == fresh.depth
                && picture.opacity == fresh.opacity
            {
                return event;
            }
            // A picture of half a save is followed by that of the whole.
        }
    }
}

impl Drop for Watch {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn fresh(folder: &Path, more: &[&str]) -> Picture {
    let status = Command::new(env!("CARGO_BIN_EXE_volgraph"))
        .args(["render", "graph.ron", "-o", "fresh.exr", "--size", "40x30"])
        .args(more)
        .current_dir(folder)
        .stdout(Stdio::null())
        .status()
        .unwrap();
    assert!(status.success());
    Picture::load(&folder.join("fresh.exr")).unwrap()
}

fn path_of(folder: &Path, file: &str) -> PathBuf {
    folder.join(if file.starts_with("live") {
        TECHNIQUE_FILE
    } else {
        file
    })
}

fn scene() -> Scratch {
    let scratch = Scratch::new();
    for file in FILES {
        let path = path_of(Path::new(""), file);
        scratch.write(path.to_str().unwrap(), content(file, 0));
    }
    scratch
}

fn every_save_is_seen(more: &[&str]) {
    let scratch = scene();
    let watch = Watch::begin(scratch.path(), more);
    let mut edits = 0;
    for file in FILES {
        if file == "mine/new.wgsl" {
            // From here on it is imported, and only from here on does it matter.
            save(
                &path_of(scratch.path(), file),
                Save::InPlace,
                &content(file, 99),
            );
            watch.is_quiet();
            edits += 1;
            let live = path_of(scratch.path(), "live");
            save(&live, Save::InPlace, &content("live and new", edits));
            watch.draws_what_is_there("a new import", &[]);
        }
        for how in SAVES {
            edits += 1;
            let path = path_of(scratch.path(), file);
            save(&path, how, &content(file, edits));
            let what = format!("{file}, {how:?}");
            let event = watch.draws_what_is_there(&what, &[]);
            assert!(
                event["difference"]["max"]["error"].as_f64() > Some(0.0),
                "{what}: {event}"
            );
            if how == Save::Burst {
                // Its last writes may each have given a picture.
                while watch.lines.recv_timeout(QUIET).is_ok() {}
            } else {
                // The same again is no change.
                save(&path, how, &content(file, edits));
                watch.is_quiet();
            }
        }
    }
}

#[test]
fn every_save_of_every_file_is_seen() {
    every_save_is_seen(&[]);
}

#[test]
fn every_save_of_every_file_is_seen_by_polling() {
    every_save_is_seen(&["--poll", "20"]);
}

#[test]
fn files_that_go_come_back_and_are_links() {
    let scratch = scene();
    let folder = scratch.path();
    let watch = Watch::begin(folder, &[]);
    let live = path_of(folder, "live");
    // Gone for good: told once, and the picture stays.
    let before = fs::read(folder.join("out.exr")).unwrap();
    let near = folder.join("mine/near.wgsl");
    fs::remove_file(&near).unwrap();
    let refused = watch.next("refused");
    assert_eq!(
        refused["findings"][0]["code"], "missing-import",
        "{refused}"
    );
    assert_eq!(fs::read(folder.join("out.exr")).unwrap(), before);
    watch.is_quiet();
    fs::write(&near, content("mine/near.wgsl", 3)).unwrap();
    watch.draws_what_is_there("a file that came back", &[]);
    // A folder renamed away and back, with an edit meanwhile.
    fs::rename(folder.join("mine"), folder.join("elsewhere")).unwrap();
    watch.next("refused");
    fs::write(
        folder.join("elsewhere/near.wgsl"),
        content("mine/near.wgsl", 4),
    )
    .unwrap();
    fs::rename(folder.join("elsewhere"), folder.join("mine")).unwrap();
    watch.draws_what_is_there("a folder that came back", &[]);
    #[cfg(unix)]
    {
        // A link in place of the file; then its target changes, then the link points elsewhere.
        let kept = folder.join("kept");
        fs::create_dir(&kept).unwrap();
        for (name, edits) in [("one.wgsl", 5), ("two.wgsl", 6)] {
            fs::write(kept.join(name), content("live", edits)).unwrap();
        }
        fs::remove_file(&live).unwrap();
        std::os::unix::fs::symlink(kept.join("one.wgsl"), &live).unwrap();
        watch.draws_what_is_there("a link in place of the file", &[]);
        for how in SAVES {
            let edits = 7 + how as usize;
            save(&kept.join("one.wgsl"), how, &content("live", edits));
            watch.draws_what_is_there(&format!("the link's target, {how:?}"), &[]);
        }
        let link = folder.join("link");
        std::os::unix::fs::symlink(kept.join("two.wgsl"), &link).unwrap();
        fs::rename(&link, &live).unwrap();
        watch.draws_what_is_there("a link that points elsewhere", &[]);
    }
    #[cfg(not(unix))]
    let _ = live;
}

#[test]
fn what_is_broken_at_the_start_is_waited_for() {
    let scratch = scene();
    let folder = scratch.path();
    fs::remove_file(folder.join("mine/near.wgsl")).unwrap();
    fs::remove_file(folder.join("v_6x5x4_uint8.raw")).unwrap();
    let watch = Watch::start(folder, &[]);
    let refused = watch.next("refused");
    assert_eq!(refused["findings"][0]["code"], "data-missing", "{refused}");
    fs::write(
        folder.join("v_6x5x4_uint8.raw"),
        content("v_6x5x4_uint8.raw", 1),
    )
    .unwrap();
    let refused = watch.next("refused");
    assert_eq!(
        refused["findings"][0]["code"], "missing-import",
        "{refused}"
    );
    assert!(!folder.join("out.exr").exists());
    fs::write(folder.join("mine/near.wgsl"), content("mine/near.wgsl", 1)).unwrap();
    watch.draws_what_is_there("mended", &[]);
    let nothing = scratch.run(&["watch", "none.ron", "-o", "a.png"]);
    assert_eq!(nothing.code, Some(1), "{nothing:?}");
}

#[test]
fn parameters_keep_their_values_by_name() {
    let scratch = scene();
    let folder = scratch.path();
    let with = |members: &str, factor: &str| {
        let text = TECHNIQUE.replace(
            "struct TechniqueState",
            &format!("struct Params {{\n{members}}}\n\nstruct TechniqueState"),
        );
        fs::write(path_of(folder, "live"), text.replace("FACTOR", factor)).unwrap();
    };
    let gain = "    /// Gain. @default 1 @range 0 4\n    gain: f32,\n";
    let tint = "    /// Tint. @default 1 1 1 @range 0 1\n    tint: vec3f,\n";
    with(gain, "params.gain");
    let sets = &["--set", "image.gain=0.25"];
    let watch = Watch::begin(folder, sets);
    // Another member before it.
    with(&format!("{tint}{gain}"), "params.tint * params.gain");
    let event = watch.draws_what_is_there("a member before it", sets);
    assert_eq!(
        event["change"]["params_added"][0], "image.tint = (1, 1, 1)",
        "{event}"
    );
    // Dropped: the value is kept aside.
    with(tint, "params.tint");
    let event = watch.draws_what_is_there("dropped", &[]);
    assert_eq!(
        event["change"]["params_dropped"][0], "image.gain = 0.25",
        "{event}"
    );
    assert_eq!(
        event["change"]["set_aside"][0], "image.gain=0.25",
        "{event}"
    );
    // Back, at another place: so is its value.
    with(&format!("{gain}{tint}"), "params.gain * params.tint");
    let event = watch.draws_what_is_there("back", sets);
    assert_eq!(
        event["change"]["params_added"][0], "image.gain = 0.25",
        "{event}"
    );
}

#[test]
fn commands_run_after_pictures_and_pictures_are_compared() {
    let scratch = scene();
    let folder = scratch.path();
    let run = scratch.run(&["render", "graph.ron", "-o", "first.exr", "--size", "40x30"]);
    assert_eq!(run.code, Some(0), "{run:?}");
    let log = "echo $VOLGRAPH_NUMBER $VOLGRAPH_PICTURE >> log";
    let watch = Watch::start(folder, &["--against", "first.exr", "--exec", log]);
    let first = watch.next("picture");
    assert_eq!(first["difference"]["rmse"], 0.0, "{first}");
    watch.next("watching");
    fs::write(path_of(folder, "live"), content("live", 5)).unwrap();
    let second = watch.draws_what_is_there("an edit", &[]);
    let rmse = second["difference"]["rmse"].as_f64().unwrap();
    assert!(rmse > 0.0, "{second}");
    let run = scratch.run(&["compare", "out.exr", "first.exr", "--json"]);
    assert_eq!(run.json()["rmse"].as_f64(), Some(rmse), "{run:?}");
    fs::write(path_of(folder, "live"), content("live", 0)).unwrap();
    let third = watch.draws_what_is_there("back", &[]);
    assert_eq!(third["difference"]["rmse"], 0.0, "{third}");
    let start = std::time::Instant::now();
    while fs::read_to_string(folder.join("log")).unwrap_or_default()
        != "1 out.exr\n2 out.exr\n3 out.exr\n"
    {
        assert!(start.elapsed() < PATIENCE, "the command does not run");
        sleep(PAUSE);
    }
}
