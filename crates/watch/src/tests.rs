//! What needs a watcher that fails, loses events or dies, or a look at what is private.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{self, Sender};
use std::sync::{Arc, Mutex};
use std::time::{Duration, SystemTime};

use notify::event::{AccessKind, AccessMode, Flag};
use notify::{Config, Event, EventHandler, EventKind, RecursiveMode, Watcher, WatcherKind};

use crate::inbox::Inbox;
use crate::platform::Platform;
use crate::record::Record;
use crate::stamp::Look;
use crate::{FileWatch, Seen, WatchOptions};

const LONG: Duration = Duration::from_secs(10);
const SHORT: Duration = Duration::from_millis(200);

/// Accepts every folder but those that end in `refused`, and tells nothing.
#[derive(Default)]
struct Silent {
    watched: Arc<Mutex<BTreeSet<PathBuf>>>,
    /// A folder that is made in the moment when its parent begins to be watched.
    made: Option<PathBuf>,
}

impl Watcher for Silent {
    fn new<F: EventHandler>(_: F, _: Config) -> notify::Result<Self> {
        Ok(Self::default())
    }

    fn watch(&mut self, path: &Path, _: RecursiveMode) -> notify::Result<()> {
        if path.ends_with("refused") {
            return Err(notify::Error::new(notify::ErrorKind::MaxFilesWatch));
        }
        if let Some(made) = self.made.take_if(|made| made.parent() == Some(path)) {
            fs::create_dir(made).unwrap();
        }
        self.watched.lock().unwrap().insert(path.to_owned());
        Ok(())
    }

    fn unwatch(&mut self, path: &Path) -> notify::Result<()> {
        assert!(self.watched.lock().unwrap().remove(path));
        Ok(())
    }

    fn kind() -> WatcherKind {
        WatcherKind::NullWatcher
    }
}

/// A watch on [`Silent`], whose thread lives as long as the sender.
fn silent() -> (FileWatch, Arc<Inbox>, Sender<()>) {
    watch_on(Silent::default())
}

fn watch_on(watcher: Silent) -> (FileWatch, Arc<Inbox>, Sender<()>) {
    let inbox = Arc::new(Inbox::default());
    let (alive, ended) = mpsc::channel();
    let options = WatchOptions {
        recheck: None,
        grace: Duration::from_secs(60),
        ..WatchOptions::default()
    };
    let platform = Platform::with(Box::new(watcher), "silence", ended);
    let watch = FileWatch::on(options, Arc::clone(&inbox), platform);
    (watch, inbox, alive)
}

/// A file of this name with content, watched and found unchanged.
fn watched(watch: &mut FileWatch, root: &Path, name: &str) -> PathBuf {
    let path = root.join(name);
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder).unwrap();
    }
    fs::write(&path, "first").unwrap();
    let files = BTreeMap::from([(path.clone(), Seen::bytes(b"first"))]);
    watch.watch(files, BTreeSet::new());
    assert_eq!(watch.wait(Some(SHORT)).unwrap(), None);
    path
}

#[test]
fn a_folder_that_cannot_be_watched_is_polled() {
    let root = tempfile::tempdir().unwrap();
    let (mut watch, _inbox, _alive) = silent();
    let path = watched(&mut watch, root.path(), "accepted/file");
    assert!(watch.backend().polled.is_empty());
    fs::write(&path, "second").unwrap();
    assert_eq!(watch.wait(Some(SHORT)).unwrap(), None, "nobody has told");

    let path = watched(&mut watch, root.path(), "refused/file");
    let backend = watch.backend().to_string();
    assert!(backend.starts_with("events from silence; polling every 500ms below"));
    assert!(backend.contains("refused`: it cannot be watched: the limit"));
    fs::write(&path, "second").unwrap();
    assert_eq!(
        watch.wait(Some(LONG)).unwrap(),
        Some(BTreeSet::from([path]))
    );
    // Nothing of it is left when it is not needed any more.
    watched(&mut watch, root.path(), "accepted/file");
    assert!(watch.backend().polled.is_empty());
}

