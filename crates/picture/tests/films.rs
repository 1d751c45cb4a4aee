//! Films come back frame by frame: animated PNG code by code, GIF with the colours that it has room for.

#![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use volgraph_picture::srgb::srgb_from_linear;
use volgraph_picture::{FilmFile, FilmFormat, Picture, PictureError, PngBits};

const SIZE: [u32; 2] = [6, 4];

/// Few colours, others in each frame; the last frame is transparent at one pixel.
fn frame(number: u32) -> Picture {
    let [width, height] = SIZE;
    let color = (0..width * height)
        .map(|at| {
            let share = ((at + number) % 5) as f32 / 4.0;
            [share, 0.25, 1.0 - share, 1.0]
        })
        .collect();
    let mut picture = Picture::from_color(width, height, color).unwrap();
    if number == 2 {
        picture.color[7] = [0.0; 4];
    }
    picture.metadata = vec![("graph.text".to_owned(), format!("of frame {number}"))];
    picture
}

/// The codes of a picture, as eight bits have them.
fn codes(picture: &Picture) -> Vec<u8> {
    let pixels = picture.color.iter();
    let code = |c: f32| (srgb_from_linear(f64::from(c)) * 255.0).round() as u8;
    pixels
        .flat_map(|[r, g, b, a]| [code(*r), code(*g), code(*b), (a * 255.0).round() as u8])
        .collect()
}

fn write(path: &Path, rate: f64, bits: PngBits) {
    let mut film = FilmFile::create(path, 3, rate, bits).unwrap();
    for number in 0..3 {
        let report = film.push(&frame(number)).unwrap();
        assert_eq!((report.nan_pixels, report.clipped_pixels), (0, 0));
        assert!(!path.exists(), "half of a film is seen");
    }
    film.finish().unwrap();
}

fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap();
    entries
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect()
}

#[test]
fn an_animated_png_has_every_frame_code_by_code() {
    let scratch = tempfile::tempdir().unwrap();
    let path = scratch.path().join("film.png");
    write(&path, 29.97, PngBits::Eight);
    let decoder = png::Decoder::new(BufReader::new(File::open(&path).unwrap()));
    let mut reader = decoder.read_info().unwrap();
    let animation = reader.info().animation_control().unwrap();
    assert_eq!((animation.num_frames, animation.num_plays), (3, 0));
    let mut data = vec![0; reader.output_buffer_size().unwrap()];
    for number in 0..3 {
        reader.next_frame(&mut data).unwrap();
        let control = reader.info().frame_control().unwrap();
        assert_eq!((control.delay_num, control.delay_den), (100, 2997));
        assert_eq!(data, codes(&frame(number)), "{number}");
    }
    assert!(reader.next_frame(&mut data).is_err(), "one more");
    // A reader of still pictures sees the first, with its metadata.
    let still = Picture::load(&path).unwrap();
    assert_eq!(codes(&still), codes(&frame(0)));
    assert_eq!(still.metadata, frame(0).metadata);
    assert_eq!(names(scratch.path()), ["film.png"]);
}

#[test]
fn sixteen_bits_are_kept() {
    let scratch = tempfile::tempdir().unwrap();
    let path = scratch.path().join("film.apng");
    write(&path, 25.0, PngBits::Sixteen);
    let still = Picture::load(&path).unwrap();
    for (is, was) in still.color.iter().zip(&frame(0).color) {
        assert!(is.iter().zip(was).all(|(is, was)| (is - was).abs() < 3e-5));
    }
}

#[test]
fn a_gif_has_every_frame_in_its_own_colours() {
    let scratch = tempfile::tempdir().unwrap();
    let path = scratch.path().join("film.GIF");
    write(&path, 30.0, PngBits::Eight);
    let mut options = gif::DecodeOptions::new();
    options.set_color_output(gif::ColorOutput::RGBA);
    let mut decoder = options.read_info(File::open(&path).unwrap()).unwrap();
    assert_eq!(decoder.repeat(), gif::Repeat::Infinite);
    for (number, delay) in [(0, 3), (1, 4), (2, 3)] {
        let read = decoder.read_next_frame().unwrap().unwrap();
        assert_eq!(read.delay, delay);
        // Fewer than 256 colours: each is kept.
        assert_eq!(read.buffer.as_ref(), codes(&frame(number)), "{number}");
    }
    assert!(decoder.read_next_frame().unwrap().is_none());
}

#[test]
fn what_is_not_finished_leaves_nothing() {
    let scratch = tempfile::tempdir().unwrap();
    for name in ["film.png", "film.gif"] {
        let path = scratch.path().join(name);
        let mut film = FilmFile::create(&path, 3, 25.0, PngBits::Eight).unwrap();
        let _ = film.push(&frame(0)).unwrap();
        assert_eq!(names(scratch.path()).len(), 1);
        drop(film);
        assert_eq!(names(scratch.path()).len(), 0, "{name}");
        // Too few, too many, and one of another size.
        let mut film = FilmFile::create(&path, 2, 25.0, PngBits::Eight).unwrap();
        let _ = film.push(&frame(0)).unwrap();
        assert!(matches!(film.finish(), Err(PictureError::Encode { .. })));
        let mut film = FilmFile::create(&path, 1, 25.0, PngBits::Eight).unwrap();
        let _ = film.push(&frame(0)).unwrap();
        let more = film.push(&frame(1));
        assert!(matches!(more, Err(PictureError::Encode { .. })));
        drop(film);
        let mut film = FilmFile::create(&path, 2, 25.0, PngBits::Eight).unwrap();
        let _ = film.push(&frame(0)).unwrap();
        let other = Picture::from_color(1, 1, vec![[0.0; 4]]).unwrap();
        assert!(matches!(film.push(&other), Err(PictureError::Shape { .. })));
        drop(film);
        assert_eq!(names(scratch.path()).len(), 0, "{name}");
    }
    for rate in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let path = scratch.path().join("film.png");
        assert!(FilmFile::create(&path, 1, rate, PngBits::Eight).is_err());
    }
    assert_eq!(FilmFormat::of(Path::new("film.webp")), None);
    assert_eq!(FilmFormat::of(Path::new("film")), None);
}
