//! The window: eframe on the session's own device.
//!
//! A device that is lost takes the window with it: the drawing thread opens another one, and the window is opened again
//! on that, with everything as it was.

use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use eframe::egui_wgpu::{WgpuConfiguration, WgpuSetup, WgpuSetupExisting};
use eframe::wgpu::TextureView;
use volgraph_engine::{Findings, Gpu};
use volgraph_report::Finding;

use crate::blit::Shot;
use crate::measure::{Measured, Measurement};
use crate::settings::Settings;
use crate::viewer::Viewer;
use crate::worker::{Worker, WorkerOptions};

/// The name that what is remembered is kept under.
const APP: &str = "volgraph";

/// Opens the window, and returns when it is closed.
///
/// # Errors
/// `no-window` where there is no display, and why no device could be opened.
pub fn open(options: WorkerOptions) -> Result<(), Findings> {
    open_with(options, None).map(|_| ())
}

/// Opens the window, orbits for so long with pictures of the session's size, closes it and says how fluent that was.
///
/// # Errors
/// As [`open`].
pub fn measure(options: WorkerOptions, length: Duration) -> Result<Measured, Findings> {
    let measured = open_with(options, Some(length))?;
    measured.ok_or_else(|| {
        Finding::error(
            "not-measured",
            "the window was closed before it was measured",
        )
        .into()
    })
}

fn open_with(
    options: WorkerOptions,
    length: Option<Duration>,
) -> Result<Option<Measured>, Findings> {
    check_display()?;
    let mut gpu = Arc::new(Gpu::open(&options.session.adapter)?);
    let (graph, budget) = (options.graph.clone(), options.budget);
    let size = options.session.size;
    let worker = Worker::start_on(options, Arc::clone(&gpu)).map_err(|error| -> Findings {
        Finding::error("no-thread", format!("no thread can be started: {error}")).into()
    })?;
    let mut viewer = Viewer::new(worker, Settings::default());
    if length.is_some() {
        viewer = viewer.with_size(size);
    }
    if let Some(budget) = budget {
        viewer = viewer.with_budget(budget);
    }
    let kept: Kept = Arc::new(Mutex::new(Some(viewer)));
    let mut is_first = true;
    let measured = Arc::new(Mutex::new(None));
    loop {
        let next = Arc::new(Mutex::new(None));
        let measurement = length.map(|length| (Measurement::new(length), Arc::clone(&measured)));
        run(&gpu, &kept, &next, is_first.then_some(&*graph), measurement)?;
        is_first = false;
        let reopened = next.lock().unwrap_or_else(PoisonError::into_inner).take();
        match reopened {
            Some(other) => gpu = other,
            None => {
                return Ok(measured
                    .lock()
                    .unwrap_or_else(PoisonError::into_inner)
                    .take());
            }
        }
    }
}

/// The viewer between windows.
type Kept = Arc<Mutex<Option<Viewer>>>;

/// Without a display winit would look for one in its own words.
fn check_display() -> Result<(), Findings> {
    let is_unix = cfg!(all(unix, not(target_os = "macos")));
    let has = |name: &str| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    if is_unix && !has("DISPLAY") && !has("WAYLAND_DISPLAY") && !has("WAYLAND_SOCKET") {
        return Err(no_window("neither DISPLAY nor WAYLAND_DISPLAY is set"));
    }
    Ok(())
}

fn no_window(why: &str) -> Findings {
    Finding::error("no-window", format!("no window can be opened: {why}"))
        .help("`volgraph render GRAPH -o FILE` draws without one, and `volgraph watch GRAPH -o FILE` draws again at each change")
        .into()
}

