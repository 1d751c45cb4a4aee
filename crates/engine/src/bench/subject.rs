//! What is drawn: a volume, with the transfer function and the camera that go with it.

use std::path::Path;
use std::sync::Arc;

use volgraph_graph::{CameraDesc, Source, SourceDesc};
use volgraph_nodes::source::volume::VolumeSource;
use volgraph_report::{Finding, Findings, Place};
use volgraph_volume::analytic::FIELDS;

use super::limit::raycast_of;
use crate::embedded;
use crate::overrides::Overrides;
use crate::scene::{Scene, SourceProgress};
use crate::shaders::ShaderFolders;

/// The transfer function of volumes that come without one.
const TRANSFER: &str = "embedded:/graphs/transfer/comparison.ron";

/// A source, as it is asked for and as it was loaded.
pub(super) type Loaded = (SourceDesc, Arc<dyn Source>);

/// A volume with what goes with it.
#[derive(Clone)]
pub struct Subject {
    /// Its name in tables.
    pub name: String,
    /// Voxels along each axis.
    pub dims: [u32; 3],
    /// One line: what it is.
    pub summary: String,
    pub(super) volume: Loaded,
    pub(super) transfer: Option<Loaded>,
    pub(super) camera: Option<CameraDesc>,
}

impl Subject {
    /// What a user means: a graph (or the name of a ready one), whose volume, transfer function and camera are taken; the
    /// name of an analytic field, 128 voxels a side in bytes; or a volume file.
    ///
    /// # Errors
    /// What is wrong with the graph or the file.
    pub fn load(
        what: &str,
        data: &Overrides,
        shaders: &ShaderFolders,
        progress: &dyn SourceProgress,
    ) -> Result<Self, Findings> {
        let path = Path::new(what);
        if FIELDS.iter().any(|field| field.name == what) {
            return Self::analytic(what, 128, shaders);
        }
        let located = embedded::locate(path);
        if located
            .extension()
            .is_some_and(|extension| extension == "ron")
        {
            let scene = Scene::load(
                &located,
                data,
                shaders,
                volgraph_nodes::registry(),
                progress,
            )?;
            return Self::of(&scene, stem(path));
        }
        let file = std::path::absolute(path).unwrap_or_else(|_| path.to_path_buf());
        // A name that is nowhere here may lie in one of the folders of data, which takes its own words.
        let file = if volgraph_graph::is_there(&file) {
            file.display().to_string()
        } else {
            what.to_owned()
        };
        let source = format!("volume(path: {file:?})");
        Self::of(
            &around_source(&source, data, shaders, progress)?,
            stem(path),
        )
    }

    /// An analytic field with so many voxels a side, in bytes.
    ///
    /// # Errors
    /// Where there is no field of that name.
    pub fn analytic(field: &str, side: u32, shaders: &ShaderFolders) -> Result<Self, Findings> {
        let source =
            format!("analytic(field: {field:?}, dims: ({side}, {side}, {side}), type: \"uint8\")");
        let scene = around_source(
            &source,
            &Overrides::default(),
            shaders,
            &crate::scene::NoProgress,
        )?;
        Self::of(&scene, field.to_owned())
    }

    /// A ball in an empty box, of a radius as a part of the box's half side, with so many voxels a side.
    ///
    /// # Errors
    /// None that is known.
    pub fn ball(radius: f64, side: u32, shaders: &ShaderFolders) -> Result<Self, Findings> {
        let source = format!(
            "analytic(field: \"sphere\", dims: ({side}, {side}, {side}), type: \"uint8\", radius: {radius:?}, falloff: 0.1)"
        );
        let scene = around_source(
            &source,
            &Overrides::default(),
            shaders,
            &crate::scene::NoProgress,
        )?;
        Self::of(&scene, format!("ball_{radius}"))
    }

    /// What a loaded scene draws.
    ///
    /// # Errors
    /// Where its picture is of no raycast of a volume.
    pub fn of(scene: &Scene, name: String) -> Result<Self, Findings> {
        let raycast = raycast_of(scene)?;
        let at = |port: &str| {
            let from = &scene.desc.nodes.get(&raycast)?.inputs.get(port)?.from;
            Some((
                scene.desc.sources.get(from)?.clone(),
                Arc::clone(scene.sources.get(from)?),
            ))
        };
        let volume = at("volume").ok_or_else(|| {
            Finding::error(
                "no-volume",
                "the raycast of the output `color` draws no volume of a source",
            )
            .at(Place::whole_file(&scene.path))
        })?;
        let dims = volume.1.as_any().downcast_ref::<VolumeSource>();
        Ok(Self {
            name,
            dims: dims.map_or([0; 3], |source| source.volume.grid().dims),
            summary: volume.1.summary(),
            transfer: at("transfer"),
            camera: scene.desc.camera.clone(),
            volume,
        })
    }
}

/// A graph around a source, for what comes without one.
fn around_source(
    source: &str,
    data: &Overrides,
    shaders: &ShaderFolders,
    progress: &dyn SourceProgress,
) -> Result<Scene, Findings> {
    let text = format!(
        r#"(
    sources: {{ "volume": {source}, "colors": transfer(path: {TRANSFER:?}) }},
    camera: orbit(azimuth: 30, elevation: 20),
    nodes: {{
        "box":   (kind: "proxy_box", in: {{ "volume": "volume" }}),
        "image": (kind: "raycast", in: {{ "volume": "volume", "transfer": "colors", "rays": "box" }}),
    }},
    outputs: {{ "color": "image.color" }},
)"#
    );
    let path = Path::new("volume.ron");
    Scene::of_text(
        path,
        text,
        data,
        shaders,
        volgraph_nodes::registry(),
        progress,
    )
}

fn stem(path: &Path) -> String {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    // Names of raw files carry dimensions and type behind the first part.
    let name = name.split('.').next().unwrap_or_default();
    let is_size =
        |part: &str| part.contains('x') && part.split('x').all(|side| side.parse::<u32>().is_ok());
    let parts = name.split('_').take_while(|part| !is_size(part));
    parts.collect::<Vec<_>>().join("_")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn volumes_are_named_by_their_files() {
        let names = [
            "a/engine_256x256x128_uint8.raw.gz",
            "bunny_ct_half_256x256x180_int16.raw.gz",
            "cthead",
            "c.nrrd",
        ];
        assert_eq!(
            names.map(|name| stem(Path::new(name))),
            ["engine", "bunny_ct_half", "cthead", "c"]
        );
    }

    #[test]
    fn a_field_comes_with_a_transfer_function_and_a_wrong_file_is_told() {
        let shaders = ShaderFolders::default();
        let none = Overrides::default();
        let subject = Subject::load("c60", &none, &shaders, &crate::scene::NoProgress).unwrap();
        assert_eq!((subject.name.as_str(), subject.dims), ("c60", [128; 3]));
        assert!(subject.transfer.is_some() && subject.camera.is_some());
        let wrong = Subject::load(
            "nothing_8x8x8_uint8.raw",
            &none,
            &shaders,
            &crate::scene::NoProgress,
        );
        assert!(
            wrong.is_err_and(|findings| findings.to_string().contains("nothing_8x8x8_uint8.raw"))
        );
    }
}
