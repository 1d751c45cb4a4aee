//! Pictures of any size and films, drawn by the session between frames of the window.

use std::path::{Path, PathBuf};

use glam::DVec3;
use volgraph_engine::film::turned_cameras;
use volgraph_engine::{Camera, Change, Findings, Session};
use volgraph_picture::{FilmFile, FilmFormat, Picture, PictureError, PngBits, SaveOptions};
use volgraph_report::{Finding, Place};

use super::{Note, Work};

/// A turn of the camera, as a film.
#[derive(Clone, Debug, PartialEq)]
pub struct Turntable {
    /// A .png, .apng or .gif, or a folder for numbered pictures.
    pub to: PathBuf,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// How many pictures.
    pub frames: u32,
    /// Pictures a second, of a file.
    pub frames_per_second: f64,
    /// The whole turn.
    pub degrees: f64,
    /// World position that it turns around.
    pub target: DVec3,
    /// The direction that it turns about.
    pub axis: DVec3,
}

impl Work {
    /// Saves a picture of the present camera in any size.
    pub(super) fn save(&mut self, file: &Path, size: [u32; 2]) {
        let (told, wake) = (
            std::sync::Arc::clone(&self.told),
            std::sync::Arc::clone(&self.wake),
        );
        let Some(session) = &mut self.session else {
            return;
        };
        let [width, height] = size;
        let mut progress = |done: usize, of: usize| {
            let share = done as f32 / of.max(1) as f32;
            super::locked(&told).reading = Some((format!("{width} × {height}"), share));
            super::locked(&wake)();
        };
        self.progressive.set(false);
        let drawn = session.render_tiled(size, None, &mut progress);
        self.progressive.set(true);
        let saved = drawn.and_then(|(picture, _)| {
            picture
                .save(file, SaveOptions::default())
                .map_err(|error| failed(&error, file))
        });
        self.conclude(saved.map(|_| format!("saved {}", file.display())));
    }

    /// Draws a turn of the camera into a film.
    pub(super) fn film(&mut self, turntable: &Turntable) {
        let Some(session) = &mut self.session else {
            return;
        };
        let (camera, size) = (session.view().camera, session.view().size);
        let told = std::sync::Arc::clone(&self.told);
        let wake = std::sync::Arc::clone(&self.wake);
        self.progressive.set(false);
        let drawn = draw(session, turntable, &camera, |frame| {
            let share = frame as f32 / turntable.frames.max(1) as f32;
            super::locked(&told).reading = Some(("frames of the film".to_owned(), share));
            super::locked(&wake)();
        });
        session.place_camera(camera);
        let back = session.apply(&Change::Size(size));
        self.progressive.set(true);
        let back = back.map_err(|refused| refused.findings);
        let done = format!(
            "saved {} frames into {}",
            turntable.frames,
            turntable.to.display()
        );
        self.conclude(drawn.and(back).map(|_| done));
    }

    /// Says how it went, and shows the window's picture again.
    fn conclude(&mut self, done: Result<String, Findings>) {
        self.tell(|told| told.reading = None);
        match done {
            Ok(text) => {
                self.tell(|told| told.note(Note::new(text)));
                self.show(Findings::new());
            }
            Err(findings) => self.show(findings),
        }
    }
}

fn draw(
    session: &mut Session,
    turntable: &Turntable,
    camera: &Camera,
    progress: impl Fn(u32),
) -> Result<(), Findings> {
    let to = &turntable.to;
    let mut film = match FilmFormat::of(to).filter(|_| !to.is_dir()) {
        Some(_) => {
            let film = FilmFile::create(
                to,
                turntable.frames,
                turntable.frames_per_second,
                PngBits::Eight,
            );
            Some(film.map_err(|error| failed(&error, to))?)
        }
        None => {
            std::fs::create_dir_all(to).map_err(|error| -> Findings {
                let message = format!("the folder cannot be made: {error}");
                Finding::error("io", message)
                    .at(Place::whole_file(to))
                    .into()
            })?;
            None
        }
    };
    session
        .apply(&Change::Size(turntable.size))
        .map_err(|refused| refused.findings)?;
    let cameras = turned_cameras(
        camera,
        turntable.target,
        turntable.axis,
        turntable.degrees,
        turntable.frames,
    );
    for (frame, camera) in (0..).zip(cameras) {
        progress(frame);
        session.place_camera(camera);
        let (picture, _) = session.render()?;
        keep(film.as_mut(), to, frame, &picture)?;
    }
    match film {
        Some(film) => film.finish().map_err(|error| failed(&error, to)),
        None => Ok(()),
    }
}

fn keep(
    film: Option<&mut FilmFile>,
    to: &Path,
    frame: u32,
    picture: &Picture,
) -> Result<(), Findings> {
    let saved = match film {
        Some(film) => film.push(picture),
        None => picture.save(
            &to.join(format!("frame_{frame:04}.png")),
            SaveOptions::default(),
        ),
    };
    saved.map(|_| ()).map_err(|error| failed(&error, to))
}

fn failed(error: &PictureError, file: &Path) -> Findings {
    Finding::error("picture", error.to_string())
        .at(Place::whole_file(file))
        .help("check the name, its extension and folder, and your permissions")
        .into()
}
