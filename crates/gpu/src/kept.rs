//! What is kept between runs of the program: small things that are measured or built once, each under a name.
//!
//! Where and for how long is somebody else's business. Nothing that is kept is needed: where it is not there, or is not what
//! it should be, it is made again.

use std::fmt;
use std::sync::Arc;

/// A place for bytes under names. What comes back is what was written under that name, or nothing.
pub trait Keep: Send + Sync {
    /// What is kept under a name.
    fn read(&self, name: &str) -> Option<Vec<u8>>;
    /// Keeps it, if that can be done.
    fn write(&self, name: &str, bytes: &[u8]);
}

/// Where a runner keeps things; nowhere by default.
#[derive(Clone, Default)]
pub(crate) struct Kept(pub Option<Arc<dyn Keep>>);

impl Kept {
    pub fn read(&self, name: &str) -> Option<Vec<u8>> {
        self.0.as_ref()?.read(name)
    }

    pub fn write(&self, name: &str, bytes: &[u8]) {
        if let Some(keep) = &self.0 {
            keep.write(name, bytes);
        }
    }
}

impl fmt::Debug for Kept {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Kept")
    }
}
