//! Controls of parameters: found by their names, they reach the shader and show what it has.

use egui::accesskit::Role;
use egui_kittest::kittest::Queryable;

use crate::desk::{Desk, assert_same, flat, graph, middle};

fn spin(desk: &Desk, label: &'static str) -> f64 {
    let node = desk.named(Role::SpinButton, label);
    let text = node.value().unwrap();
    text.parse()
        .unwrap_or_else(|_| panic!("{label} shows {text}"))
}

#[test]
fn each_kind_of_control_reaches_the_shader_and_shows_its_value() {
    let mut desk = Desk::open(&flat());
    let mut picture = desk.settle("the first picture");
    assert_eq!(middle(&picture), [0.25, 0.5, 0.25, 1.0]);
    // Beside the volume there is the background, whatever the parameters are.
    assert_eq!(picture.pixel(0, 0).unwrap(), [0.0, 0.0, 0.125, 1.0]);

    desk.named(Role::Slider, "bright").set_value_accesskit(0.75);
    picture = desk.next("a slider's value", &picture);
    assert_eq!(middle(&picture), [0.75, 0.5, 0.25, 1.0]);
    let shown = desk.named(Role::Slider, "bright");
    assert_eq!(
        egui_kittest::kittest::NodeT::accesskit_node(&shown).numeric_value(),
        Some(0.75)
    );

    desk.named(Role::SpinButton, "free")
        .set_value_accesskit(0.125);
    picture = desk.next("a number without a range", &picture);
    assert_eq!(middle(&picture), [0.75, 0.125, 0.25, 1.0]);
    assert_eq!(spin(&desk, "free"), 0.125);

    desk.named(Role::SpinButton, "eighths")
        .set_value_accesskit(5.0);
    picture = desk.next("a whole number", &picture);
    assert_eq!(middle(&picture), [0.75, 0.125, 0.625, 1.0]);
    assert_eq!(spin(&desk, "eighths"), 5.0);

    desk.pick("turn", "backwards");
    picture = desk.next("a choice", &picture);
    assert_eq!(middle(&picture), [0.625, 0.125, 0.75, 1.0]);
    assert_eq!(
        desk.named(Role::ComboBox, "turn").value().as_deref(),
        Some("backwards")
    );

    // Each number of a vector has the vector's name.
    let numbers = desk.all(Role::SpinButton, "gain");
    assert_eq!(numbers.len(), 3);
    numbers[1].set_value_accesskit(2.0);
    picture = desk.next("a vector's number", &picture);
    assert_eq!(middle(&picture), [0.625, 0.25, 0.75, 1.0]);
    assert_eq!(picture.pixel(0, 0).unwrap(), [0.0, 0.0, 0.125, 1.0]);
    let own = desk.rendered(
        &[
            "image.bright=0.75",
            "image.free=0.125",
            "image.eighths=5",
            "image.turn=backwards",
            "image.gain=(1, 2, 1)",
        ],
        [picture.width, picture.height],
    );
    assert_same(&own, &picture);
}

#[test]
fn a_number_is_typed_and_dragged() {
    let mut desk = Desk::open(&flat());
    let mut picture = desk.settle("the first picture");
    let rect = desk.named(Role::SpinButton, "free").rect();
    desk.click_at(rect.center(), egui::PointerButton::Primary);
    desk.harness.run_steps(2);
    desk.harness
        .key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::A);
    desk.harness.event(egui::Event::Text("0.875".to_owned()));
    desk.harness.key_press(egui::Key::Enter);
    picture = desk.next("a typed value", &picture);
    assert_eq!(middle(&picture)[1], 0.875);
    let rect = desk.named(Role::SpinButton, "free").rect();
    let to = rect.center() + egui::vec2(40.0, 0.0);
    desk.drag(
        [rect.center(), to],
        egui::PointerButton::Primary,
        egui::Modifiers::NONE,
    );
    picture = desk.next("a dragged value", &picture);
    let green = middle(&picture)[1];
    assert!(green > 0.875, "{green}");
    let shown = spin(&desk, "free");
    assert!(
        (shown - f64::from(green)).abs() < 0.01,
        "{shown} for {green}"
    );
}

/// What lies outside of the range is never asked for.
#[test]
fn values_stay_in_their_range() {
    let mut desk = Desk::open(&flat());
    let picture = desk.settle("the first picture");
    desk.named(Role::SpinButton, "eighths")
        .set_value_accesskit(99.0);
    let picture = desk.next("the largest value", &picture);
    assert_eq!(middle(&picture)[2], 1.0);
    assert!(desk.told(|told| told.findings.is_empty()));
}

#[test]
fn a_given_value_goes_back_to_its_default_by_a_button() {
    let mut desk = Desk::open(&flat());
    let first = desk.settle("the first picture");
    assert!(!desk.has("default"), "nothing is given");
    desk.named(Role::Slider, "bright").set_value_accesskit(1.0);
    let changed = desk.next("a slider's value", &first);
    assert_eq!(middle(&changed)[0], 1.0);
    desk.click("default");
    let back = desk.next("the default", &changed);
    assert_same(&back, &first);
    assert!(!desk.has("default"), "it has its default");
}

/// Values of nodes that do not make the picture are behind their names.
#[test]
fn nodes_open_by_their_names() {
    let mut desk = Desk::open(&flat());
    let picture = desk.settle("the first picture");
    assert!(!desk.has("pattern"));
    desk.click("background (background)");
    assert!(desk.has("color"));
    let nodes = desk.harness.query_all_by_label("Settings");
    nodes.for_each(|node| node.click_accesskit());
    desk.harness.run_steps(3);
    desk.pick("pattern", "checker");
    let picture = desk.next("another pattern", &picture);
    let own = desk.rendered(
        &["background.pattern=\"checker\""],
        [picture.width, picture.height],
    );
    assert_same(&own, &picture);
}

/// Every control has a name that assistive technologies can say.
#[test]
fn all_controls_have_names() {
    let shaders = r#"{ "technique": "dvr", "light": "phong", "gradient": "stored" }"#;
    let mut desk = Desk::open(&graph(shaders, "{}"));
    for pane in volgraph_viewer::Pane::ALL {
        desk.tab(pane);
        desk.harness.run_steps(3);
        desk.harness.check_accessibility();
    }
    desk.tab(volgraph_viewer::Pane::Graph);
}
