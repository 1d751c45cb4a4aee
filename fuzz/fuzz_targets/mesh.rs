//! See [`volgraph_fuzz::mesh`].

#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| volgraph_fuzz::mesh(data));
