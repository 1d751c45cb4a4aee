//! Every entry against an adaptive quadrature in float64, where transfer functions are at their worst: narrow peaks,
//! steps, and extinctions that go from nothing to opaque within one cell.

use super::*;

/// Nodes in -1..1 and weights of the Gauss-Legendre rule of six points.
const RULE: [(f64, f64); 3] = [
    (0.238_619_186_083_196_9, 0.467_913_934_572_691),
    (0.661_209_386_466_264_5, 0.360_761_573_048_138_6),
    (0.932_469_514_203_152, 0.171_324_492_379_170_4),
];

fn rule() -> impl Iterator<Item = (f64, f64)> {
    let both = |(x, w): (f64, f64)| [(0.5 - 0.5 * x, 0.5 * w), (0.5 + 0.5 * x, 0.5 * w)];
    RULE.into_iter().flat_map(both)
}

/// What a stretch without a knot inside shows, and its depth; `scale` is reference lengths to a unit of scalars.
fn panel(transfer: &TransferFunction, (from, to): (f64, f64), scale: f64) -> ([f64; 3], f64) {
    let depth = |to: f64| {
        let sum = rule().map(|(x, w)| w * transfer.extinction(from + x * (to - from)));
        sum.sum::<f64>() * (to - from).abs() * scale
    };
    let mut color = [0.0; 3];
    for (x, w) in rule() {
        let s = from + x * (to - from);
        let emitted = transfer.extinction(s) * (to - from).abs() * scale;
        let weight = w * emitted * (-depth(s)).exp();
        for (sum, c) in color.iter_mut().zip(transfer.color(s)) {
            *sum += weight * c;
        }
    }
    (color, depth(to))
}

fn behind((front, depth): ([f64; 3], f64), (back, more): ([f64; 3], f64)) -> ([f64; 3], f64) {
    let through = (-depth).exp();
    (
        std::array::from_fn(|i| front[i] + through * back[i]),
        depth + more,
    )
}

/// Halves until two halves say what the whole does.
fn adaptive(
    transfer: &TransferFunction,
    (from, to): (f64, f64),
    scale: f64,
    whole: ([f64; 3], f64),
    levels: u32,
) -> ([f64; 3], f64) {
    let middle = 0.5 * (from + to);
    let ends = [(from, middle), (middle, to)];
    let halves = ends.map(|ends| panel(transfer, ends, scale));
    let sum = behind(halves[0], halves[1]);
    let is_same = (sum.1 - whole.1).abs() <= 1e-14 * sum.1.max(1e-3)
        && (0..3).all(|i| (sum.0[i] - whole.0[i]).abs() <= 1e-14);
    if is_same || levels == 0 {
        return sum;
    }
    let [front, back] = [0, 1].map(|i| adaptive(transfer, ends[i], scale, halves[i], levels - 1));
    behind(front, back)
}

/// Colour and depth of a segment; right to about 1e-12. Shares no code with the table.
fn truth(transfer: &TransferFunction, (front, back): (f64, f64), length: f64) -> ([f64; 3], f64) {
    if front == back {
        let depth = transfer.extinction(front) * length;
        return (transfer.color(front).map(|c| c * -(-depth).exp_m1()), depth);
    }
    let mut cuts: Vec<f64> = transfer.knots();
    cuts.retain(|s| front.min(back) < *s && *s < front.max(back));
    if front > back {
        cuts.reverse();
    }
    let scale = length / (back - front).abs();
    let (mut sum, mut from) = (([0.0; 3], 0.0), front);
    for to in cuts.into_iter().chain([back]) {
        let whole = panel(transfer, (from, to), scale);
        let part = adaptive(transfer, (from, to), scale, whole, 45);
        sum = behind(sum, part);
        from = to;
    }
    sum
}

/// From nothing to opaque, and back, within a part of a cell of 1024: linear opacities that run into 1, linear
/// extinctions, and steps; the colour changes with them.
const OPAQUE: &str = "(color: [(0.1, (1, 0, 0)), (0.3001, (1, 0, 0)), (0.3006, (0, 1, 0)), (0.5, (0, 0, 1)), (0.5004, (1, 1, 0)),
    (0.7, (0, 0, 0)), (0.7008, (1, 1, 1))],
    opacity: [(0.3001, 0.0), (0.3006, 1.0), (0.4, 1.0), (0.4, 0.0), (0.5, 1.0), (0.5004, 0.0), (0.7, 0.0), (0.7, 1.0),
    (0.7008, 1.0), (0.9, 0.0)])";
