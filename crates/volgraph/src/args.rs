//! The arguments of all commands.

mod accuracy;
mod animate;
mod authors;
mod bench;
mod chart;
mod each;
mod live;
mod ray;
mod verify;
mod volumes;
mod words;

use std::path::PathBuf;

use clap::{Args as ClapArgs, Parser, Subcommand};
use volgraph::{AdapterChoice, CameraDesc, Overrides, ParamOverride, ShaderFolders};

pub use accuracy::{AdviseArgs, LevelsArgs, ReferenceArgs, StressArgs};
pub use animate::{AnimateArgs, Steps};
pub use authors::{GalleryArgs, GraphsArgs, NewArgs, NewSlot, SetArgs, TestArgs, TransferArgs};
pub use bench::BenchArgs;
pub use chart::{ChartArgs, TruthChoice};
pub use each::EachSceneArgs;
pub use live::{ViewArgs, WatchArgs};
pub use ray::RayArgs;
pub use verify::{STOCK, VerifyArgs};
pub use volumes::{ConvertArgs, DistanceFieldArgs, InfoArgs, InsideName, PyramidArgs, WriteArgs};

use self::words::{parse_bound, parse_camera, parse_size, parse_slot, parse_volume};

/// Draws volumes with WGSL shaders that plug into a render graph, and says how wrong each picture is.
#[derive(Parser, Debug)]
#[command(name = "volgraph", version)]
pub struct Args {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// The commands.
#[derive(Subcommand, Debug)]
pub enum Command {
    /// Render a graph into a picture.
    Render(RenderArgs),
    /// Render a film of a graph: the camera goes around its target, or along a path of keys.
    ///
    /// Frames are numbered pictures in a folder, each as `volgraph render` saves it, or one animated PNG or GIF. An
    /// interrupt leaves no half-written file.
    Animate(AnimateArgs),
    /// Compute what a graph's picture should be, in float64 on the processor; no adapter is needed.
    Reference(ReferenceArgs),
    /// Say which step a graph asks for: by Carson's rule from the spectra of its volume and transfer function, and measured.
    Advise(AdviseArgs),
    /// Draw the known breaking points of volume rendering, each with the methods that break there and those that hold.
    ///
    /// Exit code 1 means that a method which must hold does not.
    Stress(StressArgs),
    /// Measure a graph's orders of convergence and hold them against what its slots declare; or render a picture again from
    /// its metadata and compare.
    ///
    /// Exit code 1 means that an order is below the declared one, or that the picture differs.
    Verify(VerifyArgs),
    /// Say why a pixel has its value: the walk along its ray, segment by segment, and the float64 reference beside it.
    ///
    /// The walk is written down by the shader that draws the picture, whatever its technique. Segments are taken, skipped
    /// (leaps over what cannot be seen) or ended (early ray termination). A probe tells what the volume is where the ray
    /// hits, and where most of the pixel comes from.
    Ray(RayArgs),
    /// Print what a graph comes to: nodes, bindings, sizes, memory, conventions.
    Plan(PlanArgs),
    /// Check shaders, graphs, transfer functions and test cases, without a GPU; folders are searched.
    ///
    /// A volume file that is not there is a warning: a small volume stands in for it, so that the rest of its graph is
    /// checked wherever the data is. Exit code 1 means errors.
    Check(CheckArgs),
    /// Write a shader of your own to start from, with a graph that draws it and a test.
    New(NewArgs),
    /// Run test cases of shaders; folders are searched. Exit code 1 means that one failed.
    Test(TestArgs),
    /// Print a volume's dimensions, placement and statistics.
    Info(InfoArgs),
    /// Write a volume into a file of another format; crop, resample or change its type on the way.
    ///
    /// Placement, and what the file says of units and labels, go along where the format can say it; what it cannot is a
    /// warning. An interrupt leaves no half-written file.
    Convert(ConvertArgs),
    /// Build the coarser levels of a volume that is larger than memory, and tell how far each is from the finest.
    ///
    /// Voxels are read where they lie, in bounded memory. Each brick of each level is known by its range and by its exact
    /// error against the finest level. An interrupt leaves nothing half-built.
    Pyramid(PyramidArgs),
    /// Measure what a picture of a volume in bricks loses on each level: a box of it, against the float64 reference of the
    /// same box at full resolution.
    Levels(LevelsArgs),
    /// Make a volume of a mesh: the signed distance to its surface, for isosurfaces, glass and clip volumes.
    ///
    /// What is wrong with the mesh (holes, faces that look the other way) is told first.
    DistanceField(DistanceFieldArgs),
    /// Print a shader with everything it imports as one WGSL text, each part with the file it comes from.
    ///
    /// Slots that are not named take the choices that the node kinds declare, or those of the graph. What is wrong with
    /// the text goes to standard error, with exit code 1.
    Link(LinkArgs),
    /// Compare two pictures: RMSE, maximum, 99.9th percentile, PSNR, FLIP.
    Compare(CompareArgs),
    /// List node kinds and source kinds with their ports and parameters.
    Nodes(NodesArgs),
    /// List the ready graphs, print one, or copy one into a folder to start from.
    Graphs(GraphsArgs),
    /// Change parameters, slots, sources or the camera in a graph's file, and leave all else in it as it stands.
    ///
    /// Comments, layout and order stay. What would make the graph wrong is refused, and nothing is written.
    Set(SetArgs),
    /// Make a transfer function for a volume from a preset, such as bone in CT.
    Transfer(TransferArgs),
    /// Render every ready graph, and a page (index.html) that shows the pictures with graphs, times and adapter.
    ///
    /// A graph whose volume is not found is left out and named. Exit code 1 means that a graph could not be rendered.
    Gallery(GalleryArgs),
    /// List the adapters, the best first.
    Adapters(AdaptersArgs),
    /// Time the frames of a graph while the camera turns; or make the tables of frame rates of all techniques.
    ///
    /// Beside each technique the limit is measured in turn: the same rays and samples, and nothing else. With --tables,
    /// --growth, --start-up or --peers, what is measured goes into bench.json and a page in the folder of -o, after each
    /// step, so that an interrupt keeps it.
    Bench(Box<BenchArgs>),
    /// Chart the methods of graphs by speed and accuracy: a table, a chart and a page with pictures and error maps.
    ///
    /// All that a graph's raycast offers is compared: classifications, steps, storages, stages. Frames are timed in turn.
    Chart(ChartArgs),
    /// Render a graph, and again whenever a file that the picture depends on changes.
    ///
    /// Shaders with all that they import, the graph, transfer functions, images and volumes are watched. A change that
    /// is refused leaves the picture as it was; the diagnostic names file, line and column. Ctrl-C ends.
    Watch(WatchArgs),
    /// Open a graph in a live window: the camera under the mouse, parameters and transfer function under edit, shaders
    /// reloaded as they change on disk.
    View(ViewArgs),
}

/// What stands between folders in one word, as in the system's other lists of them.
const FOLDER_DELIMITER: char = if cfg!(windows) { ';' } else { ':' };

/// Where shaders are looked for.
#[derive(ClapArgs, Clone, Debug)]
pub struct ShaderArgs {
    /// A folder of your own shaders, searched first; may be given again. Several in one word have `:` between them (`;` on
    /// Windows).
    #[arg(
        long,
        value_name = "FOLDER",
        env = "VOLGRAPH_SHADERS",
        value_delimiter = FOLDER_DELIMITER
    )]
    pub shaders: Vec<PathBuf>,
}

