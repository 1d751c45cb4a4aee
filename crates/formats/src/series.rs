//! A folder or a glob: which files it means, and how they become one volume.
//!
//! Files that are slices (pictures, DICOM) are handed to their format together, in natural order of their names
//! (`slice9` before `slice10`). Files that are a volume each are time steps in that order. Files of no format are
//! passed over with a warning, hidden ones and folders in the folder without one; two formats at once are refused, for nobody can know which one is meant.

use std::path::{Path, PathBuf};

use volgraph_volume::{Grid, ScalarType, Trouble, VolumeError, Voxels};

use crate::axes::Axes;
use crate::contents::{Contents, Data, Opened};
use crate::format::{FORMATS, Format, Head, Opens, open_file, recognise};
use crate::input::Input;
use crate::load::{Limits, LoadOptions};
use crate::raw;

/// Most files of a series.
const MOST_FILES: usize = 100_000;

/// Files that desktops leave in folders, in lower case; hidden ones begin with a dot.
const LITTER: [&str; 3] = ["thumbs.db", "ehthumbs.db", "desktop.ini"];

/// The files that a folder or a glob names, in natural order; `None` where `path` is a file or not there at all.
pub(crate) fn files(path: &Path) -> Result<Option<Vec<PathBuf>>, VolumeError> {
    let refuse = |cause: String, remedy: &str| {
        VolumeError::Unreadable(Trouble::new(cause, remedy)).in_file(path)
    };
    let mut files: Vec<PathBuf> = if path.is_dir() {
        let unreadable = |error: std::io::Error| {
            refuse(
                format!("cannot be listed: {error}"),
                "check its permissions",
            )
        };
        let mut files = Vec::new();
        for entry in std::fs::read_dir(path).map_err(unreadable)? {
            let entry = entry.map_err(unreadable)?;
            let name = entry.file_name().to_string_lossy().to_lowercase();
            let hidden = name.starts_with('.') || LITTER.contains(&name.as_str());
            if !hidden && entry.path().is_file() {
                files.push(entry.path());
            }
        }
        files
    } else {
        let Some(pattern) = path.to_str().filter(|text| text.contains(['*', '?', '['])) else {
            return Ok(None);
        };
        if path.exists() {
            return Ok(None);
        }
        let matches = glob::glob(pattern).map_err(|error| {
            refuse(
                format!("is no pattern of files: {error}"),
                "write `*` for any part of a name, as in `slices/*.tif`",
            )
        })?;
        matches
            .filter_map(Result::ok)
            .filter(|file| file.is_file())
            .collect()
    };
    if files.is_empty() {
        return Err(refuse(
            "no files are there".to_owned(),
            "give a folder or a pattern that has files of a volume",
        ));
    }
    if files.len() > MOST_FILES {
        return Err(refuse(
            format!("{} files are more than {MOST_FILES}", files.len()),
            "name fewer with a pattern, as in `slices/a*.tif`",
        ));
    }
    alphanumeric_sort::sort_path_slice(&mut files);
    Ok(Some(files))
}

/// One volume of the files of a folder or a glob.
pub(crate) fn open(
    files: &[PathBuf],
    options: &LoadOptions,
) -> Result<Opened<'static>, VolumeError> {
    let mut kinds: Vec<Kind> = Vec::new();
    let mut passed: Vec<&PathBuf> = Vec::new();
    for file in files {
        let input = Input::file(file)?;
        let head = Head::of(&input)?;
        let format = recognise(&head);
        let raw = options.dims.is_some() && options.scalar_type.is_some()
            || raw::parse_raw_name(&head.name).is_ok();
        if format.is_none() && !raw {
            passed.push(file);
            continue;
        }
        let same = |kind: &&mut Kind| match (kind.format, format) {
            (Some(a), Some(b)) => std::ptr::eq(a, b),
            (a, b) => a.is_none() && b.is_none(),
        };
        match kinds.iter_mut().find(same) {
            Some(kind) => kind.inputs.push(input),
            None => kinds.push(Kind {
                format,
                inputs: vec![input],
            }),
        }
    }
    // Raw files beside headers are their data.
    if kinds.len() > 1 {
        kinds.retain(|kind| kind.format.is_some());
    }
    let [kind] = kinds.as_slice() else {
        return Err(undecided(&kinds, files.len()));
    };
    let mut opened = kind.open(options)?;
    if let Some(first) = passed.first() {
        let name = first.file_name().unwrap_or_default().to_string_lossy();
        let more = match passed.len() {
            1 => String::new(),
            n => format!(" and {} more", n - 1),
        };
        opened.contents.warnings.push(format!(
            "passed over {name}{more}: no format that is read here"
        ));
    }
    Ok(opened)
}

