//! The ray of one pixel: why this pixel has this value.
//!
//! A [`RayTracer`] plans a session's graph once more, with the output `trace` of its raycast beside the picture. That
//! output is written by the very shader that draws the picture (`slot/trace_layer/written.wgsl`): each segment that the
//! walk took with its samples, each leap, and what the technique would show if the walk ended there. So no second walk
//! has to agree with the first, and every technique can be looked at, one of a user's own as well. [`RayTracer::study`]
//! draws a frame, reads the walk back and puts the float64 reference beside it, where that covers the graph.
//! [`Probe`] says what the volume is at a place.

mod probe;
mod trace;

use std::sync::Arc;

use glam::DVec3;
use indexmap::IndexMap;
use serde::Serialize;
use volgraph_gpu::{Installation, Runner, TexelValues};
use volgraph_graph::demand::ShaderLibrary;
use volgraph_graph::{EdgeDesc, Limits, NodeContext, NodeId, NodeKind, Plan, View};
use volgraph_nodes::encoding::Encoding;
use volgraph_nodes::placement;
use volgraph_nodes::raycast::Raycast;
use volgraph_nodes::reference::{raycast_scene, rays};
use volgraph_reference::{Profile, interval, profile};
use volgraph_report::{Finding, Findings, Place};
use volgraph_shader::ParamValue;

pub use self::probe::Probe;
pub use self::trace::{RaySegment, Status};
use self::trace::{Trace, read};
use crate::overrides::ParamOverride;
use crate::scene::Scene;
use crate::session::Session;
pub use volgraph_reference::ProfilePoint;

/// How a ray is studied.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayOptions {
    /// Whether the reference is computed beside it.
    pub with_reference: bool,
    /// Absolute tolerance of the reference's colours, 1e-10 to 1.
    pub tolerance: f64,
    /// About how many points the reference's curve has; each cell has one at least.
    pub points: usize,
}

impl Default for RayOptions {
    fn default() -> Self {
        Self {
            with_reference: true,
            tolerance: volgraph_reference::DEFAULT_TOLERANCE,
            points: 512,
        }
    }
}

/// What the ray of one pixel met. Colours are linear and premultiplied, distances world units from the ray's origin.
#[derive(Clone, Debug, Serialize)]
pub struct RayStudy {
    /// The name of the raycast.
    pub node: String,
    /// Its technique.
    pub technique: String,
    /// The pixel: column and row, from the top left.
    pub pixel: [u32; 2],
    /// World position where the ray starts.
    pub origin: [f64; 3],
    /// Its unit world direction.
    pub direction: [f64; 3],
    /// Where it enters and leaves the volume's box; `None` where it misses it.
    pub interval: Option<[f64; 2]>,
    /// World positions of both.
    pub ends: Option<[[f64; 3]; 2]>,
    /// The walk, from front to back.
    pub segments: Vec<RaySegment>,
    /// Segments of a walk so long that they were not written down; their colour is in `color`.
    pub untold: usize,
    /// Samples of the volume that the walk took.
    pub samples: u32,
    /// How often the technique bent the ray. Distances then count along its way.
    pub bends: u32,
    /// What the ray shows, before what is behind; the fourth is its opacity.
    pub color: [f64; 4],
    /// What is behind.
    pub behind: [f64; 4],
    /// What the ray shows, over what is behind: the pixel.
    pub over: [f64; 4],
    /// The pixel as it was stored in the picture that was drawn with it.
    pub picture: [f64; 4],
    /// Where what it shows is, by the technique: a hit, or where half of the light is gone.
    pub depth: Option<f64>,
    /// The probe there; `None` where there is no such place, and for bent rays.
    pub hit: Option<Probe>,
    /// The probe in the middle of the segment that contributes most; `None` as above.
    pub strongest: Option<Probe>,
    /// What the ray meets in float64; `None` where it misses the volume, or was not asked for or not covered.
    pub reference: Option<Profile>,
    /// Why there is no reference.
    pub no_reference: Option<String>,
}

impl RayStudy {
    /// The ray of a session's pixel in the session's view. `pixel` is a place in the picture, from the top left; the ray
    /// is that through the middle of the pixel there.
    ///
    /// # Errors
    /// As [`RayTracer::of`] and [`RayTracer::study`].
    pub fn of(session: &Session, pixel: [f64; 2]) -> Result<Self, Findings> {
        RayTracer::of(session)?.study(session.view(), pixel, &RayOptions::default())
    }

    /// The sum of what segments contribute, and one less the transmittance behind the last.
    #[must_use]
    pub fn sum(&self) -> [f64; 4] {
        let mut sum = [0.0; 4];
        for segment in &self.segments {
            for (sum, value) in sum.iter_mut().zip(segment.contribution) {
                *sum += value;
            }
        }
        sum[3] = 1.0 - self.segments.last().map_or(1.0, |it| it.transmittance[1]);
        sum
    }

