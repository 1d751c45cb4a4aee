//! What a process and a device hold.

use std::fs;

use serde::Serialize;

use crate::session::Session;

/// Memory, in bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Memory {
    /// The most that the process has held in the main memory; `None` where the system does not say. A software adapter's
    /// device memory is in there too.
    pub peak_resident_bytes: Option<u64>,
    /// Textures and buffers of the plan on the device.
    pub device_bytes: u64,
}

/// The most bytes that this process has held in the main memory: `VmHWM` of Linux, `None` on other systems.
#[must_use]
pub fn peak_resident_bytes() -> Option<u64> {
    parse_peak(&fs::read_to_string("/proc/self/status").ok()?)
}

fn parse_peak(status: &str) -> Option<u64> {
    let line = status
        .lines()
        .find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kib = line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()?;
    kib.checked_mul(1024)
}

/// Bytes of the textures and buffers that a session's plan allocates.
#[must_use]
pub fn device_bytes(session: &Session) -> u64 {
    let allocations = session.plan().allocations.iter();
    allocations
        .map(|allocation| allocation.resource.bytes())
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_peak_is_read_from_the_status() {
        assert_eq!(
            parse_peak("Name:\tx\nVmHWM:\t   1200 kB\nVmRSS:\t 7 kB\n"),
            Some(1200 * 1024)
        );
        assert_eq!(parse_peak("Name:\tx\n"), None);
        assert_eq!(parse_peak("VmHWM:\tmany kB\n"), None);
        #[cfg(target_os = "linux")]
        assert!(peak_resident_bytes().unwrap() > 100_000);
    }
}
