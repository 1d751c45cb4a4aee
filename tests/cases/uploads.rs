//! What is uploaded in pieces arrives whole: textures are read back and compared with the files that they are made of.

use std::sync::Arc;

use volgraph_gpu::{Runner, TexelValues, Texels};
use volgraph_graph::UploadBytes;
use volgraph_tests::{Stage, adapters, gpu_alone, load, options};

/// Reads back the texture that a node of this kind makes of a raw volume.
fn texture(backend: &str, file: &str, bytes: &[u8], node: &str) -> Texels {
    let graph = format!(
        r#"(
            sources: {{ "volume": volume(path: "{file}") }},
            nodes: {{ "made": {node} }},
            outputs: {{ "texture": "made.texture" }},
        )"#
    );
    let stage = Stage::new().with(file, bytes).with("graph.ron", graph);
    let scene = load(&stage.path().join("graph.ron"), &[]).unwrap();
    let gpu = gpu_alone(backend);
    let shaders = scene.shader_library(gpu.capabilities());
    let limits = options(&[], backend, [8, 8]).limits(&gpu);
    let plan = scene.plan(&shaders, &limits, [8, 8], false).unwrap();
    let view = plan.view();
    let mut runner = Runner::new(gpu);
    let mut installation = runner.prepare(Arc::new(plan), &view, None).unwrap();
    runner.frame(&mut installation, &view).unwrap();
    runner.read(&installation, "texture").unwrap()
}

fn volume_texture(storage: &str) -> String {
    format!(
        r#"(kind: "volume_texture", in: {{ "volume": "volume" }}, params: {{ "volume_storage": "{storage}" }})"#
    )
}

/// Whole numbers that half floats hold, no two neighbours alike.
fn whole(voxels: u32) -> impl Iterator<Item = u16> {
    (0..voxels).map(|i| (i * 7 + i / 300 * 13) as u16 % 2001)
}

#[test]
fn texels_of_odd_and_large_volumes_are_exactly_the_voxels() {
    // The last takes several pieces, the last of which has fewer layers.
    for [nx, ny, nz] in [[1, 1, 1], [13, 7, 5], [301, 299, 59]] {
        let count = nx * ny * nz;
        let name = |ty: &str| format!("v_{nx}x{ny}x{nz}_{ty}.raw");
        let layer = u64::from(nx * ny);
        assert_eq!(
            nx > 100,
            layer * 4 * u64::from(nz) > 2 * UploadBytes::PIECE_BYTES
        );
        let words: Vec<u8> = whole(count).flat_map(u16::to_le_bytes).collect();
        let floats: Vec<f32> = whole(count).map(|v| f32::from(v) / 3.0).collect();
        let float_bytes: Vec<u8> = floats.iter().flat_map(|v| v.to_le_bytes()).collect();
        let bytes: Vec<u8> = whole(count).map(|v| v as u8).collect();
        for backend in adapters() {
            let made = texture(
                &backend,
                &name("uint16"),
                &words,
                &volume_texture("r32float"),
            );
            assert_eq!(made.extent, [nx, ny, nz]);
            let truth = whole(count).map(f32::from).collect();
            assert!(
                made.values == TexelValues::Scalars(truth),
                "{backend}: uint16 as float"
            );

            let made = texture(
                &backend,
                &name("uint16"),
                &words,
                &volume_texture("r16float"),
            );
            let TexelValues::Bytes(halves) = made.values else {
                panic!("{backend}: {:?}", made.format)
            };
            let read: Vec<u16> = halves.chunks(2).map(|b| half(b[0], b[1])).collect();
            assert!(
                read.into_iter().eq(whole(count)),
                "{backend}: uint16 as half"
            );

            let made = texture(
                &backend,
                &name("float32"),
                &float_bytes,
                &volume_texture("auto"),
            );
            assert!(
                made.values == TexelValues::Scalars(floats.clone()),
                "{backend}: float32"
            );

            let made = texture(&backend, &name("uint8"), &bytes, &volume_texture("r8unorm"));
            assert!(
                made.values == TexelValues::Bytes(bytes.clone()),
                "{backend}: uint8"
            );
        }
    }
}

#[test]
fn texels_of_labels_are_the_labels() {
    let [nx, ny, nz] = [203, 301, 71];
    assert!(2 * nx * ny * nz > UploadBytes::PIECE_BYTES);
    let labels: Vec<u8> = (0..nx * ny * nz).map(|i| (i / 1000 % 7) as u8).collect();
    for backend in adapters() {
        let node = r#"(kind: "label_texture", in: { "labels": "volume" })"#;
        let file = format!("l_{nx}x{ny}x{nz}_uint8.raw");
        let TexelValues::Bytes(texels) = texture(&backend, &file, &labels, node).values else {
            panic!("{backend}: texels of labels are pairs of bytes")
        };
        let read = texels.chunks(2).map(|texel| texel[0]);
        assert!(read.eq(labels.iter().copied()), "{backend}");
    }
}

/// The whole number in a half float of at least 0.
fn half(low: u8, high: u8) -> u16 {
    let bits = u16::from_le_bytes([low, high]);
    let (exponent, fraction) = (i32::from(bits >> 10), f32::from(bits & 0x3ff) / 1024.0);
    if exponent == 0 {
        return 0;
    }
    ((1.0 + fraction) * f32::powi(2.0, exponent - 15)) as u16
}
