//! The temporary file or folder beside the target, and voxel bytes into it.

use std::fs::{self, File};
use std::io::{self, BufWriter, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use flate2::write::{GzEncoder, ZlibEncoder};
use tempfile::{Builder, NamedTempFile, TempDir};
use volgraph_volume::edit::Watch;
use volgraph_volume::{Element, Trouble, Volume, VolumeError, for_voxels};

use super::{WriteOptions, Written};

/// Bytes between two looks at the watch.
const BLOCK: usize = 1 << 22;

pub(crate) fn failed(error: &io::Error) -> VolumeError {
    VolumeError::Write(Trouble::new(
        format!("cannot be written: {error}"),
        "check that the folder is there, that it may be written, and that the disk has space",
    ))
}

/// Refuses a target that is there and must stay.
pub(crate) fn check(path: &Path, folder: bool, options: &WriteOptions) -> Result<(), VolumeError> {
    let refuse = |cause: &str, remedy: &str| {
        Err(VolumeError::Write(Trouble::new(cause, remedy)).in_file(path))
    };
    let Ok(there) = fs::symlink_metadata(path) else {
        return Ok(());
    };
    if !options.overwrite {
        return refuse(
            "is there already",
            "give another name, or overwrite it (--force)",
        );
    }
    if folder != there.is_dir() {
        let (cause, remedy) = if there.is_dir() {
            ("is a folder", "give the name of a file")
        } else {
            (
                "is a file, and a folder is to be written",
                "give the name of a folder",
            )
        };
        return refuse(cause, remedy);
    }
    // A folder is replaced as a whole: only one of the same kind may go.
    if folder && !crate::zarr::is_zarr(path) {
        return refuse(
            "is a folder, and no Zarr one",
            "give another name, or remove the folder by hand",
        );
    }
    Ok(())
}

fn folder_of(path: &Path) -> &Path {
    let parent = path.parent().unwrap_or(Path::new(""));
    if parent.as_os_str().is_empty() {
        Path::new(".")
    } else {
        parent
    }
}

/// The name of what is being written: hidden, so that no one takes it for a volume.
fn builder() -> Builder<'static, 'static> {
    let mut builder = Builder::new();
    builder.prefix(".volgraph-").suffix(".part");
    builder
}

/// A file under a name of its own until it is whole.
pub(super) struct TempFile {
    file: BufWriter<NamedTempFile>,
    path: PathBuf,
}

impl TempFile {
    pub fn beside(path: &Path) -> Result<Self, VolumeError> {
        let mut builder = builder();
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt as _;
            // As any new file: the umask takes away what it must.
            builder.permissions(fs::Permissions::from_mode(0o666));
        }
        let file = builder
            .tempfile_in(folder_of(path))
            .map_err(|error| failed(&error))?;
        Ok(Self {
            file: BufWriter::with_capacity(1 << 16, file),
            path: path.to_path_buf(),
        })
    }

    pub fn put(&mut self, bytes: &[u8]) -> Result<(), VolumeError> {
        self.file.write_all(bytes).map_err(|error| failed(&error))
    }

    /// Writes over what is at `at`.
    pub fn put_at(&mut self, at: u64, bytes: &[u8]) -> Result<(), VolumeError> {
        let mut seek = || {
            self.file.seek(SeekFrom::Start(at))?;
            self.file.write_all(bytes)?;
            self.file.seek(SeekFrom::End(0))
        };
        seek().map(|_| ()).map_err(|error| failed(&error))
    }

    pub fn len(&mut self) -> Result<u64, VolumeError> {
        self.file.stream_position().map_err(|error| failed(&error))
    }

    /// All voxels, or colours, packed as asked for.
    pub fn put_voxels(
        &mut self,
        source: &Source<'_>,
        packing: Packing,
        watch: &Watch,
    ) -> Result<(), VolumeError> {
        let packed = match packing {
            Packing::None => source.write(&mut self.file, watch)?,
            Packing::Gzip(level) => {
                let mut out = GzEncoder::new(&mut self.file, flate2::Compression::new(level));
                source
                    .write(&mut out, watch)?
                    .and_then(|()| out.finish().map(|_| ()))
            }
            Packing::Zlib(level) => {
                let mut out = ZlibEncoder::new(&mut self.file, flate2::Compression::new(level));
                source
                    .write(&mut out, watch)?
                    .and_then(|()| out.finish().map(|_| ()))
            }
        };
        packed.map_err(|error| failed(&error))
    }

    /// A head and all voxels in one gzip stream.
    pub fn put_packed(
        &mut self,
        head: &[u8],
        source: &Source<'_>,
        level: u32,
        watch: &Watch,
    ) -> Result<(), VolumeError> {
        let mut out = GzEncoder::new(&mut self.file, flate2::Compression::new(level));
        out.write_all(head).map_err(|error| failed(&error))?;
        source
            .write(&mut out, watch)?
            .map_err(|error| failed(&error))?;
        out.finish().map(|_| ()).map_err(|error| failed(&error))
    }

    /// Gives the file its name; it replaces what has it only where that was asked for.
    pub fn finish(self, options: &WriteOptions, written: &mut Written) -> Result<(), VolumeError> {
        let file = self
            .file
            .into_inner()
            .map_err(|error| failed(error.error()))?;
        options.watch.check()?;
        let kept = || -> io::Result<u64> {
            file.as_file().sync_data()?;
            Ok(file.as_file().metadata()?.len())
        };
        let bytes = kept().map_err(|error| failed(&error))?;
        let named = if options.overwrite {
            file.persist(&self.path)
        } else {
            file.persist_noclobber(&self.path)
        };
        named.map_err(|error| failed(&error.error).in_file(&self.path))?;
        written.bytes += bytes;
        written.files.push(self.path);
        Ok(())
    }
}

