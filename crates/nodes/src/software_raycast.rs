//! `software_raycast`: emission and absorption by raycasting on the processor (Knittel 2002), extremes and isosurfaces from
//! cell to cell (Marmitt et al. 2004), without the device.

mod drawing;
mod instead;
mod memory;
mod params;

use std::sync::Arc;

use volgraph_graph::{
    InputPort, NodeContext, NodeKind, OutputPort, Pass, PortType, Requirement, ResourceDesc, Size,
    UploadBytes,
};
use volgraph_report::Finding;
use volgraph_shader::ParamSpec;
use volgraph_software::VoxelGrid;
use wgpu_types::TextureFormat;

pub use self::drawing::{SoftwareDrawing, scene};
pub use self::instead::{HELP, instead_of, undrawn_choice};
pub use self::memory::SoftwareMemory;
use crate::placement::{self, volume};
use crate::raycast::{MAX_SEGMENTS, longest_ray};

/// The node kind `software_raycast`.
#[derive(Default)]
pub struct SoftwareRaycast {
    memory: Arc<SoftwareMemory>,
}

const INPUTS: &[InputPort] = &[
    InputPort {
        name: "volume",
        ty: PortType::Volume,
        requirement: Requirement::Required,
        doc: "The volume.",
    },
    InputPort {
        name: "transfer",
        ty: PortType::Transfer,
        requirement: Requirement::Optional,
        doc: "The transfer function, which the technique `dvr` needs.",
    },
    InputPort {
        name: "behind",
        ty: PortType::Color,
        requirement: Requirement::Optional,
        doc: "The `background` that lies behind the volume; nothing where it is open.",
    },
];

const OUTPUTS: &[OutputPort] = &[OutputPort {
    name: "color",
    ty: PortType::Color,
    doc: "The picture, linear premultiplied colour.",
}];

impl NodeKind for SoftwareRaycast {
    fn name(&self) -> &'static str {
        "software_raycast"
    }

    fn doc(&self) -> &'static str {
        "Casts rays on the processor, eight at a time: unlit `dvr`, `mip`, `minip` and lit isosurfaces, fast without a GPU."
    }

    fn inputs(&self) -> &[InputPort] {
        INPUTS
    }

    fn outputs(&self) -> &[OutputPort] {
        OUTPUTS
    }

    fn params(&self) -> Vec<ParamSpec> {
        params::params()
    }

    fn forget(&self) {
        self.memory.forget();
    }

    // Its rays are those of a whole picture.
    fn draws_windows(&self, _node: &NodeContext<'_>) -> bool {
        false
    }

    fn passes_follow_camera(&self) -> bool {
        true
    }

    fn output(&self, _port: &str, node: &NodeContext<'_>) -> Result<ResourceDesc, Finding> {
        let volume = volume(node, "volume")?;
        // Values that f32 cannot compute with.
        placement::encoding(node)?;
        VoxelGrid::check(volume)
            .map_err(|error| node.error("volume-size", error.to_string()))
            .map_err(|finding| finding.help("draw it by a `raycast`"))?;
        if node.text("technique") == "dvr" && !node.is_connected("transfer") {
            return Err(node
                .error("missing-input", "its technique `dvr` needs the input `transfer`")
                .help("connect a transfer function, or set `technique` to `mip`, `minip` or `isosurface`"));
        }
        let segments =
            longest_ray(volume.grid()) / (node.float("step") * volume.grid().min_spacing());
        if segments > MAX_SEGMENTS {
            let message = format!(
                "its longest ray has {} segments, of {MAX_SEGMENTS} at most",
                segments.ceil()
            );
            return Err(node
                .error("too-many-segments", message)
                .help("choose a longer `step`, or resample the volume to voxels closer to cubes"));
        }
        Ok(ResourceDesc::Texture {
            dimensions: 2,
            size: Size::ViewRelative(1.0),
            format: TextureFormat::Rgba32Float,
        })
    }

    fn record(&self, node: &NodeContext<'_>) -> Result<Vec<Pass>, Finding> {
        let Some(view) = node.view() else {
            return Ok(Vec::new());
        };
        let drawing = SoftwareDrawing::of(node, view)?;
        let memory = Arc::clone(&self.memory);
        let bytes = UploadBytes::new(move || {
            let color = drawing.render(&memory)?;
            Ok(bytemuck::cast_slice(&color).to_vec())
        });
        Ok(vec![Pass::Upload {
            port: "color",
            bytes,
        }])
    }
}
