//! What the interface asks for, and how it is taken together.

use std::collections::BTreeSet;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use volgraph_engine::{Camera, CameraDesc, Change, ParamOverride, Session};

use super::{Turntable, Work};

/// What the interface asks for.
#[derive(Clone, Debug)]
pub enum Request {
    /// Another graph, or a volume alone.
    Open(PathBuf),
    /// The camera moves to exactly there.
    Camera(Camera),
    /// The camera as described; what is open is fitted to the volumes.
    Describe(CameraDesc),
    /// Width and height of the picture in pixels.
    Size([u32; 2]),
    /// Values of parameters, choices of slots, fields of sources.
    Set(Vec<ParamOverride>),
    /// These files are other than before, told by who wrote them.
    Files(BTreeSet<PathBuf>),
    /// Shows a node's port (`node.port`) in the graph panel.
    Look(Option<String>),
    /// Compares a small picture with its reference.
    Compare,
    /// Studies the ray of a pixel of the full picture: column and row from the top left.
    Ray([f64; 2]),
    /// Saves the present view in any size, in tiles where it has to be.
    Save {
        /// A .png or .exr.
        file: PathBuf,
        /// Width and height in pixels.
        size: [u32; 2],
    },
    /// Draws a film.
    Film(Turntable),
    /// Whether files are not followed; what is asked for is drawn all the same.
    Pause(bool),
    /// Reads the files again and draws, paused or not.
    Frame,
    /// Most milliseconds of a frame while the camera moves.
    Budget(f64),
}

/// Requests that came together.
#[derive(Default)]
pub(super) struct Asked {
    open: Option<PathBuf>,
    sets: Vec<ParamOverride>,
    files: BTreeSet<PathBuf>,
    look: Option<Option<String>>,
    camera: Option<Camera>,
    described: Option<CameraDesc>,
    size: Option<[u32; 2]>,
    compare: bool,
    ray: Option<[f64; 2]>,
    saves: Vec<(PathBuf, [u32; 2])>,
    films: Vec<Turntable>,
    frame: bool,
}

impl Work {
    pub(super) fn gather(&mut self, request: Request, asked: &mut Asked) {
        match request {
            Request::Open(path) => asked.open = Some(path),
            Request::Camera(camera) => {
                asked.camera = Some(camera);
                asked.described = None;
            }
            Request::Describe(camera) => {
                asked.described = Some(camera);
                asked.camera = None;
            }
            Request::Size(size) => asked.size = Some(size.map(|side| side.max(1))),
            Request::Set(sets) => {
                for set in sets {
                    let is_other = |before: &ParamOverride| {
                        (&before.target, &before.name, before.is_slot)
                            != (&set.target, &set.name, set.is_slot)
                    };
                    asked.sets.retain(is_other);
                    asked.sets.push(set);
                }
            }
            Request::Files(files) => asked.files.extend(files),
            Request::Look(port) => asked.look = Some(port),
            Request::Compare => asked.compare = true,
            Request::Save { file, size } => asked.saves.push((file, size)),
            Request::Film(turntable) => asked.films.push(turntable),
            Request::Ray(pixel) => asked.ray = Some(pixel),
            Request::Pause(is_paused) => {
                self.is_paused = is_paused;
                self.tell(|told| told.is_paused = is_paused);
            }
            Request::Frame => asked.frame = true,
            Request::Budget(milliseconds) => {
                self.budget = Duration::from_secs_f64(milliseconds.max(1.0) / 1e3);
            }
        }
    }

    pub(super) fn answer(&mut self, asked: Asked) {
        if let Some(graph) = asked.open {
            self.open(graph);
        }
        if let Some(size) = asked.size
            && size != self.full
        {
            self.full = size;
            self.options.session.size = size;
            self.moved = self.moved.or(Some(Instant::now()));
        }
        if asked.frame {
            let known = self.session.as_ref().map(Session::dependencies);
            let files = known.map(|known| known.files.keys().cloned().collect());
            self.apply(&Change::Files(files.unwrap_or_default()), true);
        }
        if !asked.files.is_empty() {
            self.be_coarse();
            self.apply(&Change::Files(asked.files), true);
        }
        if !asked.sets.is_empty() {
            self.set(asked.sets);
        }
        if let Some(port) = asked.look {
            self.apply(&Change::Look(port), true);
        }
        if let Some(camera) = asked.described {
            self.move_to(|session| session.set_camera(&camera));
        }
        if let Some(camera) = asked.camera {
            self.move_to(|session| session.place_camera(camera));
        }
        if asked.compare {
            self.compare();
        }
        if let Some(pixel) = asked.ray {
            self.study(pixel);
        }
        for (file, size) in asked.saves {
            self.save(&file, size);
        }
        for turntable in asked.films {
            self.film(&turntable);
        }
    }
}
