//! The voxels at the corners of cells, each lane's own cell.

use super::{Edges, Faces, Sampled, Singles, Words};
use crate::lanes::{Lanes, four};

/// Cells by their corners. A cell is told by the voxel at its low corner, which is a voxel of the grid: the field beyond the
/// last voxels is theirs.
pub(crate) trait Corners: Sampled {
    /// What is loaded of a cell.
    type Loaded<L: Lanes>: Copy;

    /// Loads cells.
    fn load<L: Lanes>(&self, l: L, cell: [L::F; 3]) -> Self::Loaded<L>;

    /// The scalars of the corners; x runs fastest, then y.
    fn corners<L: Lanes>(l: L, loaded: Self::Loaded<L>) -> [L::F; 8];

    /// The largest of them.
    fn highest<L: Lanes>(l: L, loaded: Self::Loaded<L>) -> L::F;

    /// The smallest of them.
    fn lowest<L: Lanes>(l: L, loaded: Self::Loaded<L>) -> L::F;
}

impl Words {
    /// The places of cells.
    #[inline(always)]
    fn place<L: Lanes>(&self, l: L, cell: [L::F; 3]) -> L::I {
        let [x, y, z] = [
            l.truncated(cell[0]),
            l.truncated(cell[1]),
            l.truncated(cell[2]),
        ];
        let row = l.add_whole(l.mul_whole(y, l.whole(self.row)), x);
        l.add_whole(l.mul_whole(z, l.whole(self.layer)), row)
    }
}

#[inline(always)]
fn highest_of<L: Lanes>(l: L, all: [L::F; 8]) -> L::F {
    let [a, b, c, d] = four(
        #[inline(always)]
        |i| l.max(all[2 * i], all[2 * i + 1]),
    );
    l.max(l.max(a, b), l.max(c, d))
}

#[inline(always)]
fn lowest_of<L: Lanes>(l: L, all: [L::F; 8]) -> L::F {
    let [a, b, c, d] = four(
        #[inline(always)]
        |i| l.min(all[2 * i], all[2 * i + 1]),
    );
    l.min(l.min(a, b), l.min(c, d))
}

impl Corners for Faces {
    type Loaded<L: Lanes> = [L::I; 2];

    #[inline(always)]
    fn load<L: Lanes>(&self, l: L, cell: [L::F; 3]) -> [L::I; 2] {
        let place = self.0.place(l, cell);
        [
            self.0.load(l, place, 0),
            self.0.load(l, place, self.0.layer),
        ]
    }

    #[inline(always)]
    fn corners<L: Lanes>(l: L, [near, far]: [L::I; 2]) -> [L::F; 8] {
        [
            l.byte::<0>(near),
            l.byte::<8>(near),
            l.byte::<16>(near),
            l.byte::<24>(near),
            l.byte::<0>(far),
            l.byte::<8>(far),
            l.byte::<16>(far),
            l.byte::<24>(far),
        ]
    }

    #[inline(always)]
    fn highest<L: Lanes>(l: L, [near, far]: [L::I; 2]) -> L::F {
        l.highest_byte(l.max_bytes(near, far))
    }

    #[inline(always)]
    fn lowest<L: Lanes>(l: L, [near, far]: [L::I; 2]) -> L::F {
        let most = l.highest_byte(l.max_bytes(l.inverted(near), l.inverted(far)));
        l.sub(l.splat(255.0), most)
    }
}

impl Corners for Edges {
    type Loaded<L: Lanes> = [L::I; 4];

    #[inline(always)]
    fn load<L: Lanes>(&self, l: L, cell: [L::F; 3]) -> [L::I; 4] {
        let place = self.0.place(l, cell);
        let (row, layer) = (self.0.row, self.0.layer);
        let places = [0, row, layer, layer + row];
        four(
            #[inline(always)]
            |i| self.0.load(l, place, places[i]),
        )
    }

    #[inline(always)]
    fn corners<L: Lanes>(l: L, [a, b, c, d]: [L::I; 4]) -> [L::F; 8] {
        [
            l.half::<0>(a),
            l.half::<16>(a),
            l.half::<0>(b),
            l.half::<16>(b),
            l.half::<0>(c),
            l.half::<16>(c),
            l.half::<0>(d),
            l.half::<16>(d),
        ]
    }

    #[inline(always)]
    fn highest<L: Lanes>(l: L, loaded: [L::I; 4]) -> L::F {
        highest_of(l, Self::corners(l, loaded))
    }

    #[inline(always)]
    fn lowest<L: Lanes>(l: L, loaded: [L::I; 4]) -> L::F {
        lowest_of(l, Self::corners(l, loaded))
    }
}

impl Corners for Singles {
    type Loaded<L: Lanes> = [L::F; 8];

    #[inline(always)]
    fn load<L: Lanes>(&self, l: L, cell: [L::F; 3]) -> [L::F; 8] {
        let place = self.0.place(l, cell);
        let (row, layer) = (self.0.row, self.0.layer);
        let places = [0, row, layer, layer + row];
        let low = four(
            #[inline(always)]
            |i| l.of_bits(self.0.load(l, place, places[i])),
        );
        let high = four(
            #[inline(always)]
            |i| l.of_bits(self.0.load(l, place, places[i] + 1)),
        );
        let [[a, c, e, g], [b, d, f, h]] = [low, high];
        [a, b, c, d, e, f, g, h]
    }

    #[inline(always)]
    fn corners<L: Lanes>(_: L, loaded: [L::F; 8]) -> [L::F; 8] {
        loaded
    }

    #[inline(always)]
    fn highest<L: Lanes>(l: L, loaded: [L::F; 8]) -> L::F {
        highest_of(l, loaded)
    }

    #[inline(always)]
    fn lowest<L: Lanes>(l: L, loaded: [L::F; 8]) -> L::F {
        lowest_of(l, loaded)
    }
}
