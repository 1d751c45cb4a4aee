//! From a path, or bytes, to a volume: options, choice of the reader, and what a wrong file looks like.
//!
//! The content decides before the name: `NRRD000` is an NRRD file, a line `ObjectType =` or `NDims =` a
//! MetaImage header. What is neither is raw data if its name or the options tell dimensions and type.

use std::fmt;
use std::path::Path;
use std::sync::Arc;

use glam::DVec3;

use crate::error::Trouble;
use crate::input::Input;
use crate::{Grid, ScalarType, Volume, VolumeError, Voxels, metaimage, nrrd, raw};

/// The limit on voxel bytes where the options name none: 16 GiB.
pub const DEFAULT_MAX_BYTES: u64 = 16 << 30;

/// Called while voxels are read, with the bytes that are there and the bytes that will be.
pub type Progress = Arc<dyn Fn(u64, u64) + Send + Sync>;

/// What the user says about a file beside its path. All are optional.
#[derive(Clone, Default)]
pub struct LoadOptions {
    /// Dimensions of a raw file, x fastest; wins over its name. For other formats they must agree.
    pub dims: Option<[u32; 3]>,
    /// Type of a raw file; wins over its name. For other formats it must agree.
    pub scalar_type: Option<ScalarType>,
    /// The voxels of a raw file are big-endian; the headers of other formats say so themselves.
    pub big_endian: bool,
    /// Spacing instead of the file's, along its directions; a negative length turns its axis around, for files that
    /// store their slices the other way.
    pub spacing: Option<DVec3>,
    /// Centre of the first voxel instead of the file's.
    pub origin: Option<DVec3>,
    /// Makes the volume node-centred, whatever the file says.
    pub node_centred: bool,
    /// Which value to take where a file has several per voxel, from 0; the fastest axis first.
    pub component: Option<u32>,
    /// Most voxel bytes, all components together; [`DEFAULT_MAX_BYTES`] where `None`.
    pub max_bytes: Option<u64>,
    /// Called while voxels are read.
    pub progress: Option<Progress>,
}

impl fmt::Debug for LoadOptions {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("LoadOptions")
            .field("dims", &self.dims)
            .field("scalar_type", &self.scalar_type)
            .field("big_endian", &self.big_endian)
            .field("spacing", &self.spacing)
            .field("origin", &self.origin)
            .field("node_centred", &self.node_centred)
            .field("component", &self.component)
            .field("max_bytes", &self.max_bytes)
            .finish_non_exhaustive()
    }
}

/// What the stream readers need of the options.
pub(crate) struct Limits {
    pub max_bytes: u64,
    progress: Option<Progress>,
}

impl Limits {
    pub fn of(options: &LoadOptions) -> Self {
        Self {
            max_bytes: options.max_bytes.unwrap_or(DEFAULT_MAX_BYTES),
            progress: options.progress.clone(),
        }
    }

    pub fn report(&self, done: u64, total: u64) {
        if let Some(progress) = &self.progress {
            progress(done, total);
        }
    }
}

impl LoadOptions {
    /// Refuses options that contradict what a header says.
    pub(crate) fn agree(&self, dims: [u32; 3], scalar_type: ScalarType) -> Result<(), VolumeError> {
        let conflict = |said: String, is: String| {
            Err(VolumeError::Option(Trouble::new(
                format!("the options say {said}, the header says {is}"),
                "leave the option out: a file with a header tells it itself",
            )))
        };
        match (self.dims, self.scalar_type) {
            (Some(said), _) if said != dims => conflict(format!("{said:?}"), format!("{dims:?}")),
            (_, Some(said)) if said != scalar_type => {
                conflict(said.to_string(), scalar_type.to_string())
            }
            _ => Ok(()),
        }
    }

