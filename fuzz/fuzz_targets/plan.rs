//! See [`volgraph_fuzz::plan`].

#![no_main]

libfuzzer_sys::fuzz_target!(init: volgraph_fuzz::forgive_naga(), |data: &[u8]| volgraph_fuzz::plan(data));
