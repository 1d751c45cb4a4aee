//! Node kinds of the tests' own: memory that nobody has, and a device that goes at a chosen moment.

use std::sync::{Arc, Mutex, PoisonError};

use volgraph::Registry;
use volgraph_gpu::Gpu;
use volgraph_graph::{
    InputPort, NodeContext, NodeKind, OutputPort, Pass, PortType, Requirement, ResourceDesc, Size,
    UploadBytes,
};
use volgraph_report::Finding;
use volgraph_shader::ParamSpec;
use wgpu_types::TextureFormat;

/// `ballast`: a cube of `side` voxels of 16 bytes each, into which nothing is written.
pub struct Ballast;

impl NodeKind for Ballast {
    fn name(&self) -> &'static str {
        "ballast"
    }

    fn doc(&self) -> &'static str {
        "Takes memory."
    }

    fn outputs(&self) -> &[OutputPort] {
        &[OutputPort {
            name: "texture",
            ty: PortType::VolumeTexture,
            doc: "Memory.",
        }]
    }

    fn params(&self) -> Vec<ParamSpec> {
        vec![ParamSpec::int("side", 4, "Voxels along each axis.").range(1.0, 4096.0)]
    }

    fn output(&self, _port: &str, node: &NodeContext<'_>) -> Result<ResourceDesc, Finding> {
        Ok(ResourceDesc::Texture {
            dimensions: 3,
            size: Size::Absolute([node.uint("side"); 3]),
            format: TextureFormat::Rgba32Float,
        })
    }

    fn record(&self, _node: &NodeContext<'_>) -> Result<Vec<Pass>, Finding> {
        Ok(Vec::new())
    }
}

/// When the device goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Moment {
    /// While memory is allocated for a plan.
    Prepare,
    /// While a frame is recorded.
    Frame,
    /// After the frame, before its picture is read back.
    ReadBack,
}

/// Takes a device away at a moment, once.
#[derive(Clone, Default)]
pub struct Trap(Arc<Mutex<Armed>>);

#[derive(Default)]
struct Armed {
    trap: Option<(Moment, Arc<Gpu>)>,
    /// The last thing that the kind was asked for.
    is_sized: bool,
    is_recorded: bool,
}

impl Trap {
    /// Arms the trap.
    pub fn arm(&self, moment: Moment, gpu: Arc<Gpu>) {
        *self.locked() = Armed {
            trap: Some((moment, gpu)),
            ..Armed::default()
        };
    }

    /// Whether it has snapped, or was never armed.
    #[must_use]
    pub fn is_idle(&self) -> bool {
        self.locked().trap.is_none()
    }

    fn locked(&self) -> std::sync::MutexGuard<'_, Armed> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn snap(&self, now: Moment) {
        let mut armed = self.locked();
        if let Some((_, gpu)) = armed.trap.take_if(|(moment, _)| *moment == now) {
            gpu.destroy();
        }
    }
}

/// `flat`: one grey, `value`, uploaded; its input is not looked at.
pub struct Flat {
    /// What it springs.
    pub trap: Trap,
}

impl NodeKind for Flat {
    fn name(&self) -> &'static str {
        let (is_sized, is_recorded) = {
            let armed = self.trap.locked();
            (armed.is_sized, armed.is_recorded)
        };
        // Names are asked for by fingerprints, first before memory is allocated, and by the report of a frame.
        if is_recorded {
            self.trap.snap(Moment::ReadBack);
        } else if is_sized {
            self.trap.snap(Moment::Prepare);
        }
        "flat"
    }

    fn doc(&self) -> &'static str {
        "One grey."
    }

    fn inputs(&self) -> &[InputPort] {
        &[InputPort {
            name: "texture",
            ty: PortType::VolumeTexture,
            requirement: Requirement::Optional,
            doc: "Needed by nobody.",
        }]
    }

    fn outputs(&self) -> &[OutputPort] {
        &[OutputPort {
            name: "color",
            ty: PortType::Color,
            doc: "The grey.",
        }]
    }

    fn params(&self) -> Vec<ParamSpec> {
        vec![ParamSpec::float("value", 0.5, "The grey.")]
    }

    fn output(&self, _port: &str, _node: &NodeContext<'_>) -> Result<ResourceDesc, Finding> {
        self.trap.locked().is_sized = true;
        Ok(ResourceDesc::Texture {
            dimensions: 2,
            size: Size::ViewRelative(1.0),
            format: TextureFormat::Rgba32Float,
        })
    }

    fn record(&self, node: &NodeContext<'_>) -> Result<Vec<Pass>, Finding> {
        self.trap.snap(Moment::Frame);
        self.trap.locked().is_recorded = true;
        let [width, height] = node.view().map_or([1; 2], |view| view.size);
        #[expect(clippy::cast_possible_truncation, reason = "a grey in f32")]
        let value = node.float("value") as f32;
        let bytes = UploadBytes::new(move || {
            let texel = [value, value, value, 1.0].map(f32::to_le_bytes);
            Ok(texel
                .as_flattened()
                .repeat(width as usize * height as usize))
        });
        Ok(vec![Pass::Upload {
            port: "color",
            bytes,
        }])
    }
}

/// volgraph's kinds and these.
#[must_use]
pub fn registry(trap: &Trap) -> Registry {
    let mut registry = volgraph::registry();
    let trap = trap.clone();
    registry.add_node(Ballast).add_node(Flat { trap });
    registry
}
