//! Menus, panels and the sheet of keys.

use egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable;
use volgraph_viewer::Pane;

use crate::desk::{Desk, flat};

fn close(desk: &mut Desk) {
    desk.harness.key_press(Key::Escape);
    desk.harness.run_steps(3);
}

#[test]
fn menus_open_with_their_entries() {
    let mut desk = Desk::open(&flat());
    for (menu, entries) in [
        ("File", ["Open…", "Recent", "Ready graphs", "Quit"]),
        (
            "View",
            ["Fit", "Parallel or perspective", "Walk", "Scale bar"],
        ),
        (
            "Compare",
            [
                "Picture alone",
                "Before and after",
                "Difference",
                "Error against the reference",
            ],
        ),
    ] {
        assert!(!desk.has(entries[0]), "{menu} is closed");
        desk.menu(menu);
        for entry in entries {
            assert!(desk.has_text(entry), "{entry} in {menu}");
        }
        desk.harness.check_accessibility();
        close(&mut desk);
        assert!(!desk.has(entries[0]), "{menu} is closed again");
    }
}

#[test]
fn panels_are_hidden_and_shown_by_their_menu() {
    let mut desk = Desk::open(&flat());
    assert!(desk.has("bright"));
    let toggle = |desk: &mut Desk| {
        desk.menu("Panels");
        let by = egui_kittest::kittest::By::new()
            .role(egui::accesskit::Role::CheckBox)
            .label("Parameters");
        desk.harness.get(by).click();
        desk.harness.run_steps(3);
        close(desk);
        desk.harness.run_steps(3);
    };
    toggle(&mut desk);
    assert!(!desk.has("bright"), "hidden");
    // What is larger now is drawn larger.
    let wide = desk.settle("the picture beside no panel");
    toggle(&mut desk);
    assert!(desk.has("bright"), "shown");
    let narrow = desk.settle("the picture beside the panel");
    assert!(narrow.width < wide.width, "{} {}", narrow.width, wide.width);
    desk.menu("Panels");
    for pane in Pane::ALL {
        assert!(desk.has(pane.title()), "{}", pane.title());
    }
}

#[test]
fn all_hidden_panels_come_back_as_at_first() {
    let mut desk = Desk::open(&flat());
    for pane in Pane::ALL {
        desk.menu("Panels");
        let by = egui_kittest::kittest::By::new()
            .role(egui::accesskit::Role::CheckBox)
            .label(pane.title());
        desk.harness.get(by).click();
        desk.harness.run_steps(2);
        close(&mut desk);
    }
    assert!(!desk.has("bright") && !desk.has("View, with the last good picture"));
    desk.menu("Panels");
    desk.harness.get_by_label("As at first").click();
    desk.harness.run_steps(4);
    close(&mut desk);
    assert!(desk.has("bright"));
    desk.settle("a picture");
}

#[test]
fn the_sheet_of_keys_lists_them() {
    let mut desk = Desk::open(&flat());
    assert!(!desk.has("Shift + drag, middle drag"));
    desk.harness.key_press(Key::F1);
    desk.harness.run_steps(3);
    for (keys, what) in [
        ("drag", "orbit (look around while walking)"),
        ("Shift + drag, middle drag", "pan"),
        ("F", "fit the volumes into the view"),
        ("Space", "pause: files are not followed"),
        ("F1", "this sheet"),
    ] {
        assert!(desk.has(keys) && desk.has(what), "{keys}: {what}");
    }
    desk.harness.key_press(Key::F1);
    desk.harness.run_steps(3);
    assert!(!desk.has("Shift + drag, middle drag"));
    desk.menu("Help");
    desk.harness.get_by_label("Keys and mouse").click();
    desk.harness.run_steps(3);
    assert!(desk.has("Shift + drag, middle drag"));
}

/// Keys that are typed into a number are not the view's.
#[test]
fn typing_into_a_field_presses_no_keys_of_the_view() {
    let mut desk = Desk::open(&flat());
    desk.settle("the first picture");
    let camera = desk.told(|told| told.camera.unwrap());
    let at = desk
        .named(egui::accesskit::Role::SpinButton, "free")
        .rect()
        .center();
    desk.click_at(at, egui::PointerButton::Primary);
    for key in [Key::Num1, Key::O, Key::Space, Key::B, Key::F1] {
        desk.harness.key_press_modifiers(Modifiers::NONE, key);
    }
    desk.harness.run_steps(3);
    assert!(!desk.has("Shift + drag, middle drag"));
    assert_eq!(desk.told(|told| told.camera.unwrap()), camera);
    assert!(!desk.told(|told| told.is_paused));
    assert_eq!(desk.harness.state().settings().overlay, Default::default());
}
