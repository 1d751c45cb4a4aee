//! A made-up family of kinds: `paint` draws, `table` and `outer` are called for, `upload` needs no shader, `half`
//! reads a picture and writes one of half the size, `overlay` is painted again when the camera moves.

use std::any::Any;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use volgraph_graph::{
    Demand, Digest, Folders, Inherited, InputPort, NodeContext, NodeKind, OutputPort, Pass,
    PortType, ProgramSpec, Progress, Registry, Requirement, ResourceDesc, Size, SlotSpec, Source,
    SourceKind,
};
use volgraph_report::{Finding, Findings};
use volgraph_shader::{MemoryFiles, ParamSpec, ParamValue, ShaderRoots};
use wgpu_types::TextureFormat;

pub fn shaders() -> ShaderRoots {
    let entry =
        |name: &str, body: &str| format!("@compute @workgroup_size(1) fn {name}() {{ {body} }}\n");
    let color_out =
        "@group(0) @binding(9) var color_out: texture_storage_2d<rgba32float, write>;\n";
    let store = "textureStore(color_out, vec2i(0), light_color());";
    let paint = format!(
        "#import slot \"light\"\n{color_out}{}",
        entry("paint", store)
    );
    let half = format!(
        "@group(0) @binding(1) var image: texture_2d<f32>;\n{color_out}{}",
        entry(
            "half",
            "textureStore(color_out, vec2i(0), textureLoad(image, vec2i(0), 0));"
        )
    );
    let table = format!(
        "struct Params {{\n  /// Gain. @default 1 @range 0 9\n  gain: f32,\n}}\n\
         @group(0) @binding(1) var volume_texture: texture_3d<f32>;\n\
         @group(0) @binding(9) var table_out: texture_storage_2d<rgba32float, write>;\n{}",
        entry(
            "table",
            "textureStore(table_out, vec2i(0), params.gain * textureLoad(volume_texture, vec3i(0), 0));"
        )
    );
    let outer = format!(
        "@group(0) @binding(1) var table: texture_2d<f32>;\n\
         @group(0) @binding(9) var outer_out: texture_storage_2d<rgba32float, write>;\n{}",
        entry(
            "outer",
            "textureStore(outer_out, vec2i(0), textureLoad(table, vec2i(0), 0));"
        )
    );
    let echo = format!(
        "struct Params {{\n  /// Tint. @default 0.5 @range 0 1\n  tint: f32,\n}}\n{color_out}{}",
        entry(
            "echo",
            "textureStore(color_out, vec2i(0), vec4f(params.tint));"
        )
    );
    let light = |declared: &str, value: &str| {
        format!("{declared}\nfn light_color() -> vec4f {{ return {value}; }}\n")
    };
    let choices = [
        (
            "flat",
            light(
                "struct Params {\n  /// Tint. @default 0.5 @range 0 1\n  tint: f32,\n}",
                "vec4f(params.tint)",
            ),
        ),
        (
            "tabled",
            light(
                "@group(0) @binding(1) var table: texture_2d<f32>;",
                "textureLoad(table, vec2i(0), 0)",
            ),
        ),
        (
            "both",
            light(
                "@group(0) @binding(1) var table: texture_2d<f32>;\n\
                 @group(0) @binding(2) var outer: texture_2d<f32>;",
                "textureLoad(table, vec2i(0), 0) + textureLoad(outer, vec2i(0), 0)",
            ),
        ),
        (
            "echoed",
            light(
                "struct Params {\n  /// Tint. @default 0.5 @range 0 1\n  tint: f32,\n  /// Gloss. @default 0 @range 0 1\n  \
                 gloss: f32,\n}\n@group(0) @binding(1) var echo: texture_2d<f32>;",
                "params.gloss + params.tint * textureLoad(echo, vec2i(0), 0)",
            ),
        ),
        (
            "over",
            light(
                "@group(0) @binding(1) var behind: texture_2d<f32>;",
                "textureLoad(behind, vec2i(0), 0)",
            ),
        ),
        (
            "over_with_params",
            light(
                "struct Params {\n  /// One. @default 1 @range 0 9\n  one: f32,\n  /// Two. @default 2 @range 0 9\n  two: f32,\n}\n\
                 @group(0) @binding(1) var behind: texture_2d<f32>;",
                "params.one * params.two * textureLoad(behind, vec2i(0), 0)",
            ),
        ),
        (
            "lens",
            light(
                "struct Lens { size: vec2f }\n@group(0) @binding(1) var<uniform> lens: Lens;",
                "lens.size.xyxy",
            ),
        ),
        (
            "posed",
            light(
                "struct Camera { eye: vec3f }\n@group(0) @binding(1) var<uniform> camera: Camera;",
                "camera.eye.xyzz",
            ),
        ),
        (
            "strange",
            light(
                "@group(0) @binding(1) var tabel: texture_2d<f32>;",
                "textureLoad(tabel, vec2i(0), 0)",
            ),
        ),
        (
            "wrong_dim",
            light(
                "@group(0) @binding(1) var table: texture_3d<f32>;",
                "textureLoad(table, vec3i(0), 0)",
            ),
        ),
        (
            "unfilled",
            light(
                "struct Lens { size: vec2f, zoom: f32 }\n@group(0) @binding(1) var<uniform> lens: Lens;",
                "vec4f(lens.zoom)",
            ),
        ),
        (
            "unregistered",
            light(
                "@group(0) @binding(1) var ghost: texture_2d<f32>;",
                "textureLoad(ghost, vec2i(0), 0)",
            ),
        ),
    ];
    let mut files = MemoryFiles::new()
        .with("/s/node/paint.wgsl", paint)
        .with("/s/node/half.wgsl", half)
        .with("/s/node/table.wgsl", table)
        .with("/s/node/outer.wgsl", outer)
        .with("/s/node/echo.wgsl", echo)
        .with("/s/node/empty.wgsl", "const NOTHING = 0;\n");
    for (name, text) in choices {
        files = files.with(format!("/s/slot/light/{name}.wgsl"), text);
    }
    ShaderRoots::new(Arc::new(files)).root("/s")
}

