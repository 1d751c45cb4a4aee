//! The bar of time: only where there is time, step by step, and what it shows is what `render` draws.

use egui::accesskit::Role;

use crate::desk::{Desk, assert_same, flat};

/// Four steps of a field that grows brighter.
fn steps() -> Vec<u8> {
    let mut bytes = b"NRRD0004\ntype: uint8\ndimension: 4\nsizes: 16 16 16 4\nkinds: domain domain domain time\nencoding: raw\n\n".to_vec();
    for step in 0..4_u8 {
        bytes.extend((0..16 * 16 * 16).map(|at: u32| {
            let x = u8::try_from(at % 16).unwrap();
            x + 60 * step
        }));
    }
    bytes
}

fn step(desk: &Desk) -> Option<u32> {
    desk.told(|told| {
        let scene = told.scene.as_ref()?;
        let (_, step, count) = *scene.series().first()?;
        assert_eq!(count, 4);
        Some(step)
    })
}

#[test]
fn steps_are_picked_and_played_and_drawn_as_they_are() {
    let mut desk = Desk::open(&flat());
    assert!(!desk.has("Play") && step(&desk).is_none());
    // The graph gets a volume with time.
    let still = desk.told(|told| told.refined.clone().unwrap());
    desk.write("four.nrrd", steps());
    let graph = flat().replace("v_16x16x16_float32.raw", "four.nrrd");
    desk.write("graph.ron", graph.replace("\"technique\": \"flat\"", ""));
    desk.next("the picture of the first step", &still);
    assert_eq!(step(&desk), Some(0));
    // The slider's number takes a step.
    let first = desk.told(|told| told.refined.clone().unwrap());
    desk.named(Role::Slider, "time step").focus();
    desk.harness.run_steps(2);
    desk.harness.key_press(egui::Key::ArrowRight);
    let second = desk.next("the picture of the second step", &first);
    assert_eq!(step(&desk), Some(1));
    let size = [second.width, second.height];
    assert_same(&second, &desk.rendered(&["volume.time=1"], size));
    // Playing goes on from there, and around.
    desk.click("Play");
    for wanted in [2, 3, 0, 1] {
        desk.wait_until("the next step", |told| {
            let scene = told.scene.as_ref().unwrap();
            scene.series().first().is_some_and(|it| it.1 == wanted)
        });
    }
    desk.click("Pause");
    desk.answered();
    let now = step(&desk).unwrap();
    for _ in 0..30 {
        desk.harness.step();
        std::thread::sleep(std::time::Duration::from_millis(10));
    }
    assert_eq!(step(&desk), Some(now));
    let last = desk.settle("the last picture");
    let set = format!("volume.time={now}");
    assert_same(&last, &desk.rendered(&[&set], [last.width, last.height]));
}
