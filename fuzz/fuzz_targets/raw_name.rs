//! See [`volgraph_fuzz::raw_name`].

#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| volgraph_fuzz::raw_name(data));
