//! A technique's frames beside those of the limit, in turn, and what they come to.
//!
//! In each round the technique draws a view in each stage, the limit the same one, and the limit with one sample a ray,
//! which is what a frame costs anyway: the ray's set-up, the target and reading it back. Forwards in one round, backwards
//! in the next. Ratios are of frames of one round, so that slow drifts of the machine cancel.

use std::sync::Arc;

use serde::Serialize;
use volgraph_gpu::Gpu;
use volgraph_measure::timing::{Summary, ratio};
use volgraph_report::Findings;

use super::limit::{empty_of, limit_of};
use super::rotation::Rotation;
use super::stand::{BenchStand, Entry};
use super::technique::in_stage;
use crate::methods::{Frames, alternate};
use crate::scene::Scene;
use crate::session::SessionOptions;

/// One frame.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FrameTime {
    /// Where the camera stood, degrees from the scene's own view.
    pub degrees: f64,
    /// From drawing until the colours are in memory.
    pub ms: f64,
}

/// A technique in a stage.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// The stage.
    pub stage: String,
    /// Why it is not drawn so; then there are no frames.
    pub refused: Option<String>,
    /// Frames a second: of the slowest frame, of all together (their number by the sum of their times), of the fastest.
    pub fps: Option<[f64; 3]>,
    /// Milliseconds of a frame.
    pub frame_ms: Option<Summary>,
    /// The same of the limit in the same stage.
    pub limit_ms: Option<Summary>,
    /// The same of a frame of the limit with one sample a ray.
    pub empty_ms: Option<Summary>,
    /// How many times longer it takes than the limit, of frames of one round.
    pub to_limit: Option<Summary>,
    /// The same without what a frame costs anyway: the median of the empty frames is subtracted from both medians. `None`
    /// where the limit is not told from an empty frame.
    pub to_limit_net: Option<f64>,
    /// Bytes that the technique takes on the device.
    pub device_bytes: u64,
    /// Its frames, in the order in which they were drawn.
    pub frames: Vec<FrameTime>,
    /// Those of the limit.
    pub limit_frames: Vec<FrameTime>,
}

impl Row {
    /// A row from times of the same rounds: of the technique, the limit, and the empty frame.
    ///
    /// # Errors
    /// Times that are not finite, or not as many of each.
    pub fn of(
        stage: &str,
        degrees: &[f64],
        [own, limit, empty]: [&[f64]; 3],
        device_bytes: u64,
    ) -> Result<Self, volgraph_measure::MeasureError> {
        let frame_ms = Summary::of(own)?;
        let (limit_ms, empty_ms) = (Summary::of(limit)?, Summary::of(empty)?);
        let seconds: f64 = own.iter().sum::<f64>() / 1e3;
        let span = limit_ms.median - empty_ms.median;
        // Less than a fifth of the frame is lost in its noise.
        let is_told = span > 0.2 * limit_ms.median;
        let frames = |times: &[f64]| {
            let views = degrees.iter().cycle().zip(times);
            views
                .map(|(degrees, ms)| FrameTime {
                    degrees: *degrees,
                    ms: *ms,
                })
                .collect()
        };
        Ok(Self {
            stage: stage.to_owned(),
            refused: None,
            fps: Some([
                1e3 / frame_ms.max,
                own.len() as f64 / seconds,
                1e3 / frame_ms.min,
            ]),
            to_limit: Some(ratio(own, limit)?),
            to_limit_net: is_told.then(|| (frame_ms.median - empty_ms.median) / span),
            frame_ms: Some(frame_ms),
            limit_ms: Some(limit_ms),
            empty_ms: Some(empty_ms),
            device_bytes,
            frames: frames(own),
            limit_frames: frames(limit),
        })
    }

    /// A row of what is not drawn, and why.
    #[must_use]
    pub fn refused(stage: &str, why: String) -> Self {
        Self {
            stage: stage.to_owned(),
            refused: Some(why),
            fps: None,
            frame_ms: None,
            limit_ms: None,
            empty_ms: None,
            to_limit: None,
            to_limit_net: None,
            device_bytes: 0,
            frames: Vec::new(),
            limit_frames: Vec::new(),
        }
    }
}

/// A technique on a volume at a size.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Table {
    /// The volume's name.
    pub volume: String,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// The technique's name.
    pub technique: String,
    /// In each stage.
    pub rows: Vec<Row>,
}

/// How frames are timed.
#[derive(Clone, Debug)]
pub struct TableOptions {
    /// The views.
    pub rotation: Rotation,
    /// No new round after so many seconds; one round is always drawn.
    pub seconds: f64,
    /// Rounds before, which are not timed.
    pub warm_up: u32,
}

