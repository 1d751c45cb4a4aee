//! The panels: each a function of what was told, that gives back what it asks for.

pub(crate) mod graph;
pub(crate) mod messages;
pub(crate) mod parameters;
pub(crate) mod ray;
pub(crate) mod slices;
pub(crate) mod transfer;
