//! See [`volgraph_fuzz::nifti`].

#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| volgraph_fuzz::nifti(data));
