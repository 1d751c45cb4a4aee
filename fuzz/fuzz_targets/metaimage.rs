//! See [`volgraph_fuzz::metaimage`].

#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| volgraph_fuzz::metaimage(data));
