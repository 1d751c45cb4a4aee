//! A file, and whether its content is still what was used.
//!
//! [`Record::examine`] reads small files and digests them; large ones have a stamp. It trusts a look that stands
//! where it may, so that a slow look at everything costs no reading.

use std::fs::{File, OpenOptions};
use std::io;
use std::path::Path;

use crate::Seen;
use crate::stamp::Look;

/// A file this long where a short one was is not read to see that it differs.
const LONG: u64 = 64 << 20;

/// What a file is now, against what was seen of it.
#[derive(Debug)]
pub(crate) enum Verdict {
    /// Its content is what was used.
    Same,
    /// There is other content.
    Changed(Seen),
    /// It is gone or empty, as it is for a moment in some ways of saving.
    Missing(Seen),
}

#[derive(Debug)]
pub(crate) struct Record {
    seen: Seen,
    /// The look under which the content was what was seen.
    matched: Option<Look>,
    /// An event named this file since its stamp was taken.
    pub(crate) named: bool,
}

impl Record {
    pub(crate) fn new(seen: Seen, named: bool) -> Self {
        Self {
            seen,
            matched: None,
            named,
        }
    }

    /// What was told becomes what is seen.
    pub(crate) fn accept(&mut self, seen: Seen) {
        *self = Self::new(seen, false);
    }

    /// Whether this look leaves open what the content is.
    pub(crate) fn must_read(&self, look: &Look) -> bool {
        matches!(self.seen, Seen::Digest(_)) && look.stamp.is_racy()
    }

    /// Compares. `look` was taken just now; `trusting` believes one that stands.
    pub(crate) fn examine(&mut self, path: &Path, look: Option<&Look>, trusting: bool) -> Verdict {
        let verdict = self.compare(path, look, trusting);
        if matches!(verdict, Verdict::Same) {
            self.named = false;
        }
        verdict
    }

    fn compare(&mut self, path: &Path, look: Option<&Look>, trusting: bool) -> Verdict {
        match &self.seen {
            Seen::Absent => match (open(path), look) {
                (Err(_), _) => Verdict::Same,
                (Ok(_), Some(look)) if look.stamp.len() > LONG => {
                    Verdict::Changed(Seen::Stamp(look.stamp.clone()))
                }
                (Ok(file), _) => digest_of(file),
            },
            Seen::Stamp(stamp) => match look {
                None => Verdict::Missing(Seen::Absent),
                // The event is all there is to tell of a second change within one tick of the clock.
                Some(look) if look.stamp == *stamp => {
                    if self.named && stamp.is_racy() {
                        Verdict::Changed(Seen::Stamp(look.stamp.clone()))
                    } else {
                        Verdict::Same
                    }
                }
                Some(look) => of_look(look),
            },
            Seen::Unsure => look.map_or(Verdict::Missing(Seen::Absent), of_look),
            Seen::Digest(digest) => {
                let Some(look) = look.filter(|look| look.is_file) else {
                    return Verdict::Missing(Seen::Absent);
                };
                if let Some(matched) = &self.matched {
                    if trusting && look == matched && !look.stamp.is_racy() {
                        return Verdict::Same;
                    }
                    if look.stamp.len() > LONG && look.stamp.len() != matched.stamp.len() {
                        return Verdict::Changed(Seen::Stamp(look.stamp.clone()));
                    }
                }
                match digest_now(path) {
                    Verdict::Changed(Seen::Digest(now)) | Verdict::Missing(Seen::Digest(now))
                        if now == *digest =>
                    {
                        self.matched = Some(look.clone());
                        Verdict::Same
                    }
                    other => other,
                }
            }
        }
    }
}

/// What a look tells without reading.
fn of_look(look: &Look) -> Verdict {
    let seen = Seen::Stamp(look.stamp.clone());
    if look.stamp.is_empty() {
        Verdict::Missing(seen)
    } else {
        Verdict::Changed(seen)
    }
}

/// The content at `path`, as something to tell.
fn digest_now(path: &Path) -> Verdict {
    open(path).map_or(Verdict::Missing(Seen::Absent), digest_of)
}

fn digest_of(file: File) -> Verdict {
    let mut hasher = blake3::Hasher::new();
    if hasher.update_reader(file).is_err() {
        return Verdict::Missing(Seen::Absent);
    }
    let seen = Seen::Digest(*hasher.finalize().as_bytes());
    if hasher.count() == 0 {
        Verdict::Missing(seen)
    } else {
        Verdict::Changed(seen)
    }
}

/// Opens a plain file. Anything else, such as a pipe, could make its reader wait for ever.
fn open(path: &Path) -> io::Result<File> {
    let refused = || io::Error::from(io::ErrorKind::InvalidInput);
    if !std::fs::metadata(path)?.is_file() {
        return Err(refused());
    }
    let mut options = OpenOptions::new();
    options.read(true);
    #[cfg(unix)]
    {
        use std::os::unix::fs::OpenOptionsExt;
        // A pipe may have taken the file's place since, and opening one waits; on a plain file this does nothing.
        options.custom_flags(rustix::fs::OFlags::NONBLOCK.bits() as i32);
    }
    let file = options.open(path)?;
    if file.metadata()?.is_file() {
        Ok(file)
    } else {
        Err(refused())
    }
}
