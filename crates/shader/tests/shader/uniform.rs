//! Filling uniform buffers by name.

use volgraph_shader::{StructLayout, UniformError, UniformValue, UniformWriter};

use crate::Files;

fn layout() -> StructLayout {
    let files = Files::one(
        "struct Light { direction: vec3f, power: f32 }\n\
         struct Frame {\n    normal_from_local: mat3x3f,\n    eye: vec3f,\n    count: u32,\n    planes: array<vec4f, 2>,\n    light: Light,\n    world_from_clip: mat4x4f,\n    offset: vec2i,\n}\n\
         @group(0) @binding(0) var<uniform> frame: Frame;\n",
    );
    files
        .check()
        .expect("it fits")
        .struct_layout("Frame")
        .expect("it fits")
}

fn floats(bytes: &[u8]) -> Vec<f32> {
    bytes
        .as_chunks()
        .0
        .iter()
        .map(|word| f32::from_le_bytes(*word))
        .collect()
}

fn fill(writer: &mut UniformWriter) {
    let matrix = [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0], [7.0, 8.0, 9.0]];
    writer.set("normal_from_local", matrix).expect("it fits");
    writer
        .set("eye", [10.0, 11.0, 12.0])
        .expect("it fits")
        .set("count", 13_u32)
        .expect("it fits");
    let planes = vec![UniformValue::Vec4([14.0; 4]), UniformValue::Vec4([15.0; 4])];
    writer
        .set("planes", UniformValue::Array(planes))
        .expect("it fits");
    let light = vec![
        ("power".to_owned(), UniformValue::F32(17.0)),
        ("direction".to_owned(), UniformValue::Vec3([16.0; 3])),
    ];
    writer
        .set("light", UniformValue::Struct(light))
        .expect("it fits");
    writer
        .set(
            "world_from_clip",
            [[18.0; 4], [19.0; 4], [20.0; 4], [21.0; 4]],
        )
        .expect("it fits");
}

#[test]
fn members_lie_where_wgsl_puts_them() {
    let layout = layout();
    let mut writer = UniformWriter::new(&layout);
    fill(&mut writer);
    writer.set("offset", [-1, 2]).unwrap();
    let bytes = writer.finish().unwrap();
    assert_eq!(bytes.len(), layout.size as usize);
    let numbers = floats(&bytes);
    assert_eq!(
        numbers[..12],
        [1.0, 2.0, 3.0, 0.0, 4.0, 5.0, 6.0, 0.0, 7.0, 8.0, 9.0, 0.0]
    );
    assert_eq!(numbers[12..15], [10.0, 11.0, 12.0]);
    assert_eq!(bytes[60..64], 13_u32.to_le_bytes());
    assert_eq!(
        numbers[16..24],
        [14.0, 14.0, 14.0, 14.0, 15.0, 15.0, 15.0, 15.0]
    );
    assert_eq!(numbers[24..28], [16.0, 16.0, 16.0, 17.0]);
    assert_eq!((numbers[28], numbers[43]), (18.0, 21.0));
    assert_eq!(bytes[176..180], (-1_i32).to_le_bytes());
}

#[test]
fn what_is_not_set_is_told() {
    let layout = layout();
    let mut writer = UniformWriter::new(&layout);
    fill(&mut writer);
    assert_eq!(
        writer.finish(),
        Err(UniformError::Missing {
            layout: "Frame".into(),
            members: "`offset`".into()
        })
    );
}

#[test]
fn unknown_members_and_wrong_types_are_told() {
    let layout = layout();
    let mut writer = UniformWriter::new(&layout);
    assert!(writer.has("eye") && !writer.has("eyes"));
    let error = writer.set("eyes", [0.0; 3]).unwrap_err();
    assert_eq!(
        error.to_string(),
        "`Frame` has no member `eyes`; did you mean `eye`?"
    );
    let error = writer.set("eye", [0.0; 4]).unwrap_err();
    assert_eq!(error.to_string(), "`Frame.eye` is vec3<f32>, not vec4<f32>");
    for (member, value) in [
        ("count", UniformValue::I32(1)),
        ("count", UniformValue::F32(1.0)),
        ("normal_from_local", UniformValue::Mat4([[0.0; 4]; 4])),
        (
            "planes",
            UniformValue::Array(vec![UniformValue::Vec4([0.0; 4])]),
        ),
        (
            "planes",
            UniformValue::Array(vec![UniformValue::Vec3([0.0; 3]); 2]),
        ),
        ("planes", UniformValue::Vec4([0.0; 4])),
        (
            "light",
            UniformValue::Struct(vec![("power".to_owned(), UniformValue::F32(1.0))]),
        ),
        (
            "light",
            UniformValue::Struct(vec![("power".to_owned(), UniformValue::F32(1.0)); 2]),
        ),
        ("offset", UniformValue::UVec2([0; 2])),
    ] {
        let error = writer.set(member, value).unwrap_err();
        assert!(matches!(error, UniformError::WrongType { .. }), "{error}");
    }
}
