//! How a frame's cost grows with the work.
//!
//! Each axis changes one thing and leaves the others: pixels, 1/step, voxels (with the step in voxels, so that there are
//! more samples as well), and the occupied part of the volume. All points of an axis are timed in turn.

use std::sync::Arc;

use serde::Serialize;
use volgraph_gpu::Gpu;
use volgraph_measure::timing::Summary;
use volgraph_report::Findings;

use super::fit::{PowerFit, fit};
use super::rotation::Rotation;
use super::stand::{BenchStand, Entry};
use super::subject::Subject;
use super::technique::{Technique, in_stage};
use crate::methods::alternate;
use crate::session::SessionOptions;
use crate::shaders::ShaderFolders;

/// What grows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum GrowthAxis {
    /// The picture's pixels.
    Pixels,
    /// Steps a voxel.
    Steps,
    /// The volume's voxels, of a dense field.
    VoxelsDense,
    /// The volume's voxels, of a sparse field.
    VoxelsSparse,
    /// The part of the box that is not empty, of 0 to 1.
    Occupied,
}

impl GrowthAxis {
    /// All of them.
    pub const ALL: [Self; 5] = [
        Self::Pixels,
        Self::Steps,
        Self::VoxelsDense,
        Self::VoxelsSparse,
        Self::Occupied,
    ];

    /// What it counts, for people.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Self::Pixels => "pixels",
            Self::Steps => "steps a voxel",
            Self::VoxelsDense => "voxels, dense field",
            Self::VoxelsSparse => "voxels, sparse field",
            Self::Occupied => "occupied fraction",
        }
    }
}

/// How far each axis goes.
#[derive(Clone, Debug)]
pub struct GrowthOptions {
    /// Largest viewport side, of 128 on in doubles.
    pub largest_view: u32,
    /// Largest volume side, of 64 on in doubles.
    pub largest_volume: u32,
    /// Viewport side of the axes that do not change it.
    pub view: u32,
    /// Volume side of the axes that do not change it.
    pub volume: u32,
    /// Seconds for each curve; one round is always drawn.
    pub seconds: f64,
    /// Rounds at most.
    pub rounds: u32,
    /// The stage.
    pub stage: String,
    /// The traversal of the raycast.
    pub traverse: String,
}

/// A point of a curve.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct GrowthPoint {
    /// What was changed, as it was set.
    pub label: String,
    /// The work, in the axis's unit.
    pub work: f64,
    /// Milliseconds of a frame.
    pub frame_ms: Summary,
    /// All frames.
    pub all_ms: Vec<f64>,
}

/// A technique's cost along an axis.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Growth {
    /// What grows.
    pub axis: GrowthAxis,
    /// The technique's name.
    pub technique: String,
    /// By rising work.
    pub points: Vec<GrowthPoint>,
    /// The power, of medians; nothing is subtracted.
    pub fit: Option<PowerFit>,
    /// Points that were not drawn, and why.
    pub refused: Vec<String>,
}

impl Growth {
    /// A curve from the times of its points: label, work, milliseconds of frames.
    #[must_use]
    pub fn of(axis: GrowthAxis, technique: &str, times: Vec<(String, f64, Vec<f64>)>) -> Self {
        let mut refused = Vec::new();
        let mut points = Vec::new();
        for (label, work, all_ms) in times {
            match Summary::of(&all_ms) {
                Ok(frame_ms) => points.push(GrowthPoint {
                    label,
                    work,
                    frame_ms,
                    all_ms,
                }),
                Err(why) => refused.push(format!("{label}: {why}")),
            }
        }
        points.sort_by(|a, b| a.work.total_cmp(&b.work));
        let medians: Vec<(f64, f64)> = points
            .iter()
            .map(|point| (point.work, point.frame_ms.median))
            .collect();
        Self {
            axis,
            technique: technique.to_owned(),
            fit: fit(&medians),
            points,
            refused,
        }
    }
}

/// What one point draws.
struct Point {
    label: String,
    work: f64,
    field: Field,
    side: u32,
    view: u32,
    step: f64,
}

/// The field of a point.
enum Field {
    Dense,
    Sparse,
    /// A ball of this radius, of the box's half side.
    Ball(f64),
}

/// Numbers in doubles.
fn doubles(from: u32, to: u32) -> Vec<u32> {
    std::iter::successors(Some(from.min(to)), |side| side.checked_mul(2))
        .take_while(|side| *side <= to)
        .collect()
}

