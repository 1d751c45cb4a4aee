//! Volumes from volumes: a box cut out, other dimensions, another type.
//!
//! Each operation is a pure function from a volume to a new one, in parallel, watched by a [`Watch`]: it reports how
//! far it is and stops when asked to. Name, facts and warnings go along; placements are carried exactly.

mod convert;
mod crop;
mod resample;

use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

pub use convert::{Converted, convert};
pub use crop::crop;
pub use resample::{Filter, Target, resample};

use crate::error::Trouble;
use crate::{Volume, VolumeError};

/// Called with what is done and what there is to do, in bytes of the result.
pub type Progress = Arc<dyn Fn(u64, u64) + Send + Sync>;

/// How long work is watched from outside.
#[derive(Clone, Default)]
pub struct Watch {
    /// Called as the work goes on, from any thread.
    pub progress: Option<Progress>,
    /// Stops the work soon after it becomes true.
    pub interrupt: Option<Arc<AtomicBool>>,
}

impl fmt::Debug for Watch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Watch").finish_non_exhaustive()
    }
}

impl Watch {
    /// Refuses to go on once the interrupt is set.
    ///
    /// # Errors
    /// [`VolumeError::Interrupted`].
    pub fn check(&self) -> Result<(), VolumeError> {
        let stop = self.interrupt.as_ref();
        if stop.is_some_and(|stop| stop.load(Ordering::Relaxed)) {
            return Err(VolumeError::Interrupted(Trouble::new(
                "the work was interrupted before it was done",
                "start it again",
            )));
        }
        Ok(())
    }

    /// Tells how much is done.
    pub fn report(&self, done: u64, total: u64) {
        if let Some(progress) = &self.progress {
            progress(done, total);
        }
    }
}

/// Work in parts of known size that many threads do.
struct Parts<'a> {
    watch: &'a Watch,
    done: AtomicU64,
    total: u64,
}

impl<'a> Parts<'a> {
    fn new(watch: &'a Watch, total: usize) -> Self {
        Self {
            watch,
            done: AtomicU64::new(0),
            total: total as u64,
        }
    }

    /// To be called after each part with its bytes.
    fn step(&self, bytes: usize) -> Result<(), VolumeError> {
        let done = self.done.fetch_add(bytes as u64, Ordering::Relaxed) + bytes as u64;
        self.watch.report(done, self.total);
        self.watch.check()
    }
}

/// A vector of a known length, or an error where memory does not hold it.
fn reserve<T: bytemuck::Zeroable + Clone>(count: usize) -> Result<Vec<T>, VolumeError> {
    let mut values = Vec::new();
    if values.try_reserve_exact(count).is_err() {
        return Err(VolumeError::TooLarge(Trouble::new(
            format!("memory does not hold {count} voxels"),
            "free memory, or ask for fewer voxels",
        )));
    }
    values.resize(count, T::zeroed());
    Ok(values)
}

/// `made` with the sources and warnings of the volume it was made of.
fn like(made: Volume, of: &Volume) -> Volume {
    made.with_sources(of.source_files().to_vec(), of.warnings().to_vec())
}
