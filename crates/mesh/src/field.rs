//! A volume of signed distances around a mesh.
//!
//! The grid: cubic voxels, cell-centred, the mesh in the middle with whole voxels of margin around its bounds. Rows are
//! filled in parallel, each run of them by one walker that knows the nearest triangle of the voxel before.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use glam::DVec3;
use rayon::prelude::*;
use volgraph_volume::{About, DEFAULT_MAX_BYTES, Grid, Trouble, Values, Volume, Voxels};

use crate::signed::{Sign, SignedDistance};
use crate::{Mesh, MeshError, Up};

/// Called while a field is computed, with the voxels that are done and all of them; from several threads.
pub type Progress = Arc<dyn Fn(u64, u64) + Send + Sync>;

/// How fine the grid is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Resolution {
    /// So many voxels along the mesh's longest axis, margin included; as many as it takes along the others.
    LongestAxis(u32),
    /// Exactly these; the voxels are as small as the mesh with its margin allows.
    Dims([u32; 3]),
    /// The edge of a voxel in mesh units.
    VoxelSize(f64),
}

/// What the user says about a distance field.
#[derive(Clone)]
pub struct FieldOptions {
    /// How fine the grid is; 128 voxels along the longest axis by default.
    pub resolution: Resolution,
    /// Voxels between the mesh's bounds and each face of the grid; 3 by default.
    pub margin: u32,
    /// Distances beyond so many voxels are clamped to it (which is faster); `None` keeps all of them.
    pub band: Option<f64>,
    /// How inside and outside are told apart.
    pub sign: Sign,
    /// Whether distances inside are positive and those outside negative, so that the solid is where the field is high, as
    /// volgraph's techniques and clips take it; else the other way round, as most programs write distance fields.
    pub positive_inside: bool,
    /// Which axis of the mesh points up.
    pub up: Up,
    /// Most bytes of voxels; [`DEFAULT_MAX_BYTES`] where `None`.
    pub max_bytes: Option<u64>,
    /// Called while the field is computed.
    pub progress: Option<Progress>,
    /// Set from elsewhere to stop; the field is then refused with [`MeshError::Cancelled`].
    pub cancel: Option<Arc<AtomicBool>>,
}

impl Default for FieldOptions {
    fn default() -> Self {
        Self {
            resolution: Resolution::LongestAxis(128),
            margin: 3,
            band: None,
            sign: Sign::Auto,
            positive_inside: false,
            up: Up::Z,
            max_bytes: None,
            progress: None,
            cancel: None,
        }
    }
}

/// Voxels between two looks at the cancel flag, at least a row.
const RUN: usize = 4096;

/// Computes the signed distance to a mesh at the centre of each voxel: float32, in mesh units, negative inside unless
/// [`FieldOptions::positive_inside`].
///
/// # Errors
/// [`MeshError::Option`] where the resolution leaves no room for the mesh or the band is not positive,
/// [`MeshError::TooLarge`] beyond `max_bytes`, [`MeshError::BadValue`] for a mesh of an absurd size,
/// [`MeshError::Cancelled`] where the flag was set. All name the mesh's file where there is one.
pub fn distance_field(mesh: &Mesh, options: &FieldOptions) -> Result<Volume, MeshError> {
    compute(mesh, options).map_err(|error| match mesh.source_files().first() {
        Some(file) => error.in_file(file),
        None => error,
    })
}

fn compute(mesh: &Mesh, options: &FieldOptions) -> Result<Volume, MeshError> {
    let turned;
    let mesh = if options.up == Up::Z {
        mesh
    } else {
        turned = mesh.clone().turned(options.up);
        &turned
    };
    let grid = grid(mesh.bounds(), options)?;
    if let Some(band) = options
        .band
        .filter(|band| !(band.is_finite() && *band > 0.0))
    {
        return Err(MeshError::Option(Trouble::new(
            format!("a narrow band of {band} voxels was asked for"),
            "give a positive number of voxels, or leave the band out",
        )));
    }
    let voxel = grid.min_spacing();
    let count = grid.voxel_count() as usize;
    let mut values: Vec<f32> = Vec::new();
    values.try_reserve_exact(count).map_err(|_| {
        MeshError::TooLarge(Trouble::new(
            format!("memory does not hold a field of {count} voxels"),
            "free memory, or use a coarser resolution",
        ))
    })?;
    values.resize(count, 0.0);

    let distance = SignedDistance::new(mesh, options.sign)?;
    let band = options.band.map_or(f64::INFINITY, |band| band * voxel);
    fill(&mut values, &grid, &distance, band, options)?;
    if options.positive_inside {
        values.par_iter_mut().for_each(|value| *value = -*value);
    }

    let mut warnings = mesh.warnings().to_vec();
    warnings.extend_from_slice(distance.warnings());
    let volume = Volume::new(mesh.name(), grid, Voxels::F32(values))?;
    Ok(volume
        .with_about(about(mesh, &distance, options))
        .with_sources(mesh.source_files().to_vec(), warnings))
}

