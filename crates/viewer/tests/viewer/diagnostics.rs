//! Mistakes on disk: told with their place, they leave the picture; mended, they are gone.

use volgraph_viewer::Pane;

use crate::desk::{Desk, FLAT, FLAT_FILE, assert_same, flat, middle};

#[test]
fn a_broken_shader_is_told_with_its_place_and_leaves_the_picture() {
    let mut desk = Desk::open(&flat());
    let first = desk.settle("the first picture");
    let serial = desk.told(|told| told.serial);
    assert!(desk.has("View"));
    let broken = FLAT.replace("params.bright, params.free", "params.bright, params.fre");
    assert_ne!(broken, FLAT);
    desk.write(FLAT_FILE, &broken);
    desk.wait_until("the mistake", |told| !told.findings.is_empty());
    desk.told(|told| {
        let finding = told.findings.sorted()[0].clone();
        let place = finding.place.unwrap();
        assert!(place.file.ends_with(FLAT_FILE), "{place:?}");
        let line = FLAT.lines().position(|line| line.contains("params.free"));
        assert_eq!(place.line as usize, line.unwrap() + 1);
        assert!(told.shown.is_some(), "a picture stays");
        assert!(told.serial >= serial);
    });
    assert_same(&desk.settle("the last good picture"), &first);
    assert!(desk.has("View, with the last good picture"));
    // On the tab, in the menu's line and in the panel, with the line that is wrong.
    assert!(desk.has("Messages (1)"));
    assert!(desk.has("1 wrong"));
    desk.tab(Pane::Messages);
    assert!(desk.has("1 finding; the last good picture stays"));
    assert!(desk.has_text("params.fre,"), "the line is shown");
    let line = FLAT
        .lines()
        .position(|line| line.contains("params.free"))
        .unwrap()
        + 1;
    let place = format!("flat.wgsl:{line}:");
    assert!(desk.shows(&place), "{place}");

    desk.write(FLAT_FILE, FLAT.replace("/ 8.0", "/ 16.0"));
    let mended = desk.next("the mended shader's picture", &first);
    assert_eq!(middle(&mended), [0.25, 0.5, 0.125, 1.0]);
    assert!(desk.told(|told| told.findings.is_empty()));
    assert!(desk.has("Messages") && desk.has("View") && desk.has("Nothing is wrong."));
    assert!(!desk.has("1 wrong"));
}

/// While a mistake stands, the camera still moves through the last good state.
#[test]
fn the_camera_moves_while_a_mistake_stands() {
    let mut desk = Desk::open(&flat());
    let first = desk.settle("the first picture");
    desk.write(FLAT_FILE, "this is no shader");
    desk.wait_until("the mistake", |told| !told.findings.is_empty());
    let mut camera = desk.told(|told| told.camera.unwrap());
    camera.eye += camera.right * 0.4;
    desk.ask(volgraph_viewer::Request::Camera(camera));
    let moved = desk.next("the picture from elsewhere", &first);
    assert_ne!(moved.color, first.color);
    let told = desk.told(|told| (told.findings.len(), told.camera.unwrap()));
    assert_eq!(told.1, camera);
    assert!(told.0 > 0, "the mistake still stands, and is still told");
}

/// Values that a graph refuses are told, and the ones before stay.
#[test]
fn a_refused_value_leaves_the_picture() {
    let mut desk = Desk::open(&flat());
    let first = desk.settle("the first picture");
    let set = volgraph_engine::ParamOverride::parse("image.no_such_thing=3").unwrap();
    desk.ask(volgraph_viewer::Request::Set(vec![set]));
    desk.wait_until("the refusal", |told| !told.findings.is_empty());
    assert_same(&desk.settle("the picture before"), &first);
    let set = volgraph_engine::ParamOverride::parse("image.bright=0.5").unwrap();
    desk.ask(volgraph_viewer::Request::Set(vec![set]));
    let picture = desk.next("a value that is taken", &first);
    assert_eq!(middle(&picture)[0], 0.5);
    assert!(desk.told(|told| told.findings.is_empty()));
}

#[test]
fn a_graph_that_cannot_be_opened_is_drawn_once_it_is_mended() {
    let mut desk = Desk::begin(&flat().replace("outputs", "oututs"), "graph.ron");
    desk.wait_until("the mistake", |told| !told.findings.is_empty());
    assert!(desk.told(|told| told.shown.is_none() && !told.is_busy));
    desk.tab(Pane::Messages);
    assert!(desk.has_text("oututs"), "the line is shown");
    desk.write("graph.ron", flat());
    let picture = desk.settle("the mended graph's picture");
    assert_eq!(middle(&picture), [0.25, 0.5, 0.25, 1.0]);
    assert!(desk.told(|told| told.findings.is_empty()));
}

#[test]
fn a_graph_that_is_not_there_is_drawn_once_it_is() {
    let mut desk = Desk::begin(&flat(), "later.ron");
    desk.wait_until("that it is missing", |told| !told.findings.is_empty());
    desk.write("later.ron", flat());
    let picture = desk.settle("the new graph's picture");
    assert_eq!(middle(&picture), [0.25, 0.5, 0.25, 1.0]);
}

#[test]
fn findings_are_copied_with_their_places() {
    let mut desk = Desk::open(&flat());
    desk.write(FLAT_FILE, FLAT.replace("params.free", "params.fre"));
    desk.wait_until("the mistake", |told| !told.findings.is_empty());
    desk.tab(Pane::Messages);
    let copied = desk.copied_by("Copy all");
    for part in ["flat.wgsl", "params.fre,", "fre"] {
        assert!(copied.contains(part), "{part} in\n{copied}");
    }
}
