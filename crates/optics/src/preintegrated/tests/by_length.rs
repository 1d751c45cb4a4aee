//! The 3D table: its layers against the 2D table of the same length, and between them.

use super::*;
use crate::PreintegratedTable3d;

/// Premultiplied colour and depth of a segment of a length, as a shader reads them: linear in the square root of the
/// length between two layers.
fn read(table: &PreintegratedTable3d, ends: (u32, u32), longest: f64, length: f64) -> [f64; 4] {
    let place = (length / longest).sqrt() * f64::from(table.layers - 1);
    let low = (place as u32).min(table.layers - 2);
    let part = place - f64::from(low);
    let layer = |layer| table.entry(ends.0, ends.1, layer).unwrap().map(f64::from);
    let (near, far) = (layer(low), layer(low + 1));
    let value: [f64; 4] = std::array::from_fn(|i| near[i] + part * (far[i] - near[i]));
    let depth = value[3] * length;
    let opacity = opacity_from_extinction(depth);
    [
        value[0] * opacity,
        value[1] * opacity,
        value[2] * opacity,
        depth,
    ]
}

/// Largest error of the colour at these shares of the longest length, and its root mean square.
fn error(text: &str, longest: f64, layers: u32, shares: &[f64]) -> (f64, f64) {
    let transfer = transfer(text);
    let table = transfer
        .preintegrated_table_3d(64, layers, longest)
        .unwrap();
    let (mut worst, mut squares, mut count) = (0.0_f64, 0.0, 0.0_f64);
    for share in shares {
        let length = share * longest;
        let truth = transfer.preintegrated_table(64, length).unwrap();
        for (front, back) in (0..64).flat_map(|front| (0..64).map(move |back| (front, back))) {
            let seen = read(&table, (front, back), longest, length);
            let truth = truth.entry(front, back).unwrap().map(f64::from);
            let depth = (seen[3] - truth[3]).abs();
            assert!(depth < 1e-6 * truth[3].max(1.0), "depth off by {depth:e}");
            for i in 0..3 {
                let error = (seen[i] - truth[i]).abs();
                worst = worst.max(error);
                squares += error * error;
                count += 1.0;
            }
        }
    }
    (worst, (squares / count).sqrt())
}

#[test]
fn at_its_layers_it_is_the_table_of_one_length() {
    for (name, text) in ALL {
        for longest in [1.0, 16.0] {
            let layers = [1.0 / 49.0, 9.0 / 49.0, 1.0];
            let (worst, _) = error(text, longest, 8, &layers);
            println!("{name}, longest {longest}: {worst:.1e}");
            assert!(worst < COLOR_BOUND, "{name}, longest {longest}: {worst:e}");
        }
    }
}

#[test]
fn between_layers_the_error_is_what_the_documentation_says_and_falls_with_their_square() {
    // Halfway between layers, where linear interpolation is worst.
    let halfway = |layers: u32| -> Vec<f64> {
        let last = f64::from(layers - 1);
        (0..layers - 1)
            .map(|i| ((f64::from(i) + 0.5) / last).powi(2))
            .collect()
    };
    for (name, text) in [("smooth", SMOOTH), ("steps", STEPS), ("peak", NARROW_PEAK)] {
        let errors = [8, 15].map(|layers| error(text, 1.0, layers, &halfway(layers)));
        println!("{name}: {errors:?}");
        assert!(
            errors[0].0 < 5e-4 && errors[0].1 < 5e-5,
            "{name}: {errors:?}"
        );
        assert!(
            errors[1].0 < 0.35 * errors[0].0 || errors[1].0 < 1e-6,
            "{name}: {errors:?}"
        );
    }
}

#[test]
fn where_nothing_absorbs_there_is_nothing_at_all() {
    let text = "(color: (1, 0.5, 0.2), opacity: [(0, 0), (0.5, 0), (0.6, 0.3), (1, 0.3)])";
    let table = transfer(text).preintegrated_table_3d(64, 5, 3.7).unwrap();
    for (front, back) in (0..31).flat_map(|front| (0..31).map(move |back| (front, back))) {
        for layer in 0..5 {
            let [.., extinction] = table.entry(front, back, layer).unwrap();
            assert_eq!(extinction, 0.0, "{front} to {back} in {layer}");
        }
    }
    assert!(table.entry(30, 33, 1).unwrap()[3] > 0.0);
}

#[test]
fn a_segment_of_no_length_has_the_mean_weighted_by_extinction() {
    // c(s) = s under τ(s) = 3 s, from 0 to 1: ∫ s² / ∫ s = 2/3 either way; and where nothing absorbs, the plain mean.
    let rising =
        transfer("(color: [(0, (0, 0, 0)), (1, (1, 1, 1))], extinction: [(0, 0), (1, 3)])");
    let clear = transfer("(color: [(0, (0, 0, 0)), (1, (1, 1, 1))], extinction: [(0, 0)])");
    for longest in [0.1, 1.0, 30.0] {
        let table = rising.preintegrated_table_3d(64, 4, longest).unwrap();
        for ends in [(0, 63), (63, 0)] {
            let [color, .., extinction] = table.entry(ends.0, ends.1, 0).unwrap().map(f64::from);
            assert!(
                (color - 2.0 / 3.0).abs() < 1e-6 * longest.max(1.0),
                "{color}"
            );
            assert!((extinction - 1.5).abs() < 1e-6);
        }
        let table = clear.preintegrated_table_3d(64, 4, longest).unwrap();
        for layer in 0..4 {
            let [color, .., extinction] = table.entry(21, 42, layer).unwrap();
            assert!(
                (color - 0.5).abs() < 1e-6 && extinction < 1e-12,
                "{color} {extinction}"
            );
        }
        assert_eq!(table.entry(0, 64, 0), None);
        assert_eq!(table.entry(0, 0, 4), None);
    }
}

#[test]
fn what_is_no_table_of_lengths_is_refused() {
    let smooth = transfer(SMOOTH);
    for layers in [0, 1, 65] {
        let error = smooth.preintegrated_table_3d(64, layers, 1.0).unwrap_err();
        assert!(matches!(error, OpticsError::Layers { asked, .. } if asked == layers));
    }
    assert!(smooth.preintegrated_table_3d(63, 4, 1.0).is_err());
    assert!(smooth.preintegrated_table_3d(64, 4, f64::NAN).is_err());
}
