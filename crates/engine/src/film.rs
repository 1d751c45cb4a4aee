//! Films: frame after frame of one session, while the camera goes its way and parameters change.
//!
//! The way of the data: a [`CameraPath`] is a turntable, or keys read from a file ([`CameraPath::read`]).
//! [`Film::new`] lays it over a plan and gives [`FilmFrame`]s: each a camera with nothing left open, and what is set.
//! [`Film::render`] draws them with one [`Session`] and hands each picture on. What is set is set by
//! [`Change::Set`], so a value that is refused is told at the path file's own line.

mod keys;
mod spline;
#[cfg(test)]
mod tests;
mod values;
mod way;

use std::path::Path;

use glam::DVec3;
use volgraph_graph::{Camera, CameraDesc, Plan, Pose};
use volgraph_picture::Picture;
use volgraph_report::{Finding, Findings, Place};

use crate::methods::around;
use crate::overrides::{ParamOverride, TIME};
use crate::scene::SourceProgress;
use crate::session::{Change, Outcome, Session};

pub use self::keys::{Key, KeyedPath};

/// Most frames of a film: an hour and more.
pub const MAX_FRAMES: u32 = 100_000;

/// The way that a camera goes.
#[derive(Clone, Debug, PartialEq)]
pub enum CameraPath {
    /// Around the target of the graph's camera, about the direction that is up there.
    Turntable {
        /// How far, in degrees; anticlockwise as seen from above, as a growing azimuth goes. Whole turns close: the frame
        /// after the last would be the first. Of other arcs the last frame is the end.
        degrees: f64,
    },
    /// From key to key.
    Keys(KeyedPath),
}

impl Default for CameraPath {
    fn default() -> Self {
        Self::Turntable { degrees: 360.0 }
    }
}

impl CameraPath {
    /// Reads a path of keys from a RON file.
    ///
    /// # Errors
    /// All findings, each with its place.
    pub fn read(file: &Path) -> Result<Self, Findings> {
        keys::read_file(file).map(Self::Keys)
    }

    /// The same of a text; `file` is its name for findings.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub fn of_text(file: &Path, text: &str) -> Result<Self, Findings> {
        keys::read_text(file, text).map(Self::Keys)
    }

    /// The frames that the path itself asks for.
    #[must_use]
    pub fn frames(&self) -> Option<u32> {
        match self {
            Self::Turntable { .. } => None,
            Self::Keys(path) => Some(path.frames()),
        }
    }

    /// The frames per second that the path itself asks for.
    #[must_use]
    pub fn frames_per_second(&self) -> Option<f64> {
        match self {
            Self::Turntable { .. } => None,
            Self::Keys(path) => path.frames_per_second(),
        }
    }
}

/// One frame of a film.
#[derive(Clone, Debug, PartialEq)]
pub struct FilmFrame {
    /// The camera.
    pub camera: Camera,
    /// Parameters with their values here: the same ones in every frame.
    pub sets: Vec<ParamOverride>,
}

/// The frames of a film.
#[derive(Clone, Debug, PartialEq)]
pub struct Film {
    frames: Vec<FilmFrame>,
    /// Where each parameter is first set, in the order of the frames' sets.
    places: Vec<Place>,
}

impl Film {
    /// Lays a path over a plan, in so many frames: 1 to [`MAX_FRAMES`]; others are taken as the nearest of these.
    #[must_use]
    pub fn new(path: &CameraPath, plan: &Plan, frames: u32) -> Self {
        let frames = frames.clamp(1, MAX_FRAMES);
        match path {
            CameraPath::Turntable { degrees } => Self {
                frames: turntable(plan, *degrees, frames),
                places: Vec::new(),
            },
            CameraPath::Keys(path) => {
                let way = path.way(&plan.camera, plan);
                let graphs_own = plan.fit(&plan.camera);
                // Keys are met exactly where the film has the path's own frames.
                let last = f64::from(path.frames() - 1);
                let at = |frame: u32| match frames {
                    1 => 0.0,
                    frames if frames == path.frames() => f64::from(frame),
                    frames => last * f64::from(frame) / f64::from(frames - 1),
                };
                let frames = (0..frames).map(|frame| FilmFrame {
                    camera: way.camera(at(frame)).unwrap_or(graphs_own),
                    sets: path.sets(at(frame)),
                });
                Self {
                    frames: frames.collect(),
                    places: path.set_places(),
                }
            }
        }
    }

