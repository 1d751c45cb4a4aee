use std::path::Path;

use super::*;

mod adaptive;
mod by_length;
mod lit;

fn transfer(text: &str) -> TransferFunction {
    TransferFunction::parse(Path::new("test.ron"), text).unwrap()
}

/// Colour and depth of a segment from scalar `front` to `back`, by the midpoint rule: thousands of slabs of
/// constant colour, cut at the knots and composited front to back. The slabs thin out towards the knots, where the
/// logarithm of an opacity that reaches 1 has its pole. Shares no code with the table.
fn quadrature(
    transfer: &TransferFunction,
    (front, back): (f64, f64),
    length: f64,
) -> ([f64; 3], f64) {
    let mut cuts: Vec<f64> = transfer.knots();
    cuts.retain(|s| front.min(back) < *s && *s < front.max(back));
    if front > back {
        cuts.reverse();
    }
    let graded = |k: u32, steps: u32| {
        let x = f64::from(k) / f64::from(steps);
        x * x * (3.0 - 2.0 * x)
    };
    let (mut color, mut depth, mut from) = ([0.0; 3], 0.0_f64, front);
    for to in cuts.into_iter().chain([back]) {
        let share = if back == front {
            1.0
        } else {
            (to - from) / (back - front)
        };
        let steps = 300 + (20_000.0 * share) as u32;
        for k in 0..steps {
            let (t0, t1) = (graded(k, steps), graded(k + 1, steps));
            let s = from + 0.5 * (t0 + t1) * (to - from);
            let slab = transfer.extinction(s) * length * share * (t1 - t0);
            let weight = (-depth).exp() * opacity_from_extinction(slab);
            for (sum, c) in color.iter_mut().zip(transfer.color(s)) {
                *sum += weight * c;
            }
            depth += slab;
        }
        from = to;
    }
    (color, depth)
}

/// A small generator (Steele, Lea, Flood 2014: SplitMix64), so that the pairs are the same in each run.
struct Random(u64);

impl Random {
    fn below(&mut self, n: u32) -> u32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) % u64::from(n)) as u32
    }
}

/// Largest errors of colour and of depth (relative to max(1, depth)) over pairs that include neighbours.
fn worst_error(
    transfer: &TransferFunction,
    table: &PreintegratedTable,
    length: f64,
    pairs: u32,
) -> (f64, f64) {
    let n = table.size;
    let mut random = Random(7);
    let (mut worst_color, mut worst_depth) = (0.0_f64, 0.0_f64);
    for k in 0..pairs {
        let front = random.below(n);
        let reach = [n, n / 16, 4][k as usize % 3].max(2);
        let back = (front + random.below(reach)).min(n - 1);
        let (front, back) = if random.below(2) == 0 {
            (front, back)
        } else {
            (back, front)
        };
        let ends = [front, back].map(|i| node(transfer.range(), n, i));
        let (color, depth) = quadrature(transfer, (ends[0], ends[1]), length);
        let [r, g, b, a] = table.entry(front, back).unwrap().map(f64::from);
        for (c, truth) in [r, g, b].into_iter().zip(color) {
            worst_color = worst_color.max((c - truth).abs());
        }
        worst_depth = worst_depth.max((a - depth).abs() / depth.max(1.0));
    }
    (worst_color, worst_depth)
}

const SMOOTH: &str = r##"(color: [(0.0, "#1a2699"), (0.4, (1, 0.2, 0)), (1.0, (0, 1, 0.5))],
    opacity: [(0.1, 0.0), (0.6, 0.5), (1.0, 0.9)])"##;
const NARROW_PEAK: &str = "(color: [(0.49, (1, 0, 0)), (0.5, (0, 1, 0)), (0.51, (0, 0, 1))],
    opacity: [(0.4987, 0.0), (0.5001, 0.98), (0.5012, 0.0)])";
const STEPS: &str =
    "(color: [(0.0, (1, 0, 0)), (0.3003, (1, 0, 0)), (0.3003, (0, 0, 1)), (0.8, (0, 1, 1))],
    opacity: [(0.2, 0.0), (0.2, 0.3), (0.3003, 0.3), (0.3003, 0.95), (0.7, 0.1), (0.7, 0.6)])";
const MAPPED: &str = r#"(domain: data(from: -1000, to: 3000), reference_length: (world: 0.5),
    color: map(name: "turbo", from: -200, to: 1500), opacity: [(-300, 0.0), (100, 0.2), (2000, 1.0)])"#;
const TO_OPAQUE: &str =
    "(color: [(0.0, (1, 0, 0)), (1.0, (0, 0, 1))], opacity: [(0.0, 0.0), (0.7, 1.0), (0.9, 0.0)])";
