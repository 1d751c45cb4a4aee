//! OME-Zarr 0.5 in a folder of Zarr v3: a pyramid of levels, each an array of chunks along z, y, x (after the
//! channels of colours).
//!
//! OME-Zarr knows scale and translation alone. Where a placement is more (oblique, mirrored) or samples lie on nodes,
//! the attribute `volgraph` of each array has it whole: our reader takes it, others see spacing and origin.
//! Source: <https://ngff.openmicroscopy.org/0.5/>.

use std::io::Write as _;
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};

use glam::{DMat3, DVec3};
use rayon::prelude::*;
use serde_json::{Value, json};
use volgraph_volume::edit::{Filter, Target, Watch, resample};
use volgraph_volume::{About, Grid, ScalarType, Trouble, Values, Volume, VolumeError, for_voxels};

use super::target::{TempFolder, failed};
use super::{Compression, WriteOptions, Written};

pub(super) fn write(
    volume: &Volume,
    path: &Path,
    options: &WriteOptions,
) -> Result<Written, VolumeError> {
    if options.chunk.contains(&0) || options.levels == 0 {
        return Err(VolumeError::Write(Trouble::new(
            "chunks without voxels, or no level",
            "give chunks of at least one voxel along each axis, and at least one level",
        )));
    }
    let folder = TempFolder::beside(path)?;
    let quiet = Watch {
        progress: None,
        interrupt: options.watch.interrupt.clone(),
    };
    let mut job = Job {
        folder: &folder,
        options,
        compression: options.compression.unwrap_or(Compression::Zstd(3)),
        colors: volume.colors().is_some(),
        done: AtomicU64::new(0),
        total: 0,
        bytes: AtomicU64::new(0),
    };
    let dims = levels(volume.grid(), options);
    let each = if job.colors {
        4
    } else {
        volume.voxels().scalar_type().size() as u64
    };
    job.total = dims
        .iter()
        .map(|dims| each * dims.iter().map(|&n| u64::from(n)).product::<u64>())
        .sum();
    let filter = Filter::for_values(&volume.about().values);
    let mut grids = Vec::new();
    let mut level: Option<Volume> = None;
    for (number, &dims) in dims.iter().enumerate() {
        if number > 0 {
            let finer = level.as_ref().unwrap_or(volume);
            level = Some(resample(finer, Target::Dims(dims), filter, &quiet)?);
        }
        let level = level.as_ref().unwrap_or(volume);
        job.write_level(number, level)?;
        grids.push(*level.grid());
    }
    let (name, about) = (volume.name(), volume.about());
    let group = group(name, about, 0, &grids, job.colors, filter);
    job.put("zarr.json", &pretty(&group))?;
    let bytes = job.bytes.into_inner();
    let mut warnings = Vec::new();
    if !is_plain(volume.grid()) {
        warnings.push(
            "OME-Zarr has spacing and origin alone: directions and centring are in an attribute that volgraph reads"
                .to_owned(),
        );
    }
    Ok(Written {
        files: vec![folder.finish(options)?],
        bytes,
        warnings,
    })
}

/// Dimensions of the levels, finest first.
fn levels(grid: &Grid, options: &WriteOptions) -> Vec<[u32; 3]> {
    let mut dims = vec![grid.dims];
    let mut last = grid.dims;
    while (dims.len() as u64) < u64::from(options.levels)
        && last.iter().zip(options.chunk).any(|(&n, chunk)| n > chunk)
    {
        last = last.map(|n| n.div_ceil(2));
        dims.push(last);
    }
    dims
}

/// Whether scale and translation say all of a placement.
fn is_plain(grid: &Grid) -> bool {
    let matrix = grid.world_from_index.matrix3;
    let diagonal = DVec3::new(matrix.x_axis.x, matrix.y_axis.y, matrix.z_axis.z);
    matrix == DMat3::from_diagonal(diagonal) && diagonal.min_element() > 0.0 && !grid.node_centred
}

pub(crate) fn pretty(value: &Value) -> Vec<u8> {
    format!("{value:#}").into_bytes()
}