    /// The same film over time steps: from `first` to `last` of each of the volumes named in `series`, evenly over the
    /// frames. A parameter that the path sets itself stays the path's.
    #[must_use]
    pub fn over_steps(mut self, series: &[&str], first: u32, last: u32) -> Self {
        let gaps = self.frames.len().saturating_sub(1).max(1) as f64;
        for (number, frame) in self.frames.iter_mut().enumerate() {
            let share = number as f64 / gaps;
            let step = (f64::from(first) + share * (f64::from(last) - f64::from(first))).round();
            for source in series {
                let is_set = |set: &ParamOverride| set.target == *source && set.name == TIME;
                if !frame.sets.iter().any(is_set)
                    && let Ok(set) = ParamOverride::parse(&format!("{source}.{TIME}={step}"))
                {
                    frame.sets.push(set);
                }
            }
        }
        self
    }

    /// The frames.
    #[must_use]
    pub fn frames(&self) -> &[FilmFrame] {
        &self.frames
    }

    /// Draws the frames one after the other and hands each picture on with its number, from 0, and the frame's hazards,
    /// until `take` is against it. The session's camera and parameters are then those of the last frame.
    ///
    /// # Errors
    /// What [`Session::apply`] or [`Session::render`] refuse, and what `take` gives.
    pub fn render<E: From<Findings>>(
        &self,
        session: &mut Session,
        progress: &dyn SourceProgress,
        mut take: impl FnMut(u32, Picture, &Findings) -> Result<(), E>,
    ) -> Result<(), E> {
        let mut set: &[ParamOverride] = &[];
        for (number, frame) in (0..).zip(&self.frames) {
            session.place_camera(frame.camera);
            let mut drawn = None;
            if frame.sets != set {
                let changed = frame.sets.iter().filter(|value| !set.contains(value));
                let change = Change::Set(changed.cloned().collect());
                drawn = match session.apply_with(&change, progress) {
                    Ok(Outcome::Drawn(drawn)) => Some((drawn.picture, drawn.report.frame)),
                    Ok(Outcome::Unchanged) => None,
                    Err(refused) => return Err(self.placed(number, &refused.findings).into()),
                };
                set = &frame.sets;
            }
            let (picture, report) = match drawn {
                Some(drawn) => drawn,
                None => session.render()?,
            };
            take(number, picture, &report.all_warnings())?;
        }
        Ok(())
    }

    /// Findings about what a frame sets, at the line of the path file where that is set.
    fn placed(&self, frame: u32, findings: &Findings) -> Findings {
        let sets = self
            .frames
            .get(frame as usize)
            .map_or(&[][..], |it| &it.sets);
        let placed = findings.sorted().into_iter().map(|finding| {
            let is_here = |set: &ParamOverride| finding.place.as_ref() == Some(&set.place());
            let place = sets
                .iter()
                .position(is_here)
                .and_then(|at| self.places.get(at));
            match place {
                Some(place) => Finding {
                    message: format!("{} (in frame {frame})", finding.message),
                    ..finding.clone().at(place.clone())
                },
                None => finding.clone(),
            }
        });
        placed.collect()
    }
}

fn turntable(plan: &Plan, degrees: f64, frames: u32) -> Vec<FilmFrame> {
    let camera = plan.fit(&plan.camera);
    let target = target(plan);
    let cameras = turned_cameras(&camera, target, plan.camera.up, degrees, frames);
    let frames = cameras.into_iter().map(|camera| FilmFrame {
        camera,
        sets: Vec::new(),
    });
    frames.collect()
}

/// What the graph's camera looks at.
fn target(plan: &Plan) -> DVec3 {
    let (Pose::Orbit { target, .. } | Pose::LookAt { target, .. }) = plan.camera.pose;
    target.unwrap_or_else(|| CameraDesc::middle(&plan.corners()))
}

/// Cameras around a target, from one on: so many degrees about an axis as a whole. A whole turn closes without a doubled
/// frame; of another arc the last frame is the end.
#[must_use]
pub fn turned_cameras(
    from: &Camera,
    target: DVec3,
    axis: DVec3,
    degrees: f64,
    frames: u32,
) -> Vec<Camera> {
    let is_closed = degrees % 360.0 == 0.0;
    let gaps = if is_closed {
        frames
    } else {
        frames.saturating_sub(1)
    };
    let turned = |frame: u32| match frame {
        0 => *from,
        frame => around(
            from,
            target,
            axis,
            degrees * f64::from(frame) / f64::from(gaps),
        ),
    };
    (0..frames).map(turned).collect()
}
