//! Phase 3, check: types of edges, parameters, bindings, cycles. Everything wrong is collected.

mod cycle;

use std::fmt;

use serde::Serialize;
use volgraph_report::{Finding, Findings, did_you_mean};
use volgraph_shader::{Binding, BindingKind, TextureDim, TextureSample};

use crate::demand::Call;
use crate::graph::{Graph, Node, NodeBody, NodeId, Origin};
use crate::kind::PortType;
use crate::limits::Limits;
use crate::node_context::NodeContext;

/// What a binding of a shader is filled with: decided by its name alone.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum BindingSource {
    /// The uniform of [`crate::Lens`].
    Lens,
    /// The uniform of the camera's pose.
    Camera,
    /// The merged parameters, or the table of their rows.
    Params,
    /// A uniform that the node kind fills.
    Uniform(String),
    /// The resource at an input port.
    Input(String),
    /// The resource at an output port.
    Output(String),
    /// A sampler.
    Sampler(SamplerKind),
}

/// The binding of the parameters where they are a table.
pub(crate) const PARAMS_TABLE: &str = "params_table";

/// The samplers there are: all clamp to the edge but the last.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum SamplerKind {
    /// `linear_sampler`
    Linear,
    /// `nearest_sampler`
    Nearest,
    /// `repeat_sampler`: linear, repeats.
    Repeat,
}

impl fmt::Display for BindingSource {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Lens => f.write_str("frame lens"),
            Self::Camera => f.write_str("frame camera"),
            Self::Params => f.write_str("parameters"),
            Self::Uniform(name) => write!(f, "uniform {name}"),
            Self::Input(port) => write!(f, "input {port}"),
            Self::Output(port) => write!(f, "output {port}"),
            Self::Sampler(kind) => write!(f, "sampler {kind:?}"),
        }
    }
}

/// Finds what fills a binding of a node's shader.
///
/// # Errors
/// `unknown-binding` where nothing of the node has that name, `missing-input` where it is a port left open.
pub fn binding_source(node: &Node, binding: &Binding) -> Result<BindingSource, Finding> {
    let name = binding.name.as_str();
    let Some(kind) = node.kind() else {
        return Err(Finding::error("internal", "a source has no bindings"));
    };
    match &binding.kind {
        BindingKind::Uniform(_) => match name {
            "lens" => return Ok(BindingSource::Lens),
            "camera" => return Ok(BindingSource::Camera),
            "params" | PARAMS_TABLE => return Ok(BindingSource::Params),
            _ if kind.uniforms().contains(&name) => {
                return Ok(BindingSource::Uniform(name.to_owned()));
            }
            _ => {}
        },
        BindingKind::Sampler { .. } => match name {
            "linear_sampler" => return Ok(BindingSource::Sampler(SamplerKind::Linear)),
            "nearest_sampler" => return Ok(BindingSource::Sampler(SamplerKind::Nearest)),
            "repeat_sampler" => return Ok(BindingSource::Sampler(SamplerKind::Repeat)),
            _ => {}
        },
        _ => {
            if let Some(port) = name
                .strip_suffix("_out")
                .filter(|port| kind.outputs().iter().any(|o| o.name == *port))
            {
                return Ok(BindingSource::Output(port.to_owned()));
            }
            let is_own = kind.outputs().iter().any(|port| port.name == name)
                && matches!(binding.kind, BindingKind::Texture { .. });
            if is_own && !node.inputs.contains_key(name) {
                return Ok(BindingSource::Output(name.to_owned()));
            }
            if kind.inputs().iter().any(|port| port.name == name) {
                if node.inputs.contains_key(name) {
                    return Ok(BindingSource::Input(name.to_owned()));
                }
                return Err(Finding::error(
                    "missing-input",
                    format!(
                        "the shader of node `{}` reads its input `{name}`, which is not connected",
                        node.name
                    ),
                )
                .at(binding.place.clone()));
            }
        }
    }
    let known: Vec<String> = match &binding.kind {
        BindingKind::Uniform(_) => ["lens", "camera", "params"]
            .iter()
            .chain(kind.uniforms())
            .map(|name| (*name).to_owned())
            .collect(),
        BindingKind::Sampler { .. } => ["linear_sampler", "nearest_sampler", "repeat_sampler"]
            .map(str::to_owned)
            .to_vec(),
        _ => kind
            .inputs()
            .iter()
            .map(|port| port.name.to_owned())
            .chain(
                kind.outputs()
                    .iter()
                    .map(|port| format!("{}_out", port.name)),
            )
            .collect(),
    };
    Err(Finding::error(
        "unknown-binding",
        format!(
            "nothing fills the binding `{name}` for a node of kind `{}`",
            kind.name()
        ),
    )
    .at(binding.place.clone())
    .help_opt(did_you_mean(name, known.iter().map(String::as_str))))
}

