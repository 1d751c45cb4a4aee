//! The transfer function under the mouse: edits are seen, taken back and saved.

use std::sync::Arc;

use egui::accesskit::Role;
use egui::{Modifiers, PointerButton, Pos2, pos2, vec2};
use egui_kittest::kittest::{NodeT, Queryable};
use volgraph_engine::Picture;
use volgraph_optics::TransferFunction;
use volgraph_viewer::Pane;

use crate::desk::{Desk, assert_same, graph};

const CURVE: &str = "Transfer function curve";

fn open() -> (Desk, Arc<Picture>) {
    let mut desk = Desk::open(&graph(r#"{ "technique": "dvr" }"#, "{}"));
    desk.tab(Pane::Transfer);
    let first = desk.settle("the first picture");
    (desk, first)
}

/// Where a point of the function lies: its scalars fill the width, its opacities the height.
fn place(desk: &Desk, at: f32, opacity: f32) -> Pos2 {
    let rect = desk.named(Role::Canvas, CURVE).rect();
    pos2(
        rect.left() + at * rect.width(),
        rect.bottom() - opacity * rect.height(),
    )
}

fn is_enabled(desk: &Desk, label: &'static str) -> bool {
    let node = desk.harness.get_by_label(label);
    !node.accesskit_node().is_disabled()
}

/// What the session reads now.
fn read(desk: &Desk) -> TransferFunction {
    desk.told(|told| {
        let scene = told.scene.as_ref().unwrap();
        let source = &scene.sources["colors"];
        let files = source.files();
        TransferFunction::load(files.first().unwrap()).unwrap()
    })
}

#[test]
fn a_dragged_point_changes_the_picture_and_is_taken_back_and_again() {
    let (mut desk, first) = open();
    assert!(!is_enabled(&desk, "Undo") && !is_enabled(&desk, "Redo"));
    let ends = [place(&desk, 0.5, 0.2), place(&desk, 0.5, 0.9)];
    desk.drag(ends, PointerButton::Primary, Modifiers::NONE);
    let dragged = desk.next("the edited function's picture", &first);
    assert_ne!(dragged.color, first.color);
    let points = read(&desk).control_points();
    assert_eq!(points.len(), 3);
    assert!((points[1].opacity - 0.9).abs() < 0.01, "{:?}", points[1]);
    assert!((points[1].at - 0.5).abs() < 0.01, "{:?}", points[1]);
    // The user's own file is as it was.
    let own = std::fs::read_to_string(desk.path("transfer.ron")).unwrap();
    assert_eq!(own, crate::desk::TRANSFER);
    let dragged = settled(&mut desk);

    assert!(is_enabled(&desk, "Undo") && !is_enabled(&desk, "Redo"));
    desk.click("Undo");
    let undone = desk.next("what was before", &dragged);
    assert_same(&undone, &first);
    assert!(!is_enabled(&desk, "Undo"), "a drag is one step");
    desk.click("Redo");
    let redone = desk.next("the edit again", &undone);
    assert_same(&redone, &dragged);
}

/// The picture after all that was asked has come: what a session of its own draws of the same file.
fn settled(desk: &mut Desk) -> Arc<Picture> {
    let folder = desk.path("");
    let mut last = desk.settle("the last picture");
    for _ in 0..200 {
        let file = desk.told(|told| {
            let sources = &told.scene.as_ref().unwrap().sources;
            sources["colors"].files().into_iter().next().unwrap()
        });
        let set = format!("colors.path={:?}", file.display().to_string());
        let own = desk.rendered(&[&set], [last.width, last.height]);
        if own.color == last.color {
            return last;
        }
        desk.harness.run_steps(4);
        last = desk.settle("the last picture");
    }
    panic!("the picture is never that of {}", folder.display());
}

#[test]
fn a_drag_beside_the_points_shifts_all_of_them() {
    let (mut desk, first) = open();
    let from = place(&desk, 0.25, 0.6);
    let width = desk.named(Role::Canvas, CURVE).rect().width();
    let ends = [from, from + vec2(0.1 * width, 0.0)];
    desk.drag(ends, PointerButton::Primary, Modifiers::NONE);
    desk.next("the shifted function's picture", &first);
    settled(&mut desk);
    let points = read(&desk).control_points();
    assert!((points[0].at - 0.1).abs() < 0.01, "{points:?}");
    assert!(
        (points[1].at - points[0].at - 0.5).abs() < 0.01,
        "{points:?}"
    );
    desk.click("Undo");
    desk.wait_until("what was before", |told| {
        told.refined
            .as_ref()
            .is_some_and(|now| now.color == first.color)
    });
}

#[test]
fn points_come_by_double_clicks_and_go_by_right_clicks() {
    let (mut desk, first) = open();
    let at = place(&desk, 0.75, 0.9);
    for _ in 0..2 {
        desk.press(at, PointerButton::Primary, true, Modifiers::NONE);
        desk.press(at, PointerButton::Primary, false, Modifiers::NONE);
    }
    let added = desk.next("the added point's picture", &first);
    assert_ne!(added.color, first.color);
    let points = read(&desk).control_points();
    assert_eq!(points.len(), 4);
    assert!((points[2].at - 0.75).abs() < 0.01 && (points[2].opacity - 0.9).abs() < 0.01);
    desk.click_at(at, PointerButton::Secondary);
    let removed = desk.next("the picture without it", &added);
    assert_same(&removed, &first);
    assert_eq!(read(&desk).control_points().len(), 3);
}

#[test]
fn a_colour_map_is_picked_and_saved() {
    let (mut desk, first) = open();
    assert!(!is_enabled(&desk, "Save"), "nothing is changed");
    desk.pick("Colours", "viridis");
    let mapped = desk.next("the colour map's picture", &first);
    assert_ne!(mapped.color, first.color);
    assert_eq!(
        desk.named(Role::ComboBox, "Colours").value().as_deref(),
        Some("viridis")
    );
    let edited = read(&desk);
    assert!(is_enabled(&desk, "Save"));
    desk.click("Save");
    desk.wait_until("the saved function", |told| {
        let sources = &told.scene.as_ref().unwrap().sources;
        let files = sources["colors"].files();
        !told.is_busy && files.iter().any(|file| file.ends_with("transfer.ron"))
    });
    let file = desk.path("transfer.ron");
    let saved = TransferFunction::load(&file).unwrap();
    assert_eq!(saved, edited);
    assert_eq!(saved.color_map(), Some("viridis"));
    desk.harness.run_steps(3);
    assert!(!is_enabled(&desk, "Save"), "it is saved");
    // The graph as it is on disk now is what is shown.
    let shown = desk.settle("the saved function's picture");
    assert_same(&shown, &mapped);
    assert_same(&desk.rendered(&[], [shown.width, shown.height]), &shown);
}

/// An edit of the file on disk is taken over where nothing is edited in the window.
#[test]
fn the_file_is_followed_while_nothing_is_edited() {
    let (mut desk, first) = open();
    let other = crate::desk::TRANSFER.replace("opacity: 0.2", "opacity: 0.8");
    desk.write("transfer.ron", &other);
    let followed = desk.next("the file's picture", &first);
    assert_ne!(followed.color, first.color);
    // The point is where the file says.
    let at = place(&desk, 0.5, 0.8);
    desk.click_at(at, PointerButton::Primary);
    let shown = desk.named(Role::SpinButton, "Opacity").value().unwrap();
    assert!(shown.starts_with("0.8"), "{shown}");
}
