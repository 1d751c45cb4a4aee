//! Scanned meshes against trimesh (`make_expected.py`), and their fields against themselves.
#![allow(clippy::print_stdout, reason = "what was measured, and what was not")]
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod common;

use std::collections::HashMap;
use std::time::Instant;

use common::data_folder;
use glam::DVec3;
use volgraph_mesh::{
    FieldOptions, Mesh, ReadOptions, Sign, SignMethod, SignedDistance, distance_field,
};
use volgraph_volume::{Volume, Voxels};

fn table(text: &str) -> Vec<HashMap<&str, &str>> {
    let mut lines = text.lines();
    let columns: Vec<&str> = lines.next().unwrap().split('\t').collect();
    lines
        .map(|line| columns.iter().copied().zip(line.split('\t')).collect())
        .collect()
}

fn point(text: &str) -> DVec3 {
    let numbers: Vec<f64> = text.split(' ').map(|word| word.parse().unwrap()).collect();
    DVec3::from_slice(&numbers)
}

/// Each mesh of the table, where the shared data is at hand.
fn meshes() -> Vec<(HashMap<&'static str, &'static str>, Mesh)> {
    let Some(folder) = data_folder() else {
        println!("no shared test data: the scanned meshes were not read");
        return Vec::new();
    };
    table(include_str!("expected_meshes.tsv"))
        .into_iter()
        .map(|row| {
            let path = folder.join("mesh").join(row["file"]);
            let mesh = Mesh::read(&path, &ReadOptions::default()).unwrap();
            assert_eq!(mesh.source_files(), [path]);
            (row, mesh)
        })
        .collect()
}

#[test]
fn counts_are_those_of_trimesh() {
    for (row, mesh) in meshes() {
        let report = mesh.report();
        let name = row["file"];
        let is = |column: &str, got: String| assert_eq!(got, row[column], "{name}: {column}");
        is("vertices", report.vertices.to_string());
        is("triangles", report.triangles.to_string());
        is("merged", report.places.to_string());
        is("boundary", report.boundary_edges.to_string());
        is("components", report.components.to_string());
        let python = |yes: bool| if yes { "True" } else { "False" }.to_owned();
        is("watertight", python(report.is_watertight()));
        is("oriented", python(report.is_oriented()));
        is("euler", report.euler.to_string());
        let volume: f64 = row["volume"].parse().unwrap();
        // trimesh integrates an open mesh about the origin, we about the middle of its bounds.
        if report.is_watertight() {
            let off = report.signed_volume / volume - 1.0;
            assert!(off.abs() < 1e-9, "{name}: {off}");
        }
        assert_eq!(
            report.bounds,
            (point(row["lo"]), point(row["hi"])),
            "{name}"
        );
    }
}

#[test]
fn distances_are_those_of_trimesh() {
    let rows = table(include_str!("expected_distances.tsv"));
    for (mesh_row, mesh) in meshes() {
        let name = mesh_row["file"];
        let distance = SignedDistance::new(&mesh, Sign::Auto).unwrap();
        let winding = SignedDistance::new(&mesh, Sign::Winding).unwrap();
        let closed = mesh.report().is_watertight();
        let method = if closed {
            SignMethod::PseudoNormal
        } else {
            SignMethod::Winding
        };
        assert_eq!(distance.method(), method, "{name}");
        let (mut checked, mut inside) = (0, 0);
        for row in rows.iter().filter(|row| row["file"] == name) {
            let p = point(row["point"]);
            let want: f64 = row["distance"].parse().unwrap();
            for distance in [&distance, &winding] {
                let got = distance.at(p);
                let off = (got.abs() - want) / want;
                assert!(off.abs() < 1e-6, "{name} {p}: {got}, not {want}");
                if closed {
                    assert_eq!(
                        row["sign"] == "-",
                        got < 0.0,
                        "{name} {p}: {:?}",
                        distance.method()
                    );
                }
            }
            checked += 1;
            inside += i32::from(distance.at(p) < 0.0);
        }
        assert_eq!(checked, 50, "{name}");
        assert!(inside > 10, "{name}: {inside}");
    }
}

/// At 128 voxels: the surface of the field is the mesh.
#[test]
fn the_zero_of_a_field_lies_on_its_mesh() {
    for (row, mesh) in meshes() {
        let name = row["file"];
        let start = Instant::now();
        let field = distance_field(&mesh, &FieldOptions::default()).unwrap();
        println!("{name}: {:?} in {:?}", field.grid().dims, start.elapsed());
        let voxel = field.grid().min_spacing();
        let index_from_world = field.grid().world_from_index.inverse();
        for corner in mesh.corners().flatten().step_by(7) {
            let at = index_from_world.transform_point3(corner);
            let value = field.trilinear(at).abs();
            assert!(value <= voxel, "{name}: {value} at {corner}");
        }
        // Where the sign changes between neighbours, the mesh passes: only holes may be crossed far from it.
        let (crossings, far) =
            crossings(&field, &SignedDistance::new(&mesh, Sign::Unsigned).unwrap());
        assert!(crossings > 10_000, "{name}: {crossings}");
        let allowed = if mesh.report().is_watertight() {
            0
        } else {
            crossings / 10
        };
        assert!(far <= allowed, "{name}: {far} of {crossings}");
        println!("{name}: {far} of {crossings} crossings are more than a voxel off");
    }
}

/// Where the field passes zero between neighbours, and how many of these points are more than a voxel from the mesh.
fn crossings(field: &Volume, distance: &SignedDistance) -> (usize, usize) {
    let Voxels::F32(values) = field.voxels() else {
        panic!("no float32");
    };
    let [nx, ny, nz] = field.grid().dims.map(|n| n as usize);
    let voxel = field.grid().min_spacing();
    let (mut all, mut far) = (0, 0);
    for z in 0..nz {
        for y in 0..ny {
            for x in 0..nx {
                let i = (z * ny + y) * nx + x;
                let here = f64::from(values[i]);
                let steps = [(x + 1 < nx, 1), (y + 1 < ny, nx), (z + 1 < nz, nx * ny)];
                for (axis, (within, step)) in steps.into_iter().enumerate() {
                    if !within || (here < 0.0) == (values[i + step] < 0.0) {
                        continue;
                    }
                    let there = f64::from(values[i + step]);
                    let mut at = DVec3::new(x as f64, y as f64, z as f64);
                    at[axis] += here / (here - there);
                    let p = field.grid().world_from_index.transform_point3(at);
                    all += 1;
                    far += usize::from(distance.at(p) > voxel);
                }
            }
        }
    }
    (all, far)
}
