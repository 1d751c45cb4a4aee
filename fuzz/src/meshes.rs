//! Meshes, and fields of distances of tiny ones.

use volgraph_mesh::{
    FieldOptions, Mesh, MeshError, ReadOptions, Resolution, Sign, Up, distance_field,
};

/// Most triangles of a mesh that a field is made of.
const FEW: usize = 64;

const NAMES: [&str; 4] = ["fuzzed.ply", "fuzzed.obj", "fuzzed.stl", "fuzzed"];
const SIGNS: [Sign; 4] = [
    Sign::Auto,
    Sign::PseudoNormal,
    Sign::Winding,
    Sign::Unsigned,
];

/// A file of PLY, OBJ or STL. The first byte chooses: the two lowest bits the name, the next two how inside and
/// outside are told apart, the next three the axis that is up, a narrow band, and what is positive.
pub fn mesh(data: &[u8]) {
    let Some((first, bytes)) = data.split_first() else {
        return;
    };
    let chosen = |shift: u8| usize::from(first >> shift & 3);
    let mesh = match Mesh::from_bytes(NAMES[chosen(0)], bytes, &ReadOptions::default()) {
        Ok(mesh) => mesh,
        Err(error) => return told(&error),
    };
    let report = mesh.report();
    assert_eq!(report.triangles, mesh.triangles().len());
    let _ = format!("{report:?}");
    if mesh.triangles().len() > FEW {
        return;
    }
    let options = FieldOptions {
        resolution: Resolution::Dims([4; 3]),
        margin: 1,
        sign: SIGNS[chosen(2)],
        up: if first & 0x10 == 0 { Up::Z } else { Up::Y },
        band: (first & 0x20 != 0).then_some(1.5),
        positive_inside: first & 0x40 != 0,
        ..FieldOptions::default()
    };
    match distance_field(&mesh, &options) {
        Ok(field) => {
            assert_eq!(field.voxels().len(), 64);
            field
                .voxels()
                .for_each(|distance| assert!(!distance.is_nan()));
        }
        Err(error) => told(&error),
    }
}

fn told(error: &MeshError) {
    assert!(!error.to_string().is_empty() && !error.trouble().remedy.is_empty());
}
