//! The thread that draws: it owns the session, follows its files, and tells what there is to see.
//!
//! Requests that have come together are taken together: of cameras and sizes the last one counts, of values each one's
//! last. A camera that moves is drawn at the share of the full size that the budget allows by the last frames' times;
//! when it stands still, first at half and then at the full size, with requests looked at in between.

mod export;
mod follow;
mod pace;
mod told;

use std::collections::BTreeSet;
use std::path::PathBuf;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use volgraph_engine::{
    Camera, CameraDesc, Change, Findings, Gpu, LOOK, Outcome, ParamOverride, RayStudy, Refused,
    Session, SessionOptions,
};
use volgraph_watch::{FileWatch, WatchOptions};

pub use export::Turntable;
pub use told::{ErrorMap, Note, Told};

use self::pace::Pace;
use crate::looked::Looked;

/// How often files are looked after where nothing is asked.
const TICK: Duration = Duration::from_millis(15);

/// How long the camera stands still before the picture is refined.
const STILL: Duration = Duration::from_millis(200);

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

/// How a worker starts.
#[derive(Clone, Debug)]
pub struct WorkerOptions {
    /// The graph.
    pub graph: PathBuf,
    /// The session's; its size is the first picture's.
    pub session: SessionOptions,
    /// Most time of a frame while the camera moves; what is remembered, or [`WorkerOptions::BUDGET`], where it is `None`.
    pub budget: Option<Duration>,
}

impl WorkerOptions {
    /// The budget where nobody says one: fluent enough to steer by.
    pub const BUDGET: Duration = Duration::from_millis(60);
}

/// The interface's end of the thread.
pub struct Worker {
    requests: Option<Sender<Request>>,
    told: Arc<Mutex<Told>>,
    wake: Arc<Mutex<Wake>>,
    thread: Option<JoinHandle<()>>,
}

/// Called when something new was told.
type Wake = Box<dyn Fn() + Send>;

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Worker {
    /// Starts to draw.
    ///
    /// # Errors
    /// Where the system gives no thread.
    pub fn start(options: WorkerOptions) -> std::io::Result<Self> {
        Self::start_with(options, None)
    }

    /// Starts to draw on this device, which a window shares.
    ///
    /// # Errors
    /// As [`Self::start`].
    pub fn start_on(options: WorkerOptions, gpu: Arc<Gpu>) -> std::io::Result<Self> {
        Self::start_with(options, Some(gpu))
    }

    fn start_with(options: WorkerOptions, gpu: Option<Arc<Gpu>>) -> std::io::Result<Self> {
        let (requests, received) = channel();
        let told = Arc::new(Mutex::new(Told::default()));
        let wake: Arc<Mutex<Wake>> = Arc::new(Mutex::new(Box::new(|| {})));
        let work = Work {
            budget: options.budget.unwrap_or(WorkerOptions::BUDGET),
            full: options.session.size,
            drawn_size: options.session.size,
            options,
            told: Arc::clone(&told),
            wake: Arc::clone(&wake),
            gpu,
            session: None,
            watch: FileWatch::new(WatchOptions::default()),
            is_paused: false,
            moved: None,
            is_kept_later: false,
            wrong: Findings::new(),
            pace: Pace::default(),
            comparing: None,
            studying: None,
            to_study: None,
        };
        let thread = std::thread::Builder::new()
            .name("volgraph drawing".to_owned())
            .spawn(move || work.run(&received))?;
        Ok(Self {
            requests: Some(requests),
            told,
            wake,
            thread: Some(thread),
        })
    }

    /// Asks for something; it is told when it is there.
    pub fn ask(&self, request: Request) {
        if let Some(requests) = &self.requests {
            // The thread ends only with this.
            let _ = requests.send(request);
        }
    }

    /// What there is to see now.
    pub fn told(&self) -> MutexGuard<'_, Told> {
        locked(&self.told)
    }

    /// What to call when something new was told.
    pub fn on_told(&self, wake: impl Fn() + Send + 'static) {
        *locked(&self.wake) = Box::new(wake);
    }

    /// Whether the thread has ended, which it does only by a fault of its own.
    #[must_use]
    pub fn has_ended(&self) -> bool {
        self.thread.as_ref().is_none_or(JoinHandle::is_finished)
    }
}

