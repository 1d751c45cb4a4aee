//! The arguments of `volgraph bench`.

use std::path::PathBuf;

use clap::{ArgGroup, Args as ClapArgs};
use volgraph::bench::{Rotation, STAGES};
use volgraph::methods::LEAST_TURN_DEGREES;
use volgraph::{CameraDesc, ParamOverride};

use super::{DataArgs, SceneArgs, ShaderArgs};

/// `volgraph bench`.
#[derive(ClapArgs, Debug)]
#[command(group(ArgGroup::new("report").args(["tables", "growth", "start_up", "peers"]).multiple(true)))]
pub struct BenchArgs {
    /// Graph files, or names of ready graphs: one to time; with --tables and --growth the techniques, in place of the ready
    /// ones; with --start-up what is started.
    #[arg(value_name = "GRAPH", required_unless_present_any = ["tables", "growth", "start_up", "peers", "list"])]
    pub graphs: Vec<PathBuf>,
    /// Min, average and max frame rate over a rotation of each technique, with its ratio to the limit.
    #[arg(long, requires = "output")]
    pub tables: bool,
    /// How cost grows with pixels, 1/step, voxels and what is occupied: exponents and charts.
    #[arg(long, requires = "output")]
    pub growth: bool,
    /// Time from the program's start to the first picture, with caches empty and filled, and memory.
    #[arg(long, requires = "output")]
    pub start_up: bool,
    /// Time other renderers in turn with volgraph, by the workers in this folder (docs/speed.md says what they are).
    #[arg(long, value_name = "FOLDER", requires = "output")]
    pub peers: Option<PathBuf>,
    /// The Python that runs the workers of --peers.
    #[arg(
        long,
        requires = "report",
        value_name = "PROGRAM",
        default_value = "python3"
    )]
    pub python: PathBuf,
    /// Draw speed against accuracy of the renderers of --peers and of volgraph into this SVG file; more settings of each are
    /// timed for it.
    #[arg(long, value_name = "FILE", requires = "peers")]
    pub chart: Option<PathBuf>,
    /// The folder for bench.json and index.html; it is made where it is not there.
    #[arg(short, long, value_name = "FOLDER")]
    pub output: Option<PathBuf>,
    /// List the techniques.
    #[arg(long)]
    pub list: bool,
    /// Only techniques, and peers, with this text in their names; may be given again.
    #[arg(long, value_name = "TEXT")]
    pub filter: Vec<String>,
    /// The stages that rays run in.
    #[arg(long, requires = "report", value_name = "STAGE", value_delimiter = ',', default_values = STAGES, value_parser = STAGES)]
    pub stage: Vec<String>,
    /// Step of all techniques in voxels, for --tables.
    #[arg(long, requires = "report", value_name = "VOXELS", default_value_t = 1.0, value_parser = parse_positive)]
    pub step: f64,
    /// Width and height of the picture in pixels, several with --tables. 512x512; for tables 1024x1024 as well.
    #[arg(long, value_name = "WxH", value_delimiter = ',', value_parser = super::parse_size)]
    pub size: Vec<[u32; 2]>,
    /// Draw another volume: [NAME=]FILE for a source of the graph. With --tables what is drawn, may be given again: a ready
    /// graph's name (its volume, transfer function and camera), an analytic field's name, or a file. c60 and
    /// marschner_lobb by default.
    #[arg(long, value_name = "VOLUME")]
    pub volume: Vec<String>,
    /// Frames that are timed: 9. With --tables at most so many views of the rotation, evenly spread.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub frames: Option<u32>,
    /// Frames before them that are not: 3; with --tables 1.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(0..=1_000_000))]
    pub warm_up: Option<u32>,
    /// Degrees from frame to frame: 1, around the camera's up direction; with --tables 2, around the vertical axis.
    #[arg(long, value_name = "DEGREES", value_parser = parse_turn)]
    pub turn: Option<f64>,
    /// Seconds for all of --tables, and the same for all of --growth, shared out evenly; each frame is drawn once all the
    /// same.
    #[arg(long, requires = "report", value_name = "S", default_value_t = 900.0, value_parser = parse_positive)]
    pub seconds: f64,
    /// Largest viewport side of --growth.
    #[arg(long, requires = "report", value_name = "N", default_value_t = 1024, value_parser = clap::value_parser!(u32).range(1..=16_384))]
    pub largest_view: u32,
    /// Largest volume side of --growth.
    #[arg(long, requires = "report", value_name = "N", default_value_t = 256, value_parser = clap::value_parser!(u32).range(2..=2048))]
    pub largest_volume: u32,
    /// Time drawing alone, without reading pixels back; of one graph.
    #[arg(long, conflicts_with = "report")]
    pub no_read_back: bool,
    /// Leave the limit out; of one graph.
    #[arg(long, conflicts_with = "report")]
    pub no_limit: bool,
    /// Edit the transfer function so many times in a live session, each time with other scalars empty, and time what that has
    /// made anew; of one graph.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub edits: Option<u32>,
    /// Set a parameter, a slot or a source's field; may be given again; of one graph.
    #[arg(long, conflicts_with = "report", value_name = "NODE.PARAM=VALUE | NODE.slots.SLOT=CHOICE", value_parser = ParamOverride::parse)]
    pub set: Vec<ParamOverride>,
    /// The camera of one graph, as a graph writes it.
    #[arg(long, conflicts_with = "report", value_name = "CAMERA", value_parser = super::parse_camera)]
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
    /// Most memory of one texture or buffer in GiB; more is refused. 8 by default.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=1 << 20))]
    pub max_resource_gib: Option<u64>,
    /// Print JSON.
    #[arg(long)]
    pub json: bool,
}

