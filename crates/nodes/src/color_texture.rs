//! `color_texture`: the colours of a volume whose voxels have their own, on the device.
//!
//! Linear half floats: filters mix light, not encoded values, and software drivers weigh half floats more finely than
//! bytes.

use std::sync::Arc;

use half::f16;
use rayon::prelude::*;
use volgraph_graph::{
    InputPort, NodeContext, NodeKind, OutputPort, Pass, PortType, Requirement, ResourceDesc, Size,
    UploadBytes,
};
use volgraph_picture::srgb::linear_from_srgb;
use volgraph_report::Finding;
use wgpu_types::TextureFormat;

use crate::placement::{self, volume};
use crate::source::volume::VolumeSource;

/// The node kind `color_texture`.
pub struct ColorTexture;

const INPUTS: &[InputPort] = &[InputPort {
    name: "volume",
    ty: PortType::Volume,
    requirement: Requirement::Required,
    doc: "A volume whose voxels have colours.",
}];

const OUTPUTS: &[OutputPort] = &[OutputPort {
    name: "texture",
    ty: PortType::ColorVolume,
    doc: "Its linear colours as a 3D texture.",
}];

/// Bytes of a texel.
const TEXEL: usize = 8;

impl NodeKind for ColorTexture {
    fn name(&self) -> &'static str {
        "color_texture"
    }

    fn doc(&self) -> &'static str {
        "Uploads the colours of a volume whose voxels have their own."
    }

    fn inputs(&self) -> &[InputPort] {
        INPUTS
    }

    fn outputs(&self) -> &[OutputPort] {
        OUTPUTS
    }

    fn output(&self, _port: &str, node: &NodeContext<'_>) -> Result<ResourceDesc, Finding> {
        let volume = volume(node, "volume")?;
        if volume.colors().is_none() {
            let message = format!("the voxels of `{}` have no colours", volume.name());
            return Err(node.error("no-colors", message).help(
                "choose the slot `colors` \"transfer\", or `component: \"color\"` for a volume of two to four values per voxel",
            ));
        }
        Ok(ResourceDesc::Texture {
            dimensions: 3,
            size: Size::Absolute(volume.grid().dims),
            format: TextureFormat::Rgba16Float,
        })
    }

    fn record(&self, node: &NodeContext<'_>) -> Result<Vec<Pass>, Finding> {
        let volume = node
            .source::<VolumeSource>("volume")
            .map(|source| Arc::clone(&source.volume));
        let linear = Arc::new(linear_of_bytes());
        let bytes = UploadBytes::by_layers(move || {
            let (volume, linear) = (volume.clone(), Arc::clone(&linear));
            Ok(Box::new(move |layers, texels| {
                let volume = volume.as_deref();
                if let Some((volume, colors)) = volume.and_then(|it| Some((it, it.colors()?))) {
                    let colors = &colors[placement::voxels_of(volume, layers)];
                    fill(&linear, colors, texels);
                }
                Ok(())
            }))
        });
        Ok(vec![Pass::Upload {
            port: "texture",
            bytes,
        }])
    }
}

/// The half float of each sRGB-encoded byte.
fn linear_of_bytes() -> [f16; 256] {
    std::array::from_fn(|byte| f16::from_f64(linear_from_srgb(byte as f64 / 255.0)))
}

fn fill(linear: &[f16; 256], colors: &[[u8; 4]], texels: &mut [u8]) {
    let texels = texels.par_chunks_exact_mut(TEXEL);
    texels.zip(colors).for_each(|(texel, &[r, g, b, a])| {
        let channels = [
            linear[r as usize],
            linear[g as usize],
            linear[b as usize],
            f16::from_f64(f64::from(a) / 255.0),
        ];
        for (bytes, channel) in texel.chunks_exact_mut(2).zip(channels) {
            bytes.copy_from_slice(&channel.to_le_bytes());
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_become_linear_half_floats() {
        let mut texels = [0; 16];
        fill(
            &linear_of_bytes(),
            &[[0, 255, 188, 255], [55, 0, 0, 0]],
            &mut texels,
        );
        let halves: Vec<f32> = texels
            .chunks(2)
            .map(|it| f16::from_le_bytes([it[0], it[1]]).to_f32())
            .collect();
        let want = [0.0, 1.0, 0.5029, 1.0, 0.0382, 0.0, 0.0, 0.0];
        for (half, want) in halves.iter().zip(want) {
            assert!((half - want).abs() < 1e-3, "{halves:?}");
        }
    }
}
