//! Pictures in tiles: the same picture, bit for bit, with all of its layers; what cannot be parted is refused by name.

use volgraph::{Findings, Picture, Session};
use volgraph_picture::LayerValues;
use volgraph_tests::{STAGES, adapters, open, root};

/// Neither side is whole tiles.
const SIZE: [u32; 2] = [61, 37];
const TILE: u32 = 24;

/// All numbers of a picture, bit by bit, with their names.
fn bits(picture: &Picture) -> Vec<(String, Vec<u32>)> {
    let scalars = |values: &[f32]| values.iter().map(|it| it.to_bits()).collect();
    let vectors = |values: &[[f32; 4]]| values.iter().flatten().map(|it| it.to_bits()).collect();
    let mut bits = vec![("color".to_owned(), vectors(&picture.color))];
    for (name, values) in [("depth", &picture.depth), ("opacity", &picture.opacity)] {
        bits.extend(values.iter().map(|it| (name.to_owned(), scalars(it))));
    }
    bits.extend(picture.layers.iter().map(|layer| {
        let values = match &layer.values {
            LayerValues::Scalar(values) => scalars(values),
            LayerValues::Vector(values) => vectors(values),
        };
        (layer.name.clone(), values)
    }));
    bits
}

/// The whole picture, and that of tiles.
fn both(graph: &str, sets: &[&str], backend: &str) -> Result<[Picture; 2], Findings> {
    let path = root().join(format!("graphs/{graph}.ron"));
    let mut session = open(&path, sets, backend, SIZE)?;
    let (whole, _) = session.render()?;
    let parts = tiled(&mut session)?;
    // The session is as it was.
    assert_eq!(session.render()?.0, whole, "{graph}");
    Ok([whole, parts])
}

fn tiled(session: &mut Session) -> Result<Picture, Findings> {
    let mut told = Vec::new();
    let (picture, _) =
        session.render_tiled(SIZE, Some(TILE), &mut |done, of| told.push((done, of)))?;
    assert_eq!(told, [(1, 6), (2, 6), (3, 6), (4, 6), (5, 6), (6, 6)]);
    Ok(picture)
}

fn check(graph: &str, [whole, parts]: &[Picture; 2]) {
    for ((name, of_whole), (_, of_parts)) in bits(whole).iter().zip(&bits(parts)) {
        let pairs = of_whole.iter().zip(of_parts);
        let apart = pairs.filter(|(a, b)| a != b).count();
        assert_eq!(apart, 0, "{graph}: {name} of {}", of_whole.len());
    }
    assert_eq!(whole.metadata, parts.metadata, "{graph}");
    assert_eq!(bits(whole).len(), bits(parts).len(), "{graph}");
}

#[test]
fn every_ready_graph_is_the_same_in_tiles_or_says_why_not() {
    let backend = &adapters()[0];
    let mut refused = Vec::new();
    let mut files: Vec<_> = std::fs::read_dir(root().join("graphs"))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|it| it == "ron"))
        .collect();
    files.sort();
    for file in files {
        let graph = file.file_stem().unwrap().to_str().unwrap().to_owned();
        match both(&graph, &[], backend) {
            Ok(pictures) => check(&graph, &pictures),
            Err(findings) => {
                let sorted = findings.sorted();
                assert!(
                    sorted.iter().all(|it| it.code == "no-window"),
                    "{graph}: {findings}"
                );
                assert!(
                    sorted.iter().all(|it| it.place.is_some()),
                    "{graph}: {findings}"
                );
                refused.push(graph);
            }
        }
    }
    // They draw on the processor.
    assert_eq!(refused, ["difference", "shear_warp", "software"]);
}

#[test]
fn both_stages_and_all_adapters_have_no_seams() {
    for backend in adapters() {
        for stage in STAGES {
            let stage = format!("image.stage={stage}");
            check(
                "quickstart",
                &both("quickstart", &[&stage], &backend).unwrap(),
            );
        }
        for graph in ["orthographic", "slices", "error"] {
            check(graph, &both(graph, &[], &backend).unwrap());
        }
    }
}

#[test]
fn the_camera_is_fitted_to_the_whole_picture() {
    let path = root().join("graphs/quickstart.ron");
    let backend = &adapters()[0];
    let whole = open(&path, &[], backend, SIZE).unwrap().render().unwrap().0;
    // The session's own picture has another form.
    let mut session = open(&path, &[], backend, [8, 40]).unwrap();
    check("quickstart", &[whole, tiled(&mut session).unwrap()]);
    for size in [[0, 8], [1 << 17, 8], [1 << 16, 1 << 16]] {
        let findings = session
            .render_tiled(size, None, &mut |_, _| {})
            .unwrap_err();
        assert_eq!(findings.sorted()[0].code, "picture-size");
    }
}
