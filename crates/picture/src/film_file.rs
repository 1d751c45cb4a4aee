//! Films: pictures one after the other in one file, animated PNG or GIF.
//!
//! The way of the data: [`FilmFile::create`] begins a file under another name; each picture that is pushed is encoded
//! and written at once, so that a film is never in memory as a whole; [`FilmFile::finish`] gives the file its own name.
//! A film that is dropped before, or abandoned ([`crate::abandon_unfinished`]), leaves nothing.
//!
//! | | PNG | GIF |
//! | --- | --- | --- |
//! | colour | the codes that a still PNG has, with alpha | 256 colours of each picture's own; where alpha is below one half, none |
//! | time | a fraction of seconds | hundredths of a second, rounded so that the film as a whole keeps its time |
//! | metadata | of the first picture | not kept |

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use gif::{DisposalMethod, Repeat};

use crate::files::Unfinished;
use crate::png_file::{codes, encoder};
use crate::{Picture, PictureError, PngBits, SaveReport};

/// How thoroughly a GIF's colours are chosen: 1 looks at every pixel, 30 at few.
const GIF_SPEED: i32 = 10;

/// The formats of films.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FilmFormat {
    /// Animated PNG.
    Png,
    /// GIF.
    Gif,
}

impl FilmFormat {
    /// The format that a path's extension names: `.png` and `.apng`, or `.gif`.
    #[must_use]
    pub fn of(path: &Path) -> Option<Self> {
        let extension = path.extension()?.to_str()?.to_ascii_lowercase();
        match extension.as_str() {
            "png" | "apng" => Some(Self::Png),
            "gif" => Some(Self::Gif),
            _ => None,
        }
    }
}

/// A film that is being written. It is shown again and again, without an end.
pub struct FilmFile {
    path: PathBuf,
    format: FilmFormat,
    frames: u32,
    frames_per_second: f64,
    bits: PngBits,
    /// What the first picture began.
    stream: Option<Stream>,
    size: [u32; 2],
    pushed: u32,
    /// The file's other name; the encoder has the file itself.
    unfinished: Unfinished,
    file: File,
}

enum Stream {
    Png(png::Writer<BufWriter<File>>),
    Gif(gif::Encoder<BufWriter<File>>),
}

impl FilmFile {
    /// Begins a film of so many pictures, at least one; `bits` are those of each PNG component.
    ///
    /// # Errors
    /// [`PictureError::Extension`], [`PictureError::Io`]; [`PictureError::Encode`] for a rate that is no number above 0.
    pub fn create(
        path: &Path,
        frames: u32,
        frames_per_second: f64,
        bits: PngBits,
    ) -> Result<Self, PictureError> {
        let named = path.to_path_buf();
        let Some(format) = FilmFormat::of(path) else {
            return Err(PictureError::Extension { path: named });
        };
        if !(frames_per_second > 0.0 && frames_per_second.is_finite()) || frames == 0 {
            let cause = format!("{frames} frames at {frames_per_second} a second are no film");
            return Err(PictureError::Encode { path: named, cause });
        }
        let (unfinished, file) = Unfinished::create(path).map_err(|source| PictureError::Io {
            path: named.clone(),
            source,
        })?;
        Ok(Self {
            path: named,
            format,
            frames,
            frames_per_second,
            bits,
            stream: None,
            size: [0; 2],
            pushed: 0,
            unfinished,
            file,
        })
    }

    /// Adds a picture, of the same size as the first.
    ///
    /// # Errors
    /// [`PictureError::Shape`] for another size, [`PictureError::Io`], [`PictureError::Encode`], also for one more
    /// than were told; and those of [`Picture::check`].
    pub fn push(&mut self, picture: &Picture) -> Result<SaveReport, PictureError> {
        picture.check()?;
        if self.pushed == 0 {
            self.size = [picture.width, picture.height];
        }
        if self.size != [picture.width, picture.height] {
            return Err(PictureError::Shape {
                buffer: "colour",
                len: picture.color.len(),
                width: self.size[0],
                height: self.size[1],
            });
        }
        if self.pushed == self.frames {
            return Err(self.encode(format!("a film of {} frames has no more", self.frames)));
        }
        let report = match self.format {
            FilmFormat::Png => self.push_png(picture).map_err(|error| self.of_png(error))?,
            FilmFormat::Gif => self.push_gif(picture).map_err(|error| self.of_gif(error))?,
        };
        self.pushed += 1;
        Ok(report)
    }

    fn push_png(&mut self, picture: &Picture) -> Result<SaveReport, png::EncodingError> {
        let writer = match &mut self.stream {
            Some(Stream::Png(writer)) => writer,
            _ => {
                let file = BufWriter::new(self.file.try_clone()?);
                // A later picture may have an alpha where the first has none, and there is one header for all.
                let mut encoder = encoder(file, picture, self.bits, true)?;
                encoder.set_animated(self.frames, 0)?;
                let (seconds, parts) = fraction(self.frames_per_second);
                encoder.set_frame_delay(seconds, parts)?;
                let writer = encoder.write_header()?;
                let Stream::Png(writer) = self.stream.insert(Stream::Png(writer)) else {
                    return Ok(SaveReport::default());
                };
                writer
            }
        };
        let (data, report) = codes(picture, self.bits, true);
        writer.write_image_data(&data)?;
        Ok(report)
    }

