//! What a picture loses on each level of a volume in bricks: levels of a crop against the float64 reference of the same crop at
//! full resolution.
//!
//! A whole volume in bricks has no reference: it may be larger than memory. So a box is cut out of its finest level, gets a
//! pyramid of its own in a folder for the time being, and is drawn as the graph draws the volume, level by level, with the
//! camera in the same direction.

use std::path::Path;
use std::sync::Arc;

use glam::{DAffine3, DVec3};
use serde::Serialize;
use volgraph_formats::bricks::{BrickStore, BuildOptions, StoreOptions, build};
use volgraph_formats::{Compression, WriteOptions, write};
use volgraph_gpu::Gpu;
use volgraph_graph::{Camera, Pose, Projection, Source};
use volgraph_nodes::source::bricks::{BricksSource, Effort, Progressive};
use volgraph_nodes::source::volume::VolumeSource;
use volgraph_reference::Progress;
use volgraph_report::{Finding, Findings};
use volgraph_volume::{Grid, Volume, VolumeError};

use crate::scene::Scene;
use crate::session::{Session, SessionOptions};
use crate::truth::{Truth, TruthOptions, plan_without_device};

/// Voxels along each edge of the box that is cut out where nobody says which.
pub const DEFAULT_EDGE: u32 = 192;

/// What is lost on each level.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LevelErrors {
    /// The source.
    pub source: String,
    /// First voxel and voxels of the box along x, y and z.
    pub crop: [[u32; 3]; 2],
    /// Width and height of the pictures.
    pub size: [u32; 2],
    /// Finest first.
    pub levels: Vec<LevelError>,
}

/// What is lost on a level.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LevelError {
    /// Its number; 0 is the finest.
    pub level: usize,
    /// Samples along x, y and z in the box.
    pub dims: [u32; 3],
    /// Bricks of the box.
    pub bricks: u64,
    /// Root mean square error of its scalars, in data units.
    pub scalar_rms: f64,
    /// Root mean square error of its picture, linear premultiplied colours.
    pub rmse: f64,
    /// The largest error of its picture.
    pub max: f64,
    /// What the picture is made of, and the error that was estimated.
    pub about: String,
}

/// Measures all levels of the volume in bricks that a graph draws, in pictures of `options.size`, on a device.
///
/// # Errors
/// `no-bricks` where the graph draws none; what is wrong with the box or the graph, and what ended the reference.
pub fn measure(
    scene: &Scene,
    crop: Option<[[u32; 3]; 2]>,
    options: &SessionOptions,
    truth: &TruthOptions,
    gpu: &Arc<Gpu>,
    progress: &dyn Progress,
) -> Result<LevelErrors, Findings> {
    let named = scene.sources.iter().find_map(|(name, source)| {
        let bricks = source.as_any().downcast_ref::<BricksSource>()?;
        Some((name.clone(), bricks))
    });
    let Some((name, bricks)) = named else {
        return Err(
            Finding::error("no-bricks", "the graph draws no volume in bricks")
                .help("give it a source `bricks(path: \"…\")` of a volume with a pyramid (`volgraph pyramid`)")
                .into(),
        );
    };
    let store = &bricks.store;
    let grid = &store.levels()[0].grid;
    let crop = crop.unwrap_or_else(|| {
        let dims = grid.dims.map(|n| n.min(DEFAULT_EDGE));
        [[0, 1, 2].map(|i| (grid.dims[i] - dims[i]) / 2), dims]
    });
    let of_volume = |error: VolumeError| Findings::from(Finding::from(error));
    let voxels = store.read_region(0, crop[0], crop[1]).map_err(of_volume)?;
    let first = DVec3::from_array(crop[0].map(f64::from));
    let cut = Grid {
        dims: crop[1],
        world_from_index: grid.world_from_index * DAffine3::from_translation(first),
        node_centred: false,
    };
    let volume = Volume::new(store.name(), cut, voxels)
        .map_err(of_volume)?
        .with_about(store.about().clone());
    let folder = tempfile::tempdir().map_err(|error| {
        Finding::error("io", format!("no folder for the box can be made: {error}"))
            .help("make room where temporary files go (TMPDIR)")
    })?;
    let cropped = cropped(&volume, store.edge(), folder.path()).map_err(of_volume)?;
    let with = |source: Arc<dyn Source>| {
        let mut scene = scene.clone();
        scene.sources.insert(name.clone(), source);
        scene
    };
    let whole = with(Arc::new(VolumeSource::new(Arc::new(volume))));
    let camera = facing(&whole, &cut, options.size)?;
    let plan = plan_without_device(&whole, options.size)?;
    let view = volgraph_graph::View {
        camera,
        ..plan.view()
    };
    let truth = Truth::of(&plan, &view, truth, progress)?;
    let mut levels = Vec::new();
    for (level, known) in cropped.levels().iter().enumerate() {
        let effort = Effort {
            tolerance: 0.0,
            pixels: 0.0,
            finest: level,
            // Whatever the graph allows, the box is drawn whole.
            pool_bytes: u64::MAX,
        };
        let source = BricksSource::new(Arc::clone(&cropped), effort, Progressive::default());
        let mut session = Session::start(with(Arc::new(source)), Arc::clone(gpu), options)?;
        session.place_camera(camera);
        let (picture, report) = session.render()?;
        let comparison = truth.compare(&picture)?;
        levels.push(LevelError {
            level,
            dims: known.grid.dims,
            bricks: known.bricks.map(u64::from).iter().product(),
            scalar_rms: scalar_rms(&cropped, level),
            rmse: comparison.rmse,
            max: comparison.max.error,
            about: report
                .nodes
                .into_iter()
                .find_map(|node| node.about)
                .unwrap_or_default(),
        });
    }
    Ok(LevelErrors {
        source: name,
        crop,
        size: options.size,
        levels,
    })
}