impl ShaderArgs {
    /// The folders.
    pub fn folders(&self) -> ShaderFolders {
        ShaderFolders {
            own: self.shaders.clone(),
        }
    }
}

/// Where volumes are looked for.
#[derive(ClapArgs, Clone, Debug)]
pub struct DataArgs {
    /// A folder of volumes, for files that do not lie beside the graph; may be given again. Several in one word have `:`
    /// between them (`;` on Windows).
    #[arg(
        long,
        value_name = "FOLDER",
        env = "VOLGRAPH_DATA",
        value_delimiter = FOLDER_DELIMITER
    )]
    pub data: Vec<PathBuf>,
}

/// What all commands on graphs share.
#[derive(ClapArgs, Clone, Debug)]
pub struct SceneArgs {
    /// The graph file; or the name of a ready graph (`volgraph graphs` lists them), where there is no such file; or a volume
    /// file, for which a graph is picked.
    pub graph: PathBuf,
    /// Width and height of the picture in pixels.
    #[arg(long, value_name = "WxH", default_value = "512x512", value_parser = parse_size)]
    pub size: [u32; 2],
    /// Set a parameter, a slot or a source's field; may be given again.
    #[arg(long, value_name = "NODE.PARAM=VALUE | NODE.slots.SLOT=CHOICE", value_parser = ParamOverride::parse)]
    pub set: Vec<ParamOverride>,
    /// Draw another volume file for a source of the graph; may be given again. The name may be left out where the graph has
    /// one volume, or one that is named `volume`.
    #[arg(long, value_name = "[NAME=]FILE", value_parser = parse_volume)]
    pub volume: Vec<(String, PathBuf)>,
    /// The time step of all volumes that have several, from 0.
    #[arg(long, value_name = "STEP")]
    pub time: Option<u32>,
    /// The camera, as a graph writes it: orbit(azimuth: 40, elevation: 25) or look_at(eye: (1, 2, 3)).
    #[arg(long, value_name = "CAMERA", value_parser = parse_camera)]
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
    /// Most memory of one texture or buffer in GiB, for devices with much of it; more is refused. 8 by default.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=1 << 20))]
    pub max_resource_gib: Option<u64>,
}

