//! What is saved comes back: EXR bit by bit, PNG within half a code; and what is lost is told.

#![expect(clippy::unwrap_used, reason = "a test that cannot go on may panic")]

use std::fs;
use std::path::Path;

use exr::prelude::{ReadChannels as _, ReadLayers as _};
use volgraph_picture::srgb::srgb_from_linear;
use volgraph_picture::{Picture, PictureError, PngBits, SaveOptions, SaveReport};

fn folder() -> tempfile::TempDir {
    tempfile::tempdir().unwrap()
}

fn sixteen() -> SaveOptions {
    SaveOptions::default().with_png_bits(PngBits::Sixteen)
}

/// Smooth colours, premultiplied, with alphas from 0 to 1.
fn translucent(width: u32, height: u32) -> Picture {
    let color = (0..width * height)
        .map(|i| {
            let (x, y) = (
                (i % width) as f32 / (width - 1) as f32,
                (i / width) as f32 / (height - 1) as f32,
            );
            [x * y, (1.0 - x) * y, 0.003 * x * y, y]
        })
        .collect();
    Picture::from_color(width, height, color).unwrap()
}

fn opaque(width: u32, height: u32) -> Picture {
    let mut picture = translucent(width, height);
    for color in &mut picture.color {
        color[3] = 1.0 - 1e-7;
    }
    picture
}

fn with_metadata(mut picture: Picture) -> Picture {
    let pairs = [
        ("graph", "(nodes: {\"größe\": 1}, \n\ttext: \"日本語\")"),
        ("empty", ""),
        ("volume.digest", "ab01"),
    ];
    picture.metadata = pairs
        .iter()
        .map(|(key, value)| ((*key).to_owned(), (*value).to_owned()))
        .collect();
    picture.metadata.sort();
    picture
}

fn saved(picture: &Picture, name: &str, options: SaveOptions) -> (Picture, SaveReport) {
    let folder = folder();
    let path = folder.path().join(name);
    let report = picture.save(&path, options).unwrap();
    (Picture::load(&path).unwrap(), report)
}

fn bits(values: impl IntoIterator<Item = f32>) -> Vec<u32> {
    values.into_iter().map(f32::to_bits).collect()
}

#[test]
fn exr_keeps_every_bit() {
    let mut picture = with_metadata(translucent(37, 21));
    let odd = [
        f32::NAN,
        f32::INFINITY,
        -0.0,
        f32::MIN_POSITIVE / 8.0,
        -3.5,
        1e30,
    ];
    for (i, value) in odd.into_iter().enumerate() {
        picture.color[i][i % 4] = value;
    }
    picture.depth = Some((0..37 * 21).map(|i| i as f32 * 0.1).collect());
    picture.opacity = Some((0..37 * 21).map(|i| 1.0 / (1.0 + i as f32)).collect());
    let (loaded, report) = saved(&picture, "a.exr", SaveOptions::default());
    assert_eq!(
        report,
        SaveReport {
            nan_pixels: 1,
            clipped_pixels: 0
        }
    );
    assert_eq!(
        bits(loaded.color.iter().flatten().copied()),
        bits(picture.color.iter().flatten().copied())
    );
    assert_eq!(loaded.depth, picture.depth);
    assert_eq!(loaded.opacity, picture.opacity);
    assert_eq!(loaded.metadata, picture.metadata);
    assert_eq!((loaded.width, loaded.height), (37, 21));

    let (plain, _) = saved(&translucent(3, 2), "a.EXR", SaveOptions::default());
    assert_eq!(plain, translucent(3, 2));
}

#[test]
fn other_readers_find_the_usual_channels() {
    let folder = folder();
    let path = folder.path().join("a.exr");
    let mut picture = translucent(5, 4);
    picture.depth = Some(vec![2.0; 20]);
    let _ = picture.save(&path, SaveOptions::default()).unwrap();
    let image = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes()
        .from_file(&path)
        .unwrap();
    let names: Vec<String> = image
        .layer_data
        .channel_data
        .list
        .iter()
        .map(|c| c.name.to_string())
        .collect();
    assert_eq!(names, ["A", "B", "G", "R", "Z"]);
}

