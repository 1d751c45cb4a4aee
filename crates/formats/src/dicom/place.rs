//! From the positions of frames to the order of slices and one affine map.
//!
//! Frames are sorted along the normal of their rows and columns, as GDCM and ITK do. The map's columns are the steps
//! along a row, down a column, and from the first slice to the last divided by their number: the ends are where the
//! file puts them. What that leaves out is told: gaps, a tilt against the normal (kept as a shear), positions beside
//! the line. Several frames at each position are time steps if the file numbers them so; else they are refused.

use glam::{DAffine3, DMat3, DVec3};
use volgraph_volume::{Trouble, VolumeError};

use super::image::Frame;

/// Slices in order, and where they lie.
pub(super) struct Placed {
    /// Frames of one step after the other.
    pub order: Vec<usize>,
    pub slices: usize,
    pub steps: usize,
    pub world_from_index: DAffine3,
    /// Whether lengths are millimetres.
    pub in_mm: bool,
    pub warnings: Vec<String>,
}

/// How far a step may be off the others, as a part of it.
const UNEVEN: f64 = 0.01;
/// From which angle on a tilt is told.
const TILT_DEGREES: f64 = 0.1;

/// `name` tells of a frame which file it is from; frames are in the order of their numbers.
pub(super) fn place(
    frames: &[&Frame],
    name: impl Fn(usize) -> String,
) -> Result<Placed, VolumeError> {
    let mut warnings = Vec::new();
    let first = frames[0];
    let in_mm = first.spacing.is_some();
    if !in_mm {
        warnings.push("the distances of the pixels are not said: they are taken as 1".to_owned());
    }
    let [row_step, column_step] = first.spacing.unwrap_or([1.0, 1.0]);
    let known = frames.iter().all(|frame| frame.position.is_some());
    let ([x, y], true) = (first.orientation.unwrap_or([DVec3::X, DVec3::Y]), known) else {
        let z = first.thickness.unwrap_or(1.0);
        if frames.len() > 1 {
            warnings.push(format!(
                "{} frames without positions: they are taken as slices in their order, {z} apart",
                frames.len()
            ));
        }
        let [x, y] = first.orientation.unwrap_or([DVec3::X, DVec3::Y]);
        return Ok(Placed {
            order: (0..frames.len()).collect(),
            slices: frames.len(),
            steps: 1,
            world_from_index: DAffine3 {
                matrix3: DMat3::from_cols(
                    x * column_step,
                    y * row_step,
                    x.cross(y).normalize() * z,
                ),
                translation: first.position.unwrap_or(DVec3::ZERO),
            },
            in_mm,
            warnings,
        });
    };
    let normal = x.cross(y).normalize();
    let position = |frame: usize| frames[frame].position.unwrap_or(DVec3::ZERO);
    let along = |frame: usize| position(frame).dot(normal);
    let mut sorted: Vec<usize> = (0..frames.len()).collect();
    // A stable sort: frames at one place keep the order of their numbers.
    sorted.sort_by(|&a, &b| along(a).total_cmp(&along(b)));
    let same = 1e-3 * row_step.min(column_step);
    let mut places: Vec<Vec<usize>> = Vec::new();
    for frame in sorted {
        match places.last_mut() {
            Some(place) if along(frame) - along(place[0]) <= same => place.push(frame),
            _ => places.push(vec![frame]),
        }
    }
    let steps = time_steps(frames, &mut places, &name)?;
    let slices = places.len();
    let order = (0..steps)
        .flat_map(|step| places.iter().map(move |place| place[step]))
        .collect();
    let (start, end) = (position(places[0][0]), position(places[slices - 1][0]));
    let z = if slices > 1 {
        (end - start) / (slices as f64 - 1.0)
    } else {
        normal * first.thickness.unwrap_or(row_step.min(column_step))
    };
    if slices > 1 {
        let placed: Vec<DVec3> = places.iter().map(|place| position(place[0])).collect();
        let name = |slice: usize| name(places[slice][0]);
        told(&placed, normal, z, &name, &mut warnings);
    }
    Ok(Placed {
        order,
        slices,
        steps,
        world_from_index: DAffine3 {
            matrix3: DMat3::from_cols(x * column_step, y * row_step, z),
            translation: start,
        },
        in_mm,
        warnings,
    })
}

/// How many time steps there are; the frames of each place are brought into their order.
fn time_steps(
    frames: &[&Frame],
    places: &mut [Vec<usize>],
    name: &impl Fn(usize) -> String,
) -> Result<usize, VolumeError> {
    let steps = places[0].len();
    let times = |place: &[usize]| -> Vec<Option<u32>> {
        place.iter().map(|&frame| frames[frame].time).collect()
    };
    for place in places.iter_mut() {
        place.sort_by_key(|&frame| frames[frame].time);
    }
    let expected = times(&places[0]);
    let distinct = expected.windows(2).all(|pair| pair[0] < pair[1]) && expected[0].is_some();
    let regular = places.iter().all(|place| times(place) == expected);
    if steps > 1 && distinct && regular || places.iter().all(|place| place.len() == 1) {
        return Ok(steps);
    }
    let twice = places
        .iter()
        .find(|place| place.len() > 1)
        .unwrap_or(&places[0]);
    let twice_count = places.iter().filter(|place| place.len() > 1).count();
    let other = twice.get(1).copied().unwrap_or(twice[0]);
    Err(VolumeError::Unsupported(Trouble::new(
        format!(
            "{} and {} lie at the same place, and so do frames at {twice_count} of {} places",
            name(twice[0]),
            name(other),
            places.len()
        ),
        "move copies and other echoes or phases of the series to folders of their own, or name one of them with a pattern",
    )))
}

/// Tells what one step for all slices leaves out.
fn told(
    placed: &[DVec3],
    normal: DVec3,
    step: DVec3,
    name: &impl Fn(usize) -> String,
    warnings: &mut Vec<String>,
) {
    let mean = step.dot(normal);
    let gaps: Vec<f64> = placed
        .windows(2)
        .map(|pair| (pair[1] - pair[0]).dot(normal))
        .collect();
    let mut sorted = gaps.clone();
    sorted.sort_by(f64::total_cmp);
    let median = sorted[sorted.len() / 2];
    let uneven: Vec<usize> = (0..gaps.len())
        .filter(|&i| (gaps[i] - median).abs() > UNEVEN * median)
        .collect();
    if let Some(&widest) = uneven.iter().max_by(|&&a, &&b| gaps[a].total_cmp(&gaps[b])) {
        warnings.push(format!(
            "the slices are not evenly spaced (some are missing?): {:.4} between {} and {}, most are {median:.4} \
             apart, {} of {} are not; all are placed {mean:.4} apart",
            gaps[widest],
            name(widest),
            name(widest + 1),
            uneven.len(),
            gaps.len()
        ));
    }
    let tilt = (mean / step.length()).clamp(-1.0, 1.0).acos().to_degrees();
    if tilt > TILT_DEGREES {
        warnings.push(format!(
            "the slices are sheared by {tilt:.2} degrees against their normal (gantry tilt): the placement keeps that"
        ));
    }
    let aside = |slice: usize| {
        let off = placed[slice] - (placed[0] + step * slice as f64);
        (off - normal * off.dot(normal)).length()
    };
    let farthest = (0..placed.len()).map(|slice| (slice, aside(slice)));
    if let Some((slice, off)) = farthest.max_by(|a, b| a.1.total_cmp(&b.1))
        && off > UNEVEN * mean
        && uneven.is_empty()
    {
        warnings.push(format!(
            "the slices do not lie on a line: {} is {off:.4} beside it",
            name(slice)
        ));
    }
}
