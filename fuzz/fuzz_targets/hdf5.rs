//! See [`volgraph_fuzz::hdf5`].

#![no_main]

libfuzzer_sys::fuzz_target!(init: volgraph_fuzz::forgive_decoders(), |data: &[u8]| volgraph_fuzz::hdf5(data));
