//! Which bricks of a volume may be seen: their ranges, made once, and the last answer.

use std::sync::{Mutex, OnceLock, PoisonError};

use volgraph_volume::{BrickRanges, Volume};

use crate::brick_proxy::{EDGE, MARGIN};
use crate::encoding::Encoding;

/// The first and the last brick along each axis.
type Bounds = Option<[[u32; 3]; 2]>;

/// What is known of a volume's bricks. The camera asks again for each frame, a transfer function seldom changes.
#[derive(Debug, Default)]
pub struct SeenBricks {
    ranges: OnceLock<BrickRanges>,
    last: Mutex<Option<(Asked, Bounds)>>,
}

#[derive(Debug, PartialEq)]
struct Asked {
    storage: String,
    spans: Vec<(f64, f64)>,
}

impl SeenBricks {
    /// The bounds of the bricks with scalars in open intervals, as shaders read them.
    pub(super) fn of(
        &self,
        volume: &Volume,
        storage: &str,
        spans: Vec<(f64, f64)>,
        encoding: &Encoding,
    ) -> Bounds {
        let asked = Asked {
            storage: storage.to_owned(),
            spans,
        };
        let mut last = self.last.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((before, bounds)) = last.as_ref()
            && *before == asked
        {
            return *bounds;
        }
        let bricks = self
            .ranges
            .get_or_init(|| volume.brick_ranges(EDGE, [MARGIN; 2]));
        let bounds = bounds(bricks, &asked.spans, encoding);
        *last = Some((asked, bounds));
        bounds
    }
}

fn bounds(bricks: &BrickRanges, spans: &[(f64, f64)], encoding: &Encoding) -> Bounds {
    let mut bounds: Bounds = None;
    let [x, y, _] = bricks.dims.map(|n| n.max(1) as usize);
    // Rounding of what shaders compute of scalars is far below that.
    let slack = 1e-6 * (encoding.range.1 - encoding.range.0).abs();
    for (number, [low, high]) in bricks.ranges.iter().enumerate() {
        let low = f64::from(encoding.stored(*low)) - slack;
        let high = f64::from(encoding.stored(*high)) + slack;
        if !spans.iter().any(|(from, to)| high > *from && low < *to) {
            continue;
        }
        #[expect(clippy::cast_possible_truncation, reason = "less than the dimensions")]
        let at = [number % x, number / x % y, number / x / y].map(|n| n as u32);
        let [first, last] = bounds.get_or_insert([at, at]);
        for axis in 0..3 {
            first[axis] = first[axis].min(at[axis]);
            last[axis] = last[axis].max(at[axis]);
        }
    }
    bounds
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use volgraph_volume::Grid;

    use super::*;

    #[test]
    fn bounds_are_those_of_bricks_with_such_scalars_and_follow_what_is_asked() {
        let dims = [40_u32, 24, 17];
        let mut voxels = vec![0_u8; 40 * 24 * 17];
        let at = |x: usize, y: usize, z: usize| (z * 24 + y) * 40 + x;
        voxels[at(20, 12, 4)] = 200;
        voxels[at(36, 12, 12)] = 90;
        let grid = Grid::axis_aligned(dims, DVec3::ONE, DVec3::ZERO);
        let volume = Volume::new("v", grid, voxels.into()).unwrap();
        let encoding = Encoding::choose(&volume, "r32float");
        let seen = SeenBricks::default();
        let of = |from: f64, to: f64| {
            let span = (from - encoding.reference, to - encoding.reference);
            seen.of(&volume, "r32float", vec![span], &encoding)
        };
        // The scalars of brick 2 are made of voxels 14 to 25.
        assert_eq!(of(100.0, 255.0), Some([[2, 1, 0], [2, 1, 0]]));
        assert_eq!(of(50.0, 255.0), Some([[2, 1, 0], [4, 1, 1]]));
        assert_eq!(of(200.5, 255.0), None);
        assert_eq!(of(-1.0, 255.0), Some([[0, 0, 0], [4, 2, 2]]));
        assert_eq!(seen.of(&volume, "r32float", Vec::new(), &encoding), None);
    }
}