fn run(
    gpu: &Arc<Gpu>,
    kept: &Kept,
    next: &Arc<Mutex<Option<Arc<Gpu>>>>,
    first: Option<&Path>,
    measurement: Option<(Measurement, Arc<Mutex<Option<Measured>>>)>,
) -> Result<(), Findings> {
    let shared = gpu.shared();
    let setup = WgpuSetup::Existing(WgpuSetupExisting {
        instance: shared.instance,
        adapter: shared.adapter,
        device: shared.device,
        queue: shared.queue,
    });
    let options = eframe::NativeOptions {
        viewport: egui::ViewportBuilder::default()
            .with_app_id(APP)
            .with_title("volgraph")
            .with_inner_size([1280.0, 800.0])
            .with_min_inner_size([480.0, 320.0])
            .with_drag_and_drop(true),
        wgpu_options: WgpuConfiguration {
            wgpu_setup: setup,
            surface: eframe::egui_wgpu::SurfaceConfig {
                present_mode: eframe::wgpu::PresentMode::AutoNoVsync,
                desired_maximum_frame_latency: None,
            },
            ..Default::default()
        },
        run_and_return: true,
        dithering: false,
        ..Default::default()
    };
    let (kept, next, gpu) = (Arc::clone(kept), Arc::clone(next), Arc::clone(gpu));
    let first = first.map(Path::to_owned);
    let opened = eframe::run_native(
        APP,
        options,
        Box::new(move |context| {
            let mut viewer = kept
                .lock()
                .unwrap_or_else(PoisonError::into_inner)
                .take()
                .ok_or("the window is open already")?;
            if let Some(graph) = &first {
                let storage = context.storage;
                viewer.restore(
                    storage.and_then(|storage| eframe::get_value(storage, "settings")),
                    storage.and_then(|storage| eframe::get_value(storage, "layout")),
                );
                viewer.remember(graph);
            }
            if gpu.adapter().class == "software" {
                // Soft edges have several times the vertices, which the processor computes.
                context
                    .egui_ctx
                    .tessellation_options_mut(|options| options.feathering = false);
            }
            let wake = context.egui_ctx.clone();
            viewer.worker().on_told(move || wake.request_repaint());
            Ok(Box::new(Window {
                viewer: Some(viewer),
                kept,
                next,
                gpu,
                shot: None,
                measurement,
            }))
        }),
    );
    opened.map_err(|error| no_window(&error.to_string()))
}

struct Window {
    viewer: Option<Viewer>,
    kept: Kept,
    next: Arc<Mutex<Option<Arc<Gpu>>>>,
    gpu: Arc<Gpu>,
    /// The picture that the interface knows, by its serial.
    shot: Option<(u64, TextureView, Shot)>,
    /// What is measured, and where the result goes.
    measurement: Option<(Measurement, Arc<Mutex<Option<Measured>>>)>,
}

impl Window {
    /// Makes the last picture known to the interface.
    fn take_picture(&mut self, frame: &eframe::Frame) -> Option<()> {
        let viewer = self.viewer.as_ref()?;
        let told = viewer.worker().told();
        let shown = told.shown.as_ref()?;
        if (self.shot.as_ref()).is_some_and(|(serial, _, _)| *serial == told.serial)
            || !Arc::ptr_eq(&shown.gpu, &self.gpu)
        {
            return None;
        }
        let state = frame.wgpu_render_state()?;
        // The same texture mostly holds the next picture as well.
        let shot = match self.shot.take() {
            Some((_, view, shot)) if view == shown.view => shot,
            _ => Shot::new(state, &shown.view, shown.size),
        };
        self.shot = Some((told.serial, shown.view.clone(), shot));
        Some(())
    }

    /// The device that pictures come from now, where that is another than the window's.
    fn other_device(&self) -> Option<Arc<Gpu>> {
        let viewer = self.viewer.as_ref()?;
        let told = viewer.worker().told();
        told.gpu.clone().filter(|gpu| !Arc::ptr_eq(gpu, &self.gpu))
    }
}

impl eframe::App for Window {
    fn ui(&mut self, ui: &mut egui::Ui, frame: &mut eframe::Frame) {
        if let Some(other) = self.other_device() {
            *self.next.lock().unwrap_or_else(PoisonError::into_inner) = Some(other);
            ui.ctx().send_viewport_cmd(egui::ViewportCommand::Close);
            return;
        }
        self.take_picture(frame);
        let shot = self.shot.as_ref().map(|(_, _, shot)| shot);
        let Some(viewer) = &mut self.viewer else {
            return;
        };
        let start = Instant::now();
        viewer.show(ui, shot);
        if let Some((measurement, result)) = &mut self.measurement {
            // A still scene has to be looked at as well, to see the end.
            ui.ctx().request_repaint_after(Duration::from_millis(200));
            if let Some(measured) = measurement.step(viewer, start.elapsed()) {
                *result.lock().unwrap_or_else(PoisonError::into_inner) = Some(measured);
                ui.ctx().send_viewport_cmd(egui::ViewportCommand::Close);
                // The window draws on until it is closed.
                self.measurement = None;
            }
        }
    }

    fn save(&mut self, storage: &mut dyn eframe::Storage) {
        if let Some(viewer) = &self.viewer {
            eframe::set_value(storage, "settings", viewer.settings());
            eframe::set_value(storage, "layout", viewer.layout());
        }
    }
}

impl Drop for Window {
    fn drop(&mut self) {
        let mut viewer = self.viewer.take();
        if let Some(viewer) = &mut viewer {
            viewer.leave_window();
        }
        *self.kept.lock().unwrap_or_else(PoisonError::into_inner) = viewer;
    }
}
