//! volgraph without its command line and window: scenes, sessions and pictures as plain owned values.
//!
//! The way of the data: [`Scene::load`] reads a graph file and its sources, with the [`Overrides`] of the command
//! line; [`Scene::plan`] decides everything without a GPU. A [`Session`] opens a device, installs the plan and
//! renders [`Picture`]s, as often as wanted: what did not change is not done again. [`metadata`] is what every
//! picture carries, so that it can be rendered again. [`ShaderFolders`] says where shaders are looked for, and
//! [`embedded`] what volgraph carries within itself.
//!
//! ```no_run
//! use volgraph_engine::{Session, SessionOptions};
//!
//! let mut session = Session::open("graphs/quickstart.ron", &SessionOptions::default())?;
//! let (picture, report) = session.render()?;
//! picture.save("quickstart.png".as_ref(), Default::default())?;
//! println!("{:?} ran", report.ran());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod advise;
pub mod alone;
pub mod bench;
mod beside;
pub mod case;
mod dependencies;
pub mod edits;
pub mod embedded;
pub mod film;
pub mod folders;
mod kept;
pub mod levels;
pub mod metadata;
pub mod methods;
mod overrides;
pub mod presets;
pub mod quality;
pub mod ray;
pub mod recorded;
pub mod renderer;
mod scene;
mod session;
mod shaders;
pub mod stress;
pub mod truth;
pub mod verify;

pub use beside::open_beside;
pub use case::{Case, CaseOptions};
pub use dependencies::Dependencies;
pub use embedded::{EMBEDDED_GRAPHS, ReadyGraph, ready_graphs};
pub use overrides::{LOOK, Overrides, ParamOverride};
pub use ray::{Probe, RayOptions, RayStudy, RayTracer};
pub use recorded::Recorded;
pub use scene::{NoProgress, Scene, SourceProgress};
pub use session::{
    Change, ChangeReport, ChangedFile, Drawn, Outcome, Refused, Session, SessionOptions, Stages,
    TILE_SIDE, Unopened, has_to_be_tiled,
};
pub use shaders::{EMBEDDED_SHADERS, ShaderFolders};
pub use truth::{Truth, TruthOptions};
pub use volgraph_gpu::{
    AdapterChoice, AdapterSummary, FrameReport, Gpu, Shown, TexelValues, Texels, list_adapters,
};
pub use volgraph_graph::{
    Camera, CameraDesc, Edit, GraphDesc, Limits, Plan, Registry, View, Window, apply_edits,
};
pub use volgraph_nodes::source::bricks::Progressive;
pub use volgraph_nodes::{progressive_registry, registry};
pub use volgraph_picture::Picture;
pub use volgraph_report::{Finding, Findings, Place};