impl Drop for Worker {
    fn drop(&mut self) {
        self.requests = None;
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

struct Work {
    options: WorkerOptions,
    budget: Duration,
    told: Arc<Mutex<Told>>,
    wake: Arc<Mutex<Wake>>,
    /// The device for the next session.
    gpu: Option<Arc<Gpu>>,
    session: Option<Session>,
    watch: FileWatch,
    /// The size of a picture that stands still.
    full: [u32; 2],
    /// The size of the last picture.
    drawn_size: [u32; 2],
    is_paused: bool,
    /// When the camera last moved, until the picture is refined.
    moved: Option<Instant>,
    /// Whether the next whole picture is one after a change.
    is_kept_later: bool,
    /// What is wrong with the files on disk, for as long as it is.
    wrong: Findings,
    /// How coarsely it is drawn while it moves.
    pace: Pace,
    comparing: Option<JoinHandle<Result<ErrorMap, Findings>>>,
    studying: Option<JoinHandle<Result<RayStudy, Findings>>>,
    /// The pixel to study next.
    to_study: Option<[f64; 2]>,
}

/// Requests that came together.
#[derive(Default)]
struct Asked {
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
    fn run(mut self, received: &Receiver<Request>) {
        let graph = self.options.graph.clone();
        self.open(graph);
        loop {
            let first = match received.recv_timeout(TICK) {
                Ok(request) => Some(request),
                Err(RecvTimeoutError::Timeout) => None,
                Err(RecvTimeoutError::Disconnected) => return,
            };
            if let Some(first) = first {
                let mut asked = Asked::default();
                self.gather(first, &mut asked);
                while let Ok(more) = received.try_recv() {
                    self.gather(more, &mut asked);
                }
                self.answer(asked);
            }
            if !self.is_paused {
                self.follow();
            }
            self.refine();
            self.look_after_device();
            self.take_comparison();
            self.take_study();
        }
    }

    fn gather(&mut self, request: Request, asked: &mut Asked) {
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

    fn answer(&mut self, asked: Asked) {
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

    /// Changes what is told, and wakes the interface.
    fn tell(&self, change: impl FnOnce(&mut Told)) {
        change(&mut locked(&self.told));
        locked(&self.wake)();
    }

    /// Opens a graph in the place of the one before, which stays where this one cannot be opened and it can be drawn.
    fn open(&mut self, graph: PathBuf) {
        self.tell(|told| told.is_busy = true);
        let start = Instant::now();
        if let Some(session) = &self.session {
            self.gpu = Some(Arc::clone(session.gpu()));
        }
        let opened = Session::begin_on(
            &graph,
            &self.options.session,
            volgraph_engine::registry(),
            &told::Progress(Arc::clone(&self.told), Arc::clone(&self.wake)),
            self.gpu.clone().filter(|gpu| gpu.lost().is_none()),
        );
        self.options.graph = graph;
        match opened {
            Ok(mut session) => {
                let drawn = session.render_checked();
                self.drawn_size = session.view().size;
                self.pace = Pace::default();
                self.arm_with(session.dependencies().clone());
                self.session = Some(session);
                self.wrong = Findings::new();
                self.tell(Told::forget);
                match drawn {
                    Ok((picture, frame)) => {
                        let note = Note::new(format!(
                            "opened in {:.0} ms",
                            start.elapsed().as_secs_f64() * 1e3
                        ));
                        self.tell(|told| {
                            told.frame = Some(frame);
                            told.keep(picture);
                            told.note(note);
                        });
                        self.show(Findings::new());
                    }
                    Err(findings) => self.show(findings),
                }
            }
            Err(unopened) => {
                self.arm_with(unopened.dependencies);
                self.session = None;
                self.tell(|told| {
                    told.reading = None;
                    told.findings = unopened.findings;
                    told.is_busy = false;
                });
            }
        }
    }

    /// Applies a change; what is refused leaves the picture as it is, and is told.
    fn apply(&mut self, change: &Change, keeps_picture: bool) {
        if self.session.is_none() {
            let graph = self.options.graph.clone();
            return self.open(graph);
        }
        self.tell(|told| told.is_busy = true);
        let start = Instant::now();
        let Some(session) = &mut self.session else {
            return;
        };
        let progress = told::Progress(Arc::clone(&self.told), Arc::clone(&self.wake));
        let applied = session.apply_with(change, &progress);
        let dependencies = session.dependencies().clone();
        self.drawn_size = session.view().size;
        self.arm_with(dependencies);
        if matches!(change, Change::Files(_)) {
            let refused = applied.as_ref().err();
            self.wrong = refused.map_or_else(Findings::new, |refused| refused.findings.clone());
        }
        match applied {
            Ok(Outcome::Unchanged) => self.show(Findings::new()),
            Ok(Outcome::Drawn(drawn)) => {
                let total = start.elapsed();
                self.learn(drawn.report.stages.draw_ms);
                let is_whole = self.drawn_size == self.full;
                self.is_kept_later |= keeps_picture;
                let keeps_now = is_whole && std::mem::take(&mut self.is_kept_later);
                if !is_whole {
                    self.moved = Some(Instant::now());
                }
                self.tell(|told| {
                    told.frame = Some(drawn.report.frame.clone());
                    if keeps_picture {
                        told.note(Note::of(change, &drawn.report, total));
                        told.report = Some(drawn.report);
                    }
                    if keeps_now {
                        told.keep(drawn.picture);
                    } else if is_whole {
                        told.refined = Some(Arc::new(drawn.picture));
                    }
                });
                self.show(Findings::new());
            }
            Err(refused) => self.refuse(refused),
        }
    }

    /// Sets values as they are dragged: coarsely where a whole picture takes long, which comes when they stay.
    fn set(&mut self, sets: Vec<ParamOverride>) {
        self.be_coarse();
        self.apply(&Change::Set(sets), true);
    }

    /// Makes what comes next as coarse as the time for a frame needs.
    fn be_coarse(&mut self) {
        let size = self.coarse();
        let is_whole = self
            .session
            .as_ref()
            .is_some_and(|session| session.view().size == self.full);
        if is_whole && 2.0 * pixels(size) < pixels(self.full) {
            self.apply(&Change::Size(size), false);
        }
    }

    fn refuse(&mut self, refused: Refused) {
        let Refused {
            findings,
            device_remade,
            ..
        } = refused;
        if let Some(reason) = device_remade {
            self.tell(|told| told.note(Note::new(format!("device opened again: {reason}"))));
        }
        self.show(findings);
    }

    /// Moves the camera and draws as finely as the time allows.
    fn move_to(&mut self, stand: impl FnOnce(&mut Session)) {
        let Some(session) = &mut self.session else {
            return;
        };
        stand(session);
        self.moved = Some(Instant::now());
        let size = self.coarse();
        self.draw_at(size);
    }

    /// The size for which a frame fits the budget.
    fn coarse(&mut self) -> [u32; 2] {
        scaled(self.full, self.pace.share(self.budget))
    }

    fn draw_at(&mut self, size: [u32; 2]) {
        let Some(session) = &mut self.session else {
            return;
        };
        if size != session.view().size {
            return self.apply(&Change::Size(size), false);
        }
        let start = Instant::now();
        let drawn = session.draw();
        self.drawn_size = size;
        match drawn {
            Ok(frame) => {
                self.learn(start.elapsed().as_secs_f64() * 1e3);
                self.tell(|told| told.frame = Some(frame));
                self.show(Findings::new());
            }
            Err(findings) => self.show(findings),
        }
    }

    /// Takes note of what a frame of the last size took. Frames of which nothing had to be drawn teach nothing.
    fn learn(&mut self, milliseconds: f64) {
        if milliseconds < 0.05 {
            return;
        }
        let share = self.pace.share(self.budget);
        if self.drawn_size == self.full {
            self.pace.learn(1.0, milliseconds, self.budget);
        } else if self.drawn_size == scaled(self.full, share) {
            self.pace.learn(share, milliseconds, self.budget);
        }
        self.tell(|told| told.frame_ms = milliseconds);
    }

    /// Draws the picture of a still camera, in two steps where that takes long.
    fn refine(&mut self) {
        let is_due = |moved: Instant| moved.elapsed() >= STILL;
        if !self.moved.is_some_and(is_due) {
            return;
        }
        let budget = self.budget.as_secs_f64() * 1e3;
        let half = scaled(self.full, 0.5);
        let full_ms = self.pace.full_ms();
        if pixels(self.drawn_size) < pixels(half) && full_ms > 4.0 * budget {
            // Looked at again at once: a request comes first.
            return self.draw_at(half);
        }
        self.moved = None;
        let Some(session) = &mut self.session else {
            return;
        };
        if session.view().size == self.full {
            let drawn = session.render_checked();
            match drawn {
                Ok((picture, frame)) => {
                    self.tell(|told| {
                        told.frame = Some(frame);
                        told.refined = Some(Arc::new(picture));
                    });
                    self.show(Findings::new());
                }
                Err(findings) => self.show(findings),
            }
        } else {
            self.apply(&Change::Size(self.full), false);
        }
    }

    /// Shows the last frame, with what is wrong with what was tried after it. What is wrong on disk stays told while the
    /// camera moves.
    fn show(&mut self, mut findings: Findings) {
        if findings.is_empty() {
            findings = self.wrong.clone();
        }
        let full = self.full;
        let Some(session) = &mut self.session else {
            return self.tell(|told| {
                told.findings = findings;
                told.is_busy = false;
            });
        };
        let remade = session.take_device_remade();
        let shown = session.display("color");
        let plan = session.shared_plan();
        let looked = plan.graph.outputs.contains_key(LOOK).then(|| {
            let texels = session.texels(LOOK);
            Arc::new(Looked::of(&plan, texels))
        });
        let camera = session.view().camera;
        let scene = session.scene().clone();
        let gpu: Arc<Gpu> = Arc::clone(session.gpu());
        let chosen = session.chosen().cloned();
        let is_refined = session.view().size == full;
        self.tell(|told| {
            if let Some(reason) = remade {
                told.note(Note::new(format!("device opened again: {reason}")));
            }
            told.gpu = Some(gpu);
            told.camera = Some(camera);
            told.plan = Some(plan);
            told.scene = Some(scene);
            told.chosen = chosen;
            told.looked = looked;
            told.is_busy = false;
            told.is_refined = is_refined;
            told.findings = findings;
            match shown {
                Ok(shown) => {
                    told.shown = Some(shown);
                    told.serial += 1;
                }
                Err(why) => told.findings.extend(why),
            }
        });
    }

    /// A device that is lost while nothing is drawn is opened again as well.
    fn look_after_device(&mut self) {
        let Some(session) = &mut self.session else {
            return;
        };
        if session.gpu().lost().is_none() {
            return;
        }
        match session.draw() {
            Ok(_) => self.show(Findings::new()),
            Err(findings) => self.tell(|told| told.findings = findings),
        }
    }
}

fn pixels([width, height]: [u32; 2]) -> f64 {
    f64::from(width) * f64::from(height)
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a share of a u32 is one"
)]
fn scaled(size: [u32; 2], share: f64) -> [u32; 2] {
    size.map(|side| ((f64::from(side) * share).round() as u32).max(1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_of_small_pictures_are_pictures() {
        assert_eq!(scaled([512, 300], 0.375), [192, 113]);
        assert_eq!(scaled([1, 3], 0.125), [1, 1]);
    }
}
