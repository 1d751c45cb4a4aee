//! The mouse and keys over the picture.

use egui::{Key, Modifiers, PointerButton, vec2};
use glam::DVec3;
use volgraph_engine::Camera;
use volgraph_graph::Projection;

use crate::desk::{Desk, flat};

/// Waits until the camera is another one, and gives it.
fn moved(desk: &mut Desk, what: &str, before: &Camera) -> Camera {
    desk.answered();
    desk.wait_until(what, |told| told.camera.is_some_and(|now| now != *before));
    desk.settle(what);
    desk.told(|told| told.camera.unwrap())
}

/// What it turns around: the middle of the volume.
fn pivot(desk: &Desk) -> DVec3 {
    desk.told(|told| {
        let corners = told.plan.as_ref().unwrap().corners();
        corners.iter().sum::<DVec3>() / corners.len() as f64
    })
}

#[test]
fn drags_orbit_pan_and_zoom() {
    let mut desk = Desk::open(&flat());
    desk.settle("the first picture");
    let first = desk.told(|told| told.camera.unwrap());
    let middle = desk.view_rect().center();
    let (pivot, height) = (pivot(&desk), f64::from(desk.view_rect().height()));
    let aside = [middle, middle + vec2(60.0, 0.0)];

    desk.drag(aside, PointerButton::Primary, Modifiers::NONE);
    let orbited = moved(&mut desk, "an orbit", &first);
    let distance = first.eye.distance(pivot);
    assert!((orbited.eye.distance(pivot) - distance).abs() < 1e-9 * distance);
    // Half a turn over the height of the view, around the vertical axis: the eye stays level.
    assert!((orbited.eye.z - first.eye.z).abs() < 1e-9 * distance);
    let flat = |eye: DVec3| (eye - pivot).truncate();
    let turned = flat(first.eye).angle_to(flat(orbited.eye));
    let expected = -180.0_f64.to_radians() * 60.0 / height;
    assert!((turned - expected).abs() < 1e-6, "{turned}, {expected}");

    desk.drag(aside, PointerButton::Primary, Modifiers::SHIFT);
    let panned = moved(&mut desk, "a pan", &orbited);
    assert_eq!(panned.forward, orbited.forward);
    let shift = panned.eye - orbited.eye;
    assert!(
        shift.dot(orbited.right) < 0.0,
        "the scene goes with the mouse"
    );
    assert!((shift.normalize().dot(orbited.right) + 1.0).abs() < 1e-9);

    desk.drag(aside, PointerButton::Middle, Modifiers::NONE);
    let again = moved(&mut desk, "a pan by the middle button", &panned);
    let by_middle = again.eye - panned.eye;
    assert!(by_middle.distance(shift) < 1e-9, "{by_middle}, {shift}");

    desk.drag(aside, PointerButton::Primary, Modifiers::COMMAND);
    let rolled = moved(&mut desk, "a roll", &again);
    assert!(rolled.eye.distance(again.eye) < 1e-12 && rolled.up != again.up);

    let down = [middle, middle + vec2(0.0, 40.0)];
    desk.drag(down, PointerButton::Secondary, Modifiers::NONE);
    let zoomed = moved(&mut desk, "a zoom", &rolled);
    assert!(zoomed.eye.distance(pivot) != rolled.eye.distance(pivot));
    assert_eq!(zoomed.forward, rolled.forward);
}

#[test]
fn the_wheel_zooms_in_and_out() {
    let mut desk = Desk::open(&flat());
    desk.settle("the first picture");
    let first = desk.told(|told| told.camera.unwrap());
    let pivot = pivot(&desk);
    let wheel = |desk: &mut Desk, turned: f32| {
        let at = desk.view_rect().center();
        desk.wheel(at, turned);
    };
    wheel(&mut desk, 50.0);
    let near = moved(&mut desk, "a zoom in", &first);
    assert!(near.eye.distance(pivot) < first.eye.distance(pivot));
    wheel(&mut desk, -50.0);
    let back = moved(&mut desk, "a zoom out", &near);
    assert!(back.eye.distance(first.eye) < 1e-4 * first.eye.distance(pivot));
}

#[test]
fn keys_look_along_the_axes() {
    let mut desk = Desk::open(&flat());
    desk.settle("the first picture");
    let mut before = desk.told(|told| told.camera.unwrap());
    // As the sheet says: front, back, left, right, top, bottom.
    for (key, forward) in [
        (Key::Num1, DVec3::Y),
        (Key::Num2, DVec3::NEG_Y),
        (Key::Num3, DVec3::NEG_X),
        (Key::Num4, DVec3::X),
        (Key::Num5, DVec3::NEG_Z),
        (Key::Num6, DVec3::Z),
    ] {
        desk.harness.key_press(key);
        desk.harness.run_steps(2);
        let now = moved(&mut desk, "an axis view", &before);
        assert!(
            now.forward.distance(forward) < 1e-9,
            "{key:?}: {}",
            now.forward
        );
        before = now;
    }
    desk.harness.key_press(Key::O);
    let parallel = moved(&mut desk, "a parallel projection", &before);
    let is_parallel =
        |camera: &Camera| matches!(camera.projection, Projection::Orthographic { .. });
    assert!(is_parallel(&parallel) && !is_parallel(&before));
    desk.harness.key_press(Key::O);
    let back = moved(&mut desk, "a perspective again", &parallel);
    assert!(!is_parallel(&back));
}

/// Whatever was panned away is in the middle again.
#[test]
fn fitting_brings_the_volume_back() {
    let mut desk = Desk::open(&flat());
    let first = desk.settle("the first picture");
    let camera = desk.told(|told| told.camera.unwrap());
    let middle = desk.view_rect().center();
    for _ in 0..3 {
        let away = [middle, middle + vec2(250.0, 200.0)];
        desk.drag(away, PointerButton::Primary, Modifiers::SHIFT);
    }
    let away = moved(&mut desk, "a pan", &camera);
    let gone = desk.next("the picture of no volume", &first);
    assert_eq!(crate::desk::middle(&gone), [0.0, 0.0, 0.125, 1.0]);
    desk.harness.key_press(Key::F);
    moved(&mut desk, "what is fitted", &away);
    let back = desk.next("the volume", &gone);
    assert_eq!(crate::desk::middle(&back), [0.25, 0.5, 0.25, 1.0]);
    for corner in [[0, 0], [back.width - 1, back.height - 1]] {
        let [x, y] = corner;
        assert_eq!(back.pixel(x, y).unwrap(), [0.0, 0.0, 0.125, 1.0]);
    }
}

/// What stands over the picture says so where it has nothing to show.
#[test]
fn overlays_bear_with_no_pictures() {
    let mut desk = Desk::begin("no graph", "graph.ron");
    desk.wait_until("the mistake", |told| !told.findings.is_empty());
    for key in [Key::B, Key::C] {
        desk.harness.key_press(key);
        desk.harness.run_steps(4);
    }
    for name in [
        "Before and after",
        "Difference",
        "Error against the reference",
    ] {
        desk.radio("Compare", name);
        desk.harness.run_steps(4);
    }
    assert!(desk.told(|told| told.shown.is_none()));
    desk.write("graph.ron", flat());
    desk.settle("the mended graph's picture");
    for name in [
        "Before and after",
        "Difference",
        "Error against the reference",
        "Picture alone",
    ] {
        desk.radio("Compare", name);
        desk.harness.run_steps(4);
    }
}