const fn input(name: &'static str, ty: PortType, requirement: Requirement) -> InputPort {
    InputPort {
        name,
        ty,
        requirement,
        doc: "A port.",
    }
}

const fn output(name: &'static str, ty: PortType) -> OutputPort {
    OutputPort {
        name,
        ty,
        doc: "A port.",
    }
}

const fn calls_for(kind: &'static str) -> Requirement {
    Requirement::Demanded(Demand {
        kind,
        inputs: &[("volume", "volume")],
        params: &[],
        slots: &[],
    })
}

/// A kind of which everything is said in values.
#[derive(Clone)]
pub struct Fake {
    pub name: &'static str,
    pub inputs: &'static [InputPort],
    pub outputs: &'static [OutputPort],
    pub slots: &'static [SlotSpec],
    /// Shader and entry point.
    pub shader: Option<(&'static str, &'static str)>,
    pub size: Size,
    pub dimensions: u8,
    pub follows_camera: bool,
    pub inherited: &'static [Inherited],
}

const FAKES: [Fake; 9] = [
    Fake {
        name: "paint",
        inputs: &[
            input("volume", PortType::Volume, Requirement::Optional),
            input("behind", PortType::Color, Requirement::Optional),
            input(
                "table",
                PortType::Table1d,
                Requirement::Demanded(Demand {
                    kind: "table",
                    inputs: &[("volume", "volume")],
                    params: &[("gain", "amount")],
                    slots: &[],
                }),
            ),
            input("outer", PortType::Color, calls_for("outer")),
            input("ghost", PortType::Table1d, calls_for("ghost")),
            input("echo", PortType::Color, Requirement::DemandedAlike("echo")),
        ],
        outputs: &[
            output("color", PortType::Color),
            output("depth", PortType::Scalar2d),
        ],
        slots: &[SlotSpec {
            name: "light",
            default: "flat",
            doc: "How is it lit?",
        }],
        shader: Some(("node/paint.wgsl", "paint")),
        size: Size::ViewRelative(1.0),
        dimensions: 2,
        follows_camera: false,
        inherited: &[],
    },
    Fake {
        name: "mirror",
        inputs: &[
            input("volume", PortType::Volume, Requirement::Optional),
            input("behind", PortType::Color, Requirement::Optional),
        ],
        outputs: &[output("color", PortType::Color)],
        slots: &[SlotSpec {
            name: "light",
            default: "flat",
            doc: "How is it lit?",
        }],
        shader: Some(("node/paint.wgsl", "paint")),
        size: Size::ViewRelative(1.0),
        dimensions: 2,
        follows_camera: false,
        inherited: &[Inherited {
            slot: "light",
            port: "behind",
            inputs: &["volume"],
        }],
    },
    Fake {
        name: "table",
        inputs: &[
            input("volume", PortType::Volume, Requirement::Required),
            input(
                "volume_texture",
                PortType::VolumeTexture,
                calls_for("upload"),
            ),
        ],
        outputs: &[output("table", PortType::Table1d)],
        slots: &[],
        shader: Some(("node/table.wgsl", "table")),
        size: Size::Absolute([64, 1, 1]),
        dimensions: 2,
        follows_camera: false,
        inherited: &[],
    },
    Fake {
        name: "outer",
        inputs: &[
            input("volume", PortType::Volume, Requirement::Required),
            input(
                "table",
                PortType::Table1d,
                Requirement::Demanded(Demand {
                    kind: "table",
                    inputs: &[("volume", "volume")],
                    params: &[("gain", "amount")],
                    slots: &[],
                }),
            ),
        ],
        outputs: &[output("outer", PortType::Color)],
        slots: &[],
        shader: Some(("node/outer.wgsl", "outer")),
        size: Size::Absolute([8, 8, 1]),
        dimensions: 2,
        follows_camera: false,
        inherited: &[],
    },
    Fake {
        name: "echo",
        inputs: &[
            input("volume", PortType::Volume, Requirement::Required),
            input("behind", PortType::Color, Requirement::Optional),
        ],
        outputs: &[output("color", PortType::Color)],
        slots: &[SlotSpec {
            name: "light",
            default: "flat",
            doc: "How is it lit?",
        }],
        shader: Some(("node/echo.wgsl", "echo")),
        size: Size::Absolute([8, 8, 1]),
        dimensions: 2,
        follows_camera: false,
        inherited: &[],
    },
    Fake {
        name: "upload",
        inputs: &[input("volume", PortType::Volume, Requirement::Required)],
        outputs: &[output("texture", PortType::VolumeTexture)],
        slots: &[],
        shader: None,
        size: Size::Absolute([8, 8, 8]),
        dimensions: 3,
        follows_camera: false,
        inherited: &[],
    },
    Fake {
        name: "half",
        inputs: &[input("image", PortType::Color, Requirement::Required)],
        outputs: &[output("color", PortType::Color)],
        slots: &[],
        shader: Some(("node/half.wgsl", "half")),
        size: Size::InputRelative("image", 0.5),
        dimensions: 2,
        follows_camera: false,
        inherited: &[],
    },
    Fake {
        name: "overlay",
        inputs: &[
            input("image", PortType::Color, Requirement::Optional),
            input("other", PortType::Color, Requirement::Optional),
        ],
        outputs: &[output("color", PortType::Color)],
        slots: &[],
        shader: None,
        size: Size::ViewRelative(1.0),
        dimensions: 2,
        follows_camera: true,
        inherited: &[],
    },
    Fake {
        name: "headless",
        inputs: &[],
        outputs: &[output("color", PortType::Color)],
        slots: &[],
        shader: Some(("node/empty.wgsl", "headless")),
        size: Size::ViewRelative(1.0),
        dimensions: 2,
        follows_camera: false,
        inherited: &[],
    },
];