/// The box with a pyramid of its own in a folder.
fn cropped(volume: &Volume, edge: u32, folder: &Path) -> Result<Arc<BrickStore>, VolumeError> {
    let file = folder.join("box.nrrd");
    let options = WriteOptions {
        compression: Some(Compression::None),
        ..WriteOptions::default()
    };
    write(volume, &file, &options)?;
    let options = BuildOptions {
        edge,
        ..BuildOptions::default()
    };
    let pyramid = folder.join("box.pyramid.zarr");
    build(&file, &pyramid, &options)?;
    let options = StoreOptions {
        pyramid: Some(pyramid),
        ..StoreOptions::default()
    };
    BrickStore::open(&file, &options).map(Arc::new)
}

/// Root mean square error of a level's scalars.
fn scalar_rms(store: &BrickStore, level: usize) -> f64 {
    let [x, y, z] = store.levels()[level].bricks;
    let all = (0..z).flat_map(|k| (0..y).flat_map(move |j| (0..x).map(move |i| [i, j, k])));
    let squares = all.filter_map(|at| Some(store.brick_info(level, at)?.rms_error.powi(2)));
    let (sum, count) = squares.fold((0.0, 0.0), |(sum, count), square| {
        (sum + square, count + 1.0)
    });
    f64::sqrt(sum / f64::max(count, 1.0))
}

/// The graph's camera, from the same side, before the box.
fn facing(scene: &Scene, grid: &Grid, size: [u32; 2]) -> Result<Camera, Findings> {
    let plan = plan_without_device(scene, size)?;
    let mut desc = plan.camera.clone();
    if let Pose::Orbit {
        target, distance, ..
    } = &mut desc.pose
    {
        (*target, *distance) = (None, None);
        return Ok(plan.fit(&desc));
    }
    let camera = plan.view().camera;
    let corners = grid.corners_world();
    let middle = corners.iter().sum::<DVec3>() / 8.0;
    let radius = corners[0].distance(middle);
    let (distance, projection) = match camera.projection {
        Projection::Perspective { fov_y } => {
            let half = (0.5 * fov_y).to_radians();
            (radius / half.sin(), camera.projection)
        }
        Projection::Orthographic { .. } => (
            2.0 * radius,
            Projection::Orthographic {
                height: Some(2.0 * radius),
            },
        ),
    };
    Ok(Camera {
        eye: middle - distance * camera.forward,
        projection,
        ..camera
    })
}
