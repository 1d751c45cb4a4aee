//! `shear_warp`: parallel rays by a sheared volume and a warped image, on the processor (Schulze et al. 2003).

mod drawing;
mod memory;

use std::sync::Arc;

use volgraph_graph::{
    InputPort, NodeContext, NodeKind, OutputPort, Pass, PortType, Requirement, ResourceDesc, Size,
    UploadBytes,
};
use volgraph_report::Finding;
use volgraph_shader::ParamSpec;
use volgraph_software::shear_warp::Frame;
use wgpu_types::TextureFormat;

pub use self::drawing::ShearDrawing;
pub use self::memory::ShearMemory;
use crate::placement::{self, volume};

/// The node kind `shear_warp`.
#[derive(Default)]
pub struct ShearWarp {
    memory: Arc<ShearMemory>,
}

/// Pixels of the intermediate image, from whatever direction: a GiB of colours.
const MAX_PIXELS: f64 = 67_108_864.0;

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
        requirement: Requirement::Required,
        doc: "The transfer function.",
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

impl NodeKind for ShearWarp {
    fn name(&self) -> &'static str {
        "shear_warp"
    }

    fn doc(&self) -> &'static str {
        "Shears slices of the volume into an image and warps it, on the processor: unlit `dvr` in parallel projection."
    }

    fn inputs(&self) -> &[InputPort] {
        INPUTS
    }

    fn outputs(&self) -> &[OutputPort] {
        OUTPUTS
    }

    fn params(&self) -> Vec<ParamSpec> {
        vec![
            ParamSpec::float(
                "scale",
                1.0,
                "Pixels of the intermediate image for each voxel, along both of its axes.",
            )
            .range(0.25, 8.0),
            ParamSpec::int(
                "slices_per_voxel",
                1,
                "Slabs for each slice of the volume; scalars between slices are interpolated.",
            )
            .range(1.0, 16.0),
            ParamSpec::float(
                "early_termination",
                1.0 / 4096.0,
                "A pixel ends where less than this share of the light behind could still reach the eye; 0 never.",
            )
            .range(0.0, 0.5),
            ParamSpec::choice(
                "slab_classify",
                &["preintegrated", "post"],
                "preintegrated",
                "Colour and opacity of a slab: integrals of all scalars from slice to slice, or the transfer function at slices.",
            ),
            ParamSpec::choice(
                "lookup",
                &["bilinear", "nearest"],
                "bilinear",
                "How the pre-integrated table is read: between four entries, or its nearest one.",
            ),
            ParamSpec::choice(
                "correction",
                &["exact", "scaled", "none"],
                "exact",
                "What is done about slabs that are longer along slanted rays: a table of that length, the opacity and colour of entries corrected, or nothing (slanted rays see too little).",
            ),
            ParamSpec::choice(
                "buffer_slice",
                &["slice", "image"],
                "slice",
                "Where scalars of the slice before are kept: in two slices of the volume's size, or one of the intermediate image's; the picture is the same.",
            ),
            ParamSpec::choice(
                "run_lengths",
                &["encoded", "none"],
                "encoded",
                "Whether rows skip runs of voxels that show nothing; the picture is the same.",
            ),
            ParamSpec::int(
                "table_size",
                256,
                "Entries of the pre-integrated table along each side.",
            )
            .range(64.0, 4096.0),
        ]
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
        let dims = volume(node, "volume")?.grid().dims;
        // Values that f32 cannot compute with.
        placement::encoding(node)?;
        let scale = node.float("scale");
        let pixels = Frame::most_pixels(dims, scale);
        if pixels > MAX_PIXELS {
            let message = format!(
                "its intermediate image may have {pixels:.0} pixels, of {MAX_PIXELS:.0} at most"
            );
            let fitting = scale * (MAX_PIXELS / pixels).sqrt();
            return Err(node
                .error("too-many-pixels", message)
                .help(format!("choose a `scale` of {fitting:.2} or less")));
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
        let drawing = ShearDrawing::of(node, view)?;
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
