//! Pieces of a ray on which colour and extinction are smooth: curves split where they turn and where they meet knots.

use crate::curve::Curve;
use crate::matter::Matter;

/// Parameters of a curve between which everything is smooth, and the part of the transfer function there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    /// Where it starts.
    pub from: f64,
    /// Where it ends.
    pub to: f64,
    /// The part of the transfer function that all of its scalars are in.
    pub part: usize,
}

/// Calls `visit` with the pieces of a curve between the parameters `from` and `to`, in order, until it returns true;
/// whether it did.
pub fn split(
    curve: &Curve,
    (from, to): (f64, f64),
    matter: &Matter,
    mut visit: impl FnMut(Piece) -> bool,
) -> bool {
    let turns = curve.turns();
    let mut turn_before = 0.0_f64;
    for turn in turns.as_slice().iter().copied().chain([1.0]) {
        let (low, high) = (turn_before.max(from), turn.min(to));
        turn_before = turn;
        if low >= high {
            continue;
        }
        let (first, last) = (curve.at(low), curve.at(high));
        let rises = last >= first;
        let knots = matter.knots();
        let (least, most) = if rises { (first, last) } else { (last, first) };
        // The knots strictly between the ends; where the curve is flat there are none, and at a knot itself the later
        // part holds.
        let lowest = knots.partition_point(|knot| *knot <= least);
        let highest = knots.partition_point(|knot| *knot < most).max(lowest);
        let mut start = low;
        for turn in lowest..=highest {
            // Knots in the order in which the ray meets them; behind the last one comes the end.
            let (end, part) = match (turn < highest, rises) {
                (true, true) => (curve.scalar.solve(start, high, knots[turn]), turn),
                (true, false) => {
                    let at = highest - 1 - (turn - lowest);
                    (curve.scalar.solve(start, high, knots[at]), at + 1)
                }
                (false, true) => (high, highest),
                (false, false) => (high, lowest),
            };
            if end > start {
                if visit(Piece {
                    from: start,
                    to: end,
                    part,
                }) {
                    return true;
                }
                start = end;
            }
        }
    }
    false
}

#[cfg(test)]
mod tests {
    use volgraph_optics::TransferFunction;

    use super::*;
    use crate::matter::Materials;
    use crate::polynomial::Polynomial;

    fn matter() -> Matter {
        let text = r#"(domain: data, points: [
            (at: 0, color: (1, 1, 1), opacity: 0), (at: 0.5, color: (1, 1, 1), opacity: 0.5),
            (at: 1, color: (1, 1, 1), opacity: 1)])"#;
        let transfer = TransferFunction::parse("matter.ron".as_ref(), text).unwrap();
        Matter::new(&transfer, (0.0, 1.0), 1.0, &Materials::NONE)
    }

    #[test]
    fn pieces_cover_a_cubic_whatever_it_does() {
        let matter = matter();
        // Flat at a knot, flat between, rising through all, a wave that meets the knot three times.
        let cubics = [
            [0.5, 0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0, 0.0],
            [0.3, 0.0, 0.0, 0.0],
            [-1.0, 3.0, 0.0, 0.0],
            [2.0, -3.0, 0.0, 0.0],
            [0.4, 2.2, -6.0, 4.0],
        ];
        for terms in cubics {
            let cubic = Curve {
                start: 0.0,
                end: 1.0,
                scalar: Polynomial::new(&terms),
            };
            let mut end = 0.0;
            split(&cubic, (0.0, 1.0), &matter, |piece| {
                assert_eq!(piece.from, end, "{terms:?}");
                let middle = cubic.at(0.5 * (piece.from + piece.to));
                assert_eq!(piece.part, matter.part_of(middle), "{terms:?}");
                end = piece.to;
                false
            });
            assert_eq!(end, 1.0, "{terms:?}");
        }
    }
}
