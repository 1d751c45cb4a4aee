//! Volumes between formats, by the command line: values and placement go along, nothing is written over, nothing half.

use crate::Scratch;

/// 6×5×4 int16 whose value at (x, y, z) is 100 z + 10 y + x - 50, oblique in the world.
fn scratch() -> Scratch {
    let scratch = Scratch::new();
    let mut bytes = b"NRRD0005\ntype: int16\ndimension: 3\nspace: left-posterior-superior\nsizes: 6 5 4\n\
        space directions: (0.6,0.8,0) (-1.6,1.2,0) (0,0,-3)\nspace origin: (5,6,7)\nkinds: domain domain domain\n\
        space units: \"mm\" \"mm\" \"mm\"\nendian: little\nencoding: raw\n\n"
        .to_vec();
    for z in 0..4_i16 {
        for y in 0..5_i16 {
            for x in 0..6_i16 {
                bytes.extend((100 * z + 10 * y + x - 50).to_le_bytes());
            }
        }
    }
    scratch.write("v.nrrd", bytes);
    scratch
}

fn info(scratch: &Scratch, file: &str) -> serde_json::Value {
    scratch.run(&["info", file, "--json"]).ok().json()
}

#[test]
fn values_and_placement_go_through_every_format() {
    let scratch = scratch();
    let before = info(&scratch, "v.nrrd");
    let outputs = [
        "a.nrrd", "b.nhdr", "c.mha", "d.mhd", "e.nii", "f.nii.gz", "g.zarr",
    ];
    let mut from = "v.nrrd".to_owned();
    for output in outputs {
        scratch.run(&["convert", &from, output]).ok();
        let after = info(&scratch, output);
        for key in ["dims", "type", "min", "max", "mean"] {
            assert_eq!(after[key], before[key], "{output} {key}");
        }
        for key in ["spacing", "origin"] {
            for axis in 0..3 {
                let (after, before) = (after[key][axis].as_f64(), before[key][axis].as_f64());
                let apart = (after.unwrap() - before.unwrap()).abs();
                // NIfTI-1 holds single floats.
                assert!(apart < 1e-5, "{output} {key}: {apart}");
            }
        }
        from = output.to_owned();
    }
    let raw = "r_6x5x4_int16.raw.gz";
    scratch.run(&["convert", "v.nrrd", raw]).ok();
    assert_eq!(info(&scratch, raw)["mean"], before["mean"]);
}

#[test]
fn a_volume_is_cropped_resampled_and_windowed_on_the_way() {
    let scratch = scratch();
    let args = ["convert", "v.nrrd", "o.nrrd", "--crop", "1,2,1..5,4,4"];
    scratch.run(&args).ok();
    let cut = info(&scratch, "o.nrrd");
    assert_eq!(cut["dims"], serde_json::json!([4, 2, 3]));
    assert_eq!((&cut["min"], &cut["max"]), (&71.0.into(), &284.0.into()));
    // (1, 2, 1) is one step along x, two along y and one along z.
    let origin: Vec<f64> = serde_json::from_value(cut["origin"].clone()).unwrap();
    for (origin, wanted) in origin.iter().zip([5.0 + 0.6 - 3.2, 6.0 + 0.8 + 2.4, 4.0]) {
        assert!((origin - wanted).abs() < 1e-9, "{origin} {wanted}");
    }
    let args = ["convert", "v.nrrd", "h.nrrd", "--resample", "3x5x2"];
    scratch.run(&args).ok();
    let half = info(&scratch, "h.nrrd");
    assert_eq!(half["dims"], serde_json::json!([3, 5, 2]));
    let args = [
        "convert", "v.nrrd", "w.nrrd", "--as", "uint8", "--window", "0..255", "--json",
    ];
    let run = scratch.run(&args).ok();
    let done = run.json();
    // -50 to -1 are below: 50 voxels of 120, some of which are not on the grid; 255 is past 250 - 50 + ….
    let below = (0..4)
        .flat_map(|z| (0..5).flat_map(move |y| (0..6).map(move |x| 100 * z + 10 * y + x - 50)));
    let clamped = below.filter(|value| !(0..=255).contains(value)).count();
    assert_eq!(done["clamped"], clamped);
    assert_eq!(info(&scratch, "w.nrrd")["type"], "uint8");
}

