//! The techniques of the papers' tables: ready graphs with settings.

use std::path::Path;
use std::sync::Arc;

use volgraph_report::{Finding, Findings};
use volgraph_shader::ParamValue;

use super::limit::{raycast_of, set};
use super::subject::Subject;
use crate::overrides::{Overrides, ParamOverride};
use crate::scene::{NoProgress, Scene};
use crate::shaders::ShaderFolders;

/// The stages that rays run in.
pub const STAGES: [&str; 2] = ["fragment", "compute"];

/// A way of drawing.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Technique {
    /// Its name in tables.
    pub name: String,
    /// What it is, in a few words.
    pub doc: String,
    /// The graph: a ready one's name, or a file.
    pub graph: String,
    /// What is set in it.
    pub sets: Vec<String>,
    /// Whether the subject's transfer function takes the place of the graph's own.
    pub takes_transfer: bool,
}

/// (name, words, graph, settings of its raycast, whether it takes the subject's transfer function)
type Ready = (
    &'static str,
    &'static str,
    &'static str,
    &'static [&'static str],
    bool,
);

/// The ready techniques.
pub const TECHNIQUES: [Ready; 15] = [
    (
        "dvr_post",
        "volume rendering, unlit, post-classified",
        "quickstart",
        &["slots.classify=post", "slots.light=unlit"],
        true,
    ),
    (
        "dvr_unlit",
        "volume rendering, unlit, pre-integrated",
        "quickstart",
        &["slots.classify=preintegrated_2d", "slots.light=unlit"],
        true,
    ),
    (
        "dvr_lit_post",
        "volume rendering, Phong with stored gradients, post-classified",
        "quickstart",
        &[
            "slots.classify=post",
            "slots.light=phong",
            "slots.gradient=stored",
        ],
        true,
    ),
    (
        "dvr_lit",
        "volume rendering, Phong with stored gradients, pre-integrated",
        "quickstart",
        &[
            "slots.classify=preintegrated_2d",
            "slots.light=phong",
            "slots.gradient=stored",
        ],
        true,
    ),
    (
        "mip",
        "maximum intensity projection, exact in each cell",
        "mip",
        &["extremum=field"],
        false,
    ),
    (
        "mip_samples",
        "maximum intensity projection of the samples",
        "mip",
        &["extremum=samples"],
        false,
    ),
    (
        "isosurface",
        "isosurface, cubic crossing, lit",
        "isosurface",
        &[],
        false,
    ),
    (
        "isosurface_dvr",
        "isosurface with volume rendering",
        "isosurface_dvr",
        &[],
        true,
    ),
    (
        "isosurfaces_translucent",
        "four translucent isosurfaces",
        "isosurfaces_translucent",
        &[],
        false,
    ),
    (
        "self_shadowing",
        "isosurface that casts shadows on itself",
        "shadow",
        &[],
        false,
    ),
    (
        "volume_shadow",
        "volume that casts shadows on itself, by a grid of light",
        "volume_shadow",
        &[],
        true,
    ),
    (
        "reflection",
        "sphere-mapped reflection",
        "environment",
        &[],
        false,
    ),
    ("clipping", "volume clipping", "clip_sphere", &[], true),
    ("translucency", "translucency", "translucency", &[], false),
    (
        "refraction",
        "continuous refraction",
        "refraction",
        &[],
        false,
    ),
];

/// A graph of the user's own as a technique; it draws the subject with the subject's transfer function.
#[must_use]
pub fn own_technique(graph: &Path) -> Technique {
    let name = graph
        .file_stem()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned();
    Technique {
        doc: format!("the graph {}", graph.display()),
        name,
        graph: graph.display().to_string(),
        sets: Vec::new(),
        takes_transfer: true,
    }
}

impl Technique {
    /// The ready ones.
    #[must_use]
    pub fn all() -> Vec<Self> {
        let ready = TECHNIQUES
            .iter()
            .map(|(name, doc, graph, sets, takes_transfer)| Self {
                name: (*name).to_owned(),
                doc: (*doc).to_owned(),
                graph: (*graph).to_owned(),
                sets: sets.iter().map(|set| (*set).to_owned()).collect(),
                takes_transfer: *takes_transfer,
            });
        ready.collect()
    }

