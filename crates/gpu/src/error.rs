//! What can go wrong on a device.

use volgraph_report::{Finding, Findings};

/// An error of this crate.
#[derive(Debug, thiserror::Error)]
pub enum GpuError {
    /// No adapter fits what was asked for.
    #[error("no adapter{asked}; found: {found}{}", NO_ADAPTER_HELP)]
    NoAdapter {
        /// What was asked for.
        asked: String,
        /// What there is.
        found: String,
    },
    /// The driver refused to make a device.
    #[error("the adapter {adapter} gave no device: {reason}")]
    NoDevice {
        /// Its name.
        adapter: String,
        /// What the driver said.
        reason: String,
    },
    /// The device is gone.
    #[error("the device is lost: {0}")]
    Lost(String),
    /// The device refused something.
    #[error("{what}: the device says: {reason}")]
    Device {
        /// What was being done.
        what: String,
        /// What the device said.
        reason: String,
    },
    /// Not enough memory.
    #[error(
        "{what}: out of device memory ({bytes} bytes held by volgraph); use a smaller picture, volume or storage format"
    )]
    OutOfMemory {
        /// What was being done.
        what: String,
        /// Bytes in the pools.
        bytes: u64,
    },
    /// There is no such output, or it cannot be read.
    #[error("output `{name}`: {reason}")]
    Output {
        /// Its name.
        name: String,
        /// Why not.
        reason: String,
    },
    /// A node kind refused to record.
    #[error(transparent)]
    Findings(#[from] Findings),
}

/// What people do who have no GPU.
const NO_ADAPTER_HELP: &str = "; on a machine without a GPU a software driver will do: on Debian or Ubuntu \
     `apt-get install mesa-vulkan-drivers` (Vulkan) or `apt-get install libegl1 libgl1-mesa-dri` (OpenGL)";

/// What people do whose device goes.
const LOST_HELP: &str = "the next frame opens it again; where it is lost each time, look for a shader that keeps it busy \
     for seconds";

impl From<Finding> for GpuError {
    fn from(finding: Finding) -> Self {
        Self::Findings(finding.into())
    }
}

impl From<GpuError> for Findings {
    fn from(error: GpuError) -> Self {
        match error {
            GpuError::Findings(findings) => findings,
            other => {
                let code = match &other {
                    GpuError::NoAdapter { .. } => "no-adapter",
                    GpuError::NoDevice { .. } => "no-device",
                    GpuError::Lost(_) => "device-lost",
                    GpuError::OutOfMemory { .. } => "out-of-memory",
                    GpuError::Output { .. } => "output",
                    GpuError::Device { .. } | GpuError::Findings(_) => "device",
                };
                let finding = Finding::error(code, other.to_string());
                match other {
                    GpuError::Lost(_) => finding.help(LOST_HELP).into(),
                    _ => finding.into(),
                }
            }
        }
    }
}