    fn push_gif(&mut self, picture: &Picture) -> Result<SaveReport, gif::EncodingError> {
        let side = |pixels: u32| {
            u16::try_from(pixels)
                .map_err(|_| io::Error::other("a GIF has at most 65535 pixels along a side"))
        };
        let (width, height) = (side(picture.width)?, side(picture.height)?);
        let encoder = match &mut self.stream {
            Some(Stream::Gif(encoder)) => encoder,
            _ => {
                let file = BufWriter::new(self.file.try_clone()?);
                let mut encoder = gif::Encoder::new(file, width, height, &[])?;
                encoder.set_repeat(Repeat::Infinite)?;
                let Stream::Gif(encoder) = self.stream.insert(Stream::Gif(encoder)) else {
                    return Ok(SaveReport::default());
                };
                encoder
            }
        };
        let (mut data, report) = codes(picture, PngBits::Eight, true);
        for pixel in data.as_chunks_mut::<4>().0 {
            *pixel = match *pixel {
                [red, green, blue, alpha] if alpha >= 128 => [red, green, blue, 255],
                _ => [0; 4],
            };
        }
        let mut frame = gif::Frame::from_rgba_speed(width, height, &mut data, GIF_SPEED);
        frame.dispose = DisposalMethod::Background;
        frame.delay = hundredths(self.pushed, self.frames_per_second);
        encoder.write_frame(&frame)?;
        Ok(report)
    }

    /// Ends the film and gives the file its name.
    ///
    /// # Errors
    /// [`PictureError::Io`]; [`PictureError::Encode`] where fewer pictures were pushed than were told.
    pub fn finish(mut self) -> Result<(), PictureError> {
        if self.pushed < self.frames {
            let cause = format!("it has {} of {} frames", self.pushed, self.frames);
            return Err(self.encode(cause));
        }
        match self.stream.take() {
            Some(Stream::Png(writer)) => {
                writer.finish().map_err(|error| self.of_png(error))?;
            }
            Some(Stream::Gif(encoder)) => {
                let ended = encoder.into_inner();
                let mut written = ended.map_err(|error| self.of_gif(error))?;
                written.flush().map_err(|source| self.io(source))?;
            }
            None => {}
        }
        let Self {
            unfinished,
            file,
            path,
            ..
        } = self;
        unfinished
            .finish(&file, true)
            .map_err(|source| PictureError::Io { path, source })
    }

    fn of_png(&self, error: png::EncodingError) -> PictureError {
        match error {
            png::EncodingError::IoError(source) => self.io(source),
            other => self.encode(other.to_string()),
        }
    }

    fn of_gif(&self, error: gif::EncodingError) -> PictureError {
        match error {
            gif::EncodingError::Io(source) => self.io(source),
            other => self.encode(other.to_string()),
        }
    }

    fn io(&self, source: io::Error) -> PictureError {
        PictureError::Io {
            path: self.path.clone(),
            source,
        }
    }

    fn encode(&self, cause: String) -> PictureError {
        PictureError::Encode {
            path: self.path.clone(),
            cause,
        }
    }
}

/// The seconds of a frame as a fraction: exactly, where a rate such as 29.97 has one.
fn fraction(frames_per_second: f64) -> (u16, u16) {
    let whole = (1..=1000_u16).find_map(|seconds| {
        let frames = frames_per_second * f64::from(seconds);
        let is_whole = (frames - frames.round()).abs() < 1e-9 * frames;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "in the range of u16"
        )]
        let parts = frames.round() as u16;
        (is_whole && (1.0..=65_535.0).contains(&frames.round())).then_some((seconds, parts))
    });
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "clamped to u16"
    )]
    whole.unwrap_or_else(|| {
        let milliseconds = (1e3 / frames_per_second).round().clamp(1.0, 65_535.0);
        (milliseconds as u16, 1000)
    })
}

/// The hundredths of a second that a frame lasts: what is rounded off one is given to the next.
fn hundredths(frame: u32, frames_per_second: f64) -> u16 {
    let end = |frames: f64| (100.0 * frames / frames_per_second).round();
    let lasts = end(f64::from(frame) + 1.0) - end(f64::from(frame));
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "clamped to u16"
    )]
    let lasts = lasts.clamp(0.0, 65_535.0) as u16;
    lasts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_are_fractions_of_seconds() {
        assert_eq!(fraction(25.0), (1, 25));
        assert_eq!(fraction(29.97), (100, 2997));
        assert_eq!(fraction(0.5), (2, 1));
        assert_eq!(fraction(12.5), (2, 25));
        // No fraction: the nearest of milliseconds.
        assert_eq!(fraction(std::f64::consts::PI), (318, 1000));
    }

    #[test]
    fn rounded_times_add_up() {
        for rate in [24.0, 25.0, 29.97, 30.0, 60.0] {
            let total: u32 = (0..300).map(|at| u32::from(hundredths(at, rate))).sum();
            assert!((f64::from(total) - 30_000.0 / rate).abs() <= 0.5, "{rate}");
        }
        assert_eq!(hundredths(0, 30.0), 3);
        assert_eq!(hundredths(1, 30.0), 4);
    }
}
