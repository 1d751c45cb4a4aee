//! What may happen to files while they are watched, and to those who listen.

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::mpsc;
use std::time::{Duration, Instant};

use serde_json::Value;

use super::{QUIET, Save, Watch, content, path_of, save, scene};
use crate::{PATIENCE, Scratch, root};

const VOLUME: &str = "v_6x5x4_uint8.raw";

/// The paths that an event says have changed.
fn changed(event: &Value) -> Vec<&str> {
    let changed = event["change"]["changed"].as_array();
    let changed = changed.or(event["changed"].as_array()).unwrap();
    let path = |file: &'_ Value| file["path"].as_str().is_some();
    changed
        .iter()
        .map(|file| if path(file) { &file["path"] } else { file })
        .map(|path| path.as_str().unwrap())
        .collect()
}

#[cfg(unix)]
#[test]
fn what_is_no_plain_file_is_refused_and_never_waited_for() {
    let scratch = scene();
    let folder = scratch.path();
    let watch = Watch::begin(folder, &[]);
    let pipe = |path: &Path| {
        let made = Command::new("mkfifo").arg(path).status();
        assert!(made.unwrap().success());
    };
    let device = |path: &Path| std::os::unix::fs::symlink("/dev/zero", path).unwrap();
    let circle = |path: &Path| std::os::unix::fs::symlink(path, path).unwrap();
    for (at, file) in ["graph.ron", "t.ron", VOLUME, "live", "mine/near.wgsl"]
        .into_iter()
        .enumerate()
    {
        let path = path_of(folder, file);
        for (kind, replace) in [&pipe as &dyn Fn(&Path), &device, &circle]
            .into_iter()
            .enumerate()
        {
            fs::remove_file(&path).unwrap();
            replace(&path);
            watch.next("refused");
            fs::remove_file(&path).unwrap();
            fs::write(&path, content(file, 1 + at + 5 * kind)).unwrap();
            watch.draws_what_is_there(file, &[]);
        }
    }
    for name in ["pipe.ron", "pipe.wgsl"] {
        pipe(&folder.join(name));
    }
    for command in [
        ["check", "pipe.ron"],
        ["plan", "pipe.ron"],
        ["link", "pipe.ron"],
        ["check", "pipe.wgsl"],
    ] {
        let run = scratch.run(&command);
        assert_eq!(run.code, Some(1), "{command:?}: {run:?}");
    }
}

