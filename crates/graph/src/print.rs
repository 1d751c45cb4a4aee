//! A plan as text, JSON and a DOT drawing.

use std::fmt::{self, Write};

use serde_json::{Value, json};

use crate::fingerprint::hex;
use crate::graph::NodeBody;
use crate::plan::Plan;
use crate::resource::ResourceKind;

/// What renderers disagree on, and what volgraph does: printed with every plan and stored in every picture.
pub const CONVENTIONS: &[(&str, &str)] = &[
    (
        "space",
        "samples at voxel centres; the box spans whole voxels, clamped in the outer half voxel, unless node_centred",
    ),
    (
        "world",
        "LPS: +x to the patient's left, +y to posterior, +z to superior",
    ),
    (
        "optical model",
        "emission and absorption; linear RGB and extinction in f32; opacity 1 is extinction 16 per reference length",
    ),
    (
        "scalar",
        "data units; a normalised transfer function spans the stored type's range, for floats the data's",
    ),
    (
        "steps",
        "in voxels of the smallest spacing; whole segments, exact tail; no jitter",
    ),
    (
        "early termination",
        "rays end where less than 1/4096 of the light behind could reach the eye, or the graph's own bound; 0 for never",
    ),
    (
        "color",
        "linear, premultiplied; PNG is sRGB-encoded, EXR is linear",
    ),
    (
        "depth",
        "world distance from the eye along the ray to what it shows: the surface that is hit, the extremum of a projection, or where the opacity reaches one half; infinite where there is no such place",
    ),
    (
        "not a number",
        "voxels that are not numbers are read as the smallest value, infinite ones as the nearest finite one; counted and reported",
    ),
];

impl Plan {
    /// The plan for people.
    #[must_use]
    pub fn to_text(&self) -> String {
        let mut text = String::new();
        // Writing to a String does not fail.
        let _ = self.write_text(&mut text);
        text
    }

    fn write_text(&self, out: &mut String) -> std::fmt::Result {
        writeln!(out, "size {}x{}", self.size[0], self.size[1])?;
        for node in self.graph.nodes.iter().filter(|node| node.is_source()) {
            if let NodeBody::Source(source) = &node.body {
                writeln!(out, "source {}: {}", node.name, source.summary())?;
            }
        }
        for (at, node) in self.nodes().iter().enumerate() {
            writeln!(out, "{}. {} ({})", at + 1, node.name, node.kind)?;
            if let Some(by) = &node.called_for_by {
                writeln!(out, "   called for by {by}")?;
            }
            for (port, writer) in &node.inputs {
                writeln!(out, "   in    {port} <- {writer}")?;
            }
            for (slot, choice) in &node.slots {
                writeln!(out, "   slot  {slot} = {choice}")?;
            }
            for (param, value) in &node.params {
                writeln!(out, "   param {param} = {value}")?;
            }
            for (entry, bindings) in &node.entries {
                writeln!(out, "   entry {entry}")?;
                for binding in bindings {
                    writeln!(
                        out,
                        "     @group({}) @binding({}) {} <- {}",
                        binding.group, binding.binding, binding.name, binding.source
                    )?;
                }
            }
            for output in &node.outputs {
                writeln!(
                    out,
                    "   out   {} -> allocation {}: {}",
                    output.port, output.allocation, output.resource
                )?;
            }
            if !node.follows_camera {
                writeln!(out, "   kept while the camera moves")?;
            }
        }
        if !self.culled.is_empty() {
            writeln!(out, "culled: {}", self.culled.join(", "))?;
        }
        let total: u64 = self
            .allocations
            .iter()
            .map(|allocation| allocation.resource.bytes())
            .sum();
        writeln!(
            out,
            "memory: {} allocations, {total} bytes",
            self.allocations.len()
        )?;
        for (name, link) in &self.graph.outputs {
            writeln!(
                out,
                "output {name} = {}.{}",
                self.graph.nodes[link.node].name, link.port
            )?;
        }
        for (what, convention) in CONVENTIONS {
            writeln!(out, "convention {what}: {convention}")?;
        }
        Ok(())
    }

    /// The plan for programs.
    #[must_use]
    pub fn to_json(&self) -> Value {
        let sources: serde_json::Map<String, Value> = self
            .graph
            .nodes
            .iter()
            .filter_map(|node| match &node.body {
                NodeBody::Source(source) => Some((
                    node.name.clone(),
                    json!({
                        "type": source.ty().to_string(),
                        "summary": source.summary(),
                        "digest": hex(&source.digest()),
                    }),
                )),
                NodeBody::Kind(_) => None,
            })
            .collect();
        let outputs: serde_json::Map<String, Value> = self
            .graph
            .outputs
            .iter()
            .map(|(name, link)| {
                (
                    name.clone(),
                    json!(format!(
                        "{}.{}",
                        self.graph.nodes[link.node].name, link.port
                    )),
                )
            })
            .collect();
        let conventions: serde_json::Map<String, Value> = CONVENTIONS
            .iter()
            .map(|(what, says)| ((*what).to_owned(), json!(says)))
            .collect();
        json!({
            "size": self.size,
            "sources": sources,
            "nodes": self.nodes(),
            "culled": self.culled,
            "allocations": self.allocations,
            "outputs": outputs,
            "conventions": conventions,
        })
    }

    /// The plan as a drawing, in the DOT language.
    #[must_use]
    pub fn to_dot(&self) -> String {
        let mut out = String::from(
            "digraph plan {\n  rankdir=LR;\n  node [shape=box, fontname=\"sans-serif\"];\n",
        );
        let quoted =
            |text: &str| format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\""));
        for id in &self.order {
            let node = &self.graph.nodes[*id];
            let style = if node.is_source() {
                "shape=ellipse"
            } else {
                "shape=box"
            };
            let label =
                quoted(&format!("{}\n{}", node.name, node.kind_name())).replace('\n', "\\n");
            out.push_str(&format!(
                "  {} [{style}, label={label}];\n",
                quoted(&node.name)
            ));
            for (port, link) in &node.inputs {
                let from = quoted(&self.graph.nodes[link.node].name);
                out.push_str(&format!(
                    "  {from} -> {} [label={}];\n",
                    quoted(&node.name),
                    quoted(port)
                ));
            }
        }
        for (name, link) in &self.graph.outputs {
            let output = quoted(&format!("output {name}"));
            out.push_str(&format!("  {output} [shape=plaintext];\n"));
            let from = quoted(&self.graph.nodes[link.node].name);
            out.push_str(&format!(
                "  {from} -> {output} [label={}];\n",
                quoted(&link.port)
            ));
        }
        out.push_str("}\n");
        out
    }
}

impl fmt::Display for ResourceKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Texture {
                dimensions,
                extent,
                format,
            } => {
                let extent: Vec<String> = extent
                    .iter()
                    .take(usize::from(*dimensions))
                    .map(u32::to_string)
                    .collect();
                let extent = extent.join("x");
                write!(f, "texture {extent} {format:?}, {} bytes", self.bytes())
            }
            Self::Buffer { bytes } => write!(f, "buffer, {bytes} bytes"),
        }
    }
}