fn fill(
    values: &mut [f32],
    grid: &Grid,
    distance: &SignedDistance,
    band: f64,
    options: &FieldOptions,
) -> Result<(), MeshError> {
    let [nx, ny, _] = grid.dims.map(|n| n as usize);
    let total = values.len() as u64;
    let done = AtomicU64::new(0);
    let run = RUN.div_ceil(nx) * nx;
    values
        .par_chunks_mut(run)
        .enumerate()
        .try_for_each(|(i, chunk)| {
            let stop = |flag: &Arc<AtomicBool>| flag.load(Ordering::Relaxed);
            if options.cancel.as_ref().is_some_and(stop) {
                return Err(MeshError::Cancelled(Trouble::new(
                    "the distance field was cancelled",
                    "start it again",
                )));
            }
            let mut walker = distance.walker();
            for (row, values) in (i * run / nx..).zip(chunk.chunks_mut(nx)) {
                let (y, z) = ((row % ny) as f64, (row / ny) as f64);
                // There and back: each point is near the one before.
                let mut set = |x: usize, value: &mut f32| {
                    let index = DVec3::new(x as f64, y, z);
                    let point = grid.world_from_index.transform_point3(index);
                    *value = walker.within(point, band) as f32;
                };
                if row % 2 == 0 {
                    (0..).zip(values).for_each(|(x, value)| set(x, value));
                } else {
                    let back = values.iter_mut().enumerate().rev();
                    back.for_each(|(x, value)| set(x, value));
                }
            }
            if let Some(progress) = &options.progress {
                let here = chunk.len() as u64;
                progress(done.fetch_add(here, Ordering::Relaxed) + here, total);
            }
            Ok(())
        })
}

fn grid((lo, hi): (DVec3, DVec3), options: &FieldOptions) -> Result<Grid, MeshError> {
    let refuse = |cause: String, remedy: &str| Err(MeshError::Option(Trouble::new(cause, remedy)));
    let extent = hi - lo;
    let margins = u64::from(options.margin) * 2;
    let room = |n: u32| u64::from(n).checked_sub(margins).filter(|&n| n > 0);
    let no_room = |n: u32| {
        refuse(
            format!(
                "{n} voxels leave no room for the mesh between margins of {} voxels",
                options.margin
            ),
            "give more voxels or a smaller margin",
        )
    };
    let voxel = match options.resolution {
        Resolution::LongestAxis(n) => match room(n) {
            Some(room) => extent.max_element() / room as f64,
            None => return no_room(n),
        },
        Resolution::Dims(dims) => {
            let mut voxel = 0.0_f64;
            for (n, extent) in dims.into_iter().zip(extent.to_array()) {
                match room(n) {
                    Some(room) => voxel = voxel.max(extent / room as f64),
                    None => return no_room(n),
                }
            }
            voxel
        }
        Resolution::VoxelSize(size) => size,
    };
    if !(voxel.is_finite() && voxel > 0.0) {
        return refuse(
            format!("voxels of size {voxel} were asked for, for a mesh that spans {extent}"),
            "give a positive size in the mesh's unit",
        );
    }
    let voxels = match options.resolution {
        Resolution::Dims(dims) => DVec3::from_array(dims.map(f64::from)),
        // A rounding error must not add a voxel.
        _ => (extent / voxel - 1e-9).ceil().max(DVec3::ONE) + margins as f64,
    };
    let max_bytes = options.max_bytes.unwrap_or(DEFAULT_MAX_BYTES);
    let bytes = voxels.element_product() * size_of::<f32>() as f64;
    // A flat grid within the limit may still have an axis beyond u32.
    let fits = bytes <= max_bytes as f64 && voxels.max_element() < f64::from(u32::MAX);
    if !fits {
        return Err(MeshError::TooLarge(Trouble::new(
            format!(
                "a field of {voxels} voxels takes {bytes} bytes, and the limit is {max_bytes} bytes"
            ),
            "use a coarser resolution, or raise the limit (max_bytes)",
        )));
    }
    let dims = voxels.to_array().map(|n| n as u32);
    let last = DVec3::from_array(dims.map(|n| f64::from(n) - 1.0));
    let origin = lo.midpoint(hi) - last * (voxel / 2.0);
    let grid = Grid::axis_aligned(dims, DVec3::splat(voxel), origin);
    grid.check()?;
    Ok(grid)
}

fn about(mesh: &Mesh, distance: &SignedDistance, options: &FieldOptions) -> About {
    let report = distance.report();
    let yes = |yes: bool| if yes { "yes" } else { "no" }.to_owned();
    let mut facts = vec![
        ("mesh".to_owned(), mesh.format().to_owned()),
        ("triangles".to_owned(), report.triangles.to_string()),
        ("watertight".to_owned(), yes(report.is_watertight())),
        ("sign".to_owned(), distance.method().to_string()),
    ];
    if let Some(band) = options.band {
        facts.push(("narrow band".to_owned(), format!("{band} voxels")));
    }
    facts.retain(|(_, fact)| !fact.is_empty());
    About {
        values: Values::Named("signed distance".to_owned()),
        facts,
        ..About::default()
    }
}
