//! `bricks(path: "head_2048x2048x1024_uint8.raw")`: a volume that may be larger than memory, with its pyramid of levels.
//!
//! What a picture needs of it is read into a pool on the device, brick by brick (see [`crate::brick_pool`]). The pyramid is
//! built once, by `volgraph pyramid`.

use std::any::Any;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, OnceLock};

use glam::DVec3;
use volgraph_formats::bricks::{BrickStore, StoreOptions};
use volgraph_graph::fingerprint::Hasher;
use volgraph_graph::{Digest, Folders, PortType, Progress, Source, SourceKind};
use volgraph_report::{Finding, Findings};
use volgraph_shader::{ParamSpec, ParamValue};
use volgraph_volume::{Volume, VolumeError};

use super::Given;
use crate::brick_pool::Streams;
use crate::encoding::Scalars;

/// Whether pictures of volumes in bricks are to come at once and get better from frame to frame, rather than to be whole at
/// once. Clones share it.
#[derive(Clone, Debug, Default)]
pub struct Progressive(Arc<AtomicBool>);

impl Progressive {
    /// Says so, from now on.
    pub fn set(&self, is_progressive: bool) {
        self.0.store(is_progressive, Ordering::Relaxed);
    }

    /// Whether they are.
    #[must_use]
    pub fn get(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// The source kind `bricks`.
#[derive(Debug, Default)]
pub struct BricksKind {
    /// How its volumes are drawn.
    pub progressive: Progressive,
}

/// How much of a volume in bricks is read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effort {
    /// Bricks are read from finer levels until each adds less than that to a pixel's error, by estimate; 0 for all that
    /// pixels can show.
    pub tolerance: f64,
    /// And as long as their voxels are larger than so many pixels; 0 where pixels do not count.
    pub pixels: f64,
    /// The finest level that is read.
    pub finest: usize,
    /// Most bytes of the pool on the device.
    pub pool_bytes: u64,
}

/// An overview has at most so many voxels.
const OVERVIEW_VOXELS: u64 = 1 << 24;

/// A volume in bricks.
#[derive(Debug)]
pub struct BricksSource {
    /// Where its bricks are read from.
    pub store: Arc<BrickStore>,
    /// How much of it is read.
    pub effort: Effort,
    /// Whether pictures get better from frame to frame.
    pub progressive: Progressive,
    digest: Digest,
    pub(crate) streams: Mutex<Streams>,
    overview: OnceLock<Option<Arc<Volume>>>,
}

/// The finest level of at most 2^24 voxels, whole in memory: what picks a look for the volume, or shows it in planes.
///
/// # Errors
/// What is wrong with its file.
pub fn overview(store: &BrickStore) -> Result<Volume, VolumeError> {
    let levels = store.levels();
    let voxels = |dims: [u32; 3]| {
        let sides = dims.map(u64::from);
        sides.iter().fold(1, |n: u64, side| n.saturating_mul(*side))
    };
    let small = |dims: [u32; 3]| voxels(dims) <= OVERVIEW_VOXELS;
    let level = levels.iter().position(|level| small(level.grid.dims));
    let level = level.unwrap_or(levels.len() - 1);
    let grid = levels[level].grid;
    let voxels = store.read_region(level, [0; 3], grid.dims)?;
    Ok(Volume::new(store.name(), grid, voxels)?.with_about(store.about().clone()))
}

impl BricksSource {
    /// A volume in bricks as a source.
    #[must_use]
    pub fn new(store: Arc<BrickStore>, effort: Effort, progressive: Progressive) -> Self {
        let mut hasher = Hasher::new();
        hasher.part(&store.digest());
        hasher.part(format!("{effort:?} {:?}", store.levels()[0].grid).as_bytes());
        Self {
            store,
            effort,
            progressive,
            digest: hasher.finish(),
            streams: Mutex::default(),
            overview: OnceLock::new(),
        }
    }

    /// Its [`overview`], read once; `None` where its file cannot be read any more.
    #[must_use]
    pub fn overview(&self) -> Option<&Arc<Volume>> {
        let read = || overview(&self.store).ok().map(Arc::new);
        self.overview.get_or_init(read).as_ref()
    }

