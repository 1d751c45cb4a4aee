//! `volume_texture`: a volume on the device.

use std::sync::Arc;

use volgraph_graph::{
    InputPort, NodeContext, NodeKind, OutputPort, Pass, PortType, Requirement, ResourceDesc, Size,
    UploadBytes,
};
use volgraph_report::Finding;
use volgraph_shader::ParamSpec;

use crate::encoding::{Encoder, Encoding};
use crate::placement::{self, volume};
use crate::source::volume::VolumeSource;

/// The node kind `volume_texture`.
pub struct VolumeTexture;

const INPUTS: &[InputPort] = &[InputPort {
    name: "volume",
    ty: PortType::Volume,
    requirement: Requirement::Required,
    doc: "The volume.",
}];

const OUTPUTS: &[OutputPort] = &[OutputPort {
    name: "texture",
    ty: PortType::VolumeTexture,
    doc: "Its scalars as a 3D texture.",
}];

/// The parameter that chooses the storage, for kinds that call for this one.
#[must_use]
pub fn storage_param() -> ParamSpec {
    ParamSpec::choice(
        "volume_storage",
        &["auto", "r8unorm", "r16float", "r32float"],
        "auto",
        "How scalars are stored: auto takes half floats where they are exact, else floats.",
    )
}

impl NodeKind for VolumeTexture {
    fn name(&self) -> &'static str {
        "volume_texture"
    }

    fn doc(&self) -> &'static str {
        "Uploads a volume as a 3D texture."
    }

    fn inputs(&self) -> &[InputPort] {
        INPUTS
    }

    fn outputs(&self) -> &[OutputPort] {
        OUTPUTS
    }

    fn params(&self) -> Vec<ParamSpec> {
        vec![storage_param()]
    }

    fn output(&self, _port: &str, node: &NodeContext<'_>) -> Result<ResourceDesc, Finding> {
        let volume = volume(node, "volume")?;
        let format = Encoding::choose(volume, node.text("volume_storage")).format;
        Ok(ResourceDesc::Texture {
            dimensions: 3,
            size: Size::Absolute(volume.grid().dims),
            format,
        })
    }

    fn record(&self, node: &NodeContext<'_>) -> Result<Vec<Pass>, Finding> {
        let encoding = Encoding::choose(volume(node, "volume")?, node.text("volume_storage"));
        let volume = node
            .source::<VolumeSource>("volume")
            .map(|source| Arc::clone(&source.volume));
        let bytes = UploadBytes::by_layers(move || {
            let volume = volume.clone();
            let encoder = volume
                .as_ref()
                .map(|volume| Encoder::new(encoding, volume.as_ref()));
            Ok(Box::new(move |layers, texels| {
                if let (Some(volume), Some(encoder)) = (&volume, &encoder) {
                    let voxels = placement::voxels_of(volume, layers);
                    encoder.fill(volume.voxels(), voxels, texels);
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
