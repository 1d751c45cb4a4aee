//! DICOM: a series of files of one slice each, or a file of many frames.
//! Source: DICOM PS3.3 (attributes), PS3.5 (encoding).
//!
//! [`dataset`] reads the [`elements`] of a file up to its pixels, [`image`] what they say of the pixels and of each frame.
//! [`series`] picks the frames that make one volume: several series in a folder are listed, and the option `part`
//! names one. [`place`] sorts them by their positions and makes the map to LPS, which is DICOM's own frame. [`codecs`]
//! decodes a frame; its values are rescaled by its own slope and intercept. Segmentations become labels
//! ([`segments`]). Directories of files (DICOMDIR), reports and other files without pixels are passed over.
//!
//! Nothing that names a patient is read.

mod codecs;
mod dataset;
mod elements;
mod image;
mod place;
mod segments;
mod series;

use dicom_dictionary_std::tags;
use rayon::prelude::*;
use volgraph_volume::{Grid, ScalarType, Trouble, Values, VolumeError, Voxels};

pub(crate) use dataset::is_dicom;

use crate::axes::Axes;
use crate::contents::{Components, Contents, Opened};
use crate::input::{Input, stem};
use crate::load::LoadOptions;
use crate::rescale::Rescale;
use crate::slices::{Frames, Slices, guarded};

use image::{Frame, Image};
use place::{Placed, place};

/// One volume of the frames of all files.
pub(crate) fn open<'a>(
    inputs: &[Input<'a>],
    options: &LoadOptions,
) -> Result<Opened<'a>, VolumeError> {
    let read: Vec<Option<Image>> = inputs
        .par_iter()
        .map(|input| guarded("DICOM", || Image::of(input)).map_err(|e| e.in_file(&input.path)))
        .collect::<Result<_, _>>()?;
    let with_pixels = inputs.iter().zip(read);
    let with_pixels = with_pixels.filter_map(|(input, image)| Some((input.clone(), image?)));
    let (files, images): (Vec<Input<'a>>, Vec<Image>) = with_pixels.unzip();
    if images.is_empty() {
        return Err(VolumeError::Unsupported(Trouble::new(
            "there are no pixels in these DICOM files (a DICOMDIR or a report?)",
            "give the folder that has the images",
        )));
    }
    let group = series::pick(&images, options.part.as_deref())?;
    if segments::is_segmentation(&images[group.members[0].0]) {
        return segments::open(files, images, &group);
    }
    let name = |member: usize| name_of(&files, &images, group.members[member]);
    let frames: Vec<&Frame> = group
        .members
        .iter()
        .map(|&(i, f)| &images[i].frames[f])
        .collect();
    let placed = place(&frames, name)?;
    let image = &images[group.members[0].0];
    for &(member, _) in &group.members {
        codecs::codec_of(&images[member].syntax)
            .and_then(|_| is_read(&images[member]))
            .map_err(|error| error.in_file(&files[member].path))?;
    }
    let (rescales, scalar_type) = rescales(&images, &group.members);
    let mut contents = contents_of(&files, &images, &group.members, &placed, scalar_type)?;
    if rescales.iter().any(|rescale| *rescale != rescales[0]) {
        let text =
            format!("slope or intercept differ among the slices: all are brought to {scalar_type}");
        contents.warnings.push(text);
    }
    let values = u64::from(image.rows) * u64::from(image.columns) * u64::from(image.samples);
    let what = contents.axes.describe(scalar_type);
    let data = Slices {
        order: placed.order,
        per_step: placed.slices,
        values,
        scalar_type,
        what,
        frames: Stack {
            files,
            members: group.members,
            rescales,
            images,
        },
    };
    Ok(Opened {
        contents,
        data: Box::new(data),
    })
}

