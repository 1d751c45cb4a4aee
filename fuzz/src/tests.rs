//! Seeds pass, and most of them are good input.

use std::path::Path;

use volgraph_formats::{LoadOptions, from_bytes, load};
use volgraph_mesh::{Mesh, ReadOptions};
use volgraph_optics::TransferFunction;
use volgraph_volume::Component;

use crate::folder::Folder;
use crate::folders::open_bricks;
use crate::text::{checked, file, planned};
use crate::volumes::{component, options, read_slices};
use crate::*;

type Target = fn(&[u8]);

/// The seeds of a target by name.
fn seeds(target: &str) -> Vec<(String, Vec<u8>)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("seeds")
        .join(target);
    let files = std::fs::read_dir(folder).expect("a folder of seeds");
    files
        .map(|file| {
            let file = file.expect("a seed");
            let bytes = std::fs::read(file.path()).expect("a seed that can be read");
            (file.file_name().to_string_lossy().into_owned(), bytes)
        })
        .collect()
}

#[test]
fn every_seed_passes() {
    let targets: [(&str, Target); 19] = [
        ("raw_name", raw_name),
        ("nrrd", nrrd),
        ("metaimage", metaimage),
        ("graph", graph),
        ("plan", plan),
        ("transfer", transfer),
        ("shader", shader),
        ("nifti", nifti),
        ("vti", vti),
        ("npy", npy),
        ("hdf5", hdf5),
        ("zarr_zip", zarr_zip),
        ("dicom", dicom),
        ("tiff", tiff),
        ("pictures", pictures),
        ("zarr", zarr),
        ("mesh", mesh),
        ("bricks", bricks),
        ("recognise", recognise),
    ];
    for (name, target) in targets {
        for (_, bytes) in seeds(name) {
            target(&bytes);
        }
    }
}

/// A seed that is refused at the door teaches a fuzzer little.
#[test]
fn most_seeds_are_good_input() {
    let text = |bytes: &[u8]| String::from_utf8(bytes.to_vec()).expect("text");
    for (name, bytes) in seeds("plan") {
        assert!(planned(&text(&bytes)).is_some(), "plan/{name}");
    }
    for (name, bytes) in seeds("transfer") {
        assert!(
            TransferFunction::parse(file(), &text(&bytes)).is_ok(),
            "transfer/{name}"
        );
    }
    for (name, bytes) in seeds("shader") {
        assert_eq!(
            checked(&text(&bytes)).is_some(),
            name != "cycle",
            "shader/{name}"
        );
    }
    for (name, bytes) in seeds("nrrd").into_iter().chain(seeds("metaimage")) {
        let options = LoadOptions {
            component: component(bytes[0]).map(Component::Index),
            ..LoadOptions::default()
        };
        let is_detached = ["list", "series"].contains(&name.as_str());
        let volume = from_bytes("seed", &bytes[1..], &options);
        assert_eq!(volume.is_err(), is_detached, "{name}: {volume:?}");
    }
}

#[test]
fn most_seeds_of_volumes_are_good_input() {
    let mut refused: Vec<String> = Vec::new();
    let mut note = |target: &str, name: &str, told: Option<String>| {
        if let Some(told) = told {
            eprintln!("{target}/{name}: {told}");
            refused.push(format!("{target}/{name}"));
        }
    };
    for (target, at) in [
        ("nifti", 0),
        ("vti", 0),
        ("npy", 0),
        ("hdf5", 0),
        ("zarr_zip", 0),
        ("recognise", 1),
    ] {
        for (name, bytes) in seeds(target) {
            let volume = from_bytes("seed", &bytes[at + 1..], &options(bytes[at]));
            note(target, &name, volume.err().map(|error| error.to_string()));
        }
    }
    for (target, ending) in [("dicom", "dcm"), ("tiff", "tif"), ("pictures", "png")] {
        for (name, bytes) in seeds(target) {
            let volume = read_slices(ending, &bytes);
            note(target, &name, volume.err().map(|error| error.to_string()));
        }
    }
    for (name, bytes) in seeds("zarr") {
        let folder = Folder::of(&bytes[1..]);
        let volume = load(folder.path(), &options(bytes[0]));
        note("zarr", &name, volume.err().map(|error| error.to_string()));
    }
    for (name, bytes) in seeds("mesh") {
        let mesh = Mesh::from_bytes("seed", &bytes[1..], &ReadOptions::default());
        note("mesh", &name, mesh.err().map(|error| error.to_string()));
    }
    for (name, bytes) in seeds("bricks") {
        let opened = open_bricks(&bytes).map(|(store, _)| store.err());
        let told = opened.map_or(Some("too short".to_owned()), |error| {
            error.map(|error| error.to_string())
        });
        note("bricks", &name, told);
    }
    refused.sort();
    assert_eq!(refused, REFUSED);
}

/// Seeds of content that is known and not read.
const REFUSED: [&str; 5] = [
    "dicom/deflated",
    "dicom/jpeg_ls",
    "dicom/palette",
    "dicom/short",
    "tiff/images",
];