impl SceneArgs {
    /// What they change in the graph.
    pub fn overrides(&self) -> Overrides {
        Overrides {
            params: self.set.clone(),
            volumes: self.volume.clone(),
            camera: self.camera.clone(),
            data: self.data.data.clone(),
            time: self.time,
            look: None,
        }
    }

    /// Where shaders are.
    pub fn shader_folders(&self) -> ShaderFolders {
        self.shaders.folders()
    }

    /// Which adapter.
    pub fn adapter_choice(&self) -> AdapterChoice {
        AdapterChoice::new(self.adapter.as_deref())
    }
}

/// `volgraph render`.
#[derive(ClapArgs, Debug)]
pub struct RenderArgs {
    /// The graph and its changes.
    #[command(flatten)]
    pub scene: SceneArgs,
    /// The picture: .png, or .exr with depth, opacity and the graph's other outputs as layers.
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// Draw in tiles of at most so many pixels a side, which make the same picture. Pictures that are larger than the
    /// adapter's textures are drawn so in any case.
    #[arg(long, value_name = "PIXELS", value_parser = clap::value_parser!(u32).range(1..=1 << 16))]
    pub tile: Option<u32>,
    /// Bits of each PNG component: 8 or 16.
    #[arg(long, value_name = "BITS", default_value = "8", value_parser = ["8", "16"])]
    pub png_bits: String,
    /// Print what ran, times and memory as JSON.
    #[arg(long)]
    pub json: bool,
}

/// `volgraph plan`.
#[derive(ClapArgs, Debug)]
pub struct PlanArgs {
    /// The graph and its changes. Without an adapter the plan is for what WebGPU guarantees everywhere.
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Print JSON.
    #[arg(long, conflicts_with = "dot")]
    pub json: bool,
    /// Print a drawing in the DOT language.
    #[arg(long)]
    pub dot: bool,
}

/// `volgraph check`.
#[derive(ClapArgs, Debug)]
pub struct CheckArgs {
    /// Files and folders.
    #[arg(required = true)]
    pub paths: Vec<PathBuf>,
    /// Where shaders are.
    #[command(flatten)]
    pub shaders: ShaderArgs,
    /// Where volumes are.
    #[command(flatten)]
    pub data: DataArgs,
    /// How findings are printed.
    #[arg(long, default_value = "human")]
    pub format: FindingFormat,
}

/// How findings are printed.
#[derive(clap::ValueEnum, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FindingFormat {
    /// With excerpts, for people.
    #[default]
    Human,
    /// One JSON array.
    Json,
    /// Annotations of GitHub Actions.
    Github,
}

/// `volgraph link`.
#[derive(ClapArgs, Debug)]
pub struct LinkArgs {
    /// A library, a slot's choice, a node's own shader (.wgsl), or a graph (.ron).
    pub file: PathBuf,
    /// Choose for a slot: a name, or a path that ends in .wgsl; may be given again.
    #[arg(long = "slots", value_name = "SLOT=CHOICE", value_parser = parse_slot)]
    pub slots: Vec<(String, String)>,
    /// The kind of node whose shader imports FILE; for a graph, the name of a node.
    #[arg(long, value_name = "KIND | NAME")]
    pub node: Option<String>,
    /// Where shaders are.
    #[command(flatten)]
    pub shaders: ShaderArgs,
    /// Where volumes are.
    #[command(flatten)]
    pub data: DataArgs,
    /// Print WGSL alone, without the comments that name files.
    #[arg(long)]
    pub plain: bool,
}

/// `volgraph compare`.
#[derive(ClapArgs, Debug)]
pub struct CompareArgs {
    /// A picture.
    pub a: PathBuf,
    /// The picture that it is held against; or the word `reference`, for the truth of A as its metadata tells it.
    pub b: PathBuf,
    /// Exit with 1 where the root mean square error is larger.
    #[arg(long, value_name = "ERROR", value_parser = parse_bound)]
    pub max_rmse: Option<f64>,
    /// Exit with 1 where the error of any component of any pixel is larger.
    #[arg(long, value_name = "ERROR", value_parser = parse_bound)]
    pub max_error: Option<f64>,
    /// Print JSON.
    #[arg(long)]
    pub json: bool,
}

/// `volgraph nodes`.
#[derive(ClapArgs, Debug)]
pub struct NodesArgs {
    /// Only this kind.
    pub kind: Option<String>,
    /// Where shaders are.
    #[command(flatten)]
    pub shaders: ShaderArgs,
    /// Print JSON.
    #[arg(long)]
    pub json: bool,
}

/// `volgraph adapters`.
#[derive(ClapArgs, Debug)]
pub struct AdaptersArgs {
    /// Print JSON.
    #[arg(long)]
    pub json: bool,
}
