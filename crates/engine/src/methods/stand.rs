//! What methods are timed on: anything that draws frames by them, one of each in turn.

use volgraph_report::Findings;

use super::accuracy::Errors;
use super::measurement::Method;

/// What draws frames.
pub trait Frames {
    /// A method that is ready to draw.
    type Ready;

    /// Draws the frame of a number, 1 or more; milliseconds. Equal numbers are equal views.
    ///
    /// # Errors
    /// What the device refused.
    fn frame(&mut self, ready: &mut Self::Ready, number: u32) -> Result<f64, Findings>;
}

/// What methods are measured on.
pub trait Stand: Frames {
    /// Makes a method ready, draws the graph's own view by it, and says how wrong it is.
    ///
    /// # Errors
    /// Why the scene refuses the method.
    fn prepare(&mut self, method: &Method) -> Result<(Self::Ready, Errors), Findings>;

    /// Bytes that it takes on the device.
    fn bytes(&self, ready: &Self::Ready) -> u64;

    /// Seconds since the survey started.
    fn seconds(&self) -> f64;
}

/// Times of one frame after the other.
pub type Times = Result<Vec<f64>, Findings>;

/// Draws these frames by each of the methods, one of each in a round: the first to the last, then the last to the first.
/// Gives their times in milliseconds in the order of the methods; a method that fails is not drawn again. `goes_on` is
/// asked after each round.
pub fn alternate<S: Frames>(
    stand: &mut S,
    methods: &mut [&mut S::Ready],
    frames: std::ops::Range<u32>,
    mut goes_on: impl FnMut(&S, u32) -> bool,
) -> Vec<Times> {
    let mut times: Vec<Times> = methods.iter().map(|_| Ok(Vec::new())).collect();
    for (round, frame) in frames.enumerate() {
        for step in 0..methods.len() {
            let is_back = round % 2 == 1;
            let at = if is_back {
                methods.len() - 1 - step
            } else {
                step
            };
            if let Ok(so_far) = &mut times[at] {
                match stand.frame(methods[at], frame) {
                    Ok(time) => so_far.push(time),
                    Err(findings) => times[at] = Err(findings),
                }
            }
        }
        if !goes_on(stand, frame) {
            break;
        }
    }
    times
}
