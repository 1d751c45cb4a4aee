//! The ray of a pixel: a click asks for it, the panel tells it, the planes go there.

use egui::{PointerButton, vec2};
use volgraph_viewer::Pane;

use crate::desk::{Desk, graph};

fn desk() -> Desk {
    let slots = r#"{ "technique": "dvr", "classify": "preintegrated_2d" }"#;
    Desk::open(&graph(slots, r#"{ "step": 0.5 }"#))
}

#[test]
fn a_click_tells_why_a_pixel_has_its_value() {
    let mut desk = desk();
    let picture = desk.settle("the picture");
    desk.tab(Pane::Ray);
    desk.harness.run_steps(2);
    assert!(desk.shows("Click into the view"));
    let at = desk.view_rect().center() + vec2(5.0, -3.0);
    desk.click_at(at, PointerButton::Primary);
    desk.wait_until("the study", |told| told.ray.is_some() && !told.is_studying);
    let study = desk.told(|told| told.ray.clone()).unwrap().unwrap();
    let [x, y] = study.pixel;
    let pixel = picture.pixel(x, y).unwrap();
    let sums = study.sum();
    for (channel, seen) in pixel.into_iter().take(3).enumerate() {
        let off = (study.over[channel] - f64::from(seen)).abs();
        assert!(off < 1e-3, "{channel}: {seen}");
        assert!((sums[channel] - study.color[channel]).abs() < 1e-3);
    }
    assert!(study.sum()[3] > 0.01, "there is something to see");
    desk.harness.run_steps(2);
    assert!(desk.shows(&format!("pixel {x}, {y}")));
    assert!(desk.shows("segments taken"));

    // The planes go to where the ray met most.
    let probe = study.hit.as_ref().or(study.strongest.as_ref()).unwrap();
    desk.tab(Pane::Slices);
    desk.harness.run_steps(2);
    let voxel = probe.index.map(f64::round);
    assert!(desk.shows(&format!("voxel [{}, {}, {}]", voxel[0], voxel[1], voxel[2])));
}

#[test]
fn beside_the_volume_there_is_nothing_to_tell() {
    let mut desk = desk();
    desk.settle("the picture");
    desk.tab(Pane::Ray);
    let corner = desk.view_rect().left_top() + vec2(3.0, 3.0);
    desk.click_at(corner, PointerButton::Primary);
    desk.wait_until("the study", |told| told.ray.is_some() && !told.is_studying);
    desk.harness.run_steps(2);
    assert!(desk.shows("The ray misses the volume."));
}
