//! `volgraph view` where there is no display.

use super::Scratch;

#[test]
#[cfg(all(unix, not(target_os = "macos")))]
fn without_a_display_it_names_the_commands_that_need_none() {
    let scratch = Scratch::new();
    let displays = ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"].map(|name| (name, ""));
    let run = scratch.run_in(&["view", "quickstart"], &displays);
    assert_eq!(run.code, Some(1), "{}", run.stderr);
    for part in ["no-window", "volgraph render", "volgraph watch"] {
        assert!(run.stderr.contains(part), "{part} in {}", run.stderr);
    }
}
