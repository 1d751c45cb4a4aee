//! Planes through the volume: the crosshair goes where is clicked, and the probe reads what is there.

use egui::accesskit::Role;
use egui::{PointerButton, pos2};
use volgraph_viewer::Pane;

use crate::desk::{Desk, flat, value};

/// Clicks the middle of a voxel of a plane.
fn click(desk: &mut Desk, plane: &'static str, [across, down]: [u32; 2]) {
    let rect = desk.named(Role::Image, plane).rect();
    let share = |index: u32| (index as f32 + 0.5) / 16.0;
    let at = pos2(
        rect.left() + share(across) * rect.width(),
        rect.top() + share(down) * rect.height(),
    );
    desk.click_at(at, PointerButton::Primary);
    desk.harness.run_steps(2);
}

fn probed(desk: &Desk, [x, y, z]: [u32; 3]) {
    let voxel = format!("voxel [{x}, {y}, {z}]");
    assert!(desk.shows(&voxel), "{voxel}");
    let strong = format!("value {}", value(x, y, z));
    assert!(desk.shows(&strong), "{strong}");
}

#[test]
fn the_probe_reads_the_voxel_that_is_clicked() {
    let mut desk = Desk::open(&flat());
    desk.tab(Pane::Slices);
    probed(&desk, [8, 8, 8]);
    click(&mut desk, "axial", [3, 12]);
    probed(&desk, [3, 12, 8]);
    click(&mut desk, "coronal", [5, 2]);
    probed(&desk, [5, 12, 2]);
    click(&mut desk, "sagittal", [1, 15]);
    probed(&desk, [5, 1, 15]);
    // The other planes follow.
    assert!(
        desk.has("axial, plane 15")
            && desk.has("coronal, plane 1")
            && desk.has("sagittal, plane 5")
    );
}

/// The field is linear in each index, so its slope is known anywhere inside.
#[test]
fn the_probe_tells_the_gradient() {
    let mut desk = Desk::open(&flat());
    desk.tab(Pane::Slices);
    click(&mut desk, "axial", [7, 7]);
    assert!(desk.shows("gradient (1.0000, 16.0000, 256.0000), 256.5015 per world unit"));
}

#[test]
fn the_wheel_turns_the_pages() {
    let mut desk = Desk::open(&flat());
    desk.tab(Pane::Slices);
    let rect = desk.named(Role::Image, "axial").rect();
    desk.wheel(rect.center(), -60.0);
    // Sixty points are three planes.
    assert!(desk.has("axial, plane 5"));
    probed(&desk, [8, 8, 5]);
}