#[test]
fn png_is_within_half_a_code() {
    for (options, codes) in [(SaveOptions::default(), 255.0), (sixteen(), 65_535.0)] {
        for picture in [opaque(64, 48), translucent(64, 48)] {
            let (loaded, report) = saved(&picture, "a.png", options);
            assert_eq!(report, SaveReport::default());
            for (a, b) in picture.color.iter().zip(&loaded.color) {
                let alphas = [a[3], b[3]].map(f64::from);
                assert!(
                    (alphas[0] - alphas[1]).abs() * codes <= 0.5 + 1e-6,
                    "{a:?} {b:?}"
                );
                if alphas[1] == 0.0 {
                    continue;
                }
                for i in 0..3 {
                    // Each is divided by its own alpha: that is the colour that the codes hold.
                    let encoded =
                        |c: f32, alpha: f64| srgb_from_linear((f64::from(c) / alpha).min(1.0));
                    let off = (encoded(a[i], alphas[0]) - encoded(b[i], alphas[1])).abs() * codes;
                    assert!(off <= 0.5 + 0.01, "{a:?} {b:?}: {off} codes");
                }
            }
        }
    }
}

/// Color type, bit depth and pixels of a PNG as another reader sees it.
fn raw_png(
    path: &Path,
) -> (
    png::ColorType,
    png::BitDepth,
    Vec<u8>,
    Option<png::SrgbRenderingIntent>,
) {
    let file = std::io::BufReader::new(fs::File::open(path).unwrap());
    let mut reader = png::Decoder::new(file).read_info().unwrap();
    let mut data = vec![0; reader.output_buffer_size().unwrap()];
    let frame = reader.next_frame(&mut data).unwrap();
    (frame.color_type, frame.bit_depth, data, reader.info().srgb)
}

#[test]
fn png_codes_are_those_of_srgb() {
    let folder = folder();
    let path = folder.path().join("a.png");
    let opaque =
        Picture::from_color(2, 1, vec![[0.5, 0.0, 1.0, 1.0], [0.002, 1.0, 0.25, 1.0]]).unwrap();
    let _ = opaque.save(&path, SaveOptions::default()).unwrap();
    let (kind, depth, data, srgb) = raw_png(&path);
    assert_eq!(
        (kind, depth, data.as_slice()),
        (
            png::ColorType::Rgb,
            png::BitDepth::Eight,
            &[188, 0, 255, 7, 255, 137][..]
        )
    );
    assert_eq!(srgb, Some(png::SrgbRenderingIntent::RelativeColorimetric));

    // Premultiplied half red of alpha one half is full red in PNG.
    let half = Picture::from_color(2, 1, vec![[0.5, 0.25, 0.0, 0.5], [0.0; 4]]).unwrap();
    let _ = half.save(&path, sixteen()).unwrap();
    let (kind, depth, data, _) = raw_png(&path);
    assert_eq!(
        (kind, depth),
        (png::ColorType::Rgba, png::BitDepth::Sixteen)
    );
    let codes: Vec<u16> = data
        .chunks(2)
        .map(|c| u16::from_be_bytes([c[0], c[1]]))
        .collect();
    assert_eq!(codes, [65_535, 48_192, 0, 32_768, 0, 0, 0, 0]);
}

