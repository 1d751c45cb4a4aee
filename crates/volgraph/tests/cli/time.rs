//! Volumes with time steps: one is drawn by its number, films go over them, and steps that are not there are refused.

use volgraph::Picture;

use crate::{SPHERE, Scratch, TRANSFER, graph};

/// Four time steps of a box that wanders to the right, as one file with four axes and as a folder of files.
fn scratch() -> Scratch {
    let scratch = Scratch::new();
    let voxels = |step: usize| -> Vec<u8> {
        let place = |at: usize| (at % 8, at / 8 % 4, at / 32);
        let inside =
            |(x, y, _): (usize, usize, usize)| (2 * step..2 * step + 2).contains(&x) && y > 0;
        (0..8 * 4 * 4)
            .map(|at| if inside(place(at)) { 255 } else { 0 })
            .collect()
    };
    let mut bytes = b"NRRD0004\ntype: uint8\ndimension: 4\nsizes: 8 4 4 4\nkinds: domain domain domain time\nencoding: raw\n\n".to_vec();
    for step in 0..4 {
        bytes.extend(voxels(step));
        scratch.write(&format!("steps/s{step}_8x4x4_uint8.raw"), voxels(step));
    }
    scratch.write("four.nrrd", bytes);
    scratch.write("t.ron", TRANSFER);
    scratch.write("file.ron", graph("volume(path: \"four.nrrd\")"));
    scratch.write("folder.ron", graph("volume(path: \"steps\")"));
    scratch.write("glob.ron", graph("volume(path: \"steps/s*.raw\")"));
    scratch.write("still.ron", graph(SPHERE));
    scratch
}

const LOOK: [&str; 4] = [
    "--size",
    "48x24",
    "--camera",
    "look_at(eye: (3.5, -30, 1.5), target: (3.5, 1.5, 1.5), fov_y: 12)",
];

/// Where the picture's light is, from 0 at the left to 1 at the right.
fn place(picture: &Picture) -> f64 {
    let (mut sum, mut all) = (0.0, 0.0);
    for (at, color) in picture.color.iter().enumerate() {
        let x = (at as u32 % picture.width) as f64;
        sum += x * f64::from(color[3]);
        all += f64::from(color[3]);
    }
    assert!(all > 1.0, "nothing is shown");
    sum / all / f64::from(picture.width)
}

#[test]
fn a_step_is_drawn_by_its_number_from_a_file_a_folder_and_a_pattern() {
    let scratch = scratch();
    for graph in ["file.ron", "folder.ron", "glob.ron"] {
        let mut before = 0.0;
        for step in ["0", "1", "2", "3"] {
            let args = ["render", graph, "-o", "o.exr", "--time", step];
            scratch.run(&[&args[..], &LOOK].concat()).ok();
            let place = place(&scratch.picture("o.exr"));
            assert!(
                place > before + 0.05,
                "{graph} {step}: {place} after {before}"
            );
            before = place;
        }
        let set = ["render", graph, "-o", "o.exr", "--set", "v.time=1"];
        scratch.run(&[&set[..], &LOOK].concat()).ok();
        let second = place(&scratch.picture("o.exr"));
        assert!(second < before - 0.1);
    }
    let info = scratch
        .run(&["info", "four.nrrd", "--time", "2", "--json"])
        .ok();
    let info = info.json();
    assert_eq!((&info["step"], &info["step_count"]), (&2.into(), &4.into()));
}

#[test]
fn a_film_goes_over_the_steps() {
    let scratch = scratch();
    for graph in ["file.ron", "folder.ron"] {
        let args = [
            "animate",
            graph,
            "-o",
            graph.trim_end_matches(".ron"),
            "--steps",
            "all",
            "--json",
        ];
        let run = scratch.run(&[&args[..], &LOOK].concat()).ok();
        assert_eq!(run.json()["frames"], 4);
    }
    let places: Vec<f64> = (0..4)
        .map(|frame| place(&scratch.picture(&format!("folder/frame_{frame:04}.png"))))
        .collect();
    assert!(
        places.windows(2).all(|pair| pair[1] > pair[0] + 0.05),
        "{places:?}"
    );
    let args = ["animate", "file.ron", "-o", "back", "--steps", "3..1"];
    scratch.run(&[&args[..], &LOOK].concat()).ok();
    for (frame, step) in [(0, 3), (1, 2), (2, 1)] {
        let back = place(&scratch.picture(&format!("back/frame_{frame:04}.png")));
        assert!((back - places[step]).abs() < 1e-6, "{frame}");
    }
}

#[test]
fn steps_that_are_not_there_are_refused() {
    let scratch = scratch();
    let refused = |args: &[&str], part: &str| {
        let run = scratch.run(args);
        assert_eq!(run.code, Some(1), "{args:?}: {run:?}");
        assert!(run.stderr.contains(part), "{args:?}: {}", run.stderr);
    };
    refused(
        &["render", "file.ron", "-o", "o.png", "--time", "4"],
        "there are 4 steps",
    );
    refused(
        &["render", "still.ron", "-o", "o.png", "--time", "1"],
        "no-time",
    );
    refused(
        &["animate", "still.ron", "-o", "o", "--steps", "all"],
        "no-time",
    );
    refused(
        &["animate", "file.ron", "-o", "o", "--steps", "0..4"],
        "no-time",
    );
    // A step of another size is told when it is its turn.
    scratch.write("steps/s2_8x4x4_uint8.raw", [0; 8]);
    refused(
        &["render", "folder.ron", "-o", "o.png", "--time", "2"],
        "s2_8x4x4_uint8.raw",
    );
    scratch
        .run(&["render", "folder.ron", "-o", "o.png", "--time", "1"])
        .ok();
}
