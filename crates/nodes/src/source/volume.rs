//! `volume(path: "engine_256x256x128_uint8.raw.gz")`: a volume from a file, a folder or a glob.
//!
//! The kind remembers the time series that it has opened (`Series`), so that a step that was read ahead is there at
//! once.

use std::any::Any;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use glam::DVec3;
use volgraph_formats::LoadOptions;
use volgraph_graph::{Digest, Folders, PortType, Source, SourceKind};
use volgraph_report::Findings;
use volgraph_shader::{ParamSpec, ParamValue};
use volgraph_volume::Volume;

use super::Given;
use super::seen_bricks::SeenBricks;
use super::series::Series;
use crate::encoding::Encoding;

/// The source kind `volume`.
#[derive(Default)]
pub struct VolumeKind {
    series: Series,
}

/// A loaded volume.
#[derive(Debug)]
pub struct VolumeSource {
    /// The volume.
    pub volume: Arc<Volume>,
    /// Where its bricks are seen.
    bricks: SeenBricks,
}

impl VolumeSource {
    /// A volume as a source.
    #[must_use]
    pub fn new(volume: Arc<Volume>) -> Self {
        Self {
            volume,
            bricks: SeenBricks::default(),
        }
    }

    /// The first and the last brick along each axis that has scalars in open intervals, as shaders read them.
    pub(crate) fn seen_bricks(
        &self,
        storage: &str,
        spans: Vec<(f64, f64)>,
        encoding: &Encoding,
    ) -> Option<[[u32; 3]; 2]> {
        self.bricks.of(&self.volume, storage, spans, encoding)
    }
}

impl SourceKind for VolumeKind {
    fn name(&self) -> &'static str {
        "volume"
    }

    fn doc(&self) -> &'static str {
        "A volume from a file, or from the slices or time steps of a folder or a pattern of names."
    }

    fn ty(&self) -> PortType {
        PortType::Volume
    }

    fn params(&self) -> Vec<ParamSpec> {
        let mut params = super::volume_file_params();
        params.extend([
            ParamSpec::int(
                "time",
                0,
                "Which time step, from 0; a volume without time is the same at all of them.",
            )
            .range(0.0, f64::from(i32::MAX)),
            ParamSpec::int(
                "level",
                0,
                "Which level of a multi-resolution file; 0 is the finest.",
            )
            .range(0.0, 64.0),
        ]);
        params
    }

    fn load(
        &self,
        params: &BTreeMap<String, ParamValue>,
        folders: &Folders,
        progress: volgraph_graph::Progress<'_>,
    ) -> Result<Arc<dyn Source>, Findings> {
        let given = Given(params);
        let (path, options) = given.volume_file(folders)?;
        let options = LoadOptions {
            level: given.uint("level"),
            ..options
        };
        let volume =
            self.series
                .load(&path, &options, given.uint("time").unwrap_or(0), progress)?;
        Ok(Arc::new(VolumeSource::new(volume)))
    }
}

impl Source for VolumeSource {
    fn ty(&self) -> PortType {
        PortType::Volume
    }

    fn digest(&self) -> Digest {
        *self.volume.digest().as_bytes()
    }

    fn summary(&self) -> String {
        let grid = self.volume.grid();
        let [x, y, z] = grid.dims;
        let spacing = grid.spacing();
        let step = match &self.volume.about().step {
            Some(step) => format!(", time step {} of {}", step.index, step.count),
            None => String::new(),
        };
        format!(
            "{} {x}x{y}x{z} {}, spacing {} {} {}{step}",
            self.volume.name(),
            self.volume.voxels().scalar_type().name(),
            spacing.x,
            spacing.y,
            spacing.z
        )
    }

    fn files(&self) -> Vec<PathBuf> {
        self.volume.source_files().to_vec()
    }

    fn corners(&self) -> Vec<DVec3> {
        self.volume.grid().corners_world().to_vec()
    }

    fn warnings(&self) -> Vec<String> {
        let mut warnings = self.volume.warnings().to_vec();
        let statistics = self.volume.statistics();
        if statistics.nan_count > 0 {
            warnings.push(format!(
                "{} voxels are not numbers; they are read as the smallest value",
                statistics.nan_count
            ));
        }
        let infinite = statistics.positive_infinity_count + statistics.negative_infinity_count;
        if infinite > 0 {
            warnings.push(format!(
                "{infinite} voxels are infinite; they are read as the nearest finite value"
            ));
        }
        warnings
    }

    fn as_any(&self) -> &dyn Any {
        self
    }
}
