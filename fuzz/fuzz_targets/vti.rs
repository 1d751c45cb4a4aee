//! See [`volgraph_fuzz::vti`].

#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| volgraph_fuzz::vti(data));
