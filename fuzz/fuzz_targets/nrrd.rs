//! See [`volgraph_fuzz::nrrd`].

#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| volgraph_fuzz::nrrd(data));