    /// The largest difference of a component of the pixel to the reference's.
    #[must_use]
    pub fn error(&self) -> Option<f64> {
        let truth = self.reference.as_ref()?.over;
        let differences = self.over.iter().zip(truth).map(|(a, b)| (a - b).abs());
        Some(differences.fold(0.0, f64::max))
    }

    /// The taken segment that changes the colour most.
    #[must_use]
    pub fn strongest_segment(&self) -> Option<&RaySegment> {
        self.segments
            .iter()
            .filter(|segment| segment.strength() > 0.0)
            .max_by(|a, b| a.strength().total_cmp(&b.strength()))
    }
}

/// Studies rays of a session's picture, one after the other: what does not change between two is made once.
pub struct RayTracer {
    runner: Runner,
    installation: Option<Installation>,
    scene: Scene,
    node: String,
    shaders: ShaderLibrary,
    limits: Limits,
    /// The reference's scene, for the view that it was made for.
    truth: Option<(View, Result<volgraph_reference::Scene, String>)>,
}

impl RayTracer {
    /// For a session's graph as it is now, on its device, with what it holds there already.
    ///
    /// # Errors
    /// `no-raycast`, and what the device refuses.
    pub fn of(session: &Session) -> Result<Self, Findings> {
        let node = raycast_of(session.plan())?;
        let mut scene = session.scene().clone();
        let edge = |port: &str| EdgeDesc {
            from: format!("{node}.{port}"),
            name_place: Place::whole_file(&scene.path),
            place: Place::whole_file(&scene.path),
        };
        let outputs = ["color", "trace"].map(|port| (port.to_owned(), edge(port)));
        scene.desc.outputs = IndexMap::from(outputs);
        let gpu = session.gpu();
        let shaders = scene.shader_library(gpu.capabilities());
        let limits = session.options().limits(gpu);
        let mut tracer = Self {
            runner: Runner::new(Arc::clone(gpu)),
            installation: None,
            scene,
            node,
            shaders,
            limits,
            truth: None,
        };
        let view = *session.view();
        let plan = tracer.plan(&view, [0, 0])?;
        let shared = Some(session.installation());
        tracer.installation = Some(tracer.runner.prepare(Arc::new(plan), &view, shared)?);
        Ok(tracer)
    }

    /// The ray through the middle of the pixel at a place in the picture of a view, from the top left.
    ///
    /// # Errors
    /// `pixel-outside`, and what the device refuses.
    pub fn study(
        &mut self,
        view: &View,
        pixel: [f64; 2],
        options: &RayOptions,
    ) -> Result<RayStudy, Findings> {
        let pixel = inside(pixel, view.size)?;
        let plan = Arc::new(self.plan(view, pixel)?);
        let before = self.installation.as_ref();
        let mut installation = self.runner.prepare(Arc::clone(&plan), view, before)?;
        self.runner.frame(&mut installation, view)?;
        let id = traced(&plan)?;
        let trace = self.colors(&installation, "trace")?.1;
        let ([width, _], picture) = self.colors(&installation, "color")?;
        self.installation = Some(installation);
        let [x, y] = pixel.map(|at| at as usize);
        let stored = picture.get(y * width as usize + x).copied();
        let node = plan.context(id, view, None);
        let mut study = study(&node, view, pixel, &trace)?;
        study.picture = stored.unwrap_or_default().map(f64::from);
        if options.with_reference {
            match self.profile(&node, view, pixel, options) {
                Ok(profile) => study.reference = profile,
                Err(why) => study.no_reference = Some(why),
            }
        }
        Ok(study)
    }

    /// The plan that writes down the ray of a pixel.
    fn plan(&self, view: &View, [x, y]: [u32; 2]) -> Result<Plan, Findings> {
        let pixel = ParamValue::Vector(vec![f64::from(x), f64::from(y)]);
        let mut sets = vec![self.set("trace_pixel", pixel)];
        let given = self.scene.desc.nodes.get(&self.node);
        let stage = given.and_then(|node| node.params.get("stage"));
        if stage.is_none_or(|stage| stage.value == ParamValue::Text("auto".to_owned())) {
            // Both draw the same, and measuring which is faster takes longer than either.
            sets.push(self.set("stage", ParamValue::Text("compute".to_owned())));
        }
        let scene = self.scene.with_sets(&sets)?;
        scene.plan(&self.shaders, &self.limits, view.size, false)
    }

    fn set(&self, name: &str, value: ParamValue) -> ParamOverride {
        ParamOverride {
            target: self.node.clone(),
            is_slot: false,
            name: name.to_owned(),
            typed: format!("{}.{name}={value}", self.node),
            value,
        }
    }

    fn colors(
        &self,
        installation: &Installation,
        output: &str,
    ) -> Result<([u32; 2], Vec<[f32; 4]>), Findings> {
        let texels = self.runner.read(installation, output)?;
        let [width, height, _] = texels.extent;
        match texels.values {
            TexelValues::Colors(values) => Ok(([width, height], values)),
            _ => Err(Finding::error("output", format!("output `{output}` has no colours")).into()),
        }
    }

