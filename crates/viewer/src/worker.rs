//! The thread that draws: it owns the session, follows its files, and tells what there is to see.
//!
//! Requests that have come together are taken together: of cameras and sizes the last one counts, of values each one's
//! last. A camera that moves is drawn at the share of the full size that the budget allows by the last frames' times;
//! when it stands still, first at half and then at the full size, with requests looked at in between.

mod drawing;
mod export;
mod follow;
mod pace;
mod request;
mod told;

use std::path::PathBuf;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use volgraph_engine::{Findings, Gpu, Progressive, RayStudy, Session, SessionOptions};
use volgraph_watch::{FileWatch, WatchOptions};

pub use export::Turntable;
pub use request::Request;
pub use told::{ErrorMap, Note, Told};

use self::pace::Pace;
use self::request::Asked;

/// How often files are looked after where nothing is asked.
const TICK: Duration = Duration::from_millis(15);

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
            progressive: Progressive::default(),
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
    /// Whether volumes in bricks come at once and get better from frame to frame: in the window, not in what is saved.
    progressive: Progressive,
    /// What is wrong with the files on disk, for as long as it is.
    wrong: Findings,
    /// How coarsely it is drawn while it moves.
    pace: Pace,
    comparing: Option<JoinHandle<Result<ErrorMap, Findings>>>,
    studying: Option<JoinHandle<Result<RayStudy, Findings>>>,
    /// The pixel to study next.
    to_study: Option<[f64; 2]>,
}

impl Work {
    fn run(mut self, received: &Receiver<Request>) {
        let graph = self.options.graph.clone();
        self.progressive.set(true);
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
            volgraph_engine::progressive_registry(self.progressive.clone()),
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
                        let warnings = self.expect_more(&frame);
                        let note = Note::new(format!(
                            "opened in {:.0} ms",
                            start.elapsed().as_secs_f64() * 1e3
                        ));
                        let is_done = frame.progress.is_whole();
                        self.is_kept_later = !is_done;
                        self.tell(|told| {
                            told.frame = Some(frame);
                            if is_done {
                                told.keep(picture);
                            } else {
                                told.refined = Some(Arc::new(picture));
                            }
                            told.note(note);
                        });
                        self.show(warnings);
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
}