    /// The grid with the placement that the options ask for, checked.
    pub(crate) fn place(&self, mut grid: Grid) -> Result<Grid, VolumeError> {
        if let Some(spacing) = self
            .spacing
            .filter(|s| !(s.is_finite() && s.abs().min_element() > 0.0))
        {
            return Err(VolumeError::Option(Trouble::new(
                format!("the options ask for a spacing of {spacing}"),
                "give three lengths other than 0; a negative one turns its axis around",
            )));
        }
        grid.check()?;
        grid.node_centred |= self.node_centred;
        let placed = grid.with_placement(self.spacing, self.origin);
        placed.check()?;
        Ok(placed)
    }
}

/// What a reader has found out; [`Volume::load`] makes the volume of it.
pub(crate) struct Loaded {
    pub name: String,
    pub grid: Grid,
    pub voxels: Voxels,
    pub data_files: Vec<std::path::PathBuf>,
    pub warnings: Vec<String>,
}

impl Volume {
    /// Reads a volume: raw voxels (dimensions and type in the file's name or the options; gzip or not), NRRD
    /// (attached or detached) or MetaImage (local or detached). The content decides, then the name.
    ///
    /// # Errors
    /// A [`VolumeError`] that names the file, the header line where there is one, the cause and the remedy.
    pub fn load(path: &Path, options: &LoadOptions) -> Result<Self, VolumeError> {
        Self::read(&Input::file(path)?, options)
    }

    /// Reads a volume from the bytes of a whole file. `name` is the file's name: raw voxels are described by
    /// it, and errors name it. A header that names other files as its data is refused.
    ///
    /// # Errors
    /// As [`Volume::load`].
    pub fn from_bytes(
        name: &str,
        bytes: &[u8],
        options: &LoadOptions,
    ) -> Result<Self, VolumeError> {
        Self::read(&Input::memory(name, bytes), options)
    }

    fn read(input: &Input<'_>, options: &LoadOptions) -> Result<Self, VolumeError> {
        let loaded = Self::read_parts(input, options).map_err(|e| e.in_file(&input.path))?;
        let mut files = vec![input.path.clone()];
        files.extend(
            loaded
                .data_files
                .into_iter()
                .filter(|file| *file != input.path),
        );
        let volume = Self::new(loaded.name, loaded.grid, loaded.voxels);
        let volume = volume.map_err(|error| error.in_file(&input.path))?;
        let warnings = loaded.warnings.iter();
        let warnings = warnings.map(|text| format!("{}: {text}", input.path.display()));
        Ok(volume.with_sources(files, warnings.collect()))
    }

    fn read_parts(input: &Input<'_>, options: &LoadOptions) -> Result<Loaded, VolumeError> {
        let head = input.head(1024)?;
        if nrrd::is_nrrd(&head) {
            return nrrd::load(input, options);
        }
        if metaimage::is_metaimage(&head) {
            return metaimage::load(input, options);
        }
        let looks_like = sniff(&head);
        let name = input.path.file_name().unwrap_or_default().to_string_lossy();
        let ending = name
            .rsplit_once('.')
            .map(|(_, ending)| ending.to_ascii_lowercase());
        let promised = match ending.as_deref() {
            Some("nrrd" | "nhdr") => Some("an NRRD file (which begins with NRRD000)"),
            Some("mha" | "mhd") => Some("a MetaImage file (which begins with ObjectType or NDims)"),
            _ => None,
        };
        if let Some(promised) = promised {
            return Err(VolumeError::WrongContent(Trouble::new(
                format!("the name says {promised}, the content looks like {looks_like}"),
                "give the file its right name, or fetch it again",
            )));
        }
        let described = options.dims.is_some() && options.scalar_type.is_some();
        if described || raw::names_raw(&name) {
            return raw::load(input, &name, looks_like, options);
        }
        Err(VolumeError::UnknownFormat(Trouble::new(
            format!("this is no volume format that is read here; it looks like {looks_like}"),
            "convert it to NRRD or MetaImage, or name raw voxels name_XxYxZ_type.raw or give their dimensions \
             and type",
        )))
    }
}

/// What a file looks like by its first bytes, for messages.
fn sniff(head: &[u8]) -> &'static str {
    const MAGIC: [(&[u8], &str); 17] = [
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
