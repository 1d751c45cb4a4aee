//! See [`volgraph_fuzz::bricks`].

#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| volgraph_fuzz::bricks(data));
