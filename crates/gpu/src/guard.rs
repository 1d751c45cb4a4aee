//! The counters of guarded shaders: bound to their pipelines, cleared before a frame's first use, read after it.

use std::collections::BTreeSet;
use std::sync::Arc;

use volgraph_graph::NodeId;
use volgraph_report::Findings;
use volgraph_shader::Guarded;
use wgpu::{
    BindGroupLayoutEntry, BindingType, Buffer, BufferBindingType, BufferDescriptor, BufferUsages,
    CommandEncoder, ShaderStages,
};

use crate::device::Gpu;
use crate::error::GpuError;
use crate::readback::map;

/// What watches the loops and loads of one shader module.
#[derive(Debug)]
pub(crate) struct Guard {
    /// Without its module, which the device has.
    guarded: Guarded,
    pub group: u32,
    pub binding: u32,
    pub counters: Buffer,
}

impl Guard {
    pub(crate) fn new(gpu: &Gpu, guarded: Guarded, what: &str) -> Result<Self, GpuError> {
        let (group, binding) = guarded.binding.unwrap_or_default();
        let counters = gpu.scoped(what, 0, || {
            gpu.device.create_buffer(&BufferDescriptor {
                label: Some("guard counters"),
                size: guarded.buffer_bytes(),
                usage: BufferUsages::STORAGE | BufferUsages::COPY_DST | BufferUsages::COPY_SRC,
                mapped_at_creation: false,
            })
        })?;
        Ok(Self {
            guarded,
            group,
            binding,
            counters,
        })
    }

    pub(crate) fn layout_entry(&self, visibility: ShaderStages) -> BindGroupLayoutEntry {
        BindGroupLayoutEntry {
            binding: self.binding,
            visibility,
            ty: BindingType::Buffer {
                ty: BufferBindingType::Storage { read_only: false },
                has_dynamic_offset: false,
                min_binding_size: None,
            },
            count: None,
        }
    }
}

/// The guards that some commands use, each with the nodes that share it.
#[derive(Debug, Default)]
pub(crate) struct Watched(Vec<(Arc<Guard>, BTreeSet<NodeId>)>);

/// What went wrong, and the nodes in whose shader it did.
pub(crate) type Found = Vec<(BTreeSet<NodeId>, Findings)>;

impl Watched {
    /// Takes note of a node's guard, and clears its counters before its first use.
    pub(crate) fn note(&mut self, guard: &Arc<Guard>, id: NodeId, encoder: &mut CommandEncoder) {
        let known = self.0.iter_mut();
        let mut known = known.filter(|(known, _)| Arc::ptr_eq(known, guard));
        if let Some((_, nodes)) = known.next() {
            nodes.insert(id);
        } else {
            encoder.clear_buffer(&guard.counters, 0, None);
            self.0.push((Arc::clone(guard), [id].into()));
        }
    }

    /// Makes the counters readable; the last command. `None` where nothing is watched.
    pub(crate) fn resolve(&self, gpu: &Gpu, encoder: &mut CommandEncoder) -> Option<Buffer> {
        let bytes: u64 = self.0.iter().map(|(guard, _)| guard.counters.size()).sum();
        if bytes == 0 {
            return None;
        }
        let readable = gpu.device.create_buffer(&BufferDescriptor {
            label: Some("guard counters"),
            size: bytes,
            usage: BufferUsages::COPY_DST | BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        let mut at = 0;
        for (guard, _) in &self.0 {
            let size = guard.counters.size();
            encoder.copy_buffer_to_buffer(&guard.counters, 0, &readable, at, size);
            at += size;
        }
        Some(readable)
    }

    /// What the counters say; waits for the device.
    pub(crate) fn findings(&self, gpu: &Gpu, readable: &Buffer) -> Result<Found, GpuError> {
        let bytes = map(gpu, readable, readable.size())?;
        let counters: Vec<u32> = bytes
            .chunks_exact(4)
            .map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]))
            .collect();
        let mut rest = counters.as_slice();
        let mut found = Found::new();
        for (guard, nodes) in &self.0 {
            let count = guard.guarded.sites.len() + 1;
            let (own, others) = rest.split_at(count.min(rest.len()));
            let findings = guard.guarded.findings(own);
            if !findings.is_empty() {
                found.push((nodes.clone(), findings));
            }
            rest = others;
        }
        Ok(found)
    }
}
