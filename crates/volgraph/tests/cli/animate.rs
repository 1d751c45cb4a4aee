//! Films: every frame is the picture that `render` draws there, files hold all of them, and nothing half-written stays.

use std::fs::File;
use std::io::BufReader;

use volgraph::Picture;

use crate::{SPHERE, Scratch, TRANSFER, graph};

fn scratch() -> Scratch {
    let scratch = Scratch::new();
    // Not round, so that views are told apart.
    let volume = SPHERE.replace("sphere", "gyroid");
    scratch.write("g.ron", graph(&volume));
    scratch.write("t.ron", TRANSFER);
    scratch
}

const SIZE: &str = "24x20";

/// The picture that `render` draws with these arguments.
fn rendered(scratch: &Scratch, more: &[&str]) -> Picture {
    let args = ["render", "g.ron", "-o", "one.png", "--size", SIZE];
    scratch.run(&[&args[..], more].concat()).ok();
    scratch.picture("one.png")
}

/// The most by which two pictures are apart.
fn apart(a: &Picture, b: &Picture) -> f32 {
    assert_eq!((a.width, a.height), (b.width, b.height));
    let pairs = a.color.iter().zip(&b.color);
    let far = pairs.flat_map(|(a, b)| (0..4).map(|i| (a[i] - b[i]).abs()));
    far.fold(0.0, f32::max)
}

/// A rotated camera rounds otherwise than the same camera that is placed: by a code of 255 at most.
const CODE: f32 = 0.01;

#[test]
fn a_frame_of_a_turntable_is_the_picture_at_that_azimuth() {
    let scratch = scratch();
    let camera = "orbit(azimuth: 10, elevation: 35, roll: 5)";
    let args = [
        "animate", "g.ron", "-o", "out", "--size", SIZE, "--camera", camera,
    ];
    let run = scratch
        .run(&[&args[..], &["--frames", "4", "--json"]].concat())
        .ok();
    assert_eq!(run.json()["frames"], 4);
    let mut before = None;
    for (number, azimuth) in [(0, 10), (1, 100), (2, 190), (3, 280)] {
        let camera = camera.replace("azimuth: 10", &format!("azimuth: {azimuth}"));
        let wanted = rendered(&scratch, &["--camera", &camera]);
        let frame = scratch.picture(&format!("out/frame_{number:04}.png"));
        assert!(apart(&frame, &wanted) < CODE, "{number}");
        let moved = before
            .replace(frame.clone())
            .map(|before| apart(&before, &frame));
        assert!(
            moved.is_none_or(|moved| moved > 0.1),
            "{number} is as the one before"
        );
        // It carries what a rendered picture carries.
        let keys = |picture: &Picture| {
            picture
                .metadata
                .iter()
                .map(|it| it.0.clone())
                .collect::<Vec<_>>()
        };
        assert_eq!(keys(&frame), keys(&wanted));
    }
    // Of an arc the last frame is the end; and what stays of the film before is told.
    let run = scratch
        .run(&[&args[..], &["--frames", "3", "--degrees", "-90"]].concat())
        .ok();
    assert!(
        run.stderr.contains("1 frames of another film"),
        "{}",
        run.stderr
    );
    let wanted = rendered(
        &scratch,
        &["--camera", &camera.replace("azimuth: 10", "azimuth: -80")],
    );
    assert!(apart(&scratch.picture("out/frame_0002.png"), &wanted) < CODE);
}

const PATH: &str = r#"(
    path: 1,
    fps: 10,
    keys: [
        (at: 0, camera: orbit(azimuth: 20, elevation: 10), set: { "image.step": 2.0 }),
        (at: 2, camera: look_at(eye: (3, -4, 5), target: (0.2, 0, 0))),
        (at: 4, camera: orbit(azimuth: -70, elevation: 80, zoom: 2), set: { "image.step": 1.0, "image.slots.technique": "mip" }),
    ],
)
"#;

#[test]
fn a_path_passes_through_its_keys_and_sets_what_they_say() {
    let scratch = scratch();
    scratch.write("path.ron", PATH);
    let args = [
        "animate", "g.ron", "-o", "film.png", "--size", SIZE, "--path", "path.ron",
    ];
    scratch.run(&args).ok();
    let file = BufReader::new(File::open(scratch.path().join("film.png")).unwrap());
    let mut reader = png::Decoder::new(file).read_info().unwrap();
    assert_eq!(reader.info().animation_control().unwrap().num_frames, 5);
    let mip = "image.slots.technique=mip";
    // The step is half-way between both keys at the middle one.
    let wanted: [(u32, &str, &[&str]); 3] = [
        (
            0,
            "orbit(azimuth: 20, elevation: 10)",
            &["--set", "image.step=2", "--set", mip],
        ),
        (
            2,
            "look_at(eye: (3, -4, 5), target: (0.2, 0, 0))",
            &["--set", "image.step=1.5", "--set", mip],
        ),
        (
            4,
            "orbit(azimuth: -70, elevation: 80, zoom: 2)",
            &["--set", "image.step=1", "--set", mip],
        ),
    ];
    let mut data = vec![0; reader.output_buffer_size().unwrap()];
    for number in 0..5 {
        reader.next_frame(&mut data).unwrap();
        let control = reader.info().frame_control().unwrap();
        assert_eq!((control.delay_num, control.delay_den), (1, 10));
        let Some((_, camera, sets)) = wanted.iter().find(|it| it.0 == number) else {
            continue;
        };
        rendered(&scratch, &[&["--camera", camera], *sets].concat());
        let still = BufReader::new(File::open(scratch.path().join("one.png")).unwrap());
        let mut still = png::Decoder::new(still).read_info().unwrap();
        let mut codes = vec![0; still.output_buffer_size().unwrap()];
        still.next_frame(&mut codes).unwrap();
        // An opaque still picture has no alpha, a film has.
        let codes = match still.info().color_type {
            png::ColorType::Rgba => codes,
            _ => codes
                .chunks(3)
                .flat_map(|rgb| [rgb[0], rgb[1], rgb[2], 255])
                .collect(),
        };
        assert_eq!(data, codes, "{number}");
    }
    let still = scratch.path().join("film.png");
    assert!(
        Picture::load(&still)
            .unwrap()
            .metadata
            .iter()
            .any(|it| it.0 == "graph.text")
    );
}