#[test]
fn a_folder_that_appears_during_registration_is_watched() {
    let root = tempfile::tempdir().unwrap();
    let root = root.path().canonicalize().unwrap();
    let made = root.join("not-yet");
    let all = Arc::default();
    let (mut watch, _inbox, _alive) = watch_on(Silent {
        watched: Arc::clone(&all),
        made: Some(made.clone()),
    });
    let files = BTreeMap::from([(made.join("file"), Seen::Absent)]);
    watch.watch(files, BTreeSet::new());
    assert!(all.lock().unwrap().contains(&made));
    assert!(all.lock().unwrap().contains(&root));
    // And what is not needed any more is let go.
    watch.watch(BTreeMap::new(), BTreeSet::new());
    assert!(all.lock().unwrap().is_empty());
}

#[test]
fn everything_is_compared_when_events_are_lost() {
    let root = tempfile::tempdir().unwrap();
    let (mut watch, inbox, _alive) = silent();
    let path = watched(&mut watch, root.path(), "file");
    fs::write(&path, "second").unwrap();
    assert_eq!(watch.wait(Some(SHORT)).unwrap(), None, "nobody has told");
    inbox.receive(Ok(Event::new(EventKind::Other).set_flag(Flag::Rescan)));
    assert_eq!(
        watch.wait(Some(LONG)).unwrap(),
        Some(BTreeSet::from([path]))
    );
    let path = watched(&mut watch, root.path(), "file");
    fs::write(&path, "second").unwrap();
    inbox.receive(Err(notify::Error::generic("it cannot be read")));
    assert_eq!(
        watch.wait(Some(LONG)).unwrap(),
        Some(BTreeSet::from([path]))
    );
}

#[test]
fn accesses_and_other_names_are_dropped() {
    let root = tempfile::tempdir().unwrap();
    let root = root.path().canonicalize().unwrap();
    let (mut watch, inbox, _alive) = silent();
    let path = watched(&mut watch, &root, "file");
    let event = |kind, path: &Path| Ok(Event::new(kind).add_path(path.to_owned()));
    for access in [
        AccessKind::Read,
        AccessKind::Open(AccessMode::Any),
        AccessKind::Close(AccessMode::Read),
    ] {
        inbox.receive(event(EventKind::Access(access), &path));
    }
    inbox.receive(event(EventKind::Any, &root.join("other")));
    let mail = inbox.empty();
    assert!(mail.span.is_none() && mail.entries.is_empty());
    let close = EventKind::Access(AccessKind::Close(AccessMode::Write));
    inbox.receive(event(close, &path));
    let mail = inbox.empty();
    assert!(mail.span.is_some() && mail.entries[&path].content);
}

#[test]
fn where_the_thread_has_ended_everything_is_polled() {
    let root = tempfile::tempdir().unwrap();
    let (mut watch, _inbox, alive) = silent();
    watched(&mut watch, root.path(), "file");
    drop(alive);
    let path = watched(&mut watch, root.path(), "file");
    let backend = watch.backend().to_string();
    assert_eq!(
        backend,
        "polling every 500ms: the thread of silence has ended"
    );
    fs::write(&path, "second").unwrap();
    assert_eq!(
        watch.wait(Some(LONG)).unwrap(),
        Some(BTreeSet::from([path]))
    );
}

#[test]
fn a_young_file_is_read_and_an_old_one_trusted() {
    let root = tempfile::tempdir().unwrap();
    let path = root.path().join("file");
    fs::write(&path, "1").unwrap();
    let mut record = Record::new(Seen::bytes(b"1"), false);
    let mut must_read = |age: Duration| {
        let file = fs::File::options().append(true).open(&path).unwrap();
        file.set_modified(SystemTime::now() - age).unwrap();
        let look = Look::of(&path).unwrap();
        record.examine(&path, Some(&look), false);
        record.must_read(&look)
    };
    assert!(must_read(Duration::ZERO));
    assert!(!must_read(Duration::from_secs(10)));
}
