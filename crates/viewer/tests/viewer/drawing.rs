//! The drawing thread: what it shows is what a session renders, whatever is asked of it and whatever happens to its device.

use std::time::Duration;

use volgraph_engine::Camera;
use volgraph_viewer::{Request, Told};

use crate::desk::{Desk, FLAT, FLAT_FILE, assert_same, flat, graph, middle, render};

fn dvr() -> String {
    graph(r#"{ "technique": "dvr", "light": "phong" }"#, "{}")
}

fn aside(told: &Told) -> Camera {
    let mut camera = told.camera.unwrap();
    camera.eye += camera.right * 0.3 + camera.up * 0.1;
    camera
}

#[test]
fn the_picture_is_what_a_session_renders() {
    let mut desk = Desk::open(&dvr());
    let picture = desk.settle("the first picture");
    let size = [picture.width, picture.height];
    assert_same(&desk.rendered(&[], size), &picture);
    // By the camera that the graph describes as well, at the size of the view.
    let described = render(&desk.path(""), "graph.ron", &[], size, None);
    assert_same(&described, &picture);
    let camera = desk.told(aside);
    desk.ask(Request::Camera(camera));
    let moved = desk.next("the picture from elsewhere", &picture);
    assert_eq!(desk.told(|told| told.camera.unwrap()), camera);
    assert_ne!(moved.color, picture.color);
    assert_same(&desk.rendered(&[], size), &moved);
}

/// With no time for a frame, what moves is drawn at an eighth of its width, and what stands still in full.
#[test]
fn moving_pictures_are_coarse_where_there_is_no_time_and_still_ones_are_whole() {
    let budget = Duration::from_nanos(1);
    let mut desk = Desk::begin_with(&dvr(), "graph.ron", budget);
    let picture = desk.settle("the first picture");
    let full = [picture.width, picture.height];
    desk.ask(Request::Size([400, 300]));
    // The view asks once for its own size, and then only where that changes.
    desk.wait_until("a picture of that size", |told| {
        told.is_refined && told.refined.as_ref().is_some_and(|now| now.width == 400)
    });
    assert_ne!(full, [400, 300]);
    let before = desk.told(|told| told.refined.clone().unwrap());
    let camera = desk.told(aside);
    desk.ask(Request::Camera(camera));
    desk.wait_until("a coarse picture", |told| {
        !told.is_refined && told.camera == Some(camera)
    });
    let coarse = desk.told(|told| told.shown.as_ref().map(|shown| shown.size));
    desk.wait_until("the whole picture", |told| {
        let now = told.refined.as_ref().unwrap();
        told.is_refined && !std::sync::Arc::ptr_eq(now, &before)
    });
    let whole = desk.told(|told| told.refined.clone().unwrap());
    assert_eq!([whole.width, whole.height], [400, 300]);
    assert!(coarse.is_some_and(|[width, _]| width < 400), "{coarse:?}");
    assert_same(&desk.rendered(&[], [400, 300]), &whole);
}

#[test]
fn paused_files_are_read_when_a_frame_is_asked_for() {
    let mut desk = Desk::open(&flat());
    let first = desk.settle("the first picture");
    desk.harness.key_press(egui::Key::Space);
    desk.wait_until("the pause", |told| told.is_paused);
    desk.write(FLAT_FILE, FLAT.replace("/ 8.0", "/ 16.0"));
    // A look at a port is a full turn of the thread, and would have seen the file.
    desk.ask(Request::Look(Some("image.color".to_owned())));
    desk.wait_until("that it goes on", |told| told.looked.is_some());
    desk.ask(Request::Look(None));
    desk.wait_until("that it goes on", |told| {
        told.looked.is_none() && !told.is_busy
    });
    assert_same(&desk.settle("the picture before"), &first);
    let before = desk.told(|told| told.refined.clone().unwrap());
    desk.harness.key_press(egui::Key::Enter);
    let read = desk.next("the frame that was asked for", &before);
    assert_eq!(middle(&read), [0.25, 0.5, 0.125, 1.0]);
    assert!(desk.told(|told| told.is_paused));
    desk.write(FLAT_FILE, FLAT);
    desk.harness.key_press(egui::Key::Space);
    let followed = desk.next("the files again", &read);
    assert_same(&followed, &first);
}

/// A camera that moves while files are not followed is drawn in full all the same.
#[test]
fn the_camera_moves_and_comes_to_rest_while_paused() {
    let mut desk = Desk::open(&dvr());
    let first = desk.settle("the first picture");
    desk.ask(Request::Pause(true));
    desk.wait_until("the pause", |told| told.is_paused);
    let camera = desk.told(aside);
    desk.ask(Request::Camera(camera));
    let moved = desk.next("the picture from elsewhere", &first);
    assert_same(&desk.rendered(&[], [moved.width, moved.height]), &moved);
}

#[test]
fn a_lost_device_is_opened_again_and_drawing_goes_on() {
    let mut desk = Desk::open(&dvr());
    let first = desk.settle("the first picture");
    let gpu = desk.told(|told| told.gpu.clone().unwrap());
    gpu.destroy();
    desk.wait_until("another device", |told| {
        !std::sync::Arc::ptr_eq(told.gpu.as_ref().unwrap(), &gpu)
    });
    let notes = desk.told(|told| told.notes.clone());
    let is_told = |note: &volgraph_viewer::Note| note.text.starts_with("device opened again");
    assert!(notes.iter().any(is_told), "{notes:?}");
    assert!(desk.told(|told| told.findings.is_empty() && told.shown.is_some()));
    let camera = desk.told(aside);
    desk.ask(Request::Camera(camera));
    let moved = desk.next("the picture from elsewhere", &first);
    let size = [moved.width, moved.height];
    assert_same(&desk.rendered(&[], size), &moved);
    // Twice, and in the middle of a change.
    desk.told(|told| told.gpu.clone().unwrap()).destroy();
    let set = volgraph_engine::ParamOverride::parse("image.step=0.5").unwrap();
    desk.ask(Request::Set(vec![set]));
    let finer = desk.next("a finer picture", &moved);
    assert_same(&desk.rendered(&["image.step=0.5"], size), &finer);
}

#[test]
fn another_graph_takes_the_place_and_a_bad_one_leaves_a_picture() {
    let mut desk = Desk::open(&flat());
    let first = desk.settle("the first picture");
    desk.write("other.ron", dvr());
    let file = desk.path("other.ron");
    desk.harness.state_mut().take_file(&file);
    desk.wait_until("the other graph", |told| {
        told.scene.as_ref().is_some_and(|scene| scene.path == file)
    });
    let other = desk.next("the other graph", &first);
    let size = [other.width, other.height];
    let own = render(&desk.path(""), "other.ron", &[], size, None);
    assert_same(&own, &other);
    desk.write("bad.ron", "(nodes: {");
    let file = desk.path("bad.ron");
    desk.harness.state_mut().take_file(&file);
    desk.wait_until("what is wrong with it", |told| !told.findings.is_empty());
    assert!(desk.told(|told| told.shown.is_some()), "never blank");
    desk.write("bad.ron", flat());
    desk.wait_until("the mended graph", |told| {
        told.scene.as_ref().is_some_and(|scene| scene.path == file)
    });
    let mended = desk.next("the mended graph", &other);
    assert_eq!(middle(&mended), [0.25, 0.5, 0.25, 1.0]);
    assert_eq!([mended.width, mended.height], size);
    assert_same(&mended, &first);
}

#[test]
fn a_volume_alone_is_opened() {
    let mut desk = Desk::begin(&flat(), "v_16x16x16_float32.raw");
    let picture = desk.settle("the volume's picture");
    let colors: std::collections::BTreeSet<[u32; 4]> = picture
        .color
        .iter()
        .map(|color| color.map(f32::to_bits))
        .collect();
    assert!(
        colors.len() > 20,
        "something is seen: {} colours",
        colors.len()
    );
    desk.tab(volgraph_viewer::Pane::Slices);
    assert!(desk.has("voxel [8, 8, 8]"));
}

#[test]
fn pictures_of_any_shape_are_drawn() {
    let mut desk = Desk::open(&flat());
    desk.settle("the first picture");
    for size in [[1, 1], [2000, 1], [1, 2000], [0, 7], [33, 17]] {
        desk.ask(Request::Size(size));
        let expected = size.map(|side: u32| side.max(1));
        desk.wait_until("a picture of that size", |told| {
            told.is_refined
                && told
                    .refined
                    .as_ref()
                    .is_some_and(|now| [now.width, now.height] == expected)
        });
        assert!(desk.told(|told| told.findings.is_empty()), "{size:?}");
    }
    // More than any device draws is refused, and the picture stays.
    desk.ask(Request::Size([1_000_000, 1_000_000]));
    desk.wait_until("that it is too large", |told| !told.findings.is_empty());
    assert!(desk.told(|told| told.shown.is_some()));
    desk.ask(Request::Size([40, 30]));
    desk.wait_until("a picture that can be drawn", |told| {
        told.findings.is_empty()
            && told.is_refined
            && told.refined.as_ref().is_some_and(|now| now.width == 40)
    });
}

/// Ray marching with small steps comes near to the float64 reference.
#[test]
fn a_comparison_finds_a_small_error() {
    let coarse = graph(r#"{ "technique": "dvr" }"#, r#"{ "step": 8.0 }"#);
    let mut desk = Desk::open(&coarse);
    let compared = |desk: &mut Desk| {
        desk.wait_until("the comparison", |told| {
            !told.is_comparing && told.error_map.is_some()
        });
        let map = desk.told(|told| told.error_map.clone().unwrap());
        map.unwrap_or_else(|findings| panic!("{findings}"))
    };
    desk.harness.key_press(egui::Key::C);
    let rough = compared(&mut desk);
    assert!(
        rough.size[0] <= 96 && rough.size[1] <= 96,
        "{:?}",
        rough.size
    );
    assert!(f64::from(rough.max) >= rough.rmse);
    let first = desk.settle("the first picture");
    let set = volgraph_engine::ParamOverride::parse("image.step=0.25").unwrap();
    desk.ask(Request::Set(vec![set]));
    desk.next("a finer picture", &first);
    desk.ask(Request::Compare);
    desk.wait_until("another comparison", |told| {
        let map = told.error_map.as_ref().and_then(|map| map.as_ref().ok());
        map.is_some_and(|map| !std::sync::Arc::ptr_eq(map, &rough))
    });
    let fine = compared(&mut desk);
    assert!(fine.rmse < 2e-3, "{}", fine.rmse);
    assert!(fine.rmse < 0.5 * rough.rmse, "{} {}", fine.rmse, rough.rmse);
}
