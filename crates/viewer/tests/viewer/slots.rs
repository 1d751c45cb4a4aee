//! Slots: another shader by its menu, and back again.

use egui::accesskit::Role;

use crate::desk::{Desk, assert_same, flat, graph, middle};

#[test]
fn another_technique_makes_its_picture_and_the_first_comes_back_bit_for_bit() {
    let mut desk = Desk::open(&graph(r#"{ "technique": "dvr" }"#, "{}"));
    let dvr = desk.settle("the first picture");
    let size = [dvr.width, dvr.height];
    assert_same(&desk.rendered(&[], size), &dvr);
    desk.pick("technique", "mip");
    let mip = desk.next("the other technique", &dvr);
    assert_ne!(mip.color, dvr.color);
    let own = desk.rendered(&["image.slots.technique=\"mip\""], size);
    assert_same(&own, &mip);
    assert_eq!(
        desk.named(Role::ComboBox, "technique").value().as_deref(),
        Some("mip")
    );
    desk.pick("technique", "dvr");
    let back = desk.next("the first technique", &mip);
    assert_same(&back, &dvr);
}

/// The user's own shaders are in the menu, and their parameters are in the panel as soon as they are used.
#[test]
fn own_shaders_are_offered_with_their_parameters() {
    let mut desk = Desk::open(&graph(r#"{ "technique": "mip" }"#, "{}"));
    let first = desk.settle("the first picture");
    assert!(!desk.has("bright"));
    desk.pick("technique", "flat");
    let picture = desk.next("the own technique", &first);
    assert_eq!(middle(&picture), [0.25, 0.5, 0.25, 1.0]);
    desk.named(Role::Slider, "bright").set_value_accesskit(0.5);
    let picture = desk.next("its parameter", &picture);
    assert_eq!(middle(&picture), [0.5, 0.5, 0.25, 1.0]);
    // A parameter that the technique before has not is no mistake on the way back.
    desk.pick("technique", "mip");
    desk.wait_until("the technique before", |told| {
        !told.is_busy
            && told
                .refined
                .as_ref()
                .is_some_and(|now| !std::sync::Arc::ptr_eq(now, &picture))
    });
    assert_same(&desk.settle("the technique before"), &first);
}

/// A shader that is dropped into the window fills the slot that its folder is named after.
#[test]
fn a_dropped_shader_fills_its_slot() {
    let mut desk = Desk::open(&graph(r#"{ "technique": "mip" }"#, "{}"));
    let first = desk.settle("the first picture");
    let file = desk.path(crate::desk::FLAT_FILE);
    desk.harness.state_mut().take_file(&file);
    let picture = desk.next("the dropped technique", &first);
    assert_eq!(middle(&picture), [0.25, 0.5, 0.25, 1.0]);
    // One of no slot is told as such, and leaves the picture.
    desk.write("elsewhere/mine.wgsl", crate::desk::FLAT);
    let file = desk.path("elsewhere/mine.wgsl");
    desk.harness.state_mut().take_file(&file);
    desk.harness.run_steps(3);
    assert!(desk.has_text("fills no slot of the picture's node"));
}

#[test]
fn slots_that_follow_from_others_are_not_offered() {
    let desk = Desk::open(&flat());
    for derived in ["volume_filter", "behind", "leap"] {
        assert!(!desk.has(derived), "{derived}");
    }
}