/// The group's metadata; its finest level has the number `first`.
pub(crate) fn group(
    name: &str,
    about: &About,
    first: usize,
    grids: &[Grid],
    colors: bool,
    filter: Filter,
) -> Value {
    let unit = about.length_unit.as_deref().and_then(long_unit);
    let axis = |name: &str| match unit {
        Some(unit) => json!({"name": name, "type": "space", "unit": unit}),
        None => json!({"name": name, "type": "space"}),
    };
    let mut axes = vec![axis("z"), axis("y"), axis("x")];
    if colors {
        axes.insert(0, json!({"name": "c", "type": "channel"}));
    }
    let vector = |v: DVec3, channel: f64| {
        let mut numbers = vec![v.z, v.y, v.x];
        if colors {
            numbers.insert(0, channel);
        }
        numbers
    };
    let datasets: Vec<Value> = grids
        .iter()
        .enumerate()
        .map(|(level, grid)| {
            json!({"path": (first + level).to_string(), "coordinateTransformations": [
                {"type": "scale", "scale": vector(grid.spacing(), 1.0)},
                {"type": "translation", "translation": vector(grid.origin(), 0.0)},
            ]})
        })
        .collect();
    let method = match filter {
        Filter::Mode => "mode",
        _ => "mean of the linear field",
    };
    let mut ome = json!({
        "version": "0.5",
        "multiscales": [{"name": name, "axes": axes, "datasets": datasets, "type": method}],
    });
    if colors {
        let channel = |label: &str, color: &str| {
            json!({"label": label, "color": color, "active": true,
                   "window": {"min": 0, "max": 255, "start": 0, "end": 255}})
        };
        ome["omero"] = json!({"channels": [
            channel("red", "FF0000"), channel("green", "00FF00"), channel("blue", "0000FF"), channel("alpha", "FFFFFF"),
        ]});
        ome["volgraph"] = json!({"colors": "rgba"});
    }
    if let Values::Labels(names) = &about.values {
        let properties: Vec<Value> = names
            .iter()
            .map(|(label, name)| json!({"label-value": label, "name": name}))
            .collect();
        ome["image-label"] = json!({"version": "0.5", "properties": properties});
    }
    json!({"zarr_format": 3, "node_type": "group", "attributes": {"ome": ome}})
}

/// The name of a unit in full, as UDUNITS-2 and the format want it.
fn long_unit(unit: &str) -> Option<&str> {
    Some(match unit {
        "Å" => "angstrom",
        "nm" => "nanometer",
        "µm" | "μm" | "um" => "micrometer",
        "mm" => "millimeter",
        "cm" => "centimeter",
        "m" => "meter",
        "km" => "kilometer",
        other if other.len() > 2 => other,
        _ => return None,
    })
}

struct Job<'a> {
    folder: &'a TempFolder,
    options: &'a WriteOptions,
    compression: Compression,
    colors: bool,
    done: AtomicU64,
    total: u64,
    bytes: AtomicU64,
}

impl Job<'_> {
    fn put(&self, name: &str, bytes: &[u8]) -> Result<(), VolumeError> {
        self.bytes.fetch_add(bytes.len() as u64, Ordering::Relaxed);
        self.folder.put(name, bytes)
    }

    #[expect(
        clippy::redundant_closure_for_method_calls,
        reason = "the method is another one for each type"
    )]
    fn write_level(&self, number: usize, level: &Volume) -> Result<(), VolumeError> {
        self.put(&format!("{number}/zarr.json"), &pretty(&self.array(level)))?;
        let dims = level.grid().dims;
        let chunk = self.chunk(dims);
        let counts = [0, 1, 2].map(|axis| dims[axis].div_ceil(chunk[axis]) as usize);
        let [cx, cy, cz] = counts;
        let channels = if self.colors { 4 } else { 1 };
        (0..cx * cy * cz * channels)
            .into_par_iter()
            .try_for_each(|i| {
                self.options.watch.check()?;
                let at = [i % cx, i / cx % cy, i / (cx * cy) % cz];
                let channel = i / (cx * cy * cz);
                let low = [0, 1, 2].map(|axis| at[axis] * chunk[axis] as usize);
                let size = chunk.map(|n| n as usize);
                let dims = dims.map(|n| n as usize);
                let (bytes, inside) = match level.colors() {
                    Some(colors) => cut(colors, dims, low, size, |color| [color[channel]]),
                    None => for_voxels!(level.voxels(), values => {
                        cut(values, dims, low, size, |value| value.to_le_bytes())
                    }),
                };
                let [x, y, z] = at;
                let name = if self.colors {
                    format!("{number}/c/{channel}/{z}/{y}/{x}")
                } else {
                    format!("{number}/c/{z}/{y}/{x}")
                };
                self.put(&name, &pack(&bytes, self.compression)?)?;
                let done = self.done.fetch_add(inside, Ordering::Relaxed) + inside;
                self.options.watch.report(done, self.total);
                Ok(())
            })
    }

    /// No chunk is larger than its array: the rest would be nothing.
    fn chunk(&self, dims: [u32; 3]) -> [u32; 3] {
        [0, 1, 2].map(|axis| self.options.chunk[axis].min(dims[axis]))
    }

    fn array(&self, level: &Volume) -> Value {
        let ty = if self.colors {
            ScalarType::U8
        } else {
            level.voxels().scalar_type()
        };
        let array = Array {
            grid: *level.grid(),
            scalar_type: ty,
            chunk: self.chunk(level.grid().dims),
            shard: None,
            compression: self.compression,
            colors: self.colors,
        };
        array.metadata()
    }
}