/// Checks the whole graph, nodes that nothing needs included.
///
/// # Errors
/// `type-mismatch`, `unknown-param`, `bad-param`, `unknown-binding`, `binding-type`, `missing-input`, `cycle`.
pub fn check(graph: &Graph) -> Result<(), Findings> {
    let mut findings = Findings::new();
    for (id, node) in graph.nodes.iter().enumerate() {
        check_types(graph, node, &mut findings);
        check_demanded(graph, node, &mut findings);
        check_params(graph, id, &mut findings);
        check_param_rows(graph, id, &mut findings);
        if let Some(program) = &node.program {
            for binding in program.used() {
                if let Some(source) = findings.take(binding_source(node, binding)) {
                    findings.take(check_binding(node, binding, &source));
                }
            }
        }
    }
    for (name, link) in &graph.outputs {
        let writer = &graph.nodes[link.node];
        if writer.is_source() {
            let message = format!(
                "output `{name}` is the source `{}`; only what a node writes is an output",
                writer.name
            );
            let finding = Finding::error("type-mismatch", message)
                .help("name a node and its port, such as `image.color`");
            findings.push(match &link.place {
                Some(place) => finding.at(place.clone()),
                None => finding,
            });
        }
    }
    if let Some(finding) = cycle::cycle(graph) {
        findings.push(finding);
    }
    findings.into_result(())
}

/// Whether the shader declares a binding as what its port carries.
fn check_binding(node: &Node, binding: &Binding, source: &BindingSource) -> Result<(), Finding> {
    let Some(kind) = node.kind() else {
        return Ok(());
    };
    let (ty, is_read) = match source {
        BindingSource::Input(name) => (
            kind.inputs()
                .iter()
                .find(|port| port.name == name)
                .map(|port| port.ty),
            true,
        ),
        BindingSource::Output(name) => (
            kind.outputs()
                .iter()
                .find(|port| port.name == name)
                .map(|port| port.ty),
            // What an earlier pass of the node left there.
            matches!(binding.kind, BindingKind::Texture { .. }),
        ),
        _ => return Ok(()),
    };
    let Some(ty) = ty else { return Ok(()) };
    let wanted = match dimension(ty) {
        Some(dim) => (dim, is_read),
        // Buffers and what stays on the CPU have no texture; a shader cannot bind the latter at all.
        None if matches!(binding.kind, BindingKind::StorageBuffer { .. })
            && matches!(ty, PortType::Mesh | PortType::Buffer) =>
        {
            return Ok(());
        }
        None => {
            let message = format!(
                "the port `{}` carries a {ty}, which no binding can read",
                binding.name
            );
            return Err(Finding::error("binding-type", message).at(binding.place.clone()));
        }
    };
    let is_whole = ty == PortType::LabelTexture;
    let declared = match &binding.kind {
        BindingKind::Texture {
            dim,
            sample: TextureSample::Float { .. },
            multisampled: false,
        } if !is_whole => Some((*dim, true)),
        BindingKind::Texture {
            dim,
            sample: TextureSample::Uint,
            multisampled: false,
        } if is_whole => Some((*dim, true)),
        BindingKind::StorageTexture { dim, .. } => Some((*dim, false)),
        _ => None,
    };
    if declared == Some(wanted) {
        return Ok(());
    }
    let axes = match wanted.0 {
        TextureDim::D1 => "1d",
        TextureDim::D2 => "2d",
        _ => "3d",
    };
    let form = if is_read {
        let texel = if is_whole { "u32" } else { "f32" };
        format!("texture_{axes}<{texel}>")
    } else {
        format!("texture_storage_{axes}<…, write>")
    };
    Err(Finding::error(
        "binding-type",
        format!(
            "`{}` is a {ty} of node `{}`, and declared as something else",
            binding.name, node.name
        ),
    )
    .at(binding.place.clone())
    .help(format!("declare it as `{form}`")))
}

/// The texture that a port's resource is; `None` for what is no texture.
fn dimension(ty: PortType) -> Option<TextureDim> {
    match ty {
        // A table over one scalar is one row: 1D textures do not work on GL (wgpu 30).
        PortType::Table1d => Some(TextureDim::D2),
        PortType::Color
        | PortType::Scalar2d
        | PortType::Vector2d
        | PortType::Trace
        | PortType::Table2d
        | PortType::Pieces
        | PortType::ImageTexture
        | PortType::DistanceMap
        | PortType::StrideMap
        | PortType::Spans
        | PortType::LightGrid => Some(TextureDim::D2),
        PortType::Table3d
        | PortType::BrickRanges
        | PortType::BrickDetails
        | PortType::VolumeTexture
        | PortType::BrickPool
        | PortType::PageTable
        | PortType::ColorVolume
        | PortType::GradientTexture
        | PortType::LabelTexture => Some(TextureDim::D3),
        PortType::Volume
        | PortType::Transfer
        | PortType::Image
        | PortType::Segments
        | PortType::Mesh
        | PortType::Buffer => None,
    }
}

