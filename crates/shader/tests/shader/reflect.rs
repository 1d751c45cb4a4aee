//! Entry points, used bindings, overrides, layouts.

use naga::{ShaderStage, StorageAccess, StorageFormat};
use volgraph_report::Place;
use volgraph_shader::{BindingKind, MemberType, ScalarType, TextureDim, TextureSample};

use crate::Files;

const SHADER: &str = "\
struct Frame { world_from_clip: mat4x4f, eye: vec3f, time: f32 }
@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> unused: Frame;
@group(1) @binding(2) var volume: texture_3d<f32>;
@group(1) @binding(1) var volume_sampler: sampler;
@group(2) @binding(0) var table: texture_2d<f32>;
@group(2) @binding(1) var labels: texture_2d_array<u32>;
@group(2) @binding(2) var shadow: texture_depth_2d;
@group(2) @binding(3) var shadow_sampler: sampler_comparison;
@group(2) @binding(4) var image: texture_storage_2d<rgba16float, write>;
struct Bricks { count: u32, offsets: array<vec4u> }
@group(2) @binding(5) var<storage> bricks: Bricks;
@group(2) @binding(6) var<storage, read_write> counts: array<atomic<u32>>;
@group(2) @binding(7) var samples: texture_multisampled_2d<f32>;
@group(2) @binding(8) var<uniform> gain: f32;

fn volume_at(t: texture_3d<f32>, s: sampler, position: vec3f) -> f32 {
    return textureSampleLevel(t, s, position, 0.0).x;
}
fn deep() -> f32 { return volume_at(volume, volume_sampler, frame.eye); }
fn middle() -> f32 { return deep(); }
fn uses_unused() -> f32 { return unused.time; }

@compute @workgroup_size(8, 4)
fn second() {
    _ = middle() + textureLoad(table, vec2u(0), 0).x + gain;
    _ = textureLoad(labels, vec2u(0), 0, 0);
    _ = textureSampleCompareLevel(shadow, shadow_sampler, vec2f(), 0.5);
    _ = textureLoad(samples, vec2u(0), 0);
    textureStore(image, vec2u(0), vec4f());
    atomicAdd(&counts[bricks.offsets[0].x], bricks.count);
}

@fragment
fn first(@builtin(position) at: vec4f) -> @location(0) vec4f {
    return textureSample(table, volume_sampler, at.xy);
}
";

#[test]
fn entry_points_are_listed_in_their_order() {
    let files = Files::one(SHADER);
    let points = files.check().unwrap().entry_points();
    let shown: Vec<_> = points
        .iter()
        .map(|point| (point.name.as_str(), point.stage, point.workgroup_size))
        .collect();
    assert_eq!(
        shown,
        [
            ("second", ShaderStage::Compute, [8, 4, 1]),
            ("first", ShaderStage::Fragment, [0, 0, 0])
        ]
    );
    assert_eq!(points[0].place, files.place("shaders/a.wgsl", "second"));
}

#[test]
fn only_what_an_entry_point_uses_is_listed() {
    let files = Files::one(SHADER);
    let module = files.check().unwrap();
    let names = |entry: &str| -> Vec<String> {
        module
            .used_bindings(entry)
            .into_iter()
            .map(|binding| binding.name)
            .collect()
    };
    assert_eq!(
        names("second"),
        [
            "frame",
            "volume_sampler",
            "volume",
            "table",
            "labels",
            "shadow",
            "shadow_sampler",
            "image",
            "bricks",
            "counts",
            "samples",
            "gain"
        ]
    );
    assert_eq!(names("first"), ["volume_sampler", "table"]);
    assert!(names("none").is_empty());
}

