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
    let targets: [(&str, Target); 17] = [
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
    for target in ["nifti", "vti", "npy", "recognise"] {
        for (name, bytes) in seeds(target) {
            let at = if target == "recognise" { 1 } else { 0 };
            let volume = from_bytes("seed", &bytes[at + 1..], &options(bytes[at]));
            assert!(volume.is_ok(), "{target}/{name}: {volume:?}");
        }
    }
    for (target, ending) in [("dicom", "dcm"), ("tiff", "tif"), ("pictures", "png")] {
        for (name, bytes) in seeds(target) {
            let volume = read_slices(ending, &bytes);
            assert!(volume.is_ok(), "{target}/{name}: {volume:?}");
        }
    }
    for (name, bytes) in seeds("zarr") {
        let folder = Folder::of(&bytes[1..]);
        let volume = load(folder.path(), &options(bytes[0]));
        assert!(volume.is_ok(), "zarr/{name}: {volume:?}");
    }
    for (name, bytes) in seeds("mesh") {
        let mesh = Mesh::from_bytes("seed", &bytes[1..], &ReadOptions::default());
        assert!(mesh.is_ok(), "mesh/{name}: {mesh:?}");
    }
    for (name, bytes) in seeds("bricks") {
        let opened = open_bricks(&bytes).map(|(store, _)| store.map(|_| ()));
        assert!(matches!(opened, Some(Ok(()))), "bricks/{name}: {opened:?}");
    }
}
