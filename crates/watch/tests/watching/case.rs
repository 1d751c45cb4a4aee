//! A watched file, reached in one of several ways, and what a caller does with it.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Condvar, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use tempfile::TempDir;
use volgraph_watch::{FileWatch, Seen, WatchOptions};

/// Long enough for a busy machine; a test waits this long only to fail.
pub const LONG: Duration = Duration::from_secs(10);

/// Long enough that a change which is told would be told by then.
pub const SHORT: Duration = Duration::from_millis(200);

/// How changes come to be known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum By {
    Events,
    Polling,
}

impl By {
    /// Options under which nothing but this can tell of a change, and no pause of the machine is taken for the
    /// end of a file.
    pub fn options(self) -> WatchOptions {
        WatchOptions {
            grace: Duration::from_secs(60),
            poll: (self == Self::Polling).then_some(Duration::from_millis(5)),
            recheck: None,
            ..WatchOptions::default()
        }
    }
}

/// How the path leads to the file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Place {
    Plain,
    #[cfg(unix)]
    LinkedFile,
    #[cfg(unix)]
    LinkedFolder,
}

const PLACES: &[Place] = &[
    Place::Plain,
    #[cfg(unix)]
    Place::LinkedFile,
    #[cfg(unix)]
    Place::LinkedFolder,
];

pub struct Case {
    _folder: TempDir,
    /// Holds everything.
    pub root: PathBuf,
    /// The path that is watched.
    pub path: PathBuf,
    /// The file that it leads to, at `root/work/file`.
    pub target: PathBuf,
    pub by: By,
    pub place: Place,
    pub watch: FileWatch,
}

impl Case {
    fn new(by: By, place: Place, options: WatchOptions) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let root = folder.path().canonicalize().unwrap();
        let target = root.join("work/file");
        fs::create_dir(root.join("work")).unwrap();
        fs::write(&target, "first").unwrap();
        let path = match place {
            Place::Plain => target.clone(),
            #[cfg(unix)]
            Place::LinkedFile => {
                fs::create_dir(root.join("links")).unwrap();
                std::os::unix::fs::symlink("../work/file", root.join("links/file")).unwrap();
                root.join("links/file")
            }
            #[cfg(unix)]
            Place::LinkedFolder => {
                std::os::unix::fs::symlink("work", root.join("linked")).unwrap();
                root.join("linked/file")
            }
        };
        let watch = FileWatch::new(options);
        if by == By::Events && cfg!(target_os = "linux") {
            assert_eq!(watch.backend().events, Ok("inotify"));
        }
        let mut case = Self {
            _folder: folder,
            root,
            path,
            target,
            by,
            place,
            watch,
        };
        case.reload();
        // Registration itself tells of nothing here.
        assert_eq!(
            case.watch.wait(Some(Duration::from_millis(20))).unwrap(),
            None
        );
        case
    }

    /// What a caller does after a change: reads the file, and says what was read. Gives the content.
    pub fn reload(&mut self) -> Option<String> {
        let (seen, content) = read(&self.path);
        let files = BTreeMap::from([(self.path.clone(), seen)]);
        self.watch.watch(files, BTreeSet::new());
        content
    }

    /// Waits for a change of the file, and reloads.
    pub fn changed(&mut self) -> Option<String> {
        let told = self.watch.wait(Some(LONG)).unwrap();
        let expected = BTreeSet::from([self.path.clone()]);
        assert_eq!(told, Some(expected), "the change was not told");
        self.reload()
    }

    /// Reloads at changes until the content is this.
    pub fn becomes(&mut self, content: &str) {
        let start = Instant::now();
        while self.changed().as_deref() != Some(content) {
            assert!(start.elapsed() < LONG, "it never became {content}");
        }
    }

    /// Nothing is told now.
    pub fn is_quiet(&mut self) {
        assert_eq!(self.watch.wait(Some(SHORT)).unwrap(), None);
    }
}

pub fn read(path: &Path) -> (Seen, Option<String>) {
    fs::read(path).map_or((Seen::Absent, None), |bytes| {
        let content = String::from_utf8(bytes.clone()).unwrap();
        (Seen::bytes(&bytes), Some(content))
    })
}

/// Runs the test for each way of knowing and each way of reaching the file, all at once as they mostly wait.
pub fn everywhere(test: impl Fn(&mut Case) + Sync) {
    everywhere_with(By::options, test);
}

pub fn everywhere_with(
    options: impl Fn(By) -> WatchOptions + Sync,
    test: impl Fn(&mut Case) + Sync,
) {
    let _turn = Turn::take();
    thread::scope(|scope| {
        for by in [By::Events, By::Polling] {
            for place in PLACES {
                let (options, test) = (&options, &test);
                thread::Builder::new()
                    .name(format!("{by:?}, {place:?}"))
                    .spawn_scoped(scope, move || {
                        test(&mut Case::new(by, *place, options(by)));
                    })
                    .unwrap();
            }
        }
    });
}

/// A test's turn. Systems allow a user some hundred watchers, and many cores would run more tests than that.
struct Turn;

static FREE_TURNS: Mutex<usize> = Mutex::new(8);
static TURN_ENDS: Condvar = Condvar::new();

impl Turn {
    fn take() -> Self {
        let free = FREE_TURNS.lock().unwrap_or_else(PoisonError::into_inner);
        let free = TURN_ENDS.wait_while(free, |free| *free == 0);
        *free.unwrap_or_else(PoisonError::into_inner) -= 1;
        Self
    }
}

impl Drop for Turn {
    fn drop(&mut self) {
        *FREE_TURNS.lock().unwrap_or_else(PoisonError::into_inner) += 1;
        TURN_ENDS.notify_one();
    }
}