fn points(axis: GrowthAxis, options: &GrowthOptions) -> Vec<Point> {
    let (view, side) = (options.view, options.volume);
    let base = |label: String, work: f64| Point {
        label,
        work,
        field: Field::Dense,
        side,
        view,
        step: 1.0,
    };
    let cubes = |field: fn() -> Field| {
        let sides = doubles(64, options.largest_volume).into_iter();
        let point = |side: u32| Point {
            field: field(),
            side,
            ..base(format!("{side}³"), f64::from(side).powi(3))
        };
        sides.map(point).collect()
    };
    match axis {
        GrowthAxis::Pixels => doubles(128, options.largest_view)
            .into_iter()
            .map(|view| Point {
                view,
                ..base(format!("{view}²"), f64::from(view).powi(2))
            })
            .collect(),
        GrowthAxis::Steps => [4.0, 2.0, 1.0, 0.5, 0.25, 0.125]
            .into_iter()
            .map(|step| Point {
                step,
                ..base(format!("step {step}"), 1.0 / step)
            })
            .collect(),
        GrowthAxis::VoxelsDense => cubes(|| Field::Dense),
        GrowthAxis::VoxelsSparse => cubes(|| Field::Sparse),
        GrowthAxis::Occupied => [0.125, 0.25, 0.5, 0.75, 1.0]
            .into_iter()
            .map(|radius: f64| {
                // The ball's part of the cube around it.
                let part = std::f64::consts::PI / 6.0 * radius.powi(3);
                Point {
                    field: Field::Ball(radius),
                    ..base(format!("ball of {radius}"), part)
                }
            })
            .collect(),
    }
}

impl Point {
    fn subject(&self, shaders: &ShaderFolders) -> Result<Subject, Findings> {
        match self.field {
            Field::Dense => Subject::analytic("marschner_lobb", self.side, shaders),
            Field::Sparse => Subject::analytic("c60", self.side, shaders),
            Field::Ball(radius) => Subject::ball(radius, self.side, shaders),
        }
    }
}

/// Times a technique along an axis.
///
/// # Errors
/// Where the technique cannot be drawn at all.
pub fn growth(
    axis: GrowthAxis,
    technique: &Technique,
    gpu: &Arc<Gpu>,
    session: &SessionOptions,
    options: &GrowthOptions,
) -> Result<Growth, Findings> {
    let mut stand = BenchStand::new(Rotation::new(360.0 / 64.0, 64));
    let mut refused = Vec::new();
    let mut ready = Vec::new();
    for point in points(axis, options) {
        let opened = point.subject(&session.shader_folders).and_then(|subject| {
            let mut scene = technique.scene(&subject, point.step, &session.shader_folders)?;
            scene = super::technique::with_traverse(&scene, &options.traverse)?;
            let size = SessionOptions {
                size: [point.view; 2],
                ..session.clone()
            };
            Entry::new(in_stage(&scene, &options.stage)?, gpu, &size)
        });
        match opened {
            Ok(entry) => ready.push((point, entry)),
            Err(why) => refused.push(format!("{}: {why}", point.label)),
        }
    }
    let mut entries: Vec<&mut Entry> = ready.iter_mut().map(|(_, entry)| entry).collect();
    // What is built and computed once is not timed.
    alternate(&mut stand, &mut entries, 0..1, |_, _| true);
    stand.start();
    let times = alternate(
        &mut stand,
        &mut entries,
        1..options.rounds.saturating_add(1),
        |stand, _| stand.started.elapsed().as_secs_f64() < options.seconds,
    );
    drop(entries);
    let mut measured = Vec::new();
    for ((point, _), times) in ready.iter().zip(times) {
        match times {
            Ok(times) => measured.push((point.label.clone(), point.work, times)),
            Err(why) => refused.push(format!("{}: {why}", point.label)),
        }
    }
    let mut growth = Growth::of(axis, &technique.name, measured);
    growth.refused.extend(refused);
    Ok(growth)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_is_fitted_to_its_medians() {
        let times = vec![
            ("b".to_owned(), 4.0, vec![8.0, 90.0, 8.0]),
            ("a".to_owned(), 1.0, vec![2.0]),
            ("c".to_owned(), 16.0, vec![32.0]),
            ("d".to_owned(), 64.0, vec![]),
        ];
        let found = Growth::of(GrowthAxis::Pixels, "mip", times);
        assert!(
            found
                .points
                .iter()
                .map(|point| point.label.as_str())
                .eq(["a", "b", "c"])
        );
        let fit = found.fit.unwrap();
        assert!(
            (fit.exponent - 1.0).abs() < 1e-12 && (fit.from, fit.to) == (1.0, 16.0_f64.ln().exp())
        );
        assert_eq!(found.refused.len(), 1);
        let json = serde_json::to_value(&found).unwrap();
        assert_eq!(
            (
                json["axis"].as_str(),
                json["points"][1]["frame_ms"]["median"].as_f64()
            ),
            (Some("pixels"), Some(8.0))
        );
    }

    #[test]
    fn axes_go_in_doubles_up_to_their_limits() {
        assert_eq!(doubles(64, 512), [64, 128, 256, 512]);
        assert_eq!(doubles(64, 100), [64]);
        assert_eq!(doubles(64, 16), [16]);
        let options = GrowthOptions {
            largest_view: 256,
            largest_volume: 128,
            view: 64,
            volume: 32,
            seconds: 1.0,
            rounds: 1,
            stage: "compute".to_owned(),
            traverse: "uniform".to_owned(),
        };
        for axis in GrowthAxis::ALL {
            let points = points(axis, &options);
            assert!(
                points.len() >= 2 && points.windows(2).all(|pair| pair[0].work < pair[1].work),
                "{axis:?}"
            );
        }
    }
}