/// What a frame is called in messages: its file, and its number where the file has several.
fn name_of(files: &[Input<'_>], images: &[Image], (image, frame): (usize, usize)) -> String {
    let name = files[image]
        .path
        .file_name()
        .unwrap_or_default()
        .to_string_lossy();
    match images[image].frames.len() {
        1 => name.into_owned(),
        _ => format!("frame {frame} of {name}"),
    }
}

/// Refuses colours that nothing here turns into red, green and blue.
fn is_read(image: &Image) -> Result<(), VolumeError> {
    let native = codecs::codec_of(&image.syntax)? == crate::slices::Codec::Stored;
    let photometric = image.photometric.as_str();
    let good = match image.samples {
        1 => true,
        3 if native => {
            matches!(photometric, "RGB" | "YBR_FULL") && image.allocated == 8
                || photometric == "RGB"
        }
        3 => photometric == "RGB" || photometric.starts_with("YBR"),
        _ => false,
    };
    if good {
        return Ok(());
    }
    Err(VolumeError::Unsupported(Trouble::new(
        format!("pixels of {} samples in {photometric}", image.samples),
        "export the series as RGB or MONOCHROME2",
    )))
}

/// How the values of each frame are rescaled, and the type that all come to.
fn rescales(images: &[Image], members: &[(usize, usize)]) -> (Vec<Rescale>, ScalarType) {
    let rescale = |&(image, frame): &(usize, usize)| {
        let image = &images[image];
        let [slope, intercept] = image.frames[frame].rescale.unwrap_or([1.0, 0.0]);
        Rescale::new(image.scalar_type(), image.range(), slope, intercept)
    };
    let mut rescales: Vec<Rescale> = members.iter().map(rescale).collect();
    let first = rescales[0].scalar_type;
    if rescales.iter().all(|rescale| rescale.scalar_type == first) {
        return (rescales, first);
    }
    // Integers of up to 16 bits that differ fit into 32, or a float holds all digits there are.
    let integers = rescales
        .iter()
        .all(|rescale| !rescale.scalar_type.is_float());
    let small = images[members[0].0].scalar_type().size() <= 2;
    let scalar_type = match (integers, small) {
        (true, true) => ScalarType::I32,
        (false, true) => ScalarType::F32,
        _ => ScalarType::F64,
    };
    for rescale in &mut rescales {
        *rescale = rescale.with_type(scalar_type);
    }
    (rescales, scalar_type)
}

fn contents_of(
    files: &[Input<'_>],
    images: &[Image],
    members: &[(usize, usize)],
    placed: &Placed,
    scalar_type: ScalarType,
) -> Result<Contents, VolumeError> {
    let (first, frame) = members[0];
    let image = &images[first];
    let sizes = [
        u64::from(image.columns),
        u64::from(image.rows),
        placed.slices as u64,
    ];
    let mut axes = match image.samples {
        1 => Axes::new(sizes.to_vec(), vec![0, 1, 2])?,
        n => Axes::new([&[n.into()], &sizes[..]].concat(), vec![1, 2, 3])?,
    };
    if placed.steps > 1 {
        axes = axes.with_steps_behind(placed.steps as u64)?;
    }
    let grid = Grid {
        dims: axes.dims(),
        world_from_index: placed.world_from_index,
        node_centred: false,
    };
    let path = &files[first].path;
    let folder = path.parent().filter(|_| files.len() > 1);
    let name = folder.map_or_else(|| stem(path), stem);
    let mut contents = Contents::new("DICOM", name, axes, scalar_type, grid);
    if image.samples == 3 {
        contents.components = Components::Colors;
    }
    contents.about.length_unit = placed.in_mm.then(|| "mm".to_owned());
    meaning(&mut contents, image, &image.frames[frame]);
    facts(&mut contents, image);
    if files.len() > 1 {
        let mut used: Vec<usize> = members.iter().map(|&(image, _)| image).collect();
        used.dedup();
        contents.data_files = used
            .iter()
            .map(|&image| files[image].path.clone())
            .collect();
        let left = files.len() - used.len();
        if left > 0 {
            contents
                .warnings
                .push(format!("{left} files of other series are passed over"));
        }
    }
    contents.warnings.extend(placed.warnings.iter().cloned());
    if members.len() == 1 {
        contents
            .warnings
            .push("this is a single slice; name the folder to read the whole series".to_owned());
    }
    Ok(contents)
}

/// What the values mean, and their unit.
fn meaning(contents: &mut Contents, image: &Image, frame: &Frame) {
    let about = &mut contents.about;
    let modality = image.data.text(tags::MODALITY).unwrap_or_default();
    let rescale_type = frame.rescale_type.as_deref();
    let hounsfield = match rescale_type {
        Some(rescale_type) => rescale_type == "HU",
        None => modality == "CT" && frame.rescale.is_some(),
    };
    if hounsfield {
        about.values = Values::Hounsfield;
        about.value_unit = Some("HU".into());
    } else if modality == "RTDOSE" {
        about.values = Values::Named("dose".into());
        about.value_unit = image.data.text(tags::DOSE_UNITS);
    } else {
        let unit = image.data.text(tags::UNITS).filter(|_| modality == "PT");
        let named = rescale_type.filter(|text| *text != "US").map(str::to_owned);
        about.value_unit = unit.or(named);
    }
    if image.photometric == "MONOCHROME1" {
        contents.warnings.push(
            "the smallest value is meant to be white (MONOCHROME1); the values stay as they are"
                .to_owned(),
        );
    }
}

/// Facts worth printing; none that names a patient.
fn facts(contents: &mut Contents, image: &Image) {
    let facts = &mut contents.about.facts;
    for (name, tag) in [
        ("modality", tags::MODALITY),
        ("series", tags::SERIES_DESCRIPTION),
        ("study", tags::STUDY_DESCRIPTION),
        ("series number", tags::SERIES_NUMBER),
        ("body part", tags::BODY_PART_EXAMINED),
        ("image type", tags::IMAGE_TYPE),
        ("slice thickness", tags::SLICE_THICKNESS),
        ("kernel", tags::CONVOLUTION_KERNEL),
        ("tube voltage in kV", tags::KVP),
        ("field strength in T", tags::MAGNETIC_FIELD_STRENGTH),
        ("echo time in ms", tags::ECHO_TIME),
        ("repetition time in ms", tags::REPETITION_TIME),
    ] {
        if let Some(text) = image.data.text_or_number(tag) {
            facts.push((name.to_owned(), text));
        }
    }
    if let Some(padding) = image.padding() {
        facts.push((
            "padding value before rescaling".to_owned(),
            padding.to_string(),
        ));
    }
    if image.data.text(tags::LOSSY_IMAGE_COMPRESSION).as_deref() == Some("01") {
        facts.push(("compression".to_owned(), "with losses".to_owned()));
    }
    if image.photometric != "MONOCHROME2" {
        facts.push((
            "photometric interpretation".to_owned(),
            image.photometric.clone(),
        ));
    }
}

/// The frames of a series.
struct Stack<'a> {
    files: Vec<Input<'a>>,
    images: Vec<Image>,
    /// Image and frame.
    members: Vec<(usize, usize)>,
    /// Of each member.
    rescales: Vec<Rescale>,
}

impl Frames for Stack<'_> {
    fn decode(&self, member: usize) -> Result<Voxels, VolumeError> {
        let (image, frame) = self.members[member];
        let values = codecs::decode(&self.files[image], &self.images[image], frame)
            .map_err(|error| error.in_file(&self.files[image].path))?;
        let stored = self.images[image].scalar_type();
        if values.scalar_type() != stored {
            return Err(VolumeError::DataCorrupt(Trouble::new(
                format!(
                    "a frame is decoded to {}, the file says {stored}",
                    values.scalar_type()
                ),
                "decompress the series, as with `gdcmconv --raw`",
            ))
            .in_file(&self.files[image].path));
        }
        Ok(self.rescales[member].apply(values))
    }
}