    /// What is known of its scalars.
    #[must_use]
    pub fn scalars(&self) -> Scalars {
        Scalars {
            ty: self.store.scalar_type(),
            range: self.store.statistics().range(),
        }
    }
}

impl SourceKind for BricksKind {
    fn name(&self) -> &'static str {
        "bricks"
    }

    fn doc(&self) -> &'static str {
        "A volume that may be larger than memory, read in bricks of the levels that a picture needs; `volgraph pyramid` builds them."
    }

    fn ty(&self) -> PortType {
        PortType::Volume
    }

    fn params(&self) -> Vec<ParamSpec> {
        let mut params = super::volume_file_params();
        params.extend([
            ParamSpec::text(
                "pyramid",
                "",
                "The folder with the levels, where it is not beside the file.",
            ),
            ParamSpec::float(
                "tolerance",
                0.002,
                "Bricks are read from finer levels until each adds less than that to a pixel's error, by estimate; 0 for all that pixels can show.",
            )
            .range(0.0, 1.0),
            ParamSpec::float(
                "pixels",
                1.0,
                "Finer levels are read as long as voxels are larger than so many pixels; 0 for any size.",
            )
            .range(0.0, 64.0),
            ParamSpec::int("finest", 0, "The finest level that is read; 0 is the file's own.")
                .range(0.0, 31.0),
            ParamSpec::int("pool_mib", 256, "Most memory for bricks on the device, in MiB.")
                .range(1.0, 65_536.0),
            ParamSpec::int(
                "cache_mib",
                128,
                "Most memory for unpacked chunks of Zarr on the host, in MiB.",
            )
            .range(0.0, 65_536.0),
        ]);
        params
    }

    fn load(
        &self,
        params: &BTreeMap<String, ParamValue>,
        folders: &Folders,
        progress: Progress<'_>,
    ) -> Result<Arc<dyn Source>, Findings> {
        let given = Given(params);
        let (path, load) = given.volume_file(folders)?;
        let pyramid = given.text("pyramid").filter(|path| !path.is_empty());
        let options = StoreOptions {
            load,
            pyramid: pyramid.map(|path| folders.find(path)),
            cache_bytes: u64::from(given.uint("cache_mib").unwrap_or(128)) << 20,
            ..StoreOptions::default()
        };
        let store = BrickStore::open(&path, &options)
            .map_err(|error| Findings::from(Finding::from(error)))?;
        let number = |name: &str, default: f64| match params.get(name) {
            Some(ParamValue::Float(value)) => *value,
            #[expect(clippy::cast_precision_loss, reason = "small whole numbers")]
            Some(ParamValue::Int(value)) => *value as f64,
            _ => default,
        };
        let effort = Effort {
            tolerance: number("tolerance", 0.002),
            pixels: number("pixels", 1.0),
            finest: (given.uint("finest").unwrap_or(0) as usize).min(store.levels().len() - 1),
            pool_bytes: u64::from(given.uint("pool_mib").unwrap_or(256)) << 20,
        };
        progress(1, 1);
        let progressive = self.progressive.clone();
        Ok(Arc::new(BricksSource::new(
            Arc::new(store),
            effort,
            progressive,
        )))
    }
}

impl Source for BricksSource {
    fn ty(&self) -> PortType {
        PortType::Volume
    }

    fn digest(&self) -> Digest {
        self.digest
    }

    fn summary(&self) -> String {
        let levels = self.store.levels();
        let grid = &levels[0].grid;
        let [x, y, z] = grid.dims;
        let spacing = grid.spacing();
        format!(
            "{} {x}x{y}x{z} {}, spacing {} {} {}, {} levels in bricks of {}",
            self.store.name(),
            self.store.scalar_type().name(),
            spacing.x,
            spacing.y,
            spacing.z,
            levels.len(),
            self.store.edge()
        )
    }

    fn files(&self) -> Vec<PathBuf> {
        self.store.paths().map(PathBuf::from).to_vec()
    }

    fn corners(&self) -> Vec<DVec3> {
        self.store.levels()[0].grid.corners_world().to_vec()
    }

    fn warnings(&self) -> Vec<String> {
        let statistics = self.store.statistics();
        let mut warnings = Vec::new();
        if statistics.nan_count > 0 {
            warnings.push(format!(
                "{} voxels are not numbers; they are read as the smallest value",
                statistics.nan_count
            ));
        }
        warnings
    }

    fn as_any(&self) -> &dyn Any {
        self
    }
}
