//! The table of formats: how each is recognised and who reads it.
//!
//! The content decides before the name. Raw voxels are what is left: no content tells them, so their name or the
//! options must.

use std::io::Read as _;
use std::path::Path;

use flate2::read::GzDecoder;
use volgraph_volume::{Trouble, VolumeError};

use crate::contents::Opened;
use crate::input::Input;
use crate::load::LoadOptions;
use crate::{dicom, hdf5, metaimage, nifti, npy, nrrd, raw, stack, tiff, vti, zarr};

/// Files of a folder that are looked at to tell whether it holds a volume.
const MOST_LOOKED_AT: usize = 256;

/// Bytes that are looked at to recognise a format.
const HEAD: u64 = 2048;

/// What a file looks like from outside.
pub(crate) struct Head {
    /// The file's name without its folder.
    pub name: String,
    /// At most the first 2048 bytes.
    pub bytes: Vec<u8>,
    /// At most the first 2048 bytes of what a gzip stream holds; empty where it is none.
    pub unpacked: Vec<u8>,
}

impl Head {
    pub fn of(input: &Input<'_>) -> Result<Self, VolumeError> {
        let bytes = input.head(HEAD)?;
        let mut unpacked = Vec::new();
        if bytes.starts_with(b"\x1f\x8b") {
            // A stream that ends early or breaks has told what it had.
            let _ = GzDecoder::new(bytes.as_slice())
                .take(HEAD)
                .read_to_end(&mut unpacked);
        }
        let name = input.path.file_name().unwrap_or_default();
        Ok(Self {
            name: name.to_string_lossy().into_owned(),
            bytes,
            unpacked,
        })
    }

    /// Whether the name ends so; lower case, with the dot.
    pub fn ends_with(&self, ending: &str) -> bool {
        self.name.to_ascii_lowercase().ends_with(ending)
    }
}

/// How files of a format become one volume.
#[derive(Clone, Copy)]
pub(crate) enum Opens {
    /// Each is a volume of its own; several are time steps.
    One(for<'a> fn(&Input<'a>, &LoadOptions) -> Result<Opened<'a>, VolumeError>),
    /// They are slices of a volume, in natural order of their names; one alone is a volume too.
    Slices(for<'a> fn(&[Input<'a>], &LoadOptions) -> Result<Opened<'a>, VolumeError>),
}

/// A row of the table.
pub(crate) struct Format {
    /// Its name for people.
    pub name: &'static str,
    /// Endings of names that promise it, in lower case, with the dot.
    pub endings: &'static [&'static str],
    /// How its content begins, for the message about a name that promises too much.
    pub begins: &'static str,
    pub recognises: fn(&Head) -> bool,
    pub opens: Opens,
}

/// All formats that are known by their content.
pub(crate) const FORMATS: &[Format] = &[
    Format {
        name: "NRRD",
        endings: &[".nrrd", ".nhdr"],
        begins: "NRRD000",
        recognises: |head| nrrd::is_nrrd(&head.bytes),
        opens: Opens::One(nrrd::open),
    },
    Format {
        name: "MetaImage",
        endings: &[".mha", ".mhd"],
        begins: "ObjectType or NDims",
        recognises: |head| metaimage::is_metaimage(&head.bytes),
        opens: Opens::One(metaimage::open),
    },
    Format {
        name: "DICOM",
        endings: &[".dcm", ".dicom", ".ima"],
        begins: "DICM behind 128 bytes",
        recognises: |head| dicom::is_dicom(&head.bytes),
        opens: Opens::Slices(dicom::open),
    },
    Format {
        name: "TIFF",
        endings: &[".tif", ".tiff", ".btf", ".tf8"],
        begins: "II or MM",
        recognises: |head| tiff::is_tiff(&head.bytes),
        opens: Opens::Slices(tiff::open),
    },
    Format {
        name: "PNG",
        endings: &[".png"],
        begins: "89 PNG",
        recognises: |head| stack::is_png(&head.bytes),
        opens: Opens::Slices(stack::open_png),
    },
    Format {
        name: "JPEG",
        endings: &[".jpg", ".jpeg"],
        begins: "FF D8 FF",
        recognises: |head| stack::is_jpeg(&head.bytes),
        opens: Opens::Slices(stack::open_jpeg),
    },
    Format {
        name: "NIfTI",
        endings: &[".nii", ".nii.gz"],
        begins: "its size, 348 or 540, and has n+1, ni1, n+2 or ni2",
        recognises: nifti::is_nifti,
        opens: Opens::One(nifti::open),
    },
    Format {
        name: "VTI",
        endings: &[".vti"],
        begins: "<VTKFile type=\"ImageData\"",
        recognises: |head| vti::is_vti(&head.bytes),
        opens: Opens::One(vti::open),
    },
    Format {
        name: "NumPy",
        endings: &[".npy"],
        begins: "\\x93NUMPY",
        recognises: |head| npy::is_npy(&head.bytes),
        opens: Opens::One(npy::open),
    },
    Format {
        name: "Zarr in a zip archive",
        endings: zarr::ENDINGS,
        begins: "PK",
        recognises: zarr::is_zip,
        opens: Opens::One(zarr::open_zip),
    },
    // The last one: its user block may be anything.
    Format {
        name: "HDF5",
        endings: &[".h5", ".hdf5", ".he5"],
        begins: "\\x89HDF",
        recognises: |head| hdf5::is_hdf5(&head.bytes),
        opens: Opens::One(hdf5::open),
    },
];

