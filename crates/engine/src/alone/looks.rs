//! What a volume's values are like: how many there are, and whether they stand in patches.

use volgraph_volume::Volume;

/// What a volume's values are like.
pub struct Looks {
    /// All that were looked at are whole numbers.
    pub is_whole: bool,
    /// How many different values were looked at.
    pub distinct: usize,
    /// The share of neighbours along x, neither of them the smallest value, that are equal.
    pub equal: f64,
    /// Of those that are not, the share that differs by 2 at most: smooth values do, labels have no order.
    near: f64,
    /// Of three in a row whose ends differ, the share whose middle lies between them: the way from one value to another
    /// leads over those between, the way from one label to another does not.
    between: f64,
    /// The values that were looked at and are not the smallest, ascending.
    inside: Vec<f64>,
}

impl Looks {
    /// Labels are few numbers in patches, and it does not matter how far apart they are: atlases of a thousand regions have
    /// numbers up to hundreds of millions.
    pub fn are_labels(&self) -> bool {
        let is_few = self.distinct <= 32 && self.equal > 0.8;
        // Each stands for many voxels.
        let is_often = 16 * self.distinct <= self.inside.len();
        let is_in_patches = is_often && self.equal > 0.3 && self.near < 0.5;
        self.is_whole && self.between < 0.25 && (is_few || is_in_patches)
    }

    /// The values between which 96 of 100 voxels are that do not have the smallest one: `from < to`.
    pub fn most(&self) -> (f64, f64) {
        let at = |share: f64| {
            let last = self.inside.len().saturating_sub(1);
            self.inside.get((share * last as f64).round() as usize)
        };
        let (from, to) = (at(0.02), at(0.98));
        let from = from.copied().unwrap_or(0.0);
        let least = (1e-4 * from.abs()).max(1.0);
        (from, to.map_or(from, |to| *to).max(from + least))
    }
}

/// Looks at some hundred thousand voxels and their neighbours, spread over all of the volume.
pub fn looks(volume: &Volume) -> Looks {
    let (min, _) = volume.statistics().range().unwrap_or((0.0, 0.0));
    let voxels = volume.voxels();
    let count = voxels.len();
    // Odd, so that it does not walk along one plane.
    let stride = (count / 500_000).max(1) | 1;
    let at = |place: usize| (place < count).then(|| volume.drawn(voxels.get(place)));
    let inside = |place: usize| at(place).filter(|value| *value > min);
    let mut values = Vec::with_capacity(count / stride + 1);
    let (mut pairs, mut equal, mut near) = (0_u64, 0_u64, 0_u64);
    let (mut changes, mut between) = (0_u64, 0_u64);
    for place in (0..count).step_by(stride) {
        values.extend(at(place));
        let (Some(value), Some(next)) = (inside(place), inside(place + 1)) else {
            continue;
        };
        pairs += 1;
        equal += u64::from(value == next);
        near += u64::from(value != next && (value - next).abs() <= 2.0);
        if let Some(last) = inside(place + 2).filter(|last| *last != value) {
            changes += 1;
            between += u64::from(value.min(last) < next && next < value.max(last));
        }
    }
    let is_whole = values.iter().all(|value| value.fract() == 0.0);
    values.sort_unstable_by(f64::total_cmp);
    let distinct = values.chunk_by(|a, b| a.to_bits() == b.to_bits()).count();
    values.retain(|value| *value > min);
    let share = |count: u64, of: u64| count as f64 / of.max(1) as f64;
    Looks {
        is_whole,
        distinct,
        equal: share(equal, pairs),
        near: share(near, pairs - equal),
        between: share(between, changes),
        inside: values,
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use volgraph_volume::Grid;

    use super::*;

    /// 24 voxels to a side.
    fn of(value: impl Fn([u32; 3]) -> u32) -> Looks {
        let mut voxels = Vec::new();
        for z in 0..24 {
            for y in 0..24 {
                for x in 0..24 {
                    voxels.push(value([x, y, z]));
                }
            }
        }
        let grid = Grid::axis_aligned([24; 3], DVec3::ONE, DVec3::ZERO);
        looks(&Volume::new("v", grid, voxels.into()).unwrap())
    }

    /// The number of a block of 2 × 4 × 4 voxels, 0 outside of the middle ones.
    fn block([x, y, z]: [u32; 3]) -> u32 {
        if x < 4 {
            0
        } else {
            1 + x / 2 + 12 * (y / 4) + 72 * (z / 4)
        }
    }

    #[test]
    fn labels_are_few_values_however_far_apart() {
        // An order that has nothing to do with where a block is.
        let label = |at| block(at) * 2_654_435 % 1_000_003;
        let labels = of(|at| {
            if block(at) == 0 {
                0
            } else {
                15_000 + label(at)
            }
        });
        assert!(labels.are_labels() && labels.distinct > 300);
        // One of them is hundreds of millions.
        let far = of(|at| match block(at) {
            0 => 0,
            7 => 300_000_000,
            _ => 15_000 + label(at) % 2000,
        });
        assert!(far.are_labels());
        let (from, to) = far.most();
        assert!(15_000.0 <= from && to < 17_000.0, "{from} {to}");
    }

    #[test]
    fn what_rises_from_voxel_to_voxel_is_no_label() {
        // Steep, with gaps between the values, and even beyond.
        let steep = of(|[x, y, z]| (1 + (x + y + z).clamp(20, 30)) * 1000);
        assert!(!steep.are_labels(), "{} {}", steep.equal, steep.between);
        // By one every few voxels.
        assert!(!of(|[x, y, z]| 1 + (x + 2 * y + 3 * z) / 4).are_labels());
        // Values that occur once or twice.
        let noise = of(|[x, y, z]| (x / 2 + 12 * (y + 24 * z)) * 7919 % 100_003);
        assert!(!noise.are_labels());
    }
}
