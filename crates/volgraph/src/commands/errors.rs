//! Errors of the picture and measure crates as findings, with a stable code and the file that they are about.

use std::path::Path;

use volgraph::{Finding, Place};
use volgraph_measure::MeasureError;
use volgraph_picture::PictureError;

/// A finding for a picture that was not saved or loaded. `file` is the picture's.
pub fn of_picture(error: &PictureError, file: &Path) -> Finding {
    let (code, message, help) = match error {
        PictureError::Io { source, .. } => (
            "io",
            source.to_string(),
            "check the path, its folder and your permissions",
        ),
        PictureError::Extension { .. } => (
            "picture-extension",
            "the extension names no picture format".to_owned(),
            "end the name with .png or .exr",
        ),
        PictureError::NotAPicture { .. } => (
            "not-a-picture",
            "this is neither a PNG nor an EXR file".to_owned(),
            "name a picture; its content counts, not its name",
        ),
        PictureError::Size { .. } => ("picture-size", error.to_string(), "use another size"),
        PictureError::Shape { .. } | PictureError::Layer { .. } | PictureError::Metadata { .. } => {
            ("picture", error.to_string(), "please report this as a bug")
        }
        PictureError::Encode { cause, .. } => (
            "picture-encode",
            format!("the picture cannot be encoded: {cause}"),
            "use another size",
        ),
        PictureError::Decode { cause, .. } => (
            "picture-decode",
            format!("the picture cannot be read: {cause}"),
            "the file is cut short or damaged, or uses a rare feature; save it again",
        ),
    };
    Finding::error(code, message)
        .at(Place::whole_file(file))
        .help(help)
}

/// A finding for two pictures, `a` and `b`, that cannot be compared.
pub fn of_comparison(error: &MeasureError, a: &Path, b: &Path) -> Finding {
    let finding = match error {
        MeasureError::Picture(error) => return of_picture(error, a),
        MeasureError::Sizes { .. } => {
            Finding::error("picture-sizes", error.to_string()).help("render both at the same size")
        }
        MeasureError::NotANumber { .. } => Finding::error("not-a-number", error.to_string()),
        MeasureError::NoSamples | MeasureError::Sample { .. } | MeasureError::Unpaired { .. } => {
            Finding::error("measure", error.to_string())
        }
    };
    finding
        .at(Place::whole_file(a))
        .related(Place::whole_file(b), "the other picture")
}