#[test]
fn what_png_cannot_hold_is_counted() {
    let color = vec![
        [0.5, 0.5, 0.5, 1.0],
        [f32::NAN, 0.5, 0.5, 1.0],
        [1.5, 0.5, 0.5, 1.0],
        [-0.5, 0.5, 0.5, 1.0],
        [0.5, 0.5, 0.5, 1.0 + 1e-6],
    ];
    let (loaded, report) = saved(
        &Picture::from_color(5, 1, color.clone()).unwrap(),
        "a.png",
        sixteen(),
    );
    assert_eq!(
        report,
        SaveReport {
            nan_pixels: 1,
            clipped_pixels: 2
        }
    );
    assert_eq!(loaded.color[1][0], 0.0);
    assert_eq!((loaded.color[2][0], loaded.color[3][0]), (1.0, 0.0));

    let mut translucent = color;
    translucent.push([0.5, 0.0, 0.0, 0.25]);
    translucent.push([0.5, 0.0, 0.0, 0.0]);
    translucent.push([0.0, 0.0, 0.0, f32::NAN]);
    let (_, report) = saved(
        &Picture::from_color(8, 1, translucent).unwrap(),
        "a.png",
        SaveOptions::default(),
    );
    assert_eq!(
        report,
        SaveReport {
            nan_pixels: 2,
            clipped_pixels: 4
        }
    );
}

#[test]
fn metadata_survives_in_both() {
    let picture = with_metadata(opaque(4, 3));
    for name in ["a.png", "a.exr"] {
        assert_eq!(
            saved(&picture, name, SaveOptions::default()).0.metadata,
            picture.metadata,
            "{name}"
        );
    }
}

#[test]
fn wrong_pictures_are_not_saved() {
    let folder = folder();
    let good = opaque(4, 3);
    let refused = |picture: &Picture, name: &str| {
        picture
            .save(&folder.path().join(name), SaveOptions::default())
            .unwrap_err()
    };
    assert!(matches!(
        refused(&good, "a.jpg"),
        PictureError::Extension { .. }
    ));
    assert!(matches!(
        refused(&good, "png"),
        PictureError::Extension { .. }
    ));
    assert!(matches!(
        refused(&good, "no/such/folder/a.png"),
        PictureError::Io { .. }
    ));
    assert!(matches!(
        refused(&Picture::default(), "a.png"),
        PictureError::Size { .. }
    ));
    let shape = |change: fn(&mut Picture)| {
        let mut picture = good.clone();
        change(&mut picture);
        picture
    };
    for wrong in [
        shape(|p| p.color.truncate(11)),
        shape(|p| p.depth = Some(vec![0.0; 13])),
        shape(|p| p.opacity = Some(Vec::new())),
    ] {
        assert!(matches!(
            refused(&wrong, "a.exr"),
            PictureError::Shape { .. }
        ));
    }
    let huge = shape(|p| (p.width, p.height) = (1 << 20, 1 << 20));
    assert!(matches!(refused(&huge, "a.exr"), PictureError::Size { .. }));
    for keys in [&[""][..], &["a b"], &["ä"], &["a", "a"]] {
        let mut picture = good.clone();
        picture.metadata = keys
            .iter()
            .map(|key| ((*key).to_owned(), String::new()))
            .collect();
        assert!(
            matches!(refused(&picture, "a.png"), PictureError::Metadata { .. }),
            "{keys:?}"
        );
    }
    assert_eq!(
        fs::read_dir(folder.path()).unwrap().count(),
        0,
        "a refused picture leaves no file"
    );
}

#[test]
fn saving_replaces_a_file_at_once_and_leaves_nothing_beside_it() {
    let folder = folder();
    let path = folder.path().join("a.png");
    let _ = opaque(8, 8).save(&path, SaveOptions::default()).unwrap();
    let _ = opaque(9, 5).save(&path, SaveOptions::default()).unwrap();
    assert_eq!(Picture::load(&path).unwrap().width, 9);
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    // A folder of that name cannot be replaced; what was written for it must go again.
    let taken = folder.path().join("b.png");
    fs::create_dir(&taken).unwrap();
    assert!(matches!(
        opaque(2, 2).save(&taken, SaveOptions::default()),
        Err(PictureError::Io { .. })
    ));
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2);
}
