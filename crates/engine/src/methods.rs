//! How a raycast can be computed, how wrong each way is, and how long it takes.
//!
//! The way of the data: [`MethodSpace::of`] reads from a plan what its raycast offers (choices of slots, storages, stages,
//! steps), narrowed by [`Filter`]s. [`survey`] goes through it on a [`Stand`], which prepares a [`Method`], says its
//! [`Errors`] against a truth, and times its frames: all methods in turn, so that what else the machine does meets them
//! alike. Of the [`Measurement`]s, [`front`] are those that no other beats in both. [`SessionStand`] is the stand on a
//! device; tests have one with a clock of its own. Nothing here reads or writes files of its own; [`peers`] reads tables
//! of other renderers' figures from text.

mod accuracy;
mod filter;
mod front;
mod measurement;
mod offered;
pub mod peers;
mod session_stand;
mod software;
mod space;
mod stand;
mod survey;
#[cfg(test)]
mod tests;
mod turn;
mod yardstick;

pub use accuracy::{Errors, core_pixels, errors};
pub use filter::{Filter, parse_filters};
pub use front::{front, near_front};
pub use measurement::{Measurement, Method, Setting};
pub use session_stand::{OnPicture, Ready, SessionStand, timed_frame};
pub(crate) use software::draws_the_same;
pub use space::{Axis, MethodSpace, raycast_node};
pub use stand::{Frames, Stand, Times, alternate};
pub use survey::{Survey, SurveyOptions, SurveyProgress, survey};
pub use turn::{LEAST_TURN_DEGREES, around, middle, turned};
pub use yardstick::{TruthKind, Yardstick, fine_method, fine_step, is_uncovered, shortest_step};