#[test]
fn nothing_is_written_over_and_what_makes_no_sense_is_refused() {
    let scratch = scratch();
    scratch.run(&["convert", "v.nrrd", "o.mha"]).ok();
    let before = std::fs::read(scratch.path().join("o.mha")).unwrap();
    let refused = |args: &[&str], part: &str| {
        let run = scratch.run(args);
        assert!(run.code.is_some_and(|code| code != 0), "{args:?}");
        assert!(run.stderr.contains(part), "{args:?}: {}", run.stderr);
    };
    refused(&["convert", "v.nrrd", "o.mha"], "--force");
    assert_eq!(std::fs::read(scratch.path().join("o.mha")).unwrap(), before);
    scratch
        .run(&[
            "convert",
            "v.nrrd",
            "o.mha",
            "--force",
            "--compress",
            "gzip:9",
        ])
        .ok();
    assert_ne!(std::fs::read(scratch.path().join("o.mha")).unwrap(), before);
    refused(&["convert", "v.nrrd", "o.png"], "volume-write");
    refused(
        &["convert", "v.nrrd", "o_1x1x1_uint8.raw"],
        "volume-raw-name",
    );
    refused(
        &["convert", "v.nrrd", "p.nrrd", "--crop", "0,0,0..9,9,9"],
        "volume-option",
    );
    refused(&["convert", "v.nrrd", "p.nrrd", "--window", "0..9"], "--as");
    refused(&["convert", "gone.nrrd", "p.nrrd"], "gone.nrrd");
    refused(&["convert", "v.nrrd", "no/such/p.nrrd"], "p.nrrd");
    let left: Vec<_> = std::fs::read_dir(scratch.path()).unwrap().collect();
    // The volume, what was written, and the folder for files that can be made again, if any.
    assert!(left.len() <= 3, "{left:?}");
}

#[cfg(unix)]
#[test]
fn an_interrupt_leaves_nothing_behind() {
    use std::os::unix::process::ExitStatusExt;
    use std::process::{Command, Stdio};
    use std::time::{Duration, Instant};

    let scratch = Scratch::new();
    // 384³ bytes that look like chance take seconds to pack.
    let mut seed = 1_u32;
    let noise: Vec<u8> = (0..384 * 384 * 384)
        .map(|_| {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (seed >> 24) as u8
        })
        .collect();
    scratch.write("v_384x384x384_uint8.raw", noise);
    let mut child = Command::new(env!("CARGO_BIN_EXE_volgraph"))
        .args([
            "convert",
            "v_384x384x384_uint8.raw",
            "o.nrrd",
            "--compress",
            "gzip:9",
        ])
        .current_dir(scratch.path())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let names = || {
        let files = std::fs::read_dir(scratch.path()).unwrap();
        files
            .map(|file| file.unwrap().file_name().into_string().unwrap())
            .collect::<Vec<_>>()
    };
    // Something is being written.
    let start = Instant::now();
    while names().len() < 2 && child.try_wait().unwrap().is_none() {
        assert!(start.elapsed() < Duration::from_secs(60));
        std::thread::sleep(Duration::from_millis(5));
    }
    let id = child.id().to_string();
    assert!(
        Command::new("kill")
            .args(["-INT", &id])
            .status()
            .unwrap()
            .success()
    );
    let status = child.wait().unwrap();
    assert_eq!(status.signal(), Some(2), "{status:?}");
    assert_eq!(names(), ["v_384x384x384_uint8.raw"]);
}