#[test]
fn kinds_are_told_apart() {
    let files = Files::one(SHADER);
    let module = files.check().unwrap();
    let kind = |entry: &str, name: &str| {
        let bindings = module.used_bindings(entry);
        let binding = bindings
            .into_iter()
            .find(|binding| binding.name == name)
            .expect(name);
        assert_eq!(
            binding.place,
            Place {
                length: name.chars().count() as u32,
                ..files.place("shaders/a.wgsl", &format!("{name}:"))
            }
        );
        binding.kind
    };
    let texture = |dim, sample, multisampled| BindingKind::Texture {
        dim,
        sample,
        multisampled,
    };
    let float = |filterable| TextureSample::Float { filterable };
    // Sampled through a function's parameters; the same table is loaded by one entry point and sampled by another.
    assert_eq!(
        kind("second", "volume"),
        texture(TextureDim::D3, float(true), false)
    );
    assert_eq!(
        kind("second", "table"),
        texture(TextureDim::D2, float(false), false)
    );
    assert_eq!(
        kind("first", "table"),
        texture(TextureDim::D2, float(true), false)
    );
    assert_eq!(
        kind("second", "labels"),
        texture(TextureDim::D2Array, TextureSample::Uint, false)
    );
    assert_eq!(
        kind("second", "shadow"),
        texture(TextureDim::D2, TextureSample::Depth, false)
    );
    assert_eq!(
        kind("second", "samples"),
        texture(TextureDim::D2, float(false), true)
    );
    assert_eq!(
        kind("second", "shadow_sampler"),
        BindingKind::Sampler { comparison: true }
    );
    assert_eq!(
        kind("second", "volume_sampler"),
        BindingKind::Sampler { comparison: false }
    );
    assert_eq!(
        kind("second", "image"),
        BindingKind::StorageTexture {
            dim: TextureDim::D2,
            format: StorageFormat::Rgba16Float,
            access: StorageAccess::STORE
        }
    );
    let BindingKind::StorageBuffer {
        read_only: true,
        min_size: 32,
        layout: Some(layout),
    } = kind("second", "bricks")
    else {
        panic!("bricks");
    };
    assert_eq!(layout.members[1].offset, 16);
    let MemberType::Array {
        count: None,
        stride: 16,
        ..
    } = layout.members[1].ty
    else {
        panic!("offsets");
    };
    assert_eq!(
        kind("second", "counts"),
        BindingKind::StorageBuffer {
            read_only: false,
            min_size: 4,
            layout: None
        }
    );
    let BindingKind::Uniform(frame) = kind("second", "frame") else {
        panic!("frame")
    };
    assert_eq!(frame.size, 80);
    let BindingKind::Uniform(gain) = kind("second", "gain") else {
        panic!("gain")
    };
    assert_eq!(
        (gain.members[0].name.as_str(), &gain.members[0].ty),
        ("gain", &MemberType::Scalar(ScalarType::F32))
    );
}

#[test]
fn overrides_have_defaults_docs_and_places() {
    let files = Files::one(
        "/// Rays per tile.\n/// At most 64.\noverride tile: u32 = 8;\n@id(7) override scale: f32;\noverride flag = true;\n\
         override twice: f32 = 2.0 * scale;\noverride low = -1.5;\noverride also: u32 = tile;\n\
         @compute @workgroup_size(tile, also)\nfn main() { _ = scale; _ = flag; _ = twice; _ = low; }\n",
    );
    let module = files.check().unwrap();
    let shown: Vec<_> = module
        .overrides()
        .into_iter()
        .map(|it| (it.name, it.key, it.ty, it.default))
        .collect();
    let row = |name: &str, key: &str, ty, default| (name.to_owned(), key.to_owned(), ty, default);
    assert_eq!(
        shown,
        [
            row("tile", "tile", Some(ScalarType::U32), Some(8.0)),
            row("scale", "7", Some(ScalarType::F32), None),
            row("flag", "flag", None, Some(1.0)),
            row("twice", "twice", Some(ScalarType::F32), None),
            row("low", "low", Some(ScalarType::F32), Some(-1.5)),
            row("also", "also", Some(ScalarType::U32), Some(8.0)),
        ]
    );
    assert_eq!(module.overrides()[0].doc, "Rays per tile. At most 64.");
    assert_eq!(
        module.overrides()[1].place,
        files.place("shaders/a.wgsl", "scale")
    );
    assert_eq!(module.entry_points()[0].workgroup_size, [8, 8, 1]);
}

#[test]
fn layouts_follow_the_rules_of_wgsl() {
    // Sizes and alignments after WGSL 14.4.1, by hand.
    let files = Files::one(
        "struct Inner { a: vec3f, b: f32 }\n\
         struct Outer {\n    a: f32,\n    b: vec3f,\n    c: f32,\n    d: vec2u,\n    e: mat3x3f,\n    f: array<vec4f, 3>,\n    g: Inner,\n    @size(32) h: i32,\n    i: vec2i,\n}\n\
         @group(0) @binding(0) var<uniform> outer: Outer;\n",
    );
    let module = files.check().unwrap();
    let layout = module.struct_layout("Outer").unwrap();
    let shown: Vec<_> = layout
        .members
        .iter()
        .map(|m| (m.name.as_str(), m.offset, m.size, m.ty.to_string()))
        .collect();
    let row = |name, offset, size, ty: &str| (name, offset, size, ty.to_owned());
    assert_eq!(
        shown,
        [
            row("a", 0, 4, "f32"),
            row("b", 16, 12, "vec3<f32>"),
            row("c", 28, 4, "f32"),
            row("d", 32, 8, "vec2<u32>"),
            row("e", 48, 48, "mat3x3<f32>"),
            row("f", 96, 48, "array<vec4<f32>, 3>"),
            row("g", 144, 16, "Inner"),
            row("h", 160, 4, "i32"),
            row("i", 192, 8, "vec2<i32>"),
        ]
    );
    assert_eq!(layout.size, 208);
    assert_eq!(
        layout.members[4].place,
        Place {
            length: 1,
            ..files.place("shaders/a.wgsl", "e: mat3x3f")
        }
    );
    assert_eq!(module.struct_layout("outer"), Some(layout));
    assert_eq!(module.struct_layout("none"), None);
}
