//! Files that change, and pictures that are compared with their reference beside the drawing.

use std::sync::Arc;

use volgraph_engine::verify::integral_truth;
use volgraph_engine::{
    Change, Dependencies, Findings, RayOptions, RayTracer, Scene, Session, SessionOptions,
    TruthOptions, View,
};
use volgraph_report::Finding;

use super::{ErrorMap, Work};

/// How long to wait for files to settle.
const SETTLE: std::time::Duration = std::time::Duration::from_millis(4);

/// The longer side of the picture that is compared: the reference takes milliseconds for each ray.
const COMPARED: u32 = 96;

impl Work {
    pub(super) fn arm_with(&mut self, dependencies: Dependencies) {
        self.watch.watch(dependencies.files, dependencies.folders);
    }

    /// Applies what has changed on disk.
    pub(super) fn follow(&mut self) {
        // An error is that nothing is watched, as nothing could be read: a graph that is not there.
        if let Ok(Some(changed)) = self.watch.wait(Some(SETTLE)) {
            self.apply(&Change::Files(changed), true);
        }
    }

    /// Starts to compare a small picture of what is shown with its reference, beside the drawing.
    pub(super) fn compare(&mut self) {
        let Some(session) = self.session.as_ref().filter(|_| self.comparing.is_none()) else {
            return;
        };
        let (scene, view) = (session.scene().clone(), *session.view());
        let gpu = Arc::clone(session.gpu());
        let options = self.options.session.clone();
        let compared = std::thread::Builder::new()
            .name("volgraph comparing".to_owned())
            .spawn(move || compare(scene, view, gpu, &options));
        match compared {
            Ok(thread) => {
                self.comparing = Some(thread);
                self.tell(|told| told.is_comparing = true);
            }
            Err(error) => self.tell(|told| told.error_map = Some(Err(refused(&error.to_string())))),
        }
    }

    /// Starts to study the ray of a pixel of the full picture, beside the drawing; of those asked for meanwhile the last
    /// one is next.
    pub(super) fn study(&mut self, pixel: [f64; 2]) {
        let Some(session) = &self.session else {
            return;
        };
        if self.studying.is_some() {
            self.to_study = Some(pixel);
            return;
        }
        let view = View {
            size: self.full,
            ..*session.view()
        };
        let tracer = RayTracer::of(session);
        let studied = std::thread::Builder::new()
            .name("volgraph ray".to_owned())
            .spawn(move || tracer?.study(&view, pixel, &RayOptions::default()));
        match studied {
            Ok(thread) => {
                self.studying = Some(thread);
                self.tell(|told| told.is_studying = true);
            }
            Err(error) => self.tell(|told| told.ray = Some(Err(refused(&error.to_string())))),
        }
    }

    pub(super) fn take_study(&mut self) {
        let Some(thread) = self.studying.take_if(|thread| thread.is_finished()) else {
            return;
        };
        let studied = thread
            .join()
            .unwrap_or_else(|_| Err(refused("the walk along the ray failed")));
        self.tell(|told| {
            told.is_studying = false;
            told.ray = Some(studied.map(Arc::new));
        });
        if let Some(pixel) = self.to_study.take() {
            self.study(pixel);
        }
    }

    pub(super) fn take_comparison(&mut self) {
        let Some(thread) = self.comparing.take_if(|thread| thread.is_finished()) else {
            return;
        };
        let compared = thread
            .join()
            .unwrap_or_else(|_| Err(refused("the comparison failed")));
        self.tell(|told| {
            told.is_comparing = false;
            told.error_map = Some(compared.map(Arc::new));
        });
    }
}

fn refused(why: &str) -> Findings {
    Finding::error("comparison", why).into()
}

fn compare(
    scene: Scene,
    view: View,
    gpu: Arc<volgraph_engine::Gpu>,
    options: &SessionOptions,
) -> Result<ErrorMap, Findings> {
    let longer = view.size[0].max(view.size[1]).max(1);
    let size = match longer > COMPARED {
        true => view
            .size
            .map(|side| (u64::from(side) * u64::from(COMPARED) / u64::from(longer)).max(1) as u32),
        false => view.size,
    };
    let options = SessionOptions {
        size,
        ..options.clone()
    };
    let truth_scene = scene.clone();
    let mut session = Session::start(scene, gpu, &options)?;
    session.place_camera(view.camera);
    let (picture, _) = session.render()?;
    let view = *session.view();
    let truth = integral_truth(
        &truth_scene,
        &view,
        &[],
        &TruthOptions::default(),
        &volgraph_reference::Silent,
    )?;
    let exact = truth.picture()?;
    Ok(ErrorMap::between(&picture, &exact))
}