    fn profile(
        &mut self,
        node: &NodeContext<'_>,
        view: &View,
        pixel: [u32; 2],
        options: &RayOptions,
    ) -> Result<Option<Profile>, String> {
        let is_current = self.truth.as_ref().is_some_and(|(of, _)| of == view);
        if !is_current {
            let scene = raycast_scene(node, view).map_err(|finding| finding.message);
            self.truth = Some((*view, scene));
        }
        match &self.truth {
            Some((_, Ok(scene))) => profile(scene, pixel, options.tolerance, options.points)
                .map_err(|error| error.to_string()),
            Some((_, Err(why))) => Err(why.clone()),
            None => Ok(None),
        }
    }
}

/// The raycast that makes the output `color`, or else the last one behind it.
fn raycast_of(plan: &Plan) -> Result<String, Findings> {
    let view = plan.view();
    let output = plan.graph.outputs.get("color").map(|link| link.node);
    let behind = plan.order.iter().rev().copied();
    output
        .into_iter()
        .chain(behind)
        .map(|id| plan.context(id, &view, None))
        .find(|node| node.kind_name() == Raycast.name())
        .map(|node| node.name().to_owned())
        .ok_or_else(|| {
            Finding::error(
                "no-raycast",
                "no `raycast` draws this picture, and the walk of no other kind can be written down",
            )
            .help("name a graph whose output `color` comes from a `raycast`")
            .into()
        })
}

fn traced(plan: &Plan) -> Result<NodeId, Findings> {
    let link = plan.graph.outputs.get("trace").map(|link| link.node);
    link.ok_or_else(|| Finding::error("no-raycast", "the raycast writes no trace").into())
}

/// The pixel at a place in a picture.
fn inside(place: [f64; 2], size: [u32; 2]) -> Result<[u32; 2], Findings> {
    let [x, y] = place;
    let [width, height] = size;
    let is_inside = (0.0..f64::from(width)).contains(&x) && (0.0..f64::from(height)).contains(&y);
    if !is_inside {
        let message = format!("the pixel {x}, {y} is not in a picture of {width}x{height}");
        return Err(Finding::error("pixel-outside", message)
            .help("pixels count from 0 at the top left")
            .into());
    }
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "it is in the picture"
    )]
    let pixel = place.map(|at| at as u32);
    Ok(pixel)
}

/// The study of what a raycast wrote down.
fn study(
    node: &NodeContext<'_>,
    view: &View,
    pixel: [u32; 2],
    texels: &[[f32; 4]],
) -> Result<RayStudy, Findings> {
    let ray = rays(view).ray(pixel[0], pixel[1]);
    let volume = placement::volume(node, "volume")?;
    let interval = interval(volume.grid(), &ray).map(|(near, far)| [near, far]);
    let near = interval.map_or(0.0, |interval| interval[0]);
    let encoding = Encoding::choose(volume, node.text("volume_storage"));
    let Trace {
        segments,
        untold,
        color,
        behind,
        depth,
        bends,
        samples,
    } = read(texels, interval, encoding.reference);
    let open = if bends > 0 { 0.0 } else { 1.0 - color[3] };
    let mut study = RayStudy {
        node: node.name().to_owned(),
        technique: node.slot("technique").to_owned(),
        pixel,
        origin: ray.origin.to_array(),
        direction: ray.direction.to_array(),
        interval,
        ends: interval.map(|ends| ends.map(|at| ray.at(at).to_array())),
        segments,
        untold,
        samples,
        bends,
        color,
        behind,
        over: std::array::from_fn(|i| color[i] + open * behind[i]),
        picture: [0.0; 4],
        depth: depth.map(|depth| near + depth),
        hit: None,
        strongest: None,
        reference: None,
        no_reference: None,
    };
    if bends == 0 {
        let probe = |distance: f64| Probe::of(node, ray.at(distance));
        study.hit = study.depth.map(probe).transpose()?;
        let middle = study
            .strongest_segment()
            .map(|it| 0.5 * (it.start + it.end));
        study.strongest = middle.map(probe).transpose()?;
    }
    Ok(study)
}

impl Probe {
    /// The volume of a session's raycast at a world position.
    ///
    /// # Errors
    /// `no-raycast`.
    pub fn at(session: &Session, world: [f64; 3]) -> Result<Self, Findings> {
        let plan = session.plan();
        let name = raycast_of(plan)?;
        let view = *session.view();
        let mut nodes = plan.order.iter().map(|id| plan.context(*id, &view, None));
        let node = nodes.find(|node| node.name() == name);
        let node = node.ok_or_else(|| Finding::error("no-raycast", "the raycast does not run"))?;
        Ok(Self::of(&node, DVec3::from_array(world))?)
    }
}
