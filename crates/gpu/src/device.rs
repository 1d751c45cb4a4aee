//! An open device and what it can do.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use naga::valid::Capabilities;
use volgraph_graph::{Limits, ResourceKind};
use wgpu::{Adapter, Device, DeviceDescriptor, Features, Instance, Queue};

use crate::adapter::{AdapterChoice, AdapterSummary, choose};
use crate::error::GpuError;

/// A device and its queue.
#[derive(Debug)]
pub struct Gpu {
    pub(crate) device: Device,
    pub(crate) queue: Queue,
    summary: AdapterSummary,
    instance: Instance,
    handle: Adapter,
    /// What the device said outside of any error scope, and whether it is lost.
    faults: Arc<Faults>,
}

/// wgpu's own handles of a device, for a window that shows what is drawn on it without a copy over the host.
#[derive(Clone, Debug)]
pub struct SharedDevice {
    /// What the adapter was found in.
    pub instance: Instance,
    /// The adapter.
    pub adapter: Adapter,
    /// The device.
    pub device: Device,
    /// Its queue.
    pub queue: Queue,
}

#[derive(Debug, Default)]
struct Faults {
    lost: Mutex<Option<String>>,
    error: Mutex<Option<String>>,
}

fn locked<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Gpu {
    /// Opens the adapter of that choice, with all of its limits and those optional features that volgraph uses.
    ///
    /// # Errors
    /// [`GpuError::NoAdapter`], which says what to install, and [`GpuError::NoDevice`].
    pub fn open(choice: &AdapterChoice) -> Result<Self, GpuError> {
        let (summary, adapter, instance) = choose(choice)?;
        let wanted = Features::FLOAT32_FILTERABLE
            | Features::FLOAT32_BLENDABLE
            | Features::TIMESTAMP_QUERY
            | Features::TIMESTAMP_QUERY_INSIDE_ENCODERS
            | Features::TEXTURE_FORMAT_16BIT_NORM;
        let descriptor = DeviceDescriptor {
            label: Some("volgraph"),
            required_features: adapter.features() & wanted,
            required_limits: adapter.limits(),
            ..Default::default()
        };
        let (device, queue) =
            pollster::block_on(adapter.request_device(&descriptor)).map_err(|error| {
                GpuError::NoDevice {
                    adapter: summary.to_string(),
                    reason: error.to_string(),
                }
            })?;
        let faults = Arc::new(Faults::default());
        let lost = Arc::clone(&faults);
        device.set_device_lost_callback(move |reason, message| {
            *locked(&lost.lost) = Some(format!("{reason:?} {message}"));
        });
        let uncaptured = Arc::clone(&faults);
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            locked(&uncaptured.error).get_or_insert_with(|| error.to_string());
        }));
        Ok(Self {
            device,
            queue,
            summary,
            instance,
            handle: adapter,
            faults,
        })
    }

    /// The adapter.
    #[must_use]
    pub fn adapter(&self) -> &AdapterSummary {
        &self.summary
    }

    /// The device for a window to draw with.
    #[must_use]
    pub fn shared(&self) -> SharedDevice {
        SharedDevice {
            instance: self.instance.clone(),
            adapter: self.handle.clone(),
            device: self.device.clone(),
            queue: self.queue.clone(),
        }
    }

    /// How many objects of each kind are alive on the device, as wgpu counts them; empty where it does not.
    #[must_use]
    pub fn live_objects(&self) -> BTreeMap<&'static str, usize> {
        let Some(report) = self.instance.generate_report() else {
            return BTreeMap::new();
        };
        let hub = report.hub_report();
        [
            ("bind group layouts", hub.bind_group_layouts),
            ("bind groups", hub.bind_groups),
            ("buffers", hub.buffers),
            ("command buffers", hub.command_buffers),
            ("command encoders", hub.command_encoders),
            ("compute pipelines", hub.compute_pipelines),
            ("pipeline layouts", hub.pipeline_layouts),
            ("query sets", hub.query_sets),
            ("render pipelines", hub.render_pipelines),
            ("samplers", hub.samplers),
            ("shader modules", hub.shader_modules),
            ("texture views", hub.texture_views),
            ("textures", hub.textures),
        ]
        .into_iter()
        .map(|(kind, report)| (kind, report.num_kept_from_user))
        .collect()
    }

    /// Why the device is lost, if it is.
    #[must_use]
    pub fn lost(&self) -> Option<String> {
        locked(&self.faults.lost).clone()
    }

    /// Destroys the device, as a crash of its driver would. What was submitted before ends first, and no more than a few
    /// seconds are waited for it.
    pub fn destroy(&self) {
        self.device.destroy();
        // That the device is lost is told by a poll that finds nothing submitted, and another thread may submit until then.
        let start = Instant::now();
        while self.lost().is_none() && start.elapsed() < LONGEST_END {
            let _ = self.device.poll(wgpu::PollType::Wait {
                submission_index: None,
                timeout: Some(Duration::from_millis(100)),
            });
        }
    }

    /// What plans for this device may ask for.
    #[must_use]
    pub fn limits(&self) -> Limits {
        let limits = self.device.limits();
        let features = self.device.features();
        Limits {
            max_texture_1d: u64::from(limits.max_texture_dimension_1d),
            max_texture_2d: u64::from(limits.max_texture_dimension_2d),
            max_texture_3d: u64::from(limits.max_texture_dimension_3d),
            max_buffer_bytes: limits.max_buffer_size,
            float32_filterable: features.contains(Features::FLOAT32_FILTERABLE),
            float32_fast: self.summary.class == "software",
            float32_blendable: features.contains(Features::FLOAT32_BLENDABLE),
            storage_3d: self.summary.backend != "gl",
            shared_samplers: self.summary.backend != "gl",
            ..Limits::default()
        }
    }

    /// What shaders for this device may use.
    pub fn capabilities(&self) -> Capabilities {
        let mut capabilities = Capabilities::default();
        if self
            .device
            .features()
            .contains(Features::TEXTURE_FORMAT_16BIT_NORM)
        {
            capabilities |= Capabilities::STORAGE_TEXTURE_16BIT_NORM_FORMATS;
        }
        capabilities
    }

    /// Whether compute shaders must not have uniforms (see [`crate::bindings::with_uniforms_as_storage`]).
    pub(crate) fn uniforms_as_storage(&self) -> bool {
        self.summary.backend == "vulkan" && self.summary.name.contains("llvmpipe")
    }

    /// Whether each read of a uniform costs time: drivers on the processor check and broadcast it every time.
    pub(crate) fn reads_uniforms_slowly(&self) -> bool {
        self.summary.class == "software"
    }

    /// Whether command encoders can write timestamps that mean something. Drivers on the processor may write both ends of a
    /// compute pass after it (Mesa's llvmpipe keeps them with what is drawn, and computes at once); frame times say it all
    /// there.
    #[must_use]
    pub(crate) fn has_timestamps(&self) -> bool {
        if self.summary.class == "software" {
            return false;
        }
        let needed = Features::TIMESTAMP_QUERY | Features::TIMESTAMP_QUERY_INSIDE_ENCODERS;
        self.device.features().contains(needed)
    }

    /// What went wrong since the last call, if anything.
    pub(crate) fn take_fault(&self, what: &str) -> Result<(), GpuError> {
        if let Some(reason) = locked(&self.faults.lost).clone() {
            return Err(GpuError::Lost(reason));
        }
        match locked(&self.faults.error).take() {
            Some(reason) => Err(GpuError::Device {
                what: what.to_owned(),
                reason,
            }),
            None => Ok(()),
        }
    }

    /// Runs `work` and gives what the device refused in it as an error.
    pub(crate) fn scoped<T>(
        &self,
        what: &str,
        held_bytes: u64,
        work: impl FnOnce() -> T,
    ) -> Result<T, GpuError> {
        let memory = self.device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let validation = self.device.push_error_scope(wgpu::ErrorFilter::Validation);
        let internal = self.device.push_error_scope(wgpu::ErrorFilter::Internal);
        let value = work();
        if let Some(reason) = self.lost() {
            return Err(GpuError::Lost(reason));
        }
        let internal = pollster::block_on(internal.pop());
        let validation = pollster::block_on(validation.pop());
        let memory = pollster::block_on(memory.pop());
        if memory.is_some() {
            return Err(GpuError::OutOfMemory {
                what: what.to_owned(),
                bytes: held_bytes,
            });
        }
        match validation.or(internal) {
            Some(error) => Err(GpuError::Device {
                what: what.to_owned(),
                reason: error.to_string(),
            }),
            None => Ok(value),
        }
    }

    /// Makes a resource. A software device has the machine's own memory, and its drivers promise what is not there:
    /// one that is larger than all that is free is refused before it is asked for.
    pub(crate) fn allocate<T>(
        &self,
        resource: ResourceKind,
        held_bytes: u64,
        make: impl FnOnce() -> T,
    ) -> Result<T, GpuError> {
        let what = format!("allocating {resource:?}");
        let is_doubtful = self.summary.class == "software" && resource.bytes() > DOUBTFUL_BYTES;
        if is_doubtful && available_bytes().is_some_and(|free| resource.bytes() > free) {
            return Err(GpuError::OutOfMemory {
                what,
                bytes: held_bytes,
            });
        }
        self.scoped(&what, held_bytes, make)
    }

    /// Waits until everything submitted is done.
    ///
    /// # Errors
    /// [`GpuError::Lost`] and what the device refused.
    pub fn wait(&self) -> Result<(), GpuError> {
        let polled = self.device.poll(wgpu::PollType::wait_indefinitely());
        self.take_fault("waiting for the device")?;
        match polled {
            Ok(_) => Ok(()),
            Err(error) => Err(GpuError::Device {
                what: "waiting for the device".to_owned(),
                reason: error.to_string(),
            }),
        }
    }
}

/// How long the end of what is submitted is waited for when a device is destroyed.
const LONGEST_END: Duration = Duration::from_secs(5);

/// What is smaller is asked for without a look at the machine's memory, which takes time.
const DOUBTFUL_BYTES: u64 = 64 << 20;

/// Bytes of memory that programs can still have, where the system tells.
fn available_bytes() -> Option<u64> {
    let meminfo = std::fs::read_to_string("/proc/meminfo").ok()?;
    let line = meminfo
        .lines()
        .find_map(|line| line.strip_prefix("MemAvailable:"))?;
    let kib: u64 = line.split_whitespace().next()?.parse().ok()?;
    Some(kib * 1024)
}
