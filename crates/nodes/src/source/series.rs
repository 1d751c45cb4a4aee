//! Time series that are open, and the steps of them that are read ahead.
//!
//! The first step of a file is read like any volume. Who asks for another step of the same file is walking along it: from
//! then on the next step in the same direction is read by a thread of its own, its digest and statistics with it, while
//! this one is drawn. At most [`MOST_KEPT`] steps and [`MOST_BYTES`] of voxels are kept; a step whose files
//! have changed since is read again.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, SystemTime};

use volgraph_formats::{LoadOptions, VolumeReader};
use volgraph_report::{Finding, Findings};
use volgraph_volume::{Volume, VolumeError};

/// Most series that are kept open.
const MOST_OPEN: usize = 4;
/// Most steps of a series that are kept.
const MOST_KEPT: usize = 4;
/// Most bytes of voxels of steps that are kept, of each series.
const MOST_BYTES: usize = 1 << 30;

/// The open series, the latest last.
#[derive(Default)]
pub(crate) struct Series {
    open: Mutex<Vec<Arc<OpenSeries>>>,
}

/// A file with several steps.
struct OpenSeries {
    path: PathBuf,
    /// The options as text: what they hold has no equality of its own, and the text shows all that matters.
    options: String,
    stamp: Stamp,
    reader: VolumeReader<'static>,
    steps: Mutex<Steps>,
    /// Held while a step is read, so that who asks for one that is being read ahead waits for it.
    reading: Mutex<()>,
}

#[derive(Default)]
struct Steps {
    /// The latest last.
    kept: Vec<(u32, Arc<Volume>, Stamp)>,
    last: Option<u32>,
}

/// Length and time of change of files.
type Stamp = Vec<(u64, Option<SystemTime>)>;

fn stamp<'a>(files: impl IntoIterator<Item = &'a PathBuf>) -> Stamp {
    let of = |file: &PathBuf| {
        let metadata = file.metadata().ok();
        let length = metadata.as_ref().map_or(0, std::fs::Metadata::len);
        (length, metadata.and_then(|it| it.modified().ok()))
    };
    files.into_iter().map(of).collect()
}

impl Series {
    /// The volume of a time step; `time` means nothing where there is only one.
    pub fn load(
        &self,
        path: &Path,
        options: &LoadOptions,
        time: u32,
        progress: volgraph_graph::Progress<'_>,
    ) -> Result<Arc<Volume>, Findings> {
        let key = format!("{options:?}");
        let is_same = |series: &Arc<OpenSeries>| {
            series.path == path
                && series.options == key
                && series.stamp == stamp([&path.to_path_buf()])
        };
        let known = self.open().iter().find(|series| is_same(series)).cloned();
        if let Some(series) = known {
            return with_progress(path, progress, |report| series.step(time, report));
        }
        with_progress(path, progress, |report| {
            let stamp = stamp([&path.to_path_buf()]);
            let reader = VolumeReader::open(path, options)?;
            let step = (reader.step_count() > 1).then_some(time);
            let volume = Arc::new(reader.read_reporting(step, Some(report))?);
            if step.is_none() {
                return Ok(volume);
            }
            let series = Arc::new(OpenSeries {
                path: path.to_path_buf(),
                options: key.clone(),
                stamp,
                reader,
                steps: Mutex::default(),
                reading: Mutex::default(),
            });
            series.keep(time, &volume);
            let mut open = self.open();
            open.retain(|other| other.path != path);
            let extra = (open.len() + 1).saturating_sub(MOST_OPEN);
            open.drain(..extra);
            open.push(series);
            Ok(volume)
        })
    }

    fn open(&self) -> std::sync::MutexGuard<'_, Vec<Arc<OpenSeries>>> {
        self.open.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl OpenSeries {
    fn steps(&self) -> std::sync::MutexGuard<'_, Steps> {
        self.steps.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn kept(&self, step: u32) -> Option<Arc<Volume>> {
        let mut steps = self.steps();
        let at = steps.kept.iter().position(|(kept, ..)| *kept == step)?;
        let (_, volume, was) = &steps.kept[at];
        if *was != stamp(volume.source_files()) {
            steps.kept.remove(at);
            return None;
        }
        Some(Arc::clone(volume))
    }

    fn keep(&self, step: u32, volume: &Arc<Volume>) {
        let mut steps = self.steps();
        steps.kept.retain(|(kept, ..)| *kept != step);
        let stamp = stamp(volume.source_files());
        steps.kept.push((step, Arc::clone(volume), stamp));
        let each = volume.voxels().as_bytes().len().max(1);
        let most = (MOST_BYTES / each).clamp(1, MOST_KEPT);
        let extra = steps.kept.len().saturating_sub(most);
        steps.kept.drain(..extra);
    }

    fn read(&self, step: u32, report: Option<Report>) -> Result<Arc<Volume>, VolumeError> {
        let _reading = self.reading.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(volume) = self.kept(step) {
            return Ok(volume);
        }
        let volume = Arc::new(self.reader.read_reporting(Some(step), report)?);
        self.keep(step, &volume);
        Ok(volume)
    }

    /// A step, and the next one in the same direction behind the caller's back.
    fn step(self: &Arc<Self>, step: u32, report: Report) -> Result<Arc<Volume>, VolumeError> {
        let volume = match self.kept(step) {
            Some(volume) => volume,
            None => self.read(step, Some(report))?,
        };
        let last = self.steps().last.replace(step);
        let backwards = last.is_some_and(|last| last > step);
        let next = if backwards {
            step.checked_sub(1)
        } else {
            step.checked_add(1)
                .filter(|next| *next < self.reader.step_count())
        };
        let big = volume.voxels().as_bytes().len() > MOST_BYTES / 2;
        if let Some(next) = next.filter(|next| !big && self.kept(*next).is_none()) {
            let series = Arc::clone(self);
            // Where no thread can be had, or the step is broken, whoever asks for it will hear.
            let _ = std::thread::Builder::new()
                .name("volgraph reads ahead".to_owned())
                .spawn(move || {
                    if let Ok(volume) = series.read(next, None) {
                        let _ = (volume.digest(), volume.statistics());
                    }
                });
        }
        Ok(volume)
    }
}

type Report = volgraph_formats::Progress;

/// The reader reports from its own thread's closure; it is handed on from here, where `progress` may be borrowed.
fn with_progress(
    path: &Path,
    progress: volgraph_graph::Progress<'_>,
    read: impl FnOnce(Report) -> Result<Arc<Volume>, VolumeError> + Send,
) -> Result<Arc<Volume>, Findings> {
    let latest = Arc::new(Mutex::new((0_u64, 0_u64)));
    let seen = Arc::clone(&latest);
    let report: Report = Arc::new(move |done, total| {
        *seen.lock().unwrap_or_else(PoisonError::into_inner) = (done, total);
    });
    std::thread::scope(|scope| {
        let reader = scope.spawn(|| read(report));
        while !reader.is_finished() {
            std::thread::sleep(Duration::from_millis(2));
            let (done, total) = *latest.lock().unwrap_or_else(PoisonError::into_inner);
            progress(done, total);
        }
        match reader.join() {
            Ok(result) => result.map_err(|error| Findings::from(Finding::from(error))),
            Err(_) => Err(Finding::error(
                "internal",
                format!("the reader of `{}` panicked", path.display()),
            )
            .help("please report this file")
            .into()),
        }
    })
}
