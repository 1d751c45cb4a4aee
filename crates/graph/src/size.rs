//! Phase 6, size: every written output gets its extent, from absolute, view-relative and input-relative rules.

use std::collections::BTreeMap;

use volgraph_report::{Finding, Findings};
use volgraph_shader::BindingKind;

use crate::graph::{Graph, NodeId};
use crate::limits::Limits;
use crate::node_context::NodeContext;
use crate::resource::{Extent, ResourceDesc, ResourceKind, Size};

/// Resources by (node, output port).
pub type Resources = BTreeMap<(NodeId, String), ResourceKind>;

/// Sizes the wanted outputs of all nodes, writers first.
///
/// # Errors
/// What a kind refuses, and `over-limit`, with the limit's name, the size asked and what to do.
pub fn size(
    graph: &Graph,
    order: &[NodeId],
    view: [u32; 2],
    limits: &Limits,
) -> Result<Resources, Findings> {
    let mut findings = Findings::new();
    let mut resources = Resources::new();
    for &id in order {
        let Some(kind) = graph.nodes[id].kind() else {
            continue;
        };
        for port in kind.written(&graph.wanted(id)) {
            let context = NodeContext {
                resources: Some(&resources),
                ..NodeContext::new(graph, id, limits)
            };
            let described = kind.output(port, &context).and_then(|desc| {
                let resource = resource(&desc, view, &context)?;
                within_limits(&resource, port, &context)?;
                storage_fits(&resource, port, &context)?;
                Ok(resource)
            });
            if let Some(resource) = findings.take(described) {
                resources.insert((id, port.to_owned()), resource);
            } else {
                // Readers would only repeat the finding in other words.
                return Err(findings);
            }
        }
    }
    findings.into_result(resources)
}

fn resource(
    desc: &ResourceDesc,
    view: [u32; 2],
    node: &NodeContext<'_>,
) -> Result<ResourceKind, Finding> {
    Ok(match *desc {
        ResourceDesc::Buffer { bytes } => ResourceKind::Buffer { bytes },
        ResourceDesc::ViewBuffer { head, per_pixel } => ResourceKind::Buffer {
            bytes: head + per_pixel * u64::from(view[0]) * u64::from(view[1]),
        },
        ResourceDesc::Texture {
            dimensions,
            size,
            format,
        } => {
            let extent = match size {
                Size::Absolute(extent) => extent,
                Size::ViewRelative(factor) => {
                    let [width, height] = view.map(|n| scaled(n, factor));
                    [width, height, 1]
                }
                Size::InputRelative(port, factor) => match node.input_resource(port) {
                    Some(ResourceKind::Texture { extent, .. }) => extent.map(|n| scaled(n, factor)),
                    _ => {
                        return Err(node.error(
                            "missing-input",
                            format!("its output is as large as its input `{port}`, which is not a texture"),
                        ));
                    }
                },
            };
            ResourceKind::Texture {
                dimensions,
                extent,
                format,
            }
        }
    })
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "sizes are positive and below 2^32"
)]
fn scaled(n: u32, factor: f32) -> u32 {
    ((f64::from(n) * f64::from(factor)).round() as u32).max(1)
}

/// The shader has to store the format that the port has.
fn storage_fits(
    resource: &ResourceKind,
    port: &str,
    node: &NodeContext<'_>,
) -> Result<(), Finding> {
    let (ResourceKind::Texture { format, .. }, Some(binding)) =
        (resource, node.binding(&format!("{port}_out")))
    else {
        return Ok(());
    };
    match &binding.kind {
        // naga and wgpu call formats by the same names.
        BindingKind::StorageTexture {
            format: declared, ..
        } if format!("{declared:?}") != format!("{format:?}") => {
            let message = format!(
                "`{}` stores {declared:?}, but the output `{port}` is {format:?}",
                binding.name
            );
            Err(node
                .error("binding-type", message)
                .at(binding.place.clone()))
        }
        _ => Ok(()),
    }
}

fn within_limits(
    resource: &ResourceKind,
    port: &str,
    node: &NodeContext<'_>,
) -> Result<(), Finding> {
    let limits = node.limits();
    let (name, limit, asked, help) = match resource {
        ResourceKind::Buffer { bytes } => (
            "max_buffer_size",
            limits.max_buffer_bytes,
            *bytes,
            "use less data, or another adapter",
        ),
        ResourceKind::Texture {
            dimensions, extent, ..
        } => {
            let largest = u64::from(extent.iter().copied().max().unwrap_or(0));
            match dimensions {
                1 => (
                    "max_texture_dimension_1d",
                    limits.max_texture_1d,
                    largest,
                    "choose a smaller table",
                ),
                2 => (
                    "max_texture_dimension_2d",
                    limits.max_texture_2d,
                    largest,
                    "choose a smaller size",
                ),
                _ => (
                    "max_texture_dimension_3d",
                    limits.max_texture_3d,
                    largest,
                    "build its pyramid (`volgraph pyramid`) and draw it in bricks, `bricks(path: \"…\")`; or crop or downsample it",
                ),
            }
        }
    };
    if asked > limit {
        return Err(node
            .error(
                "over-limit",
                format!(
                    "output `{port}` asks for {asked}, over the device's limit {name} = {limit}"
                ),
            )
            .help(help));
    }
    let bytes = resource.bytes();
    if node.is_output(port) && bytes > limits.max_buffer_bytes {
        return Err(node
            .error(
                "over-limit",
                format!(
                    "output `{port}` takes {bytes} bytes, over the device's limit max_buffer_size = {} through which \
                     it is read back",
                    limits.max_buffer_bytes
                ),
            )
            .help("choose a smaller size"));
    }
    if bytes > limits.max_resource_bytes {
        return Err(node
            .error(
                "over-limit",
                format!(
                    "output `{port}` takes {bytes} bytes, over the memory limit of {} bytes for one resource",
                    limits.max_resource_bytes
                ),
            )
            .help("crop or downsample the volume, or choose a smaller picture or storage format"));
    }
    Ok(())
}

/// Pixels or voxels in an extent.
#[must_use]
pub fn texel_count(extent: Extent) -> u64 {
    extent
        .iter()
        .fold(1, |product, &n| product.saturating_mul(n.into()))
}
