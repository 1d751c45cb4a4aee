//! What can be wrong with a volume: one enum, one stable code per variant.
//!
//! A reader makes an error where it sees the trouble, with cause and remedy; on its way up the error learns the
//! header line ([`VolumeError::on_line`]) and the file ([`VolumeError::in_file`]). The first to know wins, so an
//! error about a data file keeps that file's name. `From<VolumeError> for Finding` carries all of it on.

use std::fmt;
use std::path::{Path, PathBuf};

use volgraph_report::{Finding, Place};

/// What every [`VolumeError`] carries.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Trouble {
    /// The file it is about, as the user or the header named it; empty where no file is involved.
    pub file: PathBuf,
    /// The header line, from 1; 0 where it is about the file as a whole.
    pub line: u32,
    /// The cause, one sentence without a full stop.
    pub cause: String,
    /// The remedy, one sentence without a full stop.
    pub remedy: String,
}

impl Trouble {
    /// A cause and its remedy; file and line come later, from whoever knows them.
    pub fn new(cause: impl Into<String>, remedy: impl Into<String>) -> Box<Self> {
        Box::new(Self {
            cause: cause.into(),
            remedy: remedy.into(),
            ..Self::default()
        })
    }

    /// File and line, where a file is known.
    #[must_use]
    pub fn place(&self) -> Option<Place> {
        if self.file.as_os_str().is_empty() {
            return None;
        }
        let mut place = Place::whole_file(&self.file);
        if self.line > 0 {
            (place.line, place.column, place.length) = (self.line, 1, 1);
        }
        Some(place)
    }
}

impl fmt::Display for Trouble {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(place) = self.place() {
            write!(f, "{place}: ")?;
        }
        write!(f, "{}; {}", self.cause, self.remedy)
    }
}

macro_rules! volume_errors {
    ($($(#[$doc:meta])* $name:ident = $code:literal,)*) => {
        /// Why a volume was refused. [`VolumeError::code`] is stable; the texts are for people.
        #[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
        #[non_exhaustive]
        pub enum VolumeError {
            $($(#[$doc])* #[error("{0}")] $name(Box<Trouble>),)*
        }

        impl VolumeError {
            /// The stable code of this kind of error, in kebab case.
            #[must_use]
            pub fn code(&self) -> &'static str {
                match self { $(Self::$name(_) => $code,)* }
            }

            /// File, line, cause and remedy.
            #[must_use]
            pub fn trouble(&self) -> &Trouble {
                match self { $(Self::$name(trouble) => trouble,)* }
            }

            fn trouble_mut(&mut self) -> &mut Trouble {
                match self { $(Self::$name(trouble) => trouble,)* }
            }
        }
    };
}

volume_errors! {
    /// The file does not exist, is no regular file, or cannot be read.
    Unreadable = "volume-unreadable",
    /// A data file that the header names does not exist, is no regular file, or cannot be read.
    DataFile = "volume-data-file",
    /// Neither the content nor the name tells a format that is read here.
    UnknownFormat = "volume-unknown-format",
    /// The name says one format, the content another.
    WrongContent = "volume-wrong-content",
    /// A raw file whose name does not tell dimensions and type, and no options that do.
    RawName = "volume-raw-name",
    /// A header that is no header: a line without a key, a repeated key, no end, not text.
    HeaderSyntax = "volume-header-syntax",
    /// A header without a field that it must have.
    MissingField = "volume-missing-field",
    /// A header field whose value does not make sense.
    BadValue = "volume-bad-value",
    /// A voxel type that does not exist or is not read.
    UnknownType = "volume-unknown-type",
    /// A legal feature of the format that is not read here.
    Unsupported = "volume-unsupported",
    /// Several values per voxel and no choice among them, or a choice that does not exist.
    Component = "volume-component",
    /// A grid without voxels, or a placement that is singular or not finite.
    Grid = "volume-grid",
    /// More voxel bytes than the limit allows, or than memory gives.
    TooLarge = "volume-too-large",
    /// Fewer voxels in the file than it says.
    DataTooShort = "volume-data-too-short",
    /// More voxels in the file than it says.
    DataTooLong = "volume-data-too-long",
    /// A compressed stream or a number in text data that cannot be decoded.
    DataCorrupt = "volume-data-corrupt",
    /// A load option that contradicts the file or itself.
    Option = "volume-option",
    /// A file that cannot be written, or must not be: it is there already, or the format cannot hold the volume.
    Write = "volume-write",
    /// Work that was interrupted by the user.
    Interrupted = "volume-interrupted",
    /// An analytic field or a parameter of one that does not exist or is out of range.
    Field = "volume-field",
}

impl VolumeError {
    /// Sets the header line, unless one is known.
    #[must_use]
    pub fn on_line(mut self, line: u32) -> Self {
        let trouble = self.trouble_mut();
        if trouble.line == 0 && trouble.file.as_os_str().is_empty() {
            trouble.line = line;
        }
        self
    }

    /// Sets the file, unless one is known.
    #[must_use]
    pub fn in_file(mut self, file: &Path) -> Self {
        let trouble = self.trouble_mut();
        if trouble.file.as_os_str().is_empty() {
            trouble.file = file.to_path_buf();
        }
        self
    }
}

impl From<VolumeError> for Finding {
    fn from(error: VolumeError) -> Self {
        let trouble = error.trouble();
        let mut finding = Finding::error(error.code(), trouble.cause.as_str());
        finding.place = trouble.place();
        finding.help(trouble.remedy.as_str())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_to_know_the_file_wins_and_the_finding_keeps_everything() {
        let error = VolumeError::BadValue(Trouble::new("cause", "remedy"))
            .on_line(3)
            .in_file(Path::new("a.nrrd"))
            .on_line(9)
            .in_file(Path::new("b.nrrd"));
        assert_eq!(error.to_string(), "a.nrrd:3:1: cause; remedy");
        let finding = Finding::from(error);
        assert_eq!(finding.code, "volume-bad-value");
        assert_eq!(finding.place.unwrap().line, 3);
        assert_eq!(finding.help.as_deref(), Some("remedy"));
    }

    #[test]
    fn a_line_is_not_added_to_an_error_about_another_file() {
        let error = VolumeError::DataTooShort(Trouble::new("cause", "remedy"))
            .in_file(Path::new("data.raw"))
            .on_line(4);
        assert_eq!(error.trouble().line, 0);
    }
}
