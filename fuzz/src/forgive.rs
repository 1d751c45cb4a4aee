//! Panics that volgraph catches itself, and tells as errors. libFuzzer's own hook would end the process at each.

use std::collections::BTreeSet;
use std::panic::PanicHookInfo;
use std::sync::Mutex;

/// Lets panics of naga pass that volgraph catches on a thread of its own and tells as a finding; to be called once,
/// before the first input.
pub fn forgive_naga() {
    let abort = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |info| {
        if std::thread::current().name() != Some("volgraph-shader-check") {
            abort(info);
        }
    }));
}

/// Lets panics of other crates pass, which volgraph catches around decoders of pictures and tells as broken files. One
/// that nobody catches ends the process all the same, and so does one of volgraph's own, caught or not; to be called
/// once, before the first input. Each place is told once.
pub fn forgive_decoders() {
    let told = Mutex::new(BTreeSet::new());
    let abort = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |info| {
        if !is_others(info) {
            return abort(info);
        }
        let place = info.location().map(ToString::to_string);
        if told.lock().is_ok_and(|mut told| told.insert(place)) {
            eprintln!("a decoder {info}");
        }
    }));
}

fn is_others(info: &PanicHookInfo<'_>) -> bool {
    let of_registry = |file: &str| file.contains("/registry/src/");
    info.location()
        .is_some_and(|place| of_registry(place.file()))
}
