//! Files of others, damaged files, and files that are no pictures.

#![expect(clippy::unwrap_used, reason = "a test that cannot go on may panic")]

use std::fs;
use std::path::{Path, PathBuf};

use exr::prelude::{
    AnyChannel, AnyChannels, Encoding, FlatSamples, Image, Layer, LayerAttributes, SmallVec,
    WritableImage as _, f16,
};
use proptest::prelude::*;
use volgraph_picture::srgb::linear_from_srgb;
use volgraph_picture::{Picture, PictureError, PngBits, SaveOptions};

fn write(folder: &Path, name: &str, bytes: &[u8]) -> PathBuf {
    let path = folder.join(name);
    fs::write(&path, bytes).unwrap();
    path
}

fn load(name: &str, bytes: &[u8]) -> Result<Picture, PictureError> {
    let folder = tempfile::tempdir().unwrap();
    Picture::load(&write(folder.path(), name, bytes))
}

fn png_bytes(
    size: (u32, u32),
    kind: png::ColorType,
    depth: png::BitDepth,
    data: &[u8],
    set: impl FnOnce(&mut png::Encoder<'_, &mut Vec<u8>>),
) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, size.0, size.1);
    encoder.set_color(kind);
    encoder.set_depth(depth);
    set(&mut encoder);
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(data).unwrap();
    writer.finish().unwrap();
    bytes
}

fn code(code: f64, max: f64) -> f32 {
    linear_from_srgb(code / max) as f32
}

#[test]
fn every_kind_of_png_is_read() {
    use png::{BitDepth, ColorType};
    let (a, b) = (code(100.0, 255.0), code(200.0, 255.0));
    let gray = png_bytes(
        (2, 1),
        ColorType::Grayscale,
        BitDepth::Eight,
        &[100, 200],
        |_| {},
    );
    assert_eq!(
        load("x", &gray).unwrap().color,
        [[a, a, a, 1.0], [b, b, b, 1.0]]
    );
    // Two bits a pixel: 0, 85, 170, 255.
    let low = png_bytes(
        (4, 1),
        ColorType::Grayscale,
        BitDepth::Two,
        &[0b0001_1011],
        |_| {},
    );
    let values = [0.0, 85.0, 170.0, 255.0].map(|c| code(c, 255.0));
    assert_eq!(
        load("x.exr", &low).unwrap().color,
        values.map(|v| [v, v, v, 1.0])
    );
    let gray_alpha = png_bytes(
        (1, 1),
        ColorType::GrayscaleAlpha,
        BitDepth::Eight,
        &[100, 51],
        |_| {},
    );
    let pixel = load("x", &gray_alpha).unwrap().color[0];
    assert!(
        (pixel[0] - a * 0.2).abs() < 1e-7 && pixel[3] == 0.2,
        "{pixel:?}"
    );
    let palette = png_bytes(
        (2, 1),
        ColorType::Indexed,
        BitDepth::Eight,
        &[1, 0],
        |encoder| {
            encoder.set_palette(vec![0, 0, 255, 100, 200, 0]);
            encoder.set_trns(vec![0, 255]);
        },
    );
    assert_eq!(
        load("x", &palette).unwrap().color,
        [[a, b, 0.0, 1.0], [0.0; 4]]
    );
    let sixteen = png_bytes(
        (1, 1),
        ColorType::Rgb,
        BitDepth::Sixteen,
        &[0, 1, 0x80, 0, 0xff, 0xff],
        |_| {},
    );
    let color = [code(1.0, 65_535.0), code(32_768.0, 65_535.0), 1.0, 1.0];
    assert_eq!(load("x", &sixteen).unwrap().color, [color]);
}

#[test]
fn a_png_that_is_not_srgb_is_refused() {
    let linear = |gamma: f32| {
        png_bytes(
            (1, 1),
            png::ColorType::Grayscale,
            png::BitDepth::Eight,
            &[128],
            |encoder| {
                encoder.set_source_gamma(png::ScaledFloat::new(gamma));
            },
        )
    };
    assert!(load("x", &linear(0.45455)).is_ok());
    let error = load("x", &linear(1.0)).unwrap_err().to_string();
    assert!(error.contains("gamma"), "{error}");
}

fn exr_bytes(size: (usize, usize), channels: Vec<(&str, FlatSamples)>) -> Vec<u8> {
    let list: SmallVec<_> = channels
        .into_iter()
        .map(|(name, samples)| AnyChannel::new(name, samples))
        .collect();
    let layer = Layer::new(
        size,
        LayerAttributes::default(),
        Encoding::default(),
        AnyChannels::sort(list),
    );
    let mut bytes = std::io::Cursor::new(Vec::new());
    Image::from_layer(layer)
        .write()
        .to_buffered(&mut bytes)
        .unwrap();
    bytes.into_inner()
}

