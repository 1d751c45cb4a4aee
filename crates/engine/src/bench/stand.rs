//! Scenes on a device, ready to be timed.

use std::sync::Arc;
use std::time::Instant;

use glam::DVec3;
use volgraph_gpu::Gpu;
use volgraph_graph::Camera;
use volgraph_report::Findings;

use super::memory::device_bytes;
use super::rotation::Rotation;
use crate::methods::{Frames, around, middle, timed_frame};
use crate::scene::Scene;
use crate::session::{Session, SessionOptions};

/// Draws frames of entries over a rotation: the frame of number `n` is its view `n`, from the start again at its end.
pub struct BenchStand {
    /// The views.
    pub rotation: Rotation,
    /// Degrees that are added to all views. Frames that are not timed are drawn between the views: what did not change
    /// since the last frame is not drawn again, and would take no time.
    pub offset_degrees: f64,
    /// When the measurement started.
    pub started: Instant,
}

impl BenchStand {
    /// A stand that draws between the views, until [`Self::start`].
    #[must_use]
    pub fn new(rotation: Rotation) -> Self {
        Self {
            offset_degrees: 0.5 * rotation.turn_degrees,
            rotation,
            started: Instant::now(),
        }
    }

    /// From now on frames are of the views themselves, and time counts.
    pub fn start(&mut self) {
        self.offset_degrees = 0.0;
        self.started = Instant::now();
    }
}

/// A scene that is ready to draw.
pub struct Entry {
    session: Session,
    camera: Camera,
    target: DVec3,
    axis: DVec3,
}

impl Entry {
    /// A session for a scene; its settings stand as they are written.
    ///
    /// # Errors
    /// What the scene, the kinds, the shaders or the device refuse of it.
    pub fn new(scene: Scene, gpu: &Arc<Gpu>, options: &SessionOptions) -> Result<Self, Findings> {
        let options = SessionOptions {
            is_as_written: true,
            with_layers: false,
            ..options.clone()
        };
        let axis = scene
            .desc
            .camera
            .as_ref()
            .map_or(DVec3::Z, |camera| camera.up);
        let session = Session::start(scene, Arc::clone(gpu), &options)?;
        Ok(Self {
            camera: session.view().camera,
            target: middle(session.plan()),
            axis,
            session,
        })
    }

    /// Bytes that it takes on the device.
    #[must_use]
    pub fn device_bytes(&self) -> u64 {
        device_bytes(&self.session)
    }
}

impl Frames for BenchStand {
    type Ready = Entry;

    fn frame(&mut self, ready: &mut Entry, number: u32) -> Result<f64, Findings> {
        let views = self.rotation.degrees.len().max(1);
        let degrees = self
            .rotation
            .degrees
            .get(number as usize % views)
            .copied()
            .unwrap_or(0.0);
        let degrees = degrees + self.offset_degrees;
        let camera = around(&ready.camera, ready.target, ready.axis, degrees);
        Ok(timed_frame(&mut ready.session, camera, true)?.0)
    }
}