    /// Draws a subject, from its camera, at a step in voxels. Of the technique's graph the volume, the camera, and for most
    /// the transfer function are replaced.
    ///
    /// # Errors
    /// What is wrong with the graph, or where its picture is of no raycast.
    pub fn scene(
        &self,
        subject: &Subject,
        step: f64,
        shaders: &ShaderFolders,
    ) -> Result<Scene, Findings> {
        let none = Overrides::default();
        let path = Path::new(&self.graph);
        let mut scene = Scene::load(
            path,
            &none,
            shaders,
            volgraph_nodes::registry(),
            &NoProgress,
        )?;
        let node = raycast_of(&scene)?;
        let source_at = |scene: &Scene, port: &str| {
            let inputs = &scene.desc.nodes.get(&node)?.inputs;
            Some(inputs.get(port)?.from.clone())
        };
        let transfer = subject.transfer.as_ref().filter(|_| self.takes_transfer);
        for (port, loaded) in [("volume", Some(&subject.volume)), ("transfer", transfer)] {
            if let (Some(name), Some((desc, source))) = (source_at(&scene, port), loaded) {
                scene.desc.sources.insert(name.clone(), desc.clone());
                scene.sources.insert(name, Arc::clone(source));
            }
        }
        scene.desc.camera.clone_from(&subject.camera);
        scene.desc.quality = None;
        let mut sets = vec![set(&node, "step", ParamValue::Float(step))];
        for text in &self.sets {
            let parsed = ParamOverride::parse(&format!("{node}.{text}"));
            sets.push(parsed.map_err(|why| Finding::error("bad-param", why))?);
        }
        scene.with_sets(&sets)
    }
}

/// A scene whose raycast runs in a stage.
///
/// # Errors
/// Where its picture is of no raycast.
pub fn in_stage(scene: &Scene, stage: &str) -> Result<Scene, Findings> {
    let node = raycast_of(scene)?;
    scene.with_sets(&[set(&node, "stage", ParamValue::Text(stage.to_owned()))])
}

/// A scene whose raycast walks so.
///
/// # Errors
/// Where its picture is of no raycast.
pub(super) fn with_traverse(scene: &Scene, traverse: &str) -> Result<Scene, Findings> {
    let node = raycast_of(scene)?;
    scene.with_sets(&[ParamOverride {
        is_slot: true,
        typed: format!("{node}.slots.traverse={traverse}"),
        ..set(&node, "traverse", ParamValue::Text(traverse.to_owned()))
    }])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::{empty_of, limit_of};
    use crate::truth::plan_without_device;

    #[test]
    fn every_technique_plans_with_another_volume_and_so_does_its_limit() {
        let shaders = ShaderFolders::default();
        let subject = Subject::analytic("torus", 24, &shaders).unwrap();
        for technique in Technique::all() {
            let scene = technique.scene(&subject, 0.5, &shaders).unwrap();
            let compute = in_stage(&scene, "compute").unwrap();
            for scene in [
                &compute,
                &limit_of(&compute).unwrap(),
                &empty_of(&compute).unwrap(),
            ] {
                let plan = plan_without_device(scene, [32, 32])
                    .unwrap_or_else(|why| panic!("{}: {why}", technique.name));
                assert_eq!(
                    plan.view().camera,
                    plan_without_device(&scene.clone(), [32, 32])
                        .unwrap()
                        .view()
                        .camera
                );
            }
            let limit = limit_of(&compute).unwrap();
            let image = &limit.desc.nodes[&raycast_of(&limit).unwrap()];
            assert_eq!((image.kind.as_str(), image.slots.len()), ("fetch_only", 0));
            assert_eq!(image.params["step"].value, ParamValue::Float(0.5));
            assert_eq!(
                image.params["stage"].value,
                ParamValue::Text("compute".to_owned())
            );
        }
    }
}