/// Whether what the file connects to a demanded port is made of the node's own inputs. The
/// table of another transfer function would be read as this one's, and nobody would see why the picture is wrong.
fn check_demanded(graph: &Graph, node: &Node, findings: &mut Findings) {
    let Some(kind) = node.kind() else { return };
    for port in kind.inputs() {
        let Some(link) = node.inputs.get(port.name) else {
            continue;
        };
        let writer = &graph.nodes[link.node];
        let writer_kind = writer.kind().map(AsRef::as_ref);
        let Some(call) = Call::new(port.requirement, node, writer_kind) else {
            continue;
        };
        let (Some(place), true) = (&link.place, writer.kind_name() == call.kind) else {
            continue;
        };
        for (theirs, mine) in &call.inputs {
            let end = |node: &Node, port: &str| {
                node.inputs
                    .get(port)
                    .map(|link| (link.node, link.port.clone()))
            };
            // What a writer does without it is not made of.
            if writer.inputs.contains_key(theirs) && end(writer, theirs) != end(node, mine) {
                let message = format!(
                    "`{}` is made of another `{theirs}` than the `{mine}` of node `{}`",
                    writer.name, node.name
                );
                findings.push(
                    Finding::error("input-mismatch", message)
                        .at(place.clone())
                        .help(format!(
                            "connect both to the same source, or leave `{}` open",
                            port.name
                        )),
                );
            }
        }
    }
}

fn check_types(graph: &Graph, node: &Node, findings: &mut Findings) {
    let Some(kind) = node.kind() else { return };
    for (name, link) in &node.inputs {
        let Some(port) = kind.inputs().iter().find(|port| port.name == name) else {
            continue;
        };
        let writer = &graph.nodes[link.node];
        let given = writer
            .output_types()
            .into_iter()
            .find(|(name, _)| *name == link.port)
            .map(|(_, ty)| ty);
        if given != Some(port.ty) {
            let given = given.map_or_else(|| "nothing".to_owned(), |ty| ty.to_string());
            let finding = Finding::error(
                "type-mismatch",
                format!(
                    "input `{name}` of node `{}` takes {}, but `{}` gives {given}",
                    node.name, port.ty, writer.name
                ),
            );
            findings.push(match &link.place {
                Some(place) => finding.at(place.clone()),
                None => finding,
            });
        }
    }
}

fn check_params(graph: &Graph, id: NodeId, findings: &mut Findings) {
    let node = &graph.nodes[id];
    if node.is_source() {
        return;
    }
    let specs = node.specs();
    for (name, given) in &node.given {
        match specs.iter().find(|spec| spec.name == *name) {
            Some(spec) => {
                if let Err(reason) = spec.check(&given.value) {
                    let finding = Finding::error(
                        "bad-param",
                        format!("parameter `{name}` of node `{}`: {reason}", node.name),
                    );
                    findings.push(match &spec.place {
                        Some(place) => finding
                            .at(given.place.clone())
                            .related(place.clone(), "declared here"),
                        None => finding.at(given.place.clone()),
                    });
                }
            }
            None if matches!(node.origin, Origin::File(_)) => {
                findings.push(
                    Finding::error(
                        "unknown-param",
                        format!("node `{}` has no parameter `{name}`", node.name),
                    )
                    .at(given.name_place.clone())
                    .help_opt(did_you_mean(
                        name,
                        specs.iter().map(|spec| spec.name.as_str()),
                    )),
                );
            }
            None => {}
        }
    }
}

/// Rows are for the shader: what the kind itself reads is one for all of them.
fn check_param_rows(graph: &Graph, id: NodeId, findings: &mut Findings) {
    let node = &graph.nodes[id];
    let (Some(kind), Some(program)) = (node.kind(), &node.program) else {
        return;
    };
    let specs = program.module.params();
    let own = kind.params();
    let limits = Limits::default();
    let context = NodeContext::new(graph, id, &limits);
    for (name, given) in kind.param_rows(&context).into_iter().flatten() {
        let Some(spec) = specs.iter().find(|spec| spec.name == *name) else {
            let is_own = own.iter().any(|spec| spec.name == *name);
            let message = if is_own {
                format!(
                    "`{name}` of node `{}` is the same for all labels",
                    node.name
                )
            } else {
                format!(
                    "the shader of node `{}` has no parameter `{name}`",
                    node.name
                )
            };
            let help = if is_own {
                Some("set it in the graph".to_owned())
            } else {
                did_you_mean(name, specs.iter().map(|spec| spec.name.as_str()))
            };
            findings.push(
                Finding::error("unknown-param", message)
                    .at(given.name_place.clone())
                    .help_opt(help),
            );
            continue;
        };
        if let Err(reason) = spec.check(&given.value) {
            let message = format!("parameter `{name}` of node `{}`: {reason}", node.name);
            let finding = Finding::error("bad-param", message).at(given.place.clone());
            findings.push(match &spec.place {
                Some(place) => finding.related(place.clone(), "declared here"),
                None => finding,
            });
        }
    }
}

impl Node {
    /// Whether it is a loaded source.
    #[must_use]
    pub fn is_source(&self) -> bool {
        matches!(self.body, NodeBody::Source(_))
    }
}
