//! Which adapter: by name, backend or class, else the best there is.

use std::fmt;

use serde::Serialize;
use wgpu::{Adapter, Backend, Backends, DeviceType, Instance, InstanceDescriptor};

use crate::GpuError;

/// What the user wants: nothing (the best; GL only where there is nothing else), a backend (`vulkan`, `gl`, `metal`, `dx12`), a class (`discrete`,
/// `integrated`, `virtual`, `software`) or a part of the name; several words must all fit.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct AdapterChoice(Option<String>);

impl AdapterChoice {
    /// From the words on the command line.
    #[must_use]
    pub fn new(words: Option<&str>) -> Self {
        Self(words.map(str::to_owned))
    }

    fn fits(&self, summary: &AdapterSummary) -> bool {
        let haystack = summary.to_string().to_lowercase();
        self.0
            .as_deref()
            .unwrap_or("")
            .split_whitespace()
            .all(|word| haystack.contains(&word.to_lowercase()))
    }
}

/// An adapter, as people know it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct AdapterSummary {
    /// Its name.
    pub name: String,
    /// `vulkan`, `gl`, `metal` or `dx12`.
    pub backend: String,
    /// `discrete`, `integrated`, `virtual`, `software` or `other`.
    pub class: String,
    /// The driver and its version.
    pub driver: String,
}

impl AdapterSummary {
    pub(crate) fn of(adapter: &Adapter) -> Self {
        let info = adapter.get_info();
        let class = match info.device_type {
            DeviceType::DiscreteGpu => "discrete",
            DeviceType::IntegratedGpu => "integrated",
            DeviceType::VirtualGpu => "virtual",
            DeviceType::Cpu => "software",
            // GL does not say; its software drivers do, by name.
            DeviceType::Other
                if info.name.contains("llvmpipe") || info.name.contains("softpipe") =>
            {
                "software"
            }
            DeviceType::Other => "other",
        };
        let backend = match info.backend {
            Backend::Vulkan => "vulkan",
            Backend::Gl => "gl",
            Backend::Metal => "metal",
            Backend::Dx12 => "dx12",
            _ => "other",
        };
        Self {
            name: info.name,
            backend: backend.to_owned(),
            class: class.to_owned(),
            driver: [info.driver, info.driver_info].join(" ").trim().to_owned(),
        }
    }

    /// Lower is better: real GPUs before software.
    fn rank(&self) -> u8 {
        match self.class.as_str() {
            "discrete" => 0,
            "integrated" => 1,
            "virtual" => 2,
            "other" => 3,
            _ => 4,
        }
    }
}

impl fmt::Display for AdapterSummary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} [{}, {}] {}",
            self.name, self.backend, self.class, self.driver
        )
    }
}

/// The backends in the order in which they are looked at. GL comes alone and last: opening it costs time and makes
/// its libraries print warnings, so it is only opened where nothing before it fits.
const TIERS: [Backends; 2] = [
    Backends::VULKAN
        .union(Backends::METAL)
        .union(Backends::DX12),
    Backends::GL,
];

fn ranked(backends: Backends) -> (Instance, Vec<(AdapterSummary, Adapter)>) {
    let instance = Instance::new(InstanceDescriptor {
        backends,
        ..InstanceDescriptor::new_without_display_handle()
    });
    let mut adapters: Vec<_> = pollster::block_on(instance.enumerate_adapters(backends))
        .into_iter()
        .map(|adapter| (AdapterSummary::of(&adapter), adapter))
        .collect();
    adapters.sort_by_key(|(summary, _)| summary.rank());
    (instance, adapters)
}

/// All adapters, the best of each tier first: Vulkan, Metal and DX12, then GL.
#[must_use]
pub fn list_adapters() -> Vec<AdapterSummary> {
    TIERS
        .into_iter()
        .flat_map(|backends| ranked(backends).1)
        .map(|(summary, _)| summary)
        .collect()
}

pub(crate) fn choose(
    choice: &AdapterChoice,
) -> Result<(AdapterSummary, Adapter, Instance), GpuError> {
    let mut found = Vec::new();
    for backends in TIERS {
        let (instance, adapters) = ranked(backends);
        for (summary, adapter) in adapters {
            if choice.fits(&summary) {
                return Ok((summary, adapter, instance));
            }
            found.push(summary.to_string());
        }
    }
    Err(GpuError::NoAdapter {
        asked: choice
            .0
            .as_ref()
            .map_or_else(String::new, |words| format!(" fits `{words}`")),
        found: if found.is_empty() {
            "none at all".to_owned()
        } else {
            found.join("; ")
        },
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn summary(name: &str, backend: &str, class: &str) -> AdapterSummary {
        AdapterSummary {
            name: name.to_owned(),
            backend: backend.to_owned(),
            class: class.to_owned(),
            driver: String::new(),
        }
    }

    #[test]
    fn real_gpus_come_before_software() {
        let mut all = [
            summary("llvmpipe", "vulkan", "software"),
            summary("Card", "vulkan", "discrete"),
        ];
        all.sort_by_key(AdapterSummary::rank);
        assert_eq!(all[0].name, "Card");
    }

    #[test]
    fn words_pick_by_backend_class_and_name() {
        let lavapipe = summary("llvmpipe (LLVM 15)", "vulkan", "software");
        assert!(AdapterChoice::new(None).fits(&lavapipe));
        assert!(AdapterChoice::new(Some("Vulkan llvm")).fits(&lavapipe));
        assert!(!AdapterChoice::new(Some("gl")).fits(&lavapipe));
    }
}
