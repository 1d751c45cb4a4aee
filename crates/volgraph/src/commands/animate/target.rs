//! Where frames go: into a folder, numbered, or into one animated file.

use std::path::{Path, PathBuf};

use volgraph::{Finding, Findings, Picture, Place};
use volgraph_picture::{FilmFile, FilmFormat, PngBits, SaveOptions, SaveReport};

use crate::commands::{check_overwrites, errors, folder_of, write};
use crate::output;

/// Digits of the frames' numbers, at least.
const DIGITS: usize = 4;

/// What begins the names of frames.
const FRAME: &str = "frame_";

/// GIFs that are faster are shown slower.
const MAX_GIF_RATE: f64 = 50.0;

/// Where frames go.
pub struct Target {
    path: PathBuf,
    kind: Kind,
    bits: PngBits,
    saved: SaveReport,
}

enum Kind {
    Folder { digits: usize },
    File(FilmFile),
}

impl Target {
    /// Refuses a name that no film can be saved to, before anything else is done.
    ///
    /// # Errors
    /// `film-extension`, `io`.
    pub fn check(path: &Path) -> Result<(), Findings> {
        let refused = |code, why: String, help: &str| {
            Err(Finding::error(code, why)
                .at(Place::whole_file(path))
                .help(help)
                .into())
        };
        let folder = folder_of(path);
        if path.is_dir() {
            Ok(())
        } else if FilmFormat::of(path).is_some() {
            if folder.is_dir() {
                return Ok(());
            }
            let why = format!("there is no folder {}", folder.display());
            refused("io", why, "check the path, its folder and your permissions")
        } else if path.is_file() {
            let help = "name a folder for numbered frames, or a .png, .apng or .gif";
            refused("io", "it is a file, and no film".to_owned(), help)
        } else if path.extension().is_some() {
            let why = "the extension names no format of films".to_owned();
            let help = "end the name with .png, .apng or .gif; or name a folder for numbered frames, of which `ffmpeg -i FOLDER/frame_%04d.png` makes others";
            refused("film-extension", why, help)
        } else {
            Ok(())
        }
    }

    /// Begins it; a film that is there is replaced at the end, and pictures one by one.
    ///
    /// # Errors
    /// `overwrites-input`, `io`.
    pub fn open(
        path: &Path,
        frames: u32,
        rate: f64,
        bits: PngBits,
        inputs: &[PathBuf],
    ) -> Result<Self, Findings> {
        let kind = match FilmFormat::of(path).filter(|_| !path.is_dir()) {
            Some(format) => {
                check_overwrites(path, inputs.iter().map(PathBuf::as_path))?;
                if format == FilmFormat::Gif && rate > MAX_GIF_RATE {
                    output::warn(&format!(
                        "viewers show GIFs of more than {MAX_GIF_RATE} frames a second slower; .png has any rate"
                    ));
                }
                let film = FilmFile::create(path, frames, rate, bits);
                Kind::File(film.map_err(|error| errors::of_picture(&error, path))?)
            }
            None => {
                let digits = (frames - 1).to_string().len().max(DIGITS);
                // Only what is named as a frame is can be replaced by one.
                for input in inputs.iter().filter(|input| number(input).is_some()) {
                    let frame = path.join(input.file_name().unwrap_or_default());
                    check_overwrites(&frame, [input.as_path()])?;
                }
                write::folder(path)?;
                tell_others(path, frames, digits);
                Kind::Folder { digits }
            }
        };
        Ok(Self {
            path: path.to_path_buf(),
            kind,
            bits,
            saved: SaveReport::default(),
        })
    }

    /// Saves a frame.
    ///
    /// # Errors
    /// What the file system or the format refuses.
    pub fn push(&mut self, number: u32, picture: &Picture) -> Result<(), Findings> {
        let failed = |error, path: &Path| Findings::from(errors::of_picture(&error, path));
        let report = match &mut self.kind {
            Kind::File(film) => film
                .push(picture)
                .map_err(|error| failed(error, &self.path))?,
            Kind::Folder { digits } => {
                let digits = *digits;
                let file = self.path.join(format!("{FRAME}{number:0digits$}.png"));
                let options = SaveOptions::default().with_png_bits(self.bits);
                picture
                    .save(&file, options)
                    .map_err(|error| failed(error, &file))?
            }
        };
        self.saved.nan_pixels += report.nan_pixels;
        self.saved.clipped_pixels += report.clipped_pixels;
        Ok(())
    }

    /// Ends it, and says what the files could not hold.
    ///
    /// # Errors
    /// What the file system refuses.
    pub fn finish(self) -> Result<SaveReport, Findings> {
        if let Kind::File(film) = self.kind {
            film.finish()
                .map_err(|error| errors::of_picture(&error, &self.path))?;
        }
        Ok(self.saved)
    }
}

/// The number that a frame's name has.
fn number(file: &Path) -> Option<(u32, usize)> {
    let name = file.file_name()?.to_str()?;
    let digits = name.strip_prefix(FRAME)?.strip_suffix(".png")?;
    let is_number = digits.len() >= DIGITS && digits.bytes().all(|it| it.is_ascii_digit());
    Some((digits.parse().ok().filter(|_| is_number)?, digits.len()))
}

/// Frames of another film that will stay in the folder would be taken for this one's.
fn tell_others(folder: &Path, frames: u32, digits: usize) {
    let Ok(entries) = std::fs::read_dir(folder) else {
        return;
    };
    let stays = |(number, length)| number >= frames || length != digits;
    let others = entries
        .flatten()
        .filter(|entry| number(&entry.path()).is_some_and(stays));
    let count = others.count();
    if count > 0 {
        output::warn(&format!(
            "{} has {count} frames of another film, which stay there",
            folder.display()
        ));
    }
}
