//! The float64 reference itself: against closed forms, against the harness's own float64, against fine steps.

mod closed;
mod orders;
mod ready;
