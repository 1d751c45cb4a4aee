//! What `slot/trace_layer/written.wgsl` wrote, as segments.

use serde::Serialize;
use volgraph_nodes::raycast::NO_DEPTH;

/// Texels of the ray, and of each record.
const HEAD: usize = 4;
const RECORD: usize = 3;

/// What the walk did with a stretch of the ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Status {
    /// It was sampled and handed to the technique.
    Taken,
    /// It was leapt over: nothing of it can be seen.
    Skipped,
    /// The technique had ended the ray before it.
    Ended,
}

impl Status {
    /// As it is printed.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Taken => "taken",
            Self::Skipped => "skipped",
            Self::Ended => "ended",
        }
    }
}

/// A stretch of the ray.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RaySegment {
    /// Its number along the ray, from 0.
    pub index: usize,
    /// What the walk did with it.
    pub status: Status,
    /// World distance from the ray's origin where it starts.
    pub start: f64,
    /// Where it ends.
    pub end: f64,
    /// The scalars at its front and its back, in the file's units; `None` where no sample was taken.
    pub scalars: Option<[f64; 2]>,
    /// Mean extinction per world unit: that of even matter that lets as much light through. Infinite where nothing
    /// passes; `None` where no sample was taken.
    pub extinction: Option<f64>,
    /// Share of the light that it stops.
    pub opacity: f64,
    /// Share of the light behind that reaches the eye, before and after it.
    pub transmittance: [f64; 2],
    /// What it changes of the linear premultiplied colour. Of projections, which replace what they have, it may be below 0.
    pub contribution: [f64; 3],
    /// The label of the part that it is in; 0 where there are none.
    pub label: u32,
}

impl RaySegment {
    /// The sum of the sizes of what it changes.
    pub(super) fn strength(&self) -> f64 {
        self.contribution.iter().map(|value| value.abs()).sum()
    }
}

/// The walk of one ray.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Trace {
    pub(super) segments: Vec<RaySegment>,
    pub(super) untold: usize,
    pub(super) color: [f64; 4],
    pub(super) behind: [f64; 4],
    /// World distance from the ray's entry into the box.
    pub(super) depth: Option<f64>,
    pub(super) bends: u32,
    pub(super) samples: u32,
}

/// Reads a ray's texels. Shaders count distances from the entry into the box and scalars from `reference`: both are
/// brought back in float64.
pub(super) fn read(texels: &[[f32; 4]], interval: Option<[f64; 2]>, reference: f64) -> Trace {
    let Some((head, records)) = texels.split_at_checked(HEAD) else {
        return Trace::default();
    };
    let [count, entry, _, _] = head[0];
    let [depth, bends, samples, _] = head[3];
    let count = whole(count);
    let [near, far] = interval.unwrap_or_default();
    let mut segments: Vec<RaySegment> = Vec::new();
    let mut before = [0.0; 4];
    let mut is_done = false;
    for record in records.chunks_exact(RECORD).take(count) {
        let [start, length, front, back] = record[0].map(f64::from);
        let after = record[1].map(f64::from);
        let [kind, done, label, _] = record[2];
        let transmittance = [1.0 - before[3], 1.0 - after[3]];
        let is_taken = kind == 0.0;
        is_done = done > 0.0;
        segments.push(RaySegment {
            index: segments.len(),
            status: if is_taken {
                Status::Taken
            } else {
                Status::Skipped
            },
            start: near + start,
            end: near + start + length,
            scalars: is_taken.then_some([front + reference, back + reference]),
            extinction: is_taken.then(|| extinction(transmittance, length)),
            opacity: opacity(transmittance),
            transmittance,
            contribution: std::array::from_fn(|i| after[i] - before[i]),
            label: label as u32,
        });
        before = after;
    }
    let last = segments.last().map(|it| (it.end, it.label));
    if let Some((end, label)) = last.filter(|(end, _)| is_done && *end < far) {
        segments.push(RaySegment {
            index: segments.len(),
            status: Status::Ended,
            start: end,
            end: far,
            scalars: None,
            extinction: None,
            opacity: 0.0,
            transmittance: [1.0 - before[3]; 2],
            contribution: [0.0; 3],
            label,
        });
    }
    Trace {
        untold: count.saturating_sub(records.len() / RECORD),
        color: head[1].map(f64::from),
        behind: head[2].map(f64::from),
        depth: (depth < NO_DEPTH).then(|| f64::from(depth) - f64::from(entry)),
        bends: bends as u32,
        samples: samples as u32,
        segments,
    }
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "shaders write counts as numbers; a cast saturates"
)]
fn whole(count: f32) -> usize {
    count as usize
}

/// Share of the light that is stopped.
fn opacity([before, after]: [f64; 2]) -> f64 {
    if before > 0.0 {
        1.0 - after / before
    } else {
        0.0
    }
}

/// Of even matter that lets as much through; 0 where there is no light left to tell by.
fn extinction([before, after]: [f64; 2], length: f64) -> f64 {
    if before > 0.0 && length > 0.0 && before != after {
        (before / after.max(0.0)).ln() / length
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texels(records: &[[[f32; 4]; RECORD]]) -> Vec<[f32; 4]> {
        let count = records.len() as f32;
        let head = [
            [count, 4.0, 9.0, 0.0],
            [0.5, 0.25, 0.0, 0.75],
            [0.0; 4],
            [5.5, 0.0, 7.0, 0.0],
        ];
        let records = records.iter().flatten().copied();
        head.into_iter().chain(records).collect()
    }

    #[test]
    fn records_become_segments_and_what_is_left_has_ended() {
        let dark = [0.0; 4];
        let trace = read(
            &texels(&[
                [[0.0, 1.0, 0.0, 0.0], dark, [1.0, 0.0, 3.0, 0.0]],
                [
                    [1.0, 2.0, 5.0, 6.0],
                    [0.5, 0.25, 0.0, 0.75],
                    [0.0, 1.0, 3.0, 0.0],
                ],
            ]),
            Some([104.0, 109.0]),
            1000.0,
        );
        let status: Vec<Status> = trace.segments.iter().map(|it| it.status).collect();
        assert_eq!(status, [Status::Skipped, Status::Taken, Status::Ended]);
        let taken = trace.segments[1];
        assert_eq!((taken.start, taken.end, taken.label), (105.0, 107.0, 3));
        assert_eq!(taken.scalars, Some([1005.0, 1006.0]));
        assert_eq!(taken.contribution, [0.5, 0.25, 0.0]);
        assert_eq!((taken.opacity, taken.transmittance), (0.75, [1.0, 0.25]));
        assert!((taken.extinction.unwrap() - 4.0_f64.ln() / 2.0).abs() < 1e-12);
        let ended = trace.segments[2];
        assert_eq!((ended.start, ended.end), (107.0, 109.0));
        assert_eq!((trace.depth, trace.samples), (Some(1.5), 7));
    }

    #[test]
    fn an_opaque_segment_has_an_infinite_extinction_and_none_behind_it_has() {
        assert_eq!(extinction([1.0, 0.0], 1.0), f64::INFINITY);
        assert_eq!(extinction([0.0, 0.0], 1.0), 0.0);
        assert_eq!(opacity([0.0, 0.0]), 0.0);
    }

    #[test]
    fn what_is_cut_short_is_told() {
        let mut cut = texels(&[[[0.0; 4]; RECORD]; 3]);
        cut.truncate(HEAD + RECORD);
        assert_eq!(read(&cut, Some([0.0, 1.0]), 0.0).untold, 2);
        assert_eq!(read(&[], None, 0.0), Trace::default());
    }
}
