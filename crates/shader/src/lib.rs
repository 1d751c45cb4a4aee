//! WGSL: linking, checking, reflection, diagnostics.
//!
//! The way of the data: [`ShaderRoots`] finds files, [`link()`] follows their imports into one [`Linked`] text
//! that knows the author's place of each byte, [`check()`] gives that text to naga and turns what naga says
//! into findings at the author's places, all that one edit made where naga would stop at the first. The [`Module`] it returns answers what a render graph asks: entry
//! points, the bindings that one really uses, overrides, [`params`] and struct layouts. [`UniformWriter`]
//! fills a uniform buffer by member names. [`specialise()`] makes constants of parameters that are choices, once their
//! values are known. For live editing, [`guard()`] rewrites a module so that each
//! invocation ends and tells where it went wrong. Nothing here touches a GPU.

mod assemble;
mod check;
mod diagnose;
mod files;
mod guard;
mod head;
mod hoist;
mod items;
mod layout;
mod link;
mod linked;
mod lookup;
mod names;
pub mod order;
pub mod params;
mod recover;
mod reflect;
mod roots;
mod scan;
mod silent;
mod snapshot;
mod specialise;
mod statements;
mod token;
mod uniform;
mod wording;

pub use check::{Module, check, check_file, with_room};
pub use diagnose::DECLARED_HERE;
pub use files::{DiskFiles, MemoryFiles, ShaderFiles};
pub use guard::{GuardRequest, GuardSite, Guarded, Hazard, guard};
pub use head::stated_choice;

pub use hoist::hoist_uniforms;
pub use layout::{Member, MemberType, ScalarType, StructLayout};
pub use link::{LinkRequest, link};
pub use linked::{Linked, LinkedFile, SegmentMap};
pub use order::DeclaredOrder;
pub use params::{ParamSpec, ParamType, ParamValue};
pub use reflect::{
    Binding, BindingKind, EntryPoint, NEAREST_SAMPLER, OverrideSpec, TextureDim, TextureSample,
};
pub use roots::ShaderRoots;
pub use snapshot::SnapshotFiles;
pub use specialise::{Choices, specialise};
pub use uniform::{UniformError, UniformValue, UniformWriter};
