//! Files of volumes, each by its own target and all by `recognise`.

use volgraph_formats::{
    LoadOptions, from_bytes, load, metaimage as meta, nrrd as near, parse_raw_name,
};
use volgraph_volume::{Component, ScalarType, Volume, VolumeError};

use crate::folder::Folder;

/// What stands between the files of an input that are slices of one volume.
const BETWEEN: &[u8] = b"////\n";

/// Most files of one input.
const MOST_FILES: usize = 8;

/// A file's name up to the first line feed, its bytes behind it: the name is parsed, and where it parses the bytes
/// are read as its voxels. A name that parses means the same when it is written plainly.
pub fn raw_name(data: &[u8]) {
    let end = data
        .iter()
        .position(|byte| *byte == b'\n')
        .unwrap_or(data.len());
    let Ok(name) = std::str::from_utf8(&data[..end]) else {
        return;
    };
    let Ok(raw) = parse_raw_name(name) else {
        return;
    };
    let [x, y, z] = raw.dims;
    let plain = parse_raw_name(&format!("{}_{x}x{y}x{z}_{}.raw", raw.name, raw.scalar_type))
        .expect("a plain name");
    assert_eq!((raw.dims, raw.scalar_type), (plain.dims, plain.scalar_type));
    volume(name, data.get(end + 1..).unwrap_or_default(), None);
}

/// An NRRD file; the first byte chooses the component.
pub fn nrrd(data: &[u8]) {
    let Some((first, bytes)) = data.split_first() else {
        return;
    };
    let _ = near::parse_header(bytes);
    volume("fuzzed.nrrd", bytes, component(*first));
}

/// A MetaImage file; the first byte chooses the component.
pub fn metaimage(data: &[u8]) {
    let Some((first, bytes)) = data.split_first() else {
        return;
    };
    let _ = meta::parse_header(bytes);
    volume("fuzzed.mha", bytes, component(*first));
}

/// A NIfTI file; the first byte chooses (see [`options`]), as for all formats below.
pub fn nifti(data: &[u8]) {
    one("fuzzed.nii", data);
}

/// A VTI file.
pub fn vti(data: &[u8]) {
    one("fuzzed.vti", data);
}

/// A NumPy file.
pub fn npy(data: &[u8]) {
    one("fuzzed.npy", data);
}

/// An HDF5 file.
pub fn hdf5(data: &[u8]) {
    one("fuzzed.h5", data);
}

/// A zip archive of a Zarr hierarchy.
pub fn zarr_zip(data: &[u8]) {
    one("fuzzed.zarr.zip", data);
}

/// A DICOM file, or the files of a series (see [`slices`]).
pub fn dicom(data: &[u8]) {
    slices("dcm", data);
}

/// A TIFF file, or several that are slices or time steps.
pub fn tiff(data: &[u8]) {
    slices("tif", data);
}

/// A picture in PNG or JPEG, or a stack of them.
pub fn pictures(data: &[u8]) {
    slices("png", data);
}

/// Names of every ending that means something to the readers, and some that should mean nothing.
const NAMES: [&str; 26] = [
    "a.nrrd",
    "a.nhdr",
    "a.mha",
    "a.mhd",
    "a.dcm",
    "a.ima",
    "a.tif",
    "a.btf",
    "a.png",
    "a.jpg",
    "a.nii",
    "a.nii.gz",
    "a.hdr",
    "a.img",
    "a.vti",
    "a.npy",
    "a_3x3x3_uint8.raw",
    "a_2x2x2_float64.raw.gz",
    "a.raw",
    "a.zarr.zip",
    "a.ozx",
    "DICOMDIR",
    "",
    "a.",
    "a.h5",
    "a.zip",
];

/// Any bytes as a file of any name: the first byte chooses the name and whether the options describe raw voxels,
/// the second as for a single format.
pub fn recognise(data: &[u8]) {
    let [first, second, bytes @ ..] = data else {
        return;
    };
    let mut options = options(*second);
    if first & 0x80 != 0 {
        options.dims = Some([3, 2, 1]);
        options.scalar_type = Some(ScalarType::I16);
        options.big_endian = first & 0x40 != 0;
    }
    let name = NAMES[usize::from(*first & 0x3f) % NAMES.len()];
    sound(from_bytes(name, bytes, &options));
}

fn one(name: &str, data: &[u8]) {
    let Some((first, bytes)) = data.split_first() else {
        return;
    };
    sound(from_bytes(name, bytes, &options(*first)));
}

/// A file, or several with a line `////` between them, which are read as a folder.
fn slices(ending: &str, data: &[u8]) {
    sound(read_slices(ending, data));
}

pub(crate) fn read_slices(ending: &str, data: &[u8]) -> Result<Volume, VolumeError> {
    let (first, bytes) = data.split_first().unwrap_or((&0, &[]));
    let files: Vec<&[u8]> = pieces(bytes).take(MOST_FILES).collect();
    let options = options(*first);
    if let [file] = files.as_slice() {
        return from_bytes(&format!("fuzzed.{ending}"), file, &options);
    }
    let folder = Folder::new();
    for (number, file) in files.iter().enumerate() {
        folder.write(&format!("{number}.{ending}"), file);
    }
    load(folder.path(), &options)
}

fn pieces(bytes: &[u8]) -> impl Iterator<Item = &[u8]> {
    let mut rest = Some(bytes);
    std::iter::from_fn(move || {
        let all = rest.take()?;
        let found = all.windows(BETWEEN.len()).position(|part| part == BETWEEN);
        let Some(end) = found else { return Some(all) };
        rest = Some(&all[end + BETWEEN.len()..]);
        Some(&all[..end])
    })
}

/// What a byte chooses: the two lowest bits a component, the next two the second time step and the second level, the
/// next two colours or magnitude instead of a component.
pub(crate) fn options(byte: u8) -> LoadOptions {
    let second = |bit: u8| (byte & bit != 0).then_some(1);
    LoadOptions {
        component: match byte >> 4 & 3 {
            1 => Some(Component::Color),
            2 => Some(Component::Magnitude),
            _ => component(byte).map(Component::Index),
        },
        time: second(4),
        level: second(8),
        ..LoadOptions::default()
    }
}

pub(crate) fn component(byte: u8) -> Option<u32> {
    (byte & 3).checked_sub(1).map(u32::from)
}

fn volume(name: &str, bytes: &[u8], component: Option<u32>) {
    let options = LoadOptions {
        component: component.map(Component::Index),
        ..LoadOptions::default()
    };
    sound(from_bytes(name, bytes, &options));
}

/// Whatever is read is whole; whatever is refused says why and what to do.
pub(crate) fn sound(read: Result<Volume, VolumeError>) {
    match read {
        Ok(volume) => {
            assert_eq!(volume.voxels().len() as u64, volume.grid().voxel_count());
            assert!(volume.grid().check().is_ok());
            let (low, high) = volume.grid().box_index();
            let _ = (
                volume.trilinear(low),
                volume.trilinear(high),
                volume.digest(),
                volume.histogram(16),
            );
            let _ = volume.statistics().percentile(50.0);
        }
        Err(error) => {
            assert!(!error.to_string().is_empty());
            assert!(!error.trouble().remedy.is_empty());
        }
    }
}
