//! What `--against` names.

use std::path::Path;

use volgraph::{Finding, Findings, Picture, Place};

use crate::args::WatchArgs;
use crate::commands::errors;

/// Whether the word `reference` is meant, and no file of that name.
pub fn is_reference(args: &WatchArgs) -> bool {
    let is_word = |file: &Path| file == Path::new("reference") && !file.exists();
    args.against.as_deref().is_some_and(is_word)
}

/// The picture that pictures are compared with.
pub fn picture(args: &WatchArgs, file: &Path) -> Result<Picture, Findings> {
    crate::commands::check_overwrites(&args.output, [file])?;
    let picture = Picture::load(file).map_err(|error| errors::of_picture(&error, file))?;
    let size = args.scene.size;
    if [picture.width, picture.height] == size {
        return Ok(picture);
    }
    let (width, height) = (picture.width, picture.height);
    let message = format!(
        "it has {width}x{height} pixels, and the pictures to compare with it {}x{}",
        size[0], size[1]
    );
    Err(Finding::error("picture-sizes", message)
        .at(Place::whole_file(file))
        .help(format!("add `--size {width}x{height}`"))
        .into())
}
