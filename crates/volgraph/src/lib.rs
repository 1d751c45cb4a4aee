//! volgraph as a library: scenes, sessions and pictures as plain owned values.
//!
//! All of it is [`volgraph_engine`]'s; the package adds the command line and, through it, the viewer.

pub use volgraph_engine::*;