impl BenchArgs {
    /// Whether a report is made, and not one graph timed.
    pub fn is_report(&self) -> bool {
        self.tables || self.growth || self.start_up || self.peers.is_some()
    }

    /// What one graph is drawn with.
    ///
    /// # Errors
    /// A `--volume` that names nothing.
    pub fn scene(&self, graph: PathBuf) -> Result<SceneArgs, String> {
        let volumes = self.volume.iter().map(|volume| super::parse_volume(volume));
        Ok(SceneArgs {
            graph,
            volume: volumes.collect::<Result<_, _>>()?,
            ..self.report_scene()
        })
    }

    /// What the graphs of a report are drawn with: its volumes are no sources of theirs.
    pub fn report_scene(&self) -> SceneArgs {
        SceneArgs {
            graph: PathBuf::new(),
            volume: Vec::new(),
            size: self.size.first().copied().unwrap_or([512, 512]),
            set: self.set.clone(),
            time: None,
            camera: self.camera.clone(),
            data: self.data.clone(),
            shaders: self.shaders.clone(),
            adapter: self.adapter.clone(),
            max_resource_gib: self.max_resource_gib,
        }
    }

    /// The sizes of tables.
    pub fn sizes(&self) -> Vec<[u32; 2]> {
        if self.size.is_empty() {
            vec![[512, 512], [1024, 1024]]
        } else {
            self.size.clone()
        }
    }

    /// What tables are of.
    pub fn volumes(&self) -> Vec<String> {
        if self.volume.is_empty() {
            ["c60", "marschner_lobb"].map(str::to_owned).to_vec()
        } else {
            self.volume.clone()
        }
    }

    /// The views of tables.
    pub fn rotation(&self) -> Rotation {
        Rotation::new(self.turn.unwrap_or(2.0), self.frames.unwrap_or(u32::MAX))
    }

    /// Whether a name is asked for.
    pub fn is_wanted(&self, name: &str) -> bool {
        self.filter.is_empty() || self.filter.iter().any(|text| name.contains(text.as_str()))
    }
}

/// A camera that stands still would time frames in which nothing is done.
fn parse_turn(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(turn) if turn.is_finite() && turn.abs() >= LEAST_TURN_DEGREES => Ok(turn),
        _ => Err(format!(
            "give a number of degrees of at least {LEAST_TURN_DEGREES}, or below its negative"
        )),
    }
}

fn parse_positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() && value > 0.0 => Ok(value),
        _ => Err("give a number above 0".to_owned()),
    }
}