/// What an array's metadata is made of.
pub(crate) struct Array {
    pub grid: Grid,
    pub scalar_type: ScalarType,
    /// Voxels of a chunk along x, y and z.
    pub chunk: [u32; 3],
    /// Voxels of a shard, which are whole chunks; `None` where each chunk is a file.
    pub shard: Option<[u32; 3]>,
    pub compression: Compression,
    /// Whether a slower axis has four channels.
    pub colors: bool,
}

impl Array {
    /// The array's `zarr.json`.
    pub fn metadata(&self) -> Value {
        let (grid, ty) = (&self.grid, self.scalar_type);
        let shape = |[x, y, z]: [u32; 3], channels: u32| {
            if self.colors {
                vec![channels, z, y, x]
            } else {
                vec![z, y, x]
            }
        };
        let bytes = if ty.size() == 1 {
            json!({"name": "bytes"})
        } else {
            json!({"name": "bytes", "configuration": {"endian": "little"}})
        };
        let mut codecs = vec![bytes];
        match self.compression {
            Compression::None => {}
            Compression::Gzip(level) => {
                codecs.push(json!({"name": "gzip", "configuration": {"level": level}}));
            }
            Compression::Zstd(level) => {
                codecs.push(
                    json!({"name": "zstd", "configuration": {"level": level, "checksum": false}}),
                );
            }
        }
        if self.shard.is_some() {
            codecs = vec![json!({"name": "sharding_indexed", "configuration": {
                "chunk_shape": shape(self.chunk, 1),
                "codecs": codecs,
                "index_codecs": [
                    {"name": "bytes", "configuration": {"endian": "little"}}, {"name": "crc32c"},
                ],
                "index_location": "end",
            }})];
        }
        let outer = self.shard.unwrap_or(self.chunk);
        let fill = if ty.is_float() { json!(0.0) } else { json!(0) };
        let names = if self.colors {
            json!(["c", "z", "y", "x"])
        } else {
            json!(["z", "y", "x"])
        };
        let attributes = if is_plain(grid) {
            json!({})
        } else {
            json!({"volgraph": {
                "world_from_index": grid.world_from_index.to_cols_array(),
                "node_centred": grid.node_centred,
            }})
        };
        json!({
            "zarr_format": 3,
            "node_type": "array",
            "shape": shape(grid.dims, 4),
            "data_type": ty.name(),
            "chunk_grid": {"name": "regular", "configuration": {"chunk_shape": shape(outer, 1)}},
            "chunk_key_encoding": {"name": "default", "configuration": {"separator": "/"}},
            "fill_value": fill,
            "codecs": codecs,
            "dimension_names": names,
            "attributes": attributes,
        })
    }
}

/// A chunk's bytes as they are stored.
pub(crate) fn pack(bytes: &[u8], compression: Compression) -> Result<Vec<u8>, VolumeError> {
    let packed = match compression {
        Compression::None => Ok(bytes.to_vec()),
        Compression::Gzip(level) => {
            let level = flate2::Compression::new(level);
            let mut out = flate2::write::GzEncoder::new(Vec::new(), level);
            out.write_all(bytes).and_then(|()| out.finish())
        }
        Compression::Zstd(level) => zstd::bulk::compress(bytes, level),
    };
    packed.map_err(|error| failed(&error))
}

/// The bytes of a chunk, zeros where it reaches out of the volume, and how many of them are inside.
pub(crate) fn cut<T: Copy, const N: usize>(
    values: &[T],
    [nx, ny, nz]: [usize; 3],
    [x, y, z]: [usize; 3],
    [sx, sy, sz]: [usize; 3],
    bytes_of: impl Fn(T) -> [u8; N],
) -> (Vec<u8>, u64) {
    let mut out = vec![0; sx * sy * sz * N];
    let width = sx.min(nx - x);
    let mut inside = 0;
    for k in 0..sz.min(nz - z) {
        for j in 0..sy.min(ny - y) {
            let from = ((z + k) * ny + y + j) * nx + x;
            let to = (k * sy + j) * sx * N;
            let row = out[to..to + width * N].chunks_exact_mut(N);
            for (out, &value) in row.zip(&values[from..from + width]) {
                out.copy_from_slice(&bytes_of(value));
            }
            inside += (width * N) as u64;
        }
    }
    (out, inside)
}