pub fn registry() -> Registry {
    let mut registry = Registry::new();
    registry.add_source(FieldKind);
    for fake in FAKES {
        registry.add_node(fake);
    }
    registry
}

impl NodeKind for Fake {
    fn name(&self) -> &'static str {
        self.name
    }

    fn doc(&self) -> &'static str {
        "Made up."
    }

    fn inputs(&self) -> &[InputPort] {
        self.inputs
    }

    fn outputs(&self) -> &[OutputPort] {
        self.outputs
    }

    fn slots(&self) -> &[SlotSpec] {
        self.slots
    }

    fn params(&self) -> Vec<ParamSpec> {
        vec![ParamSpec::float("amount", 2.0, "An amount.").range(0.0, 9.0)]
    }

    fn passes_follow_camera(&self) -> bool {
        self.follows_camera
    }

    fn program(&self, _node: &NodeContext<'_>) -> Option<ProgramSpec> {
        let (root, entry) = self.shader?;
        Some(ProgramSpec {
            root,
            fixed_slots: BTreeMap::new(),
            entries: vec![entry],
            inherited: self.inherited.to_vec(),
        })
    }

    fn output(&self, _port: &str, _node: &NodeContext<'_>) -> Result<ResourceDesc, Finding> {
        let format = TextureFormat::Rgba32Float;
        Ok(ResourceDesc::Texture {
            dimensions: self.dimensions,
            size: self.size,
            format,
        })
    }

    fn record(&self, _node: &NodeContext<'_>) -> Result<Vec<Pass>, Finding> {
        Ok(Vec::new())
    }
}

/// The source kind `field`: nothing but a seed.
struct FieldKind;

#[derive(Debug)]
struct Field(i64);

impl SourceKind for FieldKind {
    fn name(&self) -> &'static str {
        "field"
    }

    fn doc(&self) -> &'static str {
        "Made up."
    }

    fn ty(&self) -> PortType {
        PortType::Volume
    }

    fn params(&self) -> Vec<ParamSpec> {
        vec![ParamSpec::int("seed", 0, "What it is made of.")]
    }

    fn load(
        &self,
        params: &BTreeMap<String, ParamValue>,
        _folders: &Folders,
        _progress: Progress<'_>,
    ) -> Result<Arc<dyn Source>, Findings> {
        match params.get("seed") {
            Some(ParamValue::Int(seed)) => Ok(Arc::new(Field(*seed))),
            _ => Err(Finding::error("no-seed", "a field needs a seed").into()),
        }
    }
}

impl Source for Field {
    fn ty(&self) -> PortType {
        PortType::Volume
    }

    fn digest(&self) -> Digest {
        [u8::try_from(self.0).unwrap_or(255); 32]
    }

    fn summary(&self) -> String {
        format!("field {}", self.0)
    }

    fn files(&self) -> Vec<PathBuf> {
        Vec::new()
    }

    fn as_any(&self) -> &dyn Any {
        self
    }
}