const EXTINCTION: &str = "(color: [(0.2, (0, 0, 1)), (0.8, (1, 1, 0))],
    extinction: [(0.0, 0.0), (0.5, 12.0), (0.5, 0.5), (1.0, 3.0)])";

const ALL: [(&str, &str); 6] = [
    ("smooth", SMOOTH),
    ("narrow peak", NARROW_PEAK),
    ("steps", STEPS),
    ("mapped", MAPPED),
    ("to opaque", TO_OPAQUE),
    ("extinction", EXTINCTION),
];

/// The bounds that the table's documentation states.
const COLOR_BOUND: f64 = 1e-6;
const DEPTH_BOUND: f64 = 1e-6;

#[test]
fn entries_agree_with_quadrature() {
    for (name, text) in ALL {
        let transfer = transfer(text);
        for length in [0.25, 1.0, 6.0] {
            let table = transfer.preintegrated_table(1024, length).unwrap();
            let (color, depth) = worst_error(&transfer, &table, length, 60);
            println!("{name}, length {length}: colour {color:.1e}, depth {depth:.1e}");
            assert!(
                color < COLOR_BOUND,
                "{name}, length {length}: colour error {color:e}"
            );
            assert!(
                depth < DEPTH_BOUND,
                "{name}, length {length}: depth error {depth:e}"
            );
        }
    }
}

#[test]
fn the_bound_sees_a_wrong_table() {
    let smooth = transfer(SMOOTH);
    // A transposed table confuses front and back, one of another length attenuates wrongly.
    let table = smooth.preintegrated_table(256, 1.0).unwrap();
    let mut transposed = table.clone();
    for front in 0..256 {
        for back in 0..256 {
            transposed.entries[front + 256 * back] = table.entries[back + 256 * front];
        }
    }
    assert!(worst_error(&smooth, &transposed, 1.0, 60).0 > COLOR_BOUND);
    let longer = smooth.preintegrated_table(256, 1.001).unwrap();
    let (color, depth) = worst_error(&smooth, &longer, 1.0, 60);
    assert!(color > COLOR_BOUND && depth > DEPTH_BOUND);
}

#[test]
fn entries_are_the_same_at_any_size() {
    // Colours of up to 4 and an extinction of up to 160 over the segment: f32's grain, and no more, at every size.
    let steep = transfer(
        "(color: [(0, (0, 0, 0)), (1, (4, 0, 0))], extinction: [(0, 1), (0.37, 40), (1, 3)])",
    );
    for n in [9, 17, 33, 65] {
        let table = build(&steep, n, 4.0);
        let stride = (n - 1) / 8;
        for (front, back) in (0..9).flat_map(|front| (0..9).map(move |back| (front, back))) {
            let ends = [front, back].map(|i| f64::from(i) / 8.0);
            let (color, _) = quadrature(&steep, (ends[0], ends[1]), 4.0);
            let red = table.entry(front * stride, back * stride).unwrap()[0];
            let error = (f64::from(red) - color[0]).abs();
            assert!(error < 4.0 * COLOR_BOUND, "{n}, {front} {back}: {error:e}");
        }
    }
}

#[test]
fn constant_colour_and_extinction_have_a_closed_form() {
    let constant = transfer("(color: (0.2, 0.4, 2.0), extinction: [(0, 3.0)])");
    for length in [1e-6, 0.5, 1.0, 100.0] {
        let table = constant.preintegrated_table(64, length).unwrap();
        let opacity = -(-3.0 * length).exp_m1();
        for entry in &table.entries {
            let truth = [0.2 * opacity, 0.4 * opacity, 2.0 * opacity, 3.0 * length];
            for (value, truth) in entry.iter().zip(truth) {
                assert!(
                    (f64::from(*value) - truth).abs() <= 2e-7 * truth,
                    "{entry:?} at {length}"
                );
            }
        }
    }
}

#[test]
fn linear_extinction_of_one_colour_has_a_closed_form() {
    // τ(s) = 5 s: the depth is the mean of both ends, and the colour c (1 - exp(-depth)).
    let linear = transfer("(color: (1, 0.5, 0), extinction: [(0, 0), (1, 5)])");
    let table = linear.preintegrated_table(128, 2.0).unwrap();
    for front in 0..128 {
        for back in 0..128 {
            let depth = 2.0 * 5.0 * f64::from(front + back) / (2.0 * 127.0);
            let opacity = -(-depth).exp_m1();
            let entry = table.entry(front, back).unwrap().map(f64::from);
            for (value, truth) in entry.into_iter().zip([opacity, 0.5 * opacity, 0.0, depth]) {
                assert!(
                    (value - truth).abs() <= 3e-7 * truth.max(1e-3),
                    "{front} {back}: {entry:?}"
                );
            }
        }
    }
}

