//! All cases, one binary; only `live` has a process of its own, whose memory it measures.

#![expect(clippy::unwrap_used, reason = "a case fails by panicking")]

mod accuracy;
mod adaptive;
mod agreement;
mod clips;
mod closed_forms;
mod differences;
mod error_estimates;
mod exhaustion;
mod fetch_only;
mod glass;
mod hazards;
mod isosurface_colors;
mod isosurface_faces;
mod isosurfaces;
mod kept_choices;
mod layers;
mod light_volumes;
mod lights;
mod lost_devices;
mod materials;
mod memory_of_work;
mod plans;
mod projections;
mod quadratures;
mod quality;
mod rebuilds;
mod reference;
mod reflections;
mod refraction;
mod refraction_behind;
mod refraction_media;
mod renderers;
mod segment_files;
mod segments;
mod shader_cases;
mod shear_warp;
mod skipping;
mod snapshots;
mod stress;
mod sweep;
mod tables;
mod units;
mod uploads;
