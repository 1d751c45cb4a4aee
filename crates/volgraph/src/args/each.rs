//! What the commands that draw many graphs draw each of them with.

use std::path::PathBuf;

use clap::Args as ClapArgs;
use volgraph::{CameraDesc, ParamOverride};

use super::{DataArgs, SceneArgs, ShaderArgs};

/// What `volgraph chart` and `volgraph gallery` share.
#[derive(ClapArgs, Debug)]
pub struct EachSceneArgs {
    /// Width and height of each picture in pixels.
    #[arg(long, value_name = "WxH", default_value = "512x512", value_parser = super::parse_size)]
    pub size: [u32; 2],
    /// Set a parameter, a slot or a source's field in every graph; may be given again.
    #[arg(long, value_name = "NODE.PARAM=VALUE | NODE.slots.SLOT=CHOICE", value_parser = ParamOverride::parse)]
    pub set: Vec<ParamOverride>,
    /// Draw another volume file in every graph; may be given again. The name may be left out where a graph has one
    /// volume, or one that is named `volume`.
    #[arg(long, value_name = "[NAME=]FILE", value_parser = super::parse_volume)]
    pub volume: Vec<(String, PathBuf)>,
    /// The camera of every graph, as a graph writes it.
    #[arg(long, value_name = "CAMERA", value_parser = super::parse_camera)]
    pub camera: Option<CameraDesc>,
    /// Where volumes are.
    #[command(flatten)]
    pub data: DataArgs,
    /// Where shaders are.
    #[command(flatten)]
    pub shaders: ShaderArgs,
    /// The adapter: part of its name, a backend (vulkan, gl, metal, dx12) or a class (discrete, software, …).
    #[arg(long, value_name = "WORDS", env = "VOLGRAPH_ADAPTER")]
    pub adapter: Option<String>,
    /// Print what was measured and what was left out as JSON.
    #[arg(long)]
    pub json: bool,
}

impl EachSceneArgs {
    /// What `volgraph render` would be given to draw one of the graphs.
    pub fn scene(&self, graph: impl Into<PathBuf>) -> SceneArgs {
        SceneArgs {
            graph: graph.into(),
            size: self.size,
            set: self.set.clone(),
            volume: self.volume.clone(),
            time: None,
            camera: self.camera.clone(),
            data: self.data.clone(),
            shaders: self.shaders.clone(),
            adapter: self.adapter.clone(),
            max_resource_gib: None,
        }
    }
}
