//! See [`volgraph_fuzz::npy`].

#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| volgraph_fuzz::npy(data));