#[test]
fn what_is_wrong_with_a_path_is_told_at_its_line_and_leaves_nothing() {
    let scratch = scratch();
    let args = [
        "animate", "g.ron", "-o", "film.gif", "--size", SIZE, "--path", "path.ron",
    ];
    let planted: [(&str, &str, &[&str]); 8] = [
        ("path: 1", "path: 2", &["path.ron:2:", "version 2"]),
        (
            "at: 2",
            "at: 5",
            &["path.ron:7:", "the key at 4 comes after that at 5"],
        ),
        (
            "fps: 10",
            "frames: 3",
            &["path.ron:7:", "a key at frame 4 of 3"],
        ),
        ("eye: (3", "aye: (3", &["path.ron:6:", "aye"]),
        (
            "look_at(",
            "look_at(height: 2, ",
            &["path.ron:6:", "orthographic"],
        ),
        (
            "step\": 1.0",
            "step\": \"x\"",
            &["path.ron:7:", "no way to"],
        ),
        ("image.slots", "images.slots", &["path.ron:7:", "images"]),
        ("image.step\": 2.0", "image.step\": -2.0", &["path.ron:5:"]),
    ];
    for (from, to, told) in planted {
        assert!(PATH.contains(from), "{from}");
        scratch.write("path.ron", PATH.replace(from, to));
        let run = scratch.run(&args);
        assert_eq!(run.code, Some(1), "{to}: {run:?}");
        for words in told {
            assert!(run.stderr.contains(words), "{to}: {}", run.stderr);
        }
        let left = std::fs::read_dir(scratch.path()).unwrap().flatten();
        let names: Vec<_> = left
            .map(|it| it.file_name().into_string().unwrap())
            .collect();
        assert!(!names.iter().any(|it| it.contains("film")), "{names:?}");
    }
    for (output, code) in [
        ("film.webp", "film-extension"),
        ("no/film.png", "io"),
        ("g.ron", "io"),
    ] {
        scratch
            .run(&["animate", "g.ron", "-o", output])
            .refused(&[code]);
    }
    for wrong in [["--frames", "0"], ["--fps", "nan"], ["--degrees", "inf"]] {
        let run = scratch.run(&[&["animate", "g.ron", "-o", "out"], &wrong[..]].concat());
        assert_eq!(run.code, Some(2), "{wrong:?}");
    }
}

#[test]
fn a_film_does_not_replace_what_it_is_made_of() {
    let scratch = scratch();
    let text = graph(SPHERE).replace(
        "\"v\": analytic",
        "\"i\": image(path: \"frame_0000.png\"), \"v\": analytic",
    );
    scratch
        .run(&["render", "g.ron", "-o", "frame_0000.png", "--size", "8x8"])
        .ok();
    scratch.write("g.ron", text);
    let before = std::fs::read(scratch.path().join("frame_0000.png")).unwrap();
    scratch
        .run(&[
            "animate", "g.ron", "-o", ".", "--size", "8x8", "--frames", "1",
        ])
        .refused(&["overwrites-input"]);
    scratch
        .run(&[
            "animate",
            "g.ron",
            "-o",
            "frame_0000.png",
            "--size",
            "8x8",
            "--frames",
            "1",
        ])
        .refused(&["overwrites-input"]);
    assert_eq!(
        before,
        std::fs::read(scratch.path().join("frame_0000.png")).unwrap()
    );
}

#[test]
fn a_picture_in_tiles_is_the_picture() {
    let scratch = scratch();
    let exr = |more: &[&str]| {
        let args = ["render", "g.ron", "-o", "tiled.exr", "--size", SIZE];
        scratch.run(&[&args[..], more].concat()).ok();
        scratch.picture("tiled.exr")
    };
    let whole = exr(&[]);
    assert_eq!(whole, exr(&["--tile", "7"]));
    // What draws on the processor draws the whole.
    let graph = graph(SPHERE).replace("\"raycast\"", "\"software_raycast\"");
    let graph = graph.replace(", \"rays\": \"box\"", "");
    scratch.write("g.ron", graph);
    scratch
        .run(&[
            "render",
            "g.ron",
            "-o",
            "tiled.png",
            "--tile",
            "7",
            "--size",
            SIZE,
        ])
        .refused(&["no-window"]);
}