/// The files of one format.
struct Kind {
    /// `None` for raw voxels.
    format: Option<&'static Format>,
    inputs: Vec<Input<'static>>,
}

impl Kind {
    fn name(&self) -> &'static str {
        self.format.map_or("raw", |format| format.name)
    }

    fn open(&self, options: &LoadOptions) -> Result<Opened<'static>, VolumeError> {
        match self.format.map(|format| format.opens) {
            Some(Opens::Slices(open)) => open(&self.inputs, options),
            _ => open_steps(&self.inputs, options),
        }
    }
}

fn undecided(kinds: &[Kind], files: usize) -> VolumeError {
    if kinds.is_empty() {
        let names: Vec<&str> = FORMATS.iter().map(|format| format.name).collect();
        return VolumeError::UnknownFormat(Trouble::new(
            format!("none of {files} files is of a format that is read here"),
            format!("give a folder with files of {}", names.join(", ")),
        ));
    }
    let found: Vec<String> = kinds
        .iter()
        .map(|kind| format!("{} {}", kind.inputs.len(), kind.name()))
        .collect();
    VolumeError::UnknownFormat(Trouble::new(
        format!("holds files of several formats: {}", found.join(", ")),
        "name those of one with a pattern, as in `folder/*.nrrd`",
    ))
}

/// Files that are a volume each, as time steps.
fn open_steps(
    inputs: &[Input<'static>],
    options: &LoadOptions,
) -> Result<Opened<'static>, VolumeError> {
    let open_one =
        |input: &Input<'static>| open_file(input, options).map_err(|e| e.in_file(&input.path));
    let first = open_one(&inputs[0])?;
    if inputs.len() == 1 {
        return Ok(first);
    }
    let mut contents = first.contents;
    let axes = contents.axes.clone();
    if axes.steps() > 1 {
        return Err(VolumeError::Unsupported(Trouble::new(
            format!(
                "each of {} files has {} time steps of its own",
                inputs.len(),
                axes.steps()
            ),
            "give one of the files",
        ))
        .in_file(&inputs[0].path));
    }
    let steps = FileSteps {
        inputs: inputs.to_vec(),
        options: options.clone(),
        like: Like {
            axes,
            grid: contents.grid,
            scalar_type: contents.scalar_type,
        },
    };
    contents.axes = contents.axes.with_steps_behind(inputs.len() as u64)?;
    contents
        .data_files
        .extend(inputs.iter().map(|input| input.path.clone()));
    Ok(Opened {
        contents,
        data: Box::new(steps),
    })
}

/// A file per time step; each is opened when it is read.
struct FileSteps {
    inputs: Vec<Input<'static>>,
    options: LoadOptions,
    like: Like,
}

/// What all steps have in common.
struct Like {
    axes: Axes,
    grid: Grid,
    scalar_type: ScalarType,
}

impl Data for FileSteps {
    fn read(&self, step: u32, limits: &Limits) -> Result<Voxels, VolumeError> {
        let input = &self.inputs[step as usize];
        let read = || {
            let opened = open_file(input, &self.options)?;
            self.like.check(&opened.contents)?;
            opened.data.read(0, limits)
        };
        read().map_err(|error: VolumeError| error.in_file(&input.path))
    }
}

impl Like {
    /// Refuses a step that is not like the first one: it would be drawn at a wrong place or with wrong values.
    fn check(&self, contents: &Contents) -> Result<(), VolumeError> {
        let differs = |what: &str, this: String, first: String| {
            Err(VolumeError::Unsupported(Trouble::new(
                format!("this time step has {what} {this}, and the first one {first}"),
                "give files of the same dimensions, type and placement, or one of them",
            )))
        };
        let (axes, grid) = (&contents.axes, &contents.grid);
        let sizes = |axes: &Axes, ty| axes.describe(ty);
        let (this, first) = (
            sizes(axes, contents.scalar_type),
            sizes(&self.axes, self.scalar_type),
        );
        if this != first {
            return differs("the size", this, first);
        }
        let close = |a: [f64; 12], b: [f64; 12]| {
            let scale = grid.spacing().max_element();
            a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 1e-6 * scale)
        };
        let (this, first) = (
            grid.world_from_index.to_cols_array(),
            self.grid.world_from_index.to_cols_array(),
        );
        if !close(this, first) {
            return differs("the placement", format!("{this:?}"), format!("{first:?}"));
        }
        Ok(())
    }
}
