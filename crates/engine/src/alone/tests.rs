//! What is picked for volumes, and which files are volumes.

use glam::DVec3;
use volgraph_graph::read;
use volgraph_optics::TransferFunction;
use volgraph_shader::ParamValue;
use volgraph_volume::Grid;

use super::*;

fn volume(value: impl Fn([i32; 3]) -> f32) -> Volume {
    let mut voxels = Vec::new();
    for z in 0..16 {
        for y in 0..16 {
            for x in 0..16 {
                voxels.push(value([x, y, z]));
            }
        }
    }
    let grid = Grid::axis_aligned([16; 3], DVec3::ONE, DVec3::ZERO);
    Volume::new("v", grid, voxels.into()).unwrap()
}

/// What is picked is a graph whose transfer function can be read.
fn why(volume: &Volume) -> String {
    let picked = pick(volume, "a \"b\".nrrd");
    let desc = read::graph(Path::new("t.ron"), &picked.graph).unwrap();
    let text = desc
        .sources
        .get("transfer")
        .map(|source| source.params["text"].value.clone());
    assert_eq!(text, picked.transfer.clone().map(ParamValue::Text));
    if let Some(text) = &picked.transfer {
        let read = TransferFunction::parse(Path::new("t.ron"), text);
        read.unwrap_or_else(|found| panic!("{found} in {text}"));
    }
    let (graph, _) = picked.files("t.ron");
    read::graph(Path::new("t.ron"), &graph).unwrap();
    assert_eq!(graph.contains("path: \"t.ron\""), picked.transfer.is_some());
    picked.why
}

#[test]
fn what_is_in_a_volume_decides_what_is_drawn() {
    let radius =
        |[x, y, z]: [i32; 3]| (((x - 8).pow(2) + (y - 8).pow(2) + (z - 8).pow(2)) as f32).sqrt();
    let mask = volume(|at| f32::from(u8::from(radius(at) < 5.0)) * 257.0);
    assert!(why(&mask).contains("the surface between"));
    let labels = volume(|at| (at[1] / 4 * 100 + at[2] / 4 * 17) as f32);
    assert!(why(&labels).contains("labels"));
    let ct = volume(|at| match radius(at) {
        r if r < 3.0 => 900.0,
        r if r < 6.0 => 30.0 + at[0] as f32,
        _ => -1000.0 + (at[0] % 5) as f32,
    });
    assert!(why(&ct).contains("ct-bone"));
    // Whole numbers that rise slowly are no labels.
    assert!(
        why(&volume(
            |at| (10.0 - radius(at)).round() * 7.0 + at[0] as f32
        ))
        .contains("solid")
    );
    assert!(why(&volume(|at| (-radius(at)).exp())).contains("inferno"));
    assert!(why(&volume(|at| (at[0] as f32 - 7.5) * 0.37)).contains("both tails"));
    // Nothing to see is no reason to fail.
    for value in [0.0, -1e30, f32::NAN, f32::INFINITY, 3e38] {
        why(&volume(|_| value));
        why(&volume(|at| if at == [8; 3] { value } else { 0.25 }));
        why(&volume(|at| {
            if at == [8; 3] {
                value
            } else {
                at[0] as f32 * 1.5
            }
        }));
    }
}

#[test]
fn volumes_are_told_from_graphs_by_what_they_hold() {
    let folder = tempfile::tempdir().unwrap();
    let is = |name: &str, content: &[u8]| {
        let path = folder.path().join(name);
        std::fs::write(&path, content).unwrap();
        is_volume(&path)
    };
    assert!(is("a.nrrd", b"NRRD0004\n") && is("b_2x2x2_uint8.raw", b"01234567"));
    assert!(is("c.mha", b"ObjectType = Image\n") && is("d", b"\x5c\x01\0\0"));
    assert!(!is("a.ron", b"NRRD0004\n") && !is("a.txt", b"( nodes: {} )"));
    assert!(!is("a.png", b"\x89PNG\r\n\x1a\n\0\0"));
    let path = Path::new("/a/b c.nrrd");
    assert_eq!(volume_of(&path_for(path)).as_deref(), Some(path));
    assert_eq!(volume_of(Path::new("embedded:/graphs/mip.ron")), None);
}