/// A scene with an image behind the volume, in `back.png`.
fn with_image() -> Scratch {
    let scratch = scene();
    let text = String::from_utf8(content("graph.ron", 0)).unwrap();
    let text = text
        .replace("sources: {", r#"sources: { "i": image(path: "back.png"),"#)
        .replace(
            "nodes: {",
            r#"nodes: { "background": (kind: "background", in: { "image": "i" }, params: { "pattern": "image" }),"#,
        )
        .replace(r#""rays": "box""#, r#""rays": "box", "behind": "background""#);
    let drawn = scratch.run(&["render", "graph.ron", "-o", "back.png", "--size", "8x8"]);
    assert_eq!(drawn.code, Some(0), "{drawn:?}");
    scratch.write("graph.ron", text);
    scratch
}

#[test]
fn a_picture_replaces_nothing_that_is_read_for_it() {
    let scratch = with_image();
    let folder = scratch.path();
    fs::copy(folder.join("graph.ron"), folder.join("graph.png")).unwrap();
    let mut cases = vec![
        ("graph.ron", "back.png"),
        ("graph.ron", "./mine/../back.png"),
        ("graph.png", "graph.png"),
    ];
    if cfg!(unix) {
        #[cfg(unix)]
        std::os::unix::fs::symlink("back.png", folder.join("link.png")).unwrap();
        cases.push(("graph.ron", "link.png"));
    }
    let before = ["back.png", "graph.png"].map(|name| fs::read(folder.join(name)).unwrap());
    for command in ["render", "watch"] {
        for (graph, output) in &cases {
            let run = scratch.run(&[command, graph, "-o", output, "--size", "8x8"]);
            assert_eq!(run.code, Some(1), "{command} {output}: {run:?}");
            assert!(run.stderr.contains("overwrites-input"), "{run:?}");
        }
    }
    let run = scratch.run(&[
        "watch",
        "graph.ron",
        "-o",
        "a.png",
        "--against",
        "a.png",
        "--size",
        "8x8",
    ]);
    assert!(
        run.code == Some(1) && !folder.join("a.png").exists(),
        "{run:?}"
    );
    let after = ["back.png", "graph.png"].map(|name| fs::read(folder.join(name)).unwrap());
    assert!(before == after, "a file was replaced");
    // The same by an edit of the graph is refused like any other.
    let text = fs::read_to_string(folder.join("graph.ron")).unwrap();
    let watch = Watch::begin(folder, &[]);
    fs::copy(folder.join("out.exr"), folder.join("kept.exr")).unwrap();
    fs::write(
        folder.join("graph.ron"),
        text.replace("back.png", "out.exr"),
    )
    .unwrap();
    let refused = watch.next("refused");
    assert_eq!(
        refused["findings"][0]["code"], "overwrites-input",
        "{refused}"
    );
    let kept = fs::read(folder.join("kept.exr")).unwrap();
    assert!(kept == fs::read(folder.join("out.exr")).unwrap());
}

#[test]
fn what_cannot_work_ends_at_once() {
    let scratch = scene();
    let drawn = scratch.run(&["render", "graph.ron", "-o", "small.png", "--size", "8x8"]);
    assert_eq!(drawn.code, Some(0), "{drawn:?}");
    fs::create_dir(scratch.path().join("folder.png")).unwrap();
    for (args, code) in [
        (["-o", "a.png", "--against", "small.png"], "picture-sizes"),
        (["-o", "a.png", "--against", "none.png"], "io"),
        (["-o", "none/a.png", "--size", "8x8"], "io"),
        (["-o", "folder.png", "--size", "8x8"], "io"),
    ] {
        let run = scratch.run(&[&["watch", "graph.ron"], &args[..]].concat());
        assert_eq!(run.code, Some(1), "{args:?}: {run:?}");
        let told = run.stderr.contains(&format!("error[{code}]"));
        assert!(told && run.stdout.is_empty(), "{args:?}: {run:?}");
    }
}

#[test]
fn a_volume_is_read_once_for_each_save() {
    let scratch = scene();
    let watch = Watch::begin(scratch.path(), &[]);
    // A file that was written right before it was read may be read again, once.
    watch.is_quiet();
    let is_read_again = |edits: &usize| {
        let path = scratch.path().join(VOLUME);
        save(&path, Save::RenameOver, &content(VOLUME, *edits));
        watch.draws_what_is_there("a volume", &[]);
        let end = Instant::now() + QUIET;
        let left = || end.saturating_duration_since(Instant::now());
        let mut events = std::iter::from_fn(|| watch.lines.recv_timeout(left()).ok());
        events.any(|event| event["event"] == "unchanged")
    };
    // On a busy machine an event of the save may come late, and be looked after.
    let again = (1..6).filter(is_read_again).count();
    assert!(again < 3, "{again} of 5 saves were read twice");
}

#[test]
fn a_header_and_its_data_are_watched_as_one_volume() {
    let scratch = scene();
    let folder = scratch.path();
    let text = String::from_utf8(content("graph.ron", 0)).unwrap();
    scratch.write("graph.ron", text.replace(VOLUME, "v.nhdr"));
    let header = |data: &str| {
        let text = "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 6 5 4\nencoding: raw\ndata file: ";
        scratch.write("v.nhdr", format!("{text}{data}\n"));
    };
    scratch.write("a.raw", content(VOLUME, 1));
    scratch.write("b.raw", content(VOLUME, 2));
    header("a.raw");
    let watch = Watch::begin(folder, &[]);
    scratch.write("a.raw", content(VOLUME, 3));
    let event = watch.draws_what_is_there("the data", &[]);
    assert_eq!(changed(&event), ["a.raw"], "{event}");
    header("b.raw");
    watch.draws_what_is_there("the header", &[]);
    scratch.write("a.raw", content(VOLUME, 4));
    watch.is_quiet();
    header("c.raw");
    watch.next("refused");
    // What lies beside it is none of the picture's, and does not end the wait for what is.
    scratch.write("notes.txt", "a");
    watch.is_quiet();
    scratch.write("c.raw", content(VOLUME, 5));
    let event = watch.draws_what_is_there("data that appear", &[]);
    assert_eq!(changed(&event), ["c.raw", "v.nhdr"], "{event}");
}

#[test]
fn a_ready_graph_is_watched_with_shaders_of_ones_own() {
    let scratch = Scratch::new();
    let name = "mine/slot/technique/dvr.wgsl";
    let dvr = fs::read_to_string(root().join("shaders/slot/technique/dvr.wgsl")).unwrap();
    scratch.write(name, format!("{dvr}\nfn broken() -> f32 {{ return x; }}\n"));
    let args = ["--json", "--shaders", "mine"];
    let watch = Watch::start_text(scratch.path(), "quickstart", &args);
    // What is broken at the start is waited for, as with a graph on the disk.
    watch.next("refused");
    scratch.write(name, &dvr);
    watch.next("picture");
    scratch.write(
        name,
        format!("{dvr}\nfn another() -> f32 {{ return 1.0; }}\n"),
    );
    let event = watch.next("picture");
    assert_eq!(changed(&event), [name], "{event}");
}

#[test]
fn the_text_says_when_a_mistake_stays_and_when_it_is_mended() {
    let scratch = scene();
    let watch = Watch::start_text(scratch.path(), "graph.ron", &[]);
    let next = |start: &str| loop {
        let line = watch.lines.recv_timeout(PATIENCE).unwrap();
        let line = line.as_str().unwrap().to_owned();
        if line.starts_with(start) {
            break line;
        }
    };
    next("watching");
    let live = path_of(scratch.path(), "live");
    let good = content("live", 0);
    let bad = String::from_utf8(good.clone())
        .unwrap()
        .replace("near_factor()", "near()");
    fs::write(&live, &bad).unwrap();
    assert_eq!(next("   "), "   out.exr stays as it was");
    fs::write(&live, format!("{bad}\n")).unwrap();
    assert_eq!(next("   "), "   refused as before; out.exr stays as it was");
    fs::write(&live, good).unwrap();
    assert_eq!(next("   "), "   mended: out.exr is right as it is");
    fs::write(&live, content("live", 1)).unwrap();
    assert_eq!(next("#"), "#2 slot/technique/live.wgsl (shader)");
    let times = next("   ");
    let times = if times.contains("ms from") {
        times
    } else {
        next("   ")
    };
    let times = if times.contains("ms from") {
        times
    } else {
        next("   ")
    };
    assert!(
        times.contains(" ms from save to picture: settle "),
        "{times}"
    );
}

#[test]
fn standard_output_is_json_alone_whatever_the_command_prints() {
    let scratch = scene();
    let watch = Watch::start(
        scratch.path(),
        &["--exec", "echo not JSON; echo done > done"],
    );
    let start = Instant::now();
    while !scratch.path().join("done").exists() {
        assert!(start.elapsed() < PATIENCE, "the command does not run");
        std::thread::sleep(Duration::from_millis(5));
    }
    fs::write(path_of(scratch.path(), "live"), content("live", 1)).unwrap();
    loop {
        let line = watch.lines.recv_timeout(PATIENCE).unwrap();
        assert!(line.is_object(), "{line}");
        if line["number"] == 2 {
            break;
        }
    }
}

#[test]
fn it_ends_when_nobody_reads_what_it_tells() {
    let scratch = scene();
    let mut child = Command::new(env!("CARGO_BIN_EXE_volgraph"))
        .args(["watch", "graph.ron", "-o", "out.exr", "--size", "8x8"])
        .current_dir(scratch.path())
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let (sender, ended) = mpsc::channel();
    let id = child.id();
    std::thread::spawn(move || sender.send(child.wait()));
    let Ok(status) = ended.recv_timeout(PATIENCE) else {
        let _ = Command::new("kill").arg(id.to_string()).status();
        panic!("it goes on");
    };
    assert_eq!(status.unwrap().code(), Some(0));
}

#[cfg(unix)]
#[test]
fn an_interrupt_ends_it_as_shells_expect() {
    use std::os::unix::process::ExitStatusExt;
    let scratch = scene();
    let mut watch = Watch::begin(scratch.path(), &[]);
    let id = watch.child.id().to_string();
    let sent = Command::new("kill").args(["-INT", &id]).status().unwrap();
    assert!(sent.success());
    let start = Instant::now();
    let status = loop {
        if let Some(status) = watch.child.try_wait().unwrap() {
            break status;
        }
        assert!(start.elapsed() < PATIENCE, "it goes on");
        std::thread::sleep(Duration::from_millis(5));
    };
    assert_eq!(status.signal(), Some(2), "{status}");
}
