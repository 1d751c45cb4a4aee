//! What can be wrong with a mesh or with what is asked of it: one enum, one stable code per variant.
//!
//! As a `VolumeError`, an error is made where the trouble is seen and learns line and file on its way up; the first
//! to know wins.

use std::path::Path;

use volgraph_report::Finding;
use volgraph_volume::{Trouble, VolumeError};

macro_rules! mesh_errors {
    ($($(#[$doc:meta])* $name:ident = $code:literal,)*) => {
        /// Why a mesh or a distance field was refused. [`MeshError::code`] is stable; the texts are for people.
        #[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
        #[non_exhaustive]
        pub enum MeshError {
            $($(#[$doc])* #[error("{0}")] $name(Box<Trouble>),)*
        }

        impl MeshError {
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

mesh_errors! {
    /// The file does not exist, is no regular file, or cannot be read.
    Unreadable = "mesh-unreadable",
    /// Neither the content nor the name tells a mesh format that is read here.
    UnknownFormat = "mesh-unknown-format",
    /// A header or a line that is none of its format.
    Syntax = "mesh-syntax",
    /// A number that is no number, not finite or out of range.
    BadValue = "mesh-bad-value",
    /// A face that names a vertex which does not exist.
    Index = "mesh-index",
    /// A legal feature of the format that is not read here.
    Unsupported = "mesh-unsupported",
    /// Less in the file than it says.
    TooShort = "mesh-too-short",
    /// More bytes, vertices or voxels than the limit allows.
    TooLarge = "mesh-too-large",
    /// A mesh without any triangle that has an area.
    Empty = "mesh-empty",
    /// An option of the distance field that contradicts the mesh or itself.
    Option = "mesh-option",
    /// The grid of the distance field is not valid.
    Grid = "mesh-grid",
    /// The caller asked to stop.
    Cancelled = "mesh-cancelled",
}

impl MeshError {
    /// Sets the line, unless one is known.
    #[must_use]
    pub fn on_line(mut self, line: usize) -> Self {
        let trouble = self.trouble_mut();
        if trouble.line == 0 && trouble.file.as_os_str().is_empty() {
            trouble.line = u32::try_from(line).unwrap_or(u32::MAX);
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

impl From<VolumeError> for MeshError {
    fn from(error: VolumeError) -> Self {
        Self::Grid(Box::new(error.trouble().clone()))
    }
}

impl From<MeshError> for Finding {
    fn from(error: MeshError) -> Self {
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
    fn a_finding_keeps_place_cause_and_remedy() {
        let error = MeshError::BadValue(Trouble::new("cause", "remedy"))
            .on_line(3)
            .in_file(Path::new("a.obj"))
            .in_file(Path::new("b.obj"))
            .on_line(9);
        assert_eq!(error.to_string(), "a.obj:3:1: cause; remedy");
        let finding = Finding::from(error);
        assert_eq!(finding.code, "mesh-bad-value");
        assert_eq!(finding.place.unwrap().line, 3);
        assert_eq!(finding.help.as_deref(), Some("remedy"));
    }
}