#[test]
fn linear_colour_under_constant_extinction_has_a_closed_form() {
    // c(s) = s, τ = 2, front 0, back 1: ∫₀¹ x T exp(-T x) dx with T = 2 L; and from 1 to 0 the rest of 1.
    let linear = transfer("(color: [(0, (0, 0, 0)), (1, (1, 1, 1))], extinction: [(0, 2)])");
    for length in [0.1, 1.0, 5.0] {
        let table = linear.preintegrated_table(257, length).unwrap();
        let t: f64 = 2.0 * length;
        let opacity = -(-t).exp_m1();
        let rising = opacity / t - (-t).exp();
        let value = |front, back| f64::from(table.entry(front, back).unwrap()[0]);
        assert!((value(0, 256) - rising).abs() < 2e-7, "rising at {length}");
        assert!(
            (value(256, 0) - (opacity - rising)).abs() < 2e-7,
            "falling at {length}"
        );
    }
}

#[test]
fn the_opacity_is_that_of_the_integral_of_extinction() {
    for (name, text) in ALL {
        let mut white = transfer(text);
        white.color = transfer("(color: (1, 1, 1), opacity: [(0, 0)])").color;
        let table = white.preintegrated_table(300, 1.5).unwrap();
        for entry in &table.entries {
            let opacity = opacity_from_extinction(f64::from(entry[3]));
            assert!(
                (f64::from(entry[0]) - opacity).abs() < 2e-7,
                "{name}: {entry:?}"
            );
        }
    }
}

#[test]
fn small_and_odd_sizes_are_the_same_composites() {
    let steps = transfer(STEPS);
    for n in [2, 3, 4, 5, 7, 12, 13, 65] {
        let table = build(&steps, n, 2.0);
        assert_eq!(table.entries.len(), (n * n) as usize);
        let cells = Cells::integrate(&steps, n, 2.0, 0.0);
        for front in 0..n {
            for back in front + 1..n {
                let cell_length = 2.0 / f64::from(back - front);
                let whole = (front..back)
                    .map(|cell| cells.stretch(cell as usize, cell_length))
                    .fold(Stretch::EMPTY, Stretch::then);
                for (entry, color) in [
                    ((front, back), whole.rising),
                    ((back, front), whole.falling),
                ] {
                    let value = table.entry(entry.0, entry.1).unwrap().map(f64::from);
                    for (value, truth) in value
                        .into_iter()
                        .zip(color.into_iter().chain([whole.depth]))
                    {
                        assert!((value - truth).abs() < 1e-6, "{n}: {entry:?}");
                    }
                }
            }
        }
        assert_eq!(table.entry(n, 0), None);
    }
}

#[test]
fn the_number_of_threads_changes_nothing() {
    let mapped = transfer(MAPPED);
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| mapped.preintegrated_table(200, 1.0).unwrap())
    };
    assert!(with(1) == with(3));
}

#[test]
fn between_entries_bilinear_values_are_near_the_truth() {
    // What a shader reads. Across the diagonal the table has a crease of the size of one cell.
    let smooth = transfer(SMOOTH);
    let table = smooth.preintegrated_table(1024, 1.0).unwrap();
    let mut random = Random(3);
    let mut worst = 0.0_f64;
    for _ in 0..200 {
        let [x, y] = [0; 2].map(|_| f64::from(random.below(1023 * 16)) / 16.0);
        let (i, j) = (x as u32, y as u32);
        let (u, v) = (x.fract(), y.fract());
        let read = |di: u32, dj: u32| {
            f64::from(table.entry((i + di).min(1023), (j + dj).min(1023)).unwrap()[0])
        };
        let value = (1.0 - v) * ((1.0 - u) * read(0, 0) + u * read(1, 0))
            + v * ((1.0 - u) * read(0, 1) + u * read(1, 1));
        let (color, _) = quadrature(&smooth, (x / 1023.0, y / 1023.0), 1.0);
        worst = worst.max((value - color[0]).abs());
    }
    println!("bilinear between entries: {worst:.1e}");
    assert!(worst < 1e-5, "{worst:e}");
}

#[test]
fn what_is_no_table_is_refused() {
    let smooth = transfer(SMOOTH);
    for n in [0, 1, 63, 4097, u32::MAX] {
        let error = smooth.preintegrated_table(n, 1.0).unwrap_err();
        assert!(
            matches!(error, OpticsError::TableSize { asked, .. } if asked == n),
            "{error}"
        );
    }
    for length in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let error = smooth.preintegrated_table(64, length).unwrap_err();
        assert!(matches!(error, OpticsError::SegmentLength(_)), "{error}");
    }
}