/// Times a scene in these stages beside its limit. What a stage refuses, of the scene or of its limit, is a row that says
/// why.
pub fn run_table(
    scene: &Scene,
    stages: &[&str],
    gpu: &Arc<Gpu>,
    session: &SessionOptions,
    options: &TableOptions,
) -> Vec<Row> {
    let mut stand = BenchStand::new(options.rotation.clone());
    let mut ready = Vec::new();
    let mut rows = Vec::new();
    for stage in stages {
        let mut open = || -> Result<_, Findings> {
            let own = in_stage(scene, stage)?;
            let limits = [limit_of(&own)?, empty_of(&own)?];
            let mut entry = Entry::new(own, gpu, session)?;
            stand.frame(&mut entry, 0)?;
            let [limit, empty] = limits;
            let limit = Entry::new(limit, gpu, session)?;
            Ok((*stage, entry, [limit, Entry::new(empty, gpu, session)?]))
        };
        match open() {
            Ok(entries) => ready.push(entries),
            Err(why) => rows.push(Row::refused(stage, why.to_string())),
        }
    }
    let mut entries: Vec<&mut Entry> = Vec::new();
    for (_, own, [limit, empty]) in &mut ready {
        entries.extend([own, limit, empty]);
    }
    let views = u32::try_from(options.rotation.degrees.len()).unwrap_or(u32::MAX);
    alternate(&mut stand, &mut entries, 0..options.warm_up, |_, _| true);
    stand.start();
    let times = alternate(&mut stand, &mut entries, 0..views, |stand, _| {
        stand.started.elapsed().as_secs_f64() < options.seconds
    });
    drop(entries);
    for ((stage, entry, _), times) in ready.iter().zip(times.chunks_exact(3)) {
        rows.push(row(
            stage,
            &options.rotation.degrees,
            times,
            entry.device_bytes(),
        ));
    }
    rows
}

fn row(stage: &str, degrees: &[f64], times: &[crate::methods::Times], bytes: u64) -> Row {
    let [Ok(own), Ok(limit), Ok(empty)] = times else {
        let why = times.iter().find_map(|times| times.as_ref().err());
        return Row::refused(stage, why.map_or_else(String::new, ToString::to_string));
    };
    Row::of(stage, degrees, [own, limit, empty], bytes)
        .unwrap_or_else(|error| Row::refused(stage, error.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_says_rates_and_ratios_with_and_without_the_fixed_cost() {
        let own = [40.0, 50.0, 100.0];
        let limit = [20.0, 25.0, 50.0];
        let row = Row::of(
            "compute",
            &[0.0, 180.0, 90.0],
            [&own, &limit, &[5.0, 5.0, 5.0]],
            7,
        )
        .unwrap();
        let [min, average, max] = row.fps.unwrap();
        assert_eq!((min, max), (10.0, 25.0));
        assert!(
            (average - 3000.0 / 190.0).abs() < 1e-9,
            "not the mean of rates: {average}"
        );
        assert_eq!(row.to_limit.unwrap().median, 2.0);
        assert_eq!(row.to_limit_net, Some(45.0 / 20.0));
        assert_eq!(
            row.frames[1],
            FrameTime {
                degrees: 180.0,
                ms: 50.0
            }
        );
        assert_eq!(row.device_bytes, 7);
        // A limit that is nearly all fixed cost tells nothing without it.
        let lost = Row::of("compute", &[0.0], [&[9.0], &[5.5], &[5.0]], 0).unwrap();
        assert_eq!(lost.to_limit_net, None);
        assert!(Row::of("compute", &[0.0], [&[9.0], &[], &[5.0]], 0).is_err());
    }

    #[test]
    fn tables_are_json_of_plain_names() {
        let row = Row::of("fragment", &[0.0], [&[9.0], &[3.0], &[1.0]], 5).unwrap();
        let json = serde_json::to_value(Table {
            volume: "v".to_owned(),
            size: [4, 3],
            technique: "t".to_owned(),
            rows: vec![row, Row::refused("compute", "no".to_owned())],
        })
        .unwrap();
        assert_eq!(json["rows"][0]["to_limit"]["median"], 3.0);
        assert_eq!(json["rows"][0]["to_limit_net"], 4.0);
        assert_eq!(json["rows"][0]["frames"][0]["ms"], 9.0);
        assert_eq!(json["rows"][1]["refused"], "no");
        assert!(json["rows"][1]["fps"].is_null());
    }
}