/// How a stream of voxels is packed.
#[derive(Clone, Copy)]
pub(super) enum Packing {
    None,
    Gzip(u32),
    Zlib(u32),
}

impl Packing {
    pub fn gzip(level: Option<u32>) -> Self {
        level.map_or(Self::None, Self::Gzip)
    }
}

/// Voxels or colours of a volume as bytes, little-endian.
pub(super) struct Source<'a> {
    volume: &'a Volume,
    /// Whether the colours are written.
    pub colors: bool,
}

impl<'a> Source<'a> {
    /// The colours where the volume has them.
    pub fn colored(volume: &'a Volume) -> Self {
        let colors = volume.colors().is_some();
        Self { volume, colors }
    }

    /// The scalars.
    pub fn scalars(volume: &'a Volume) -> Self {
        Self {
            volume,
            colors: false,
        }
    }

    fn write(&self, out: &mut impl Write, watch: &Watch) -> Result<io::Result<()>, VolumeError> {
        if let Some(colors) = self.volume.colors().filter(|_| self.colors) {
            return put_blocks(colors.as_flattened(), out, watch, |value| value);
        }
        for_voxels!(self.volume.voxels(), values => put_blocks(values, out, watch, Element::swapped))
    }
}

fn put_blocks<T: bytemuck::Pod>(
    values: &[T],
    out: &mut impl Write,
    watch: &Watch,
    swapped: impl Fn(T) -> T,
) -> Result<io::Result<()>, VolumeError> {
    let total = size_of_val(values) as u64;
    let mut done = 0;
    for block in values.chunks(BLOCK / size_of::<T>()) {
        watch.check()?;
        let put = if cfg!(target_endian = "little") {
            out.write_all(bytemuck::cast_slice(block))
        } else {
            let block: Vec<T> = block.iter().map(|&value| swapped(value)).collect();
            out.write_all(bytemuck::cast_slice(&block))
        };
        if let Err(error) = put {
            return Ok(Err(error));
        }
        done += size_of_val(block) as u64;
        watch.report(done, total);
    }
    Ok(Ok(()))
}

/// A folder under a name of its own until it is whole.
pub(crate) struct TempFolder {
    folder: TempDir,
    path: PathBuf,
}

impl TempFolder {
    pub fn beside(path: &Path) -> Result<Self, VolumeError> {
        let mut builder = builder();
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt as _;
            builder.permissions(fs::Permissions::from_mode(0o777));
        }
        let folder = builder
            .tempdir_in(folder_of(path))
            .map_err(|error| failed(&error))?;
        Ok(Self {
            folder,
            path: path.to_path_buf(),
        })
    }

    /// Where it is for now.
    pub fn path(&self) -> &Path {
        self.folder.path()
    }

    /// Writes a file of the folder, with the folders on the way to it.
    pub fn put(&self, name: &str, bytes: &[u8]) -> Result<(), VolumeError> {
        let path = self.folder.path().join(name);
        let put = || -> io::Result<()> {
            if let Some(parent) = path.parent() {
                fs::create_dir_all(parent)?;
            }
            File::create(&path)?.write_all(bytes)
        };
        put().map_err(|error| failed(&error))
    }

    /// Gives the folder its name. What had it goes aside first and is removed last, so that one of the two is
    /// always there.
    pub fn finish(self, options: &WriteOptions) -> Result<PathBuf, VolumeError> {
        options.watch.check()?;
        let aside = if options.overwrite && self.path.is_dir() {
            let aside = builder()
                .tempdir_in(folder_of(&self.path))
                .map_err(|error| failed(&error))?;
            fs::rename(&self.path, aside.path().join("old")).map_err(|error| failed(&error))?;
            Some(aside)
        } else {
            None
        };
        match fs::rename(self.folder.path(), &self.path) {
            Ok(()) => {
                // It has moved: there is nothing left to remove.
                let _ = self.folder.keep();
                Ok(self.path)
            }
            Err(error) => {
                if let Some(aside) = aside {
                    let _ = fs::rename(aside.path().join("old"), &self.path);
                }
                Err(failed(&error))
            }
        }
    }
}
