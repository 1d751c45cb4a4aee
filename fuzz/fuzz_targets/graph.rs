//! See [`volgraph_fuzz::graph`].

#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| volgraph_fuzz::graph(data));
