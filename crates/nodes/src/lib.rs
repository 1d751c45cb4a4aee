//! volgraph's node kinds and source kinds, one file each, beside nothing else.
//!
//! A node file reads top to bottom: what it does, its ports, its parameters, what it writes, its passes. Sources
//! ([`source`]) load volumes, transfer functions and images. What several kinds share stands in [`encoding`] (how
//! scalars become texels) and [`placement`] (the uniform of a volume). [`registry`] has them all.

pub mod background;
pub mod brick_details;
pub mod brick_pool;
pub mod brick_proxy;
pub mod brick_ranges;
pub(crate) mod clip_volume;
pub mod color_texture;
pub(crate) mod composing;
pub mod difference;
pub mod distance_map;
pub mod encoding;
pub mod false_color;
pub mod fetch_only;
pub mod gradient;
pub mod image_texture;
pub mod integral_table;
pub mod label_texture;
pub mod legend;
pub mod light_volume;
pub mod lit_preintegration;
pub mod material_table;
pub mod multipass_raycast;
pub mod multivolume_raycast;
pub mod placement;
pub mod preintegration;
pub mod preintegration_3d;
pub mod preintegration_pieces;
pub mod proxy_box;
pub mod raycast;
pub mod reference;
pub mod refraction_table;
pub mod scout;
pub mod segmentation;
pub mod shear_warp;
pub mod slices;
pub mod software_raycast;
pub mod source;
pub mod step_table;
pub mod stride_map;
pub mod transfer_table;
pub mod volume_texture;

use volgraph_graph::Registry;

use crate::source::bricks::Progressive;

/// Whether nodes of this kind draw a volume with the slots and parameters of a raycast, or some of them: so that the
/// reference computes what their pictures should be.
#[must_use]
pub fn draws_volumes(kind: &str) -> bool {
    ["raycast", "slices", "multipass_raycast", "shear_warp"].contains(&kind)
}

/// All of volgraph's own kinds.
#[must_use]
pub fn registry() -> Registry {
    progressive_registry(Progressive::default())
}

/// The same, where somebody says how volumes in bricks are drawn.
#[must_use]
pub fn progressive_registry(progressive: Progressive) -> Registry {
    let mut registry = Registry::new();
    registry
        .add_source(source::volume::VolumeKind::default())
        .add_source(source::bricks::BricksKind { progressive })
        .add_source(source::analytic::AnalyticKind)
        .add_source(source::transfer::TransferKind)
        .add_source(source::image::ImageKind)
        .add_source(source::segments::SegmentsKind)
        .add_node(background::Background)
        .add_node(proxy_box::ProxyBox)
        .add_node(brick_proxy::BrickProxy)
        .add_node(raycast::Raycast)
        .add_node(fetch_only::FetchOnly)
        .add_node(slices::Slices)
        .add_node(multipass_raycast::MultipassRaycast)
        .add_node(multivolume_raycast::MultivolumeRaycast)
        .add_node(brick_ranges::BrickRanges)
        .add_node(brick_pool::BrickPool)
        .add_node(distance_map::DistanceMap)
        .add_node(scout::Scout)
        .add_node(brick_details::BrickDetails)
        .add_node(stride_map::StrideMap)
        .add_node(volume_texture::VolumeTexture)
        .add_node(color_texture::ColorTexture)
        .add_node(label_texture::LabelTexture)
        .add_node(gradient::Gradient)
        .add_node(transfer_table::TransferTable)
        .add_node(step_table::StepTable)
        .add_node(preintegration::Preintegration::Whole)
        .add_node(preintegration::Preintegration::Half)
        .add_node(integral_table::IntegralTable)
        .add_node(preintegration_3d::Preintegration3d)
        .add_node(preintegration_pieces::PreintegrationPieces)
        .add_node(refraction_table::RefractionTable)
        .add_node(material_table::MaterialTable)
        .add_node(lit_preintegration::LitPreintegration::Material)
        .add_node(lit_preintegration::LitPreintegration::MaterialMoments)
        .add_node(lit_preintegration::LitPreintegration::EmissionMoments)
        .add_node(image_texture::ImageTexture)
        .add_node(light_volume::LightVolume)
        .add_node(false_color::FalseColor)
        .add_node(legend::Legend)
        .add_node(difference::Difference)
        .add_node(reference::Reference)
        .add_node(software_raycast::SoftwareRaycast::default())
        .add_node(shear_warp::ShearWarp::default());
    registry
}
