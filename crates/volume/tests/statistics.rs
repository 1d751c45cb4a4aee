//! Statistics against plain sums, for every type.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use glam::DVec3;
use volgraph_volume::{Grid, Volume, Voxels};

fn volume(voxels: impl Into<Voxels>) -> Volume {
    let voxels = voxels.into();
    let dims = [voxels.len() as u32, 1, 1];
    Volume::new(
        "v",
        Grid::axis_aligned(dims, DVec3::ONE, DVec3::ZERO),
        voxels,
    )
    .unwrap()
}

/// A fixed sequence without order.
fn noise(count: usize) -> impl Iterator<Item = u64> {
    let mut state = 1_u64;
    std::iter::repeat_with(move || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        state >> 16
    })
    .take(count)
}

fn check(volume: &Volume) {
    let mut values = Vec::new();
    volume.voxels().for_each(|value| values.push(value));
    let total = values.len() as f64;
    values.retain(|value| value.is_finite());
    values.sort_by(f64::total_cmp);
    let statistics = volume.statistics();
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let deviation = (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / n).sqrt();
    assert_eq!(
        (statistics.min, statistics.max),
        (values[0], values[values.len() - 1])
    );
    let span = statistics.max - statistics.min;
    assert!((statistics.mean - mean).abs() <= 1e-13 * mean.abs().max(span));
    assert!((statistics.standard_deviation - deviation).abs() <= 1e-12 * span);
    assert_eq!(statistics.finite_count, values.len() as u64);
    assert_eq!(statistics.has_non_finite(), n < total);
    for p in [0.0, 0.1, 1.0, 25.0, 50.0, 90.0, 99.9, 100.0] {
        let rank = ((p / 100.0 * n).ceil() as usize).clamp(1, values.len());
        let error = (statistics.percentile(p) - values[rank - 1]).abs();
        assert!(
            error <= statistics.percentile_error(),
            "{p}: {error} of {}",
            statistics.percentile_error()
        );
    }
    for bins in [1, 7, 256] {
        let histogram = volume.histogram(bins);
        assert_eq!(histogram.counts.len(), bins);
        assert_eq!(histogram.counts.iter().sum::<u64>(), values.len() as u64);
        let mut counts = vec![0; bins];
        for value in &values {
            let at = (value / 2.0 - histogram.lo / 2.0) / (histogram.hi / 2.0 - histogram.lo / 2.0);
            counts[((at * bins as f64) as usize).min(bins - 1)] += 1;
        }
        assert_eq!(counts, histogram.counts);
    }
    assert_eq!(volume.histogram(256), statistics.histogram);
}

#[test]
fn statistics_agree_with_plain_sums_for_every_type() {
    let n = 5000;
    check(&volume(noise(n).map(|v| v as u8).collect::<Vec<_>>()));
    check(&volume(noise(n).map(|v| v as i8).collect::<Vec<_>>()));
    check(&volume(noise(n).map(|v| v as u16).collect::<Vec<_>>()));
    check(&volume(noise(n).map(|v| v as i16).collect::<Vec<_>>()));
    check(&volume(noise(n).map(|v| v as u32).collect::<Vec<_>>()));
    check(&volume(noise(n).map(|v| v as i32).collect::<Vec<_>>()));
    check(&volume(noise(n).map(|v| v << 16).collect::<Vec<u64>>()));
    check(&volume(
        noise(n).map(|v| (v << 16) as i64).collect::<Vec<_>>(),
    ));
    check(&volume(
        noise(n).map(|v| v as f32 / 1e10 - 3.0).collect::<Vec<_>>(),
    ));
    check(&volume(
        noise(n).map(|v| v as f64 * 1e-100).collect::<Vec<_>>(),
    ));
}

#[test]
fn pieces_of_a_long_volume_add_up() {
    check(&volume(
        noise(2_500_000).map(|v| v as f32).collect::<Vec<_>>(),
    ));
    check(&volume(
        noise(2_500_000).map(|v| v as u8).collect::<Vec<_>>(),
    ));
}

#[test]
fn what_is_not_finite_is_counted_and_left_out() {
    let (nan, inf) = (f64::NAN, f64::INFINITY);
    let mixed = volume(vec![nan, 1.0, inf, -inf, 3.0, nan, inf]);
    check(&mixed);
    let statistics = mixed.statistics();
    assert_eq!(statistics.nan_count, 2);
    assert_eq!(statistics.positive_infinity_count, 2);
    assert_eq!(statistics.negative_infinity_count, 1);
    assert_eq!((statistics.mean, statistics.standard_deviation), (2.0, 1.0));
    let none = volume(vec![nan, inf]);
    assert_eq!(none.statistics().range(), None);
    assert!(none.statistics().mean.is_nan() && none.statistics().percentile(50.0).is_nan());
    assert_eq!(none.histogram(4).counts, [0; 4]);
}

#[test]
fn extremes_neither_overflow_nor_vanish() {
    let huge = volume(vec![f64::MAX, -f64::MAX, f64::MAX, -f64::MAX]);
    assert_eq!(huge.statistics().mean, 0.0);
    assert_eq!(huge.statistics().standard_deviation, f64::MAX);
    assert_eq!(huge.statistics().histogram.counts[0], 2);
    assert_eq!(huge.statistics().histogram.counts[255], 2);
    let tiny = volume(vec![5e-324, 1.5e-323]);
    assert_eq!(tiny.statistics().mean, 1e-323);
    let flat = volume(vec![7.0_f32; 9]);
    assert_eq!(
        (flat.statistics().mean, flat.statistics().standard_deviation),
        (7.0, 0.0)
    );
    assert_eq!(flat.statistics().percentile(50.0), 7.0);
    assert_eq!(flat.histogram(3).counts, [9, 0, 0]);
    assert_eq!(volume(vec![0.0]).statistics().standard_deviation, 0.0);
}
