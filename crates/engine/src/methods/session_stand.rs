//! Methods on a device: a session for each, with the sources and the device shared.

use std::sync::Arc;
use std::time::Instant;

use glam::DVec3;
use volgraph_gpu::{FrameReport, Gpu};
use volgraph_graph::Camera;
use volgraph_picture::Picture;
use volgraph_report::{Finding, Findings};

use super::accuracy::Errors;
use super::measurement::Method;
use super::stand::{Frames, Stand};
use super::turn::{middle, turned};
use super::yardstick::Yardstick;
use crate::scene::Scene;
use crate::session::{Session, SessionOptions};

/// Told each method's picture.
pub type OnPicture<'a> = Box<dyn FnMut(&Method, &Picture, &Errors) -> Result<(), Findings> + 'a>;

/// Draws a scene's raycast by methods. Frames turn the camera by one degree each about its up direction, so that none is
/// remembered; a frame's time ends when its colours are in memory.
pub struct SessionStand<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// The device.
    pub gpu: Arc<Gpu>,
    /// How sessions are opened; the size of the yardstick's truth.
    pub options: SessionOptions,
    /// The raycast's name.
    pub node: String,
    /// What pictures are held against.
    pub yardstick: &'a Yardstick,
    /// Told each method's picture.
    pub on_picture: OnPicture<'a>,
    /// When the survey started.
    pub started: Instant,
}

/// A method that is ready to draw.
pub struct Ready {
    session: Session,
    camera: Camera,
    target: DVec3,
}

impl Ready {
    /// A session as it is.
    #[must_use]
    pub fn new(session: Session) -> Self {
        let (camera, target) = (session.view().camera, middle(session.plan()));
        Self {
            session,
            camera,
            target,
        }
    }
}

impl SessionStand<'_> {
    /// A session that draws by a method.
    ///
    /// # Errors
    /// What the scene, the kinds, the shaders or the device refuse of it.
    pub fn session(&self, method: &Method) -> Result<Session, Findings> {
        let scene = self.scene.with_sets(&method.overrides(&self.node))?;
        let options = SessionOptions {
            is_as_written: true,
            ..self.options.clone()
        };
        Session::start(scene, Arc::clone(&self.gpu), &options)
    }
}

impl Frames for SessionStand<'_> {
    type Ready = Ready;

    fn frame(&mut self, ready: &mut Ready, number: u32) -> Result<f64, Findings> {
        let camera = turned(&ready.camera, ready.target, f64::from(number));
        Ok(timed_frame(&mut ready.session, camera, true)?.0)
    }
}

impl Stand for SessionStand<'_> {
    fn prepare(&mut self, method: &Method) -> Result<(Ready, Errors), Findings> {
        let mut session = self.session(method)?;
        let (picture, _) = session.render_checked()?;
        let errors = self.yardstick.errors(&picture)?;
        (self.on_picture)(method, &picture, &errors)?;
        Ok((Ready::new(session), errors))
    }

    fn bytes(&self, ready: &Ready) -> u64 {
        let allocations = ready.session.plan().allocations.iter();
        allocations
            .map(|allocation| allocation.resource.bytes())
            .sum()
    }

    fn seconds(&self) -> f64 {
        self.started.elapsed().as_secs_f64()
    }
}

/// Draws a frame from a camera, with its colours in memory where they are read back: milliseconds, and what was done.
///
/// # Errors
/// As [`Session::draw`]; `same-view` where nothing had to be drawn, since the camera is where it was.
pub fn timed_frame(
    session: &mut Session,
    camera: Camera,
    reads_back: bool,
) -> Result<(f64, FrameReport), Findings> {
    session.place_camera(camera);
    let start = Instant::now();
    let report = session.draw()?;
    if reads_back {
        session.read("color")?;
    }
    let ms = start.elapsed().as_secs_f64() * 1e3;
    if report.ran().is_empty() {
        let message = "a frame that was to be timed was that of before, and nothing was drawn";
        return Err(Finding::error("same-view", message)
            .help("turn the camera farther from frame to frame")
            .into());
    }
    Ok((ms, report))
}