const OPAQUE_EXTINCTION: &str = "(color: [(0.3, (1, 0, 0)), (0.3005, (0, 1, 0)), (0.6, (0, 0, 1)), (0.6012, (1, 1, 1))],
    extinction: [(0.3, 0.0), (0.3005, 16.0), (0.5, 16.0), (0.5, 0.0), (0.6, 0.0), (0.6012, 16.0), (0.6013, 0.0)])";

/// Entries around each knot, and some from far and near.
fn pairs(transfer: &TransferFunction, n: u32) -> Vec<(u32, u32)> {
    let (low, high) = transfer.range();
    let mut knots = transfer.knots();
    // Of a colour map all samples are alike.
    let every = knots.len().div_ceil(16);
    let mut random = Random(5);
    let mut pairs = Vec::new();
    knots.retain(|knot| (low..=high).contains(knot));
    for knot in knots.into_iter().step_by(every) {
        let cell = ((knot - low) / (high - low) * f64::from(n - 1)) as i64;
        let entry = |at: i64| at.clamp(0, i64::from(n) - 1) as u32;
        for (before, after) in [(0, 1), (1, 1), (0, 2), (5, 3), (90, 40)] {
            let (a, b) = (entry(cell - before), entry(cell + after));
            pairs.extend([(a, b), (b, a)]);
        }
        pairs.push((random.below(n), entry(cell)));
        pairs.push((entry(cell), entry(cell)));
    }
    pairs.extend((0..12).map(|_| (random.below(n), random.below(n))));
    pairs
}

/// Largest errors of colour and of depth, the latter relative to max(1, depth).
fn worst(transfer: &TransferFunction, table: &PreintegratedTable, length: f64) -> (f64, f64) {
    let (mut color, mut depth) = (0.0_f64, 0.0_f64);
    for (front, back) in pairs(transfer, table.size) {
        let ends = [front, back].map(|i| node(transfer.range(), table.size, i));
        let (seen, deep) = truth(transfer, (ends[0], ends[1]), length);
        let [r, g, b, a] = table.entry(front, back).unwrap().map(f64::from);
        for (c, seen) in [r, g, b].into_iter().zip(seen) {
            color = color.max((c - seen).abs());
        }
        depth = depth.max((a - deep).abs() / deep.max(1.0));
    }
    (color, depth)
}

/// The bounds that the table's documentation states.
const COLOR: f64 = 1e-6;
const DEPTH: f64 = 1e-6;

#[test]
fn every_entry_agrees_with_adaptive_quadrature() {
    let more = [("opaque", OPAQUE), ("opaque extinction", OPAQUE_EXTINCTION)];
    let mut failures = Vec::new();
    for (name, text) in ALL.into_iter().chain(more) {
        let transfer = transfer(text);
        for length in [0.25, 1.0, 6.0, 32.0] {
            for n in [64, 1024] {
                let table = transfer.preintegrated_table(n, length).unwrap();
                let (color, depth) = worst(&transfer, &table, length);
                println!("{name}, {n}, length {length}: colour {color:.1e}, depth {depth:.1e}");
                if color > COLOR || depth > DEPTH {
                    failures.push((name, n, length, color, depth));
                }
            }
        }
    }
    assert!(failures.is_empty(), "{failures:?}");
}

#[test]
fn the_quadrature_is_right_where_there_is_a_closed_form() {
    // τ(s) = 5 s and one colour: 1 - exp(-depth); and c(s) = s under τ = 2: ∫₀¹ x T exp(-T x) dx.
    let linear = transfer("(color: (1, 0.5, 0), extinction: [(0, 0), (1, 5)])");
    let rising = transfer("(color: [(0, (0, 0, 0)), (1, (1, 1, 1))], extinction: [(0, 2)])");
    for length in [0.25, 4.0, 32.0] {
        let (color, depth) = truth(&linear, (0.2, 0.9), length);
        let expected: f64 = 5.0 * 0.55 * length;
        assert!((depth - expected).abs() < 1e-12 * expected);
        assert!((color[0] + (-expected).exp_m1()).abs() < 1e-12);
        let (color, _) = truth(&rising, (0.0, 1.0), length);
        let t: f64 = 2.0 * length;
        let expected = -(-t).exp_m1() / t - (-t).exp();
        assert!((color[1] - expected).abs() < 1e-12, "{color:?} {expected}");
    }
}