/// The format of a file by its content.
pub(crate) fn recognise(head: &Head) -> Option<&'static Format> {
    FORMATS.iter().find(|format| (format.recognises)(head))
}

/// Whether a path looks like a volume without being read: a folder or a pattern of files of known
/// formats, a Zarr folder, a file of a known format, or one whose name describes raw voxels.
#[must_use]
pub fn is_volume(path: &Path) -> bool {
    if zarr::is_hierarchy(path) {
        return true;
    }
    let is_one = |path: &Path| {
        let head = Input::file(path).and_then(|input| Head::of(&input));
        head.is_ok_and(|head| recognise(&head).is_some() || raw::parse_raw_name(&head.name).is_ok())
    };
    if path.is_file() {
        return is_one(path);
    }
    let files = crate::series::files(path);
    files.is_ok_and(|files| {
        let files = files.unwrap_or_default();
        files.iter().take(MOST_LOOKED_AT).any(|file| is_one(file))
    })
}

/// Opens one file.
pub(crate) fn open_file<'a>(
    input: &Input<'a>,
    options: &LoadOptions,
) -> Result<Opened<'a>, VolumeError> {
    let head = Head::of(input)?;
    if let Some(format) = recognise(&head) {
        return match format.opens {
            Opens::One(open) => open(input, options),
            Opens::Slices(open) => open(std::slice::from_ref(input), options),
        };
    }
    // The voxels of a pair: its header says what they are.
    if let Some(header) = nifti::header_of(input, &head) {
        return nifti::open(&header, options);
    }
    let looks_like = sniff(&head.bytes);
    if looks_like == CLASSIC {
        return Err(VolumeError::Unsupported(Trouble::new(
            "NetCDF files of the classic format are not read",
            "make a NetCDF-4 file of it: `nccopy -k nc4 OLD.nc NEW.nc`",
        )));
    }
    let promised = FORMATS
        .iter()
        .find(|format| format.endings.iter().any(|ending| head.ends_with(ending)));
    if let Some(Format { name, begins, .. }) = promised {
        return Err(VolumeError::WrongContent(Trouble::new(
            format!(
                "the name says {name} (which begins with {begins}), the content looks like {looks_like}"
            ),
            "give the file its right name, or fetch it again",
        )));
    }
    let described = options.dims.is_some() && options.scalar_type.is_some();
    if described || raw::names_raw(&head.name) {
        return raw::open(input, &head.name, looks_like, options);
    }
    // Archives that are not called so, and whose first entry is any.
    if looks_like == "a zip archive" {
        return zarr::open_zip(input, options);
    }
    let names: Vec<&str> = FORMATS.iter().map(|format| format.name).collect();
    Err(VolumeError::UnknownFormat(Trouble::new(
        format!("this is no volume format that is read here; it looks like {looks_like}"),
        format!(
            "convert it to one of {}, or name raw voxels name_XxYxZ_type.raw or give their dimensions and type",
            names.join(", ")
        ),
    )))
}

/// NetCDF before it was HDF5.
const CLASSIC: &str = "a classic NetCDF file";

/// What a file looks like by its first bytes, for messages.
pub(crate) fn sniff(head: &[u8]) -> &'static str {
    const MAGIC: [(&[u8], &str); 20] = [
        (b"\x89PNG", "a PNG picture"),
        (b"\xff\xd8\xff", "a JPEG picture"),
        (b"GIF8", "a GIF picture"),
        (b"II*\0", "a TIFF picture"),
        (b"MM\0*", "a TIFF picture"),
        (b"\x76\x2f\x31\x01", "an OpenEXR picture"),
        (b"\x1f\x8b", "a gzip stream"),
        (b"BZh", "a bzip2 stream"),
        (b"PK\x03\x04", "a zip archive"),
        (b"\x89HDF", "an HDF5 file"),
        (b"CDF\x01", CLASSIC),
        (b"CDF\x02", CLASSIC),
        (b"CDF\x05", CLASSIC),
        (b"\x5c\x01\0\0", "a NIfTI file"),
        (b"\0\0\x01\x5c", "a NIfTI file"),
        (b"\x1c\x02\0\0", "a NIfTI-2 file"),
        (b"<?xml", "an XML file (VTK?)"),
        (b"<VTKFile", "a VTK XML file"),
        (b"# vtk", "a legacy VTK file"),
        (b"DDS v3d", "a PVM volume"),
    ];
    if head.is_empty() {
        return "an empty file";
    }
    if let Some((_, what)) = MAGIC.iter().find(|(magic, _)| head.starts_with(magic)) {
        return what;
    }
    if head.get(128..132) == Some(b"DICM") {
        return "a DICOM file";
    }
    let is_text = |byte: &u8| byte.is_ascii_graphic() || byte.is_ascii_whitespace();
    if head.iter().all(is_text) {
        return "text";
    }
    "bytes of no format known here"
}
