//! A device is opened while something else is made ready.

use std::panic::resume_unwind;
use std::thread;

use volgraph_gpu::{AdapterChoice, Gpu, GpuError};

/// Does some work, such as loading a scene, and opens a device in a thread beside it. Both are waited for.
pub fn open_beside<T>(
    adapter: &AdapterChoice,
    work: impl FnOnce() -> T,
) -> (T, Result<Gpu, GpuError>) {
    thread::scope(|scope| {
        let opening = scope.spawn(|| Gpu::open(adapter));
        let made = work();
        match opening.join() {
            Ok(opened) => (made, opened),
            Err(panic) => resume_unwind(panic),
        }
    })
}
