//! See [`volgraph_fuzz::transfer`].

#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| volgraph_fuzz::transfer(data));