#[test]
fn half_floats_and_gray_exr_are_read() {
    let half = |v: f32| FlatSamples::F16(vec![f16::from_f32(v); 2]);
    let rgb = exr_bytes(
        (2, 1),
        vec![("R", half(0.5)), ("G", half(0.25)), ("B", half(2.0))],
    );
    assert_eq!(
        load("x.png", &rgb).unwrap().color,
        [[0.5, 0.25, 2.0, 1.0]; 2]
    );
    let gray = exr_bytes(
        (2, 1),
        vec![("Y", FlatSamples::F32(vec![0.1, 0.2])), ("A", half(0.5))],
    );
    assert_eq!(
        load("x", &gray).unwrap().color,
        [[0.1, 0.1, 0.1, 0.5], [0.2, 0.2, 0.2, 0.5]]
    );
    let other = exr_bytes((2, 1), vec![("X", half(0.5)), ("diffuse.R", half(0.5))]);
    let error = load("x", &other).unwrap_err().to_string();
    assert!(error.contains("X, diffuse.R"), "{error}");
    let whole = exr_bytes((2, 1), vec![("Y", FlatSamples::U32(vec![1, 2]))]);
    assert!(
        load("x", &whole)
            .unwrap_err()
            .to_string()
            .contains("whole numbers")
    );
}

#[test]
fn what_is_no_picture_is_said_to_be_none() {
    for bytes in [&b""[..], b"\x89PNG", b"P6 2 2 255 ", &[0; 100]] {
        assert!(
            matches!(load("a.png", bytes), Err(PictureError::NotAPicture { .. })),
            "{bytes:?}"
        );
    }
    let folder = tempfile::tempdir().unwrap();
    assert!(matches!(
        Picture::load(folder.path()),
        Err(PictureError::NotAPicture { .. })
    ));
    let gone = folder.path().join("gone.png");
    let error = Picture::load(&gone).unwrap_err();
    assert!(
        matches!(error, PictureError::Io { .. }) && error.to_string().contains("gone.png"),
        "{error}"
    );
}

/// A PNG header that states this size and then ends.
fn lying_png(width: u32, height: u32) -> Vec<u8> {
    let mut bytes = png_bytes(
        (1, 1),
        png::ColorType::Rgba,
        png::BitDepth::Sixteen,
        &[0; 8],
        |_| {},
    );
    bytes[16..20].copy_from_slice(&width.to_be_bytes());
    bytes[20..24].copy_from_slice(&height.to_be_bytes());
    // The checksum of IHDR, so that it is the size that is judged.
    let mut crc = !0_u32;
    for &byte in &bytes[12..29] {
        crc ^= u32::from(byte);
        for _ in 0..8 {
            crc = (crc >> 1) ^ (0xedb8_8320 * (crc & 1));
        }
    }
    bytes[29..33].copy_from_slice(&(!crc).to_be_bytes());
    bytes
}

#[test]
fn sizes_that_a_file_cannot_hold_are_refused_before_they_are_allocated() {
    assert!(load("x", &lying_png(1, 1)).is_ok());
    for (width, height) in [
        (0, 5),
        (5, 0),
        (70_000, 1),
        (0x7fff_ffff, 0x7fff_ffff),
        (40_000, 40_000),
    ] {
        assert!(
            matches!(
                load("x", &lying_png(width, height)),
                Err(PictureError::Decode { .. })
            ),
            "{width} {height}"
        );
    }
    let error = load("x", &lying_png(16_000, 8_000))
        .unwrap_err()
        .to_string();
    assert!(error.contains("asks for"), "{error}");

    // The data window of an EXR: the attribute's name and type, its length, then x0 y0 x1 y1.
    let good = exr_bytes((2, 1), vec![("Y", FlatSamples::F32(vec![0.1, 0.2]))]);
    let name = b"dataWindow\0box2i\0";
    let at = good
        .windows(name.len())
        .position(|window| window == name)
        .unwrap()
        + name.len()
        + 4;
    for (x1, y1) in [
        (i32::MAX, i32::MAX),
        (60_000, 2_000),
        (-5, -5),
        (0, 1 << 20),
    ] {
        let mut bytes = good.clone();
        bytes[at + 8..at + 12].copy_from_slice(&x1.to_le_bytes());
        bytes[at + 12..at + 16].copy_from_slice(&y1.to_le_bytes());
        assert!(
            matches!(load("x", &bytes), Err(PictureError::Decode { .. })),
            "{x1} {y1}"
        );
    }
}

fn sample_files() -> Vec<Vec<u8>> {
    let color = (0..19 * 23)
        .map(|i| [0.1, i as f32 * 0.002, 0.5, 0.9])
        .collect();
    let mut picture = Picture::from_color(19, 23, color).unwrap();
    picture.metadata = vec![("graph".to_owned(), "()".to_owned())];
    let folder = tempfile::tempdir().unwrap();
    let saved = |name: &str, bits| {
        let path = folder.path().join(name);
        let _ = picture
            .save(&path, SaveOptions::default().with_png_bits(bits))
            .unwrap();
        fs::read(path).unwrap()
    };
    vec![
        saved("a.png", PngBits::Eight),
        saved("b.png", PngBits::Sixteen),
        saved("c.exr", PngBits::Eight),
    ]
}

#[test]
fn truncated_files_are_errors() {
    for bytes in sample_files() {
        assert!(load("x", &bytes).is_ok());
        for len in (0..bytes.len()).step_by(7) {
            assert!(
                load("x", &bytes[..len]).is_err(),
                "{len} of {} bytes",
                bytes.len()
            );
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn damaged_files_do_not_panic(
        which in 0..3_usize,
        damage in proptest::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
    ) {
        let mut bytes = FILES.with(|files| files[which].clone());
        for (at, byte) in damage {
            let at = at.index(bytes.len());
            bytes[at] = byte;
        }
        let _ = load("x", &bytes);
    }
}

thread_local! {
    static FILES: Vec<Vec<u8>> = sample_files();
}
