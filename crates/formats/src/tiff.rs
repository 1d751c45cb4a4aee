//! TIFF and BigTIFF: a file per slice, a file of many pages, hyperstacks of ImageJ and OME-TIFF.
//!
//! [`pages`] walks through the directories of a file and decodes pages; `layout` reads what the first page's
//! description says of slices, channels, time steps and lengths, in ImageJ's words or in OME-XML. Without one, pages
//! (or files of one page each) are slices. Pages of another size or type than the first one (thumbnails, smaller
//! copies) are passed over with a warning; directories below the pages are not looked at. Files of many pages each
//! are time steps.
//!
//! x grows to the right, y downwards as the rows go, z along the slices. Where only the resolution of a page is
//! known, slices are as far apart as its columns.

mod entries;
mod layout;
mod look;
mod pages;
mod patched;

use glam::DVec3;
use volgraph_volume::{Grid, Trouble, VolumeError, Voxels};

use crate::axes::Axes;
use crate::contents::{Components, Contents, Opened};
use crate::input::{Input, stem};
use crate::load::LoadOptions;
use crate::slices::{Frames, Slices, guarded};
use crate::stack::{Shape, same_shape};

use layout::Layout;
pub(crate) use look::{rgb_of_ycbcr, weave};
use pages::Pages;

/// Whether a file with this head is TIFF or BigTIFF.
pub(crate) fn is_tiff(head: &[u8]) -> bool {
    const MAGIC: [&[u8]; 4] = [b"II*\0", b"MM\0*", b"II+\0\x08\0\0\0", b"MM\0+\0\x08\0\0"];
    MAGIC.iter().any(|magic| head.starts_with(magic))
}

/// One volume of the pages of all files.
pub(crate) fn open<'a>(
    inputs: &[Input<'a>],
    options: &LoadOptions,
) -> Result<Opened<'a>, VolumeError> {
    if options.level.is_some_and(|level| level > 0) {
        return Err(VolumeError::Option(Trouble::new(
            "of TIFF only the finest level is read",
            "leave the option `level` out",
        )));
    }
    let mut files: Vec<Pages<'a>> = inputs
        .iter()
        .map(|input| {
            guarded("TIFF", || Pages::of(input)).map_err(|error| error.in_file(&input.path))
        })
        .collect::<Result<_, _>>()?;
    let shapes: Vec<Shape> = files.iter().map(Pages::shape).collect();
    let shape = same_shape(&shapes, |i| inputs[i].path.clone())?;
    let in_first = |error: VolumeError| error.in_file(&inputs[0].path);
    let mut layout = layout::of(&mut files[0], options).map_err(in_first)?;
    let counts: Vec<usize> = files.iter().map(Pages::count).collect();
    if let Some(other) = counts.iter().position(|&count| count != counts[0]) {
        return Err(VolumeError::Unsupported(Trouble::new(
            format!(
                "this file has {} pages, and the first one {}",
                counts[other], counts[0]
            ),
            "give one of the files, or name those that belong together with a pattern",
        ))
        .in_file(&inputs[other].path));
    }
    let slices_in_files = files.len() > 1 && counts[0] == 1;
    if slices_in_files {
        layout.stack_files(files.len());
    } else if files.len() > 1 {
        layout
            .steps_in_files(files.len(), counts[0])
            .map_err(in_first)?;
    }
    let mut contents = contents_of(inputs, shape, &layout)?;
    contents.warnings.append(&mut layout.warnings);
    for (file, input) in files.iter().zip(inputs) {
        let name = input.path.file_name().unwrap_or_default().to_string_lossy();
        let several = files.len() > 1;
        let prefix = if several {
            format!("{name}: ")
        } else {
            String::new()
        };
        let told = file.warnings.iter().map(|text| format!("{prefix}{text}"));
        contents.warnings.extend(told);
    }
    contents.components = match shape.channels {
        2..=4 if files[0].is_color() && layout.channels == 1 => Components::Colors,
        _ => Components::Values,
    };
    let what = contents.axes.describe(shape.scalar_type);
    let data = Slices {
        frames: AllPages {
            files,
            each: counts[0],
        },
        order: layout.order,
        per_step: layout.channels * layout.slices,
        values: shape.values(),
        scalar_type: shape.scalar_type,
        what,
    };
    Ok(Opened {
        contents,
        data: Box::new(data),
    })
}

fn contents_of(
    inputs: &[Input<'_>],
    shape: Shape,
    layout: &Layout,
) -> Result<Contents, VolumeError> {
    let sizes = [
        (shape.channels, false),
        (shape.width.into(), true),
        (shape.height.into(), true),
        (layout.channels as u64, false),
        (layout.slices as u64, true),
    ];
    // Axes of one value that are not spatial are left out.
    let sizes = sizes
        .into_iter()
        .filter(|&(size, spatial)| spatial || size > 1);
    let (sizes, spatial): (Vec<u64>, Vec<bool>) = sizes.unzip();
    let spatial = (0..sizes.len()).filter(|&axis| spatial[axis]).collect();
    let mut axes = Axes::new(sizes, spatial)?;
    if layout.steps > 1 {
        axes = axes.with_steps_behind(layout.steps as u64)?;
    }
    let grid = Grid::axis_aligned(axes.dims(), layout.spacing, DVec3::ZERO);
    let first = &inputs[0].path;
    let folder = first.parent().filter(|_| inputs.len() > 1);
    let name = folder.map_or_else(|| stem(first), stem);
    let mut contents = Contents::new(layout.format.clone(), name, axes, shape.scalar_type, grid);
    contents.about.length_unit.clone_from(&layout.length_unit);
    contents.about.facts.clone_from(&layout.facts);
    if let Some(interval) = layout.interval.filter(|_| layout.steps > 1) {
        contents.times = (0..layout.steps)
            .map(|step| step as f64 * interval)
            .collect();
        contents.time_unit.clone_from(&layout.time_unit);
    }
    if inputs.len() > 1 {
        contents.data_files = inputs.iter().map(|input| input.path.clone()).collect();
    }
    Ok(contents)
}

/// The pages of all files, one file after the other.
struct AllPages<'a> {
    files: Vec<Pages<'a>>,
    /// Pages of each.
    each: usize,
}

impl Frames for AllPages<'_> {
    fn decode(&self, frame: usize) -> Result<Voxels, VolumeError> {
        let file = &self.files[frame / self.each];
        guarded("TIFF", || file.decode(frame % self.each))
            .map_err(|error| error.in_file(&file.input.path))
    }
}
