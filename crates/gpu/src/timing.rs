//! Time per node on the device, where it can write timestamps between passes.

use wgpu::{
    Buffer, BufferDescriptor, BufferUsages, CommandEncoder, QuerySet, QuerySetDescriptor, QueryType,
};

use crate::device::Gpu;
use crate::error::GpuError;
use crate::readback::map;

/// Timestamps before and after each node of one frame.
pub(crate) struct Timer {
    queries: QuerySet,
    resolved: Buffer,
    readable: Buffer,
    capacity: u32,
    written: u32,
}

impl Timer {
    /// For at most `nodes` nodes; `None` where the device writes no timestamps.
    pub(crate) fn new(gpu: &Gpu, nodes: usize) -> Option<Self> {
        if !gpu.has_timestamps() || nodes == 0 {
            return None;
        }
        let capacity = u32::try_from(nodes * 2)
            .ok()
            .filter(|count| *count <= wgpu::QUERY_SET_MAX_QUERIES)?;
        let bytes = u64::from(capacity) * 8;
        let buffer = |usage| {
            gpu.device.create_buffer(&BufferDescriptor {
                label: Some("timestamps"),
                size: bytes,
                usage,
                mapped_at_creation: false,
            })
        };
        Some(Self {
            queries: gpu.device.create_query_set(&QuerySetDescriptor {
                label: Some("timestamps"),
                ty: QueryType::Timestamp,
                count: capacity,
            }),
            resolved: buffer(BufferUsages::QUERY_RESOLVE | BufferUsages::COPY_SRC),
            readable: buffer(BufferUsages::COPY_DST | BufferUsages::MAP_READ),
            capacity,
            written: 0,
        })
    }

    /// Writes the time now; called before and after each node.
    pub(crate) fn mark(&mut self, encoder: &mut CommandEncoder) {
        if self.written < self.capacity {
            encoder.write_timestamp(&self.queries, self.written);
            self.written += 1;
        }
    }

    /// Makes the times readable; the last command of the frame.
    pub(crate) fn resolve(&self, encoder: &mut CommandEncoder) {
        if self.written > 0 {
            encoder.resolve_query_set(&self.queries, 0..self.written, &self.resolved, 0);
            encoder.copy_buffer_to_buffer(
                &self.resolved,
                0,
                &self.readable,
                0,
                u64::from(self.written) * 8,
            );
        }
    }

    /// Milliseconds of each node; waits for the device.
    pub(crate) fn milliseconds(&self, gpu: &Gpu) -> Result<Vec<f64>, GpuError> {
        if self.written == 0 {
            return Ok(Vec::new());
        }
        let bytes = map(gpu, &self.readable, u64::from(self.written) * 8)?;
        let period = f64::from(gpu.queue.get_timestamp_period()) * 1e-6;
        let ticks: Vec<u64> = bytes
            .chunks_exact(8)
            .map(|b| u64::from_le_bytes([b[0], b[1], b[2], b[3], b[4], b[5], b[6], b[7]]))
            .collect();
        #[expect(
            clippy::cast_precision_loss,
            reason = "a frame is shorter than 2^52 ticks"
        )]
        let milliseconds = ticks
            .chunks_exact(2)
            .map(|pair| pair[1].saturating_sub(pair[0]) as f64 * period);
        Ok(milliseconds.collect())
    }
}
