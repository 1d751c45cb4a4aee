//! The table of whole steps: what a segment of one scalar emits and lets through.

use std::path::Path;

use volgraph_optics::{OpticsError, TransferFunction};

fn parse(text: &str) -> TransferFunction {
    TransferFunction::parse(Path::new("t.ron"), text).expect("a sound transfer function")
}

#[test]
fn an_entry_is_the_closed_form_of_its_scalar() {
    let transfer = parse("(domain: data, color: (1, 0.5, 0), extinction: [(-10, 0), (30, 8)])");
    for length in [0.01, 0.5, 3.0] {
        let table = transfer.step_table(1025, length).unwrap();
        assert_eq!(table.len(), 1025);
        for (i, entry) in table.iter().enumerate() {
            let transmittance = (-8.0 * i as f64 / 1024.0 * length).exp();
            let opacity = 1.0 - transmittance;
            let expected = [opacity, 0.5 * opacity, 0.0, transmittance];
            let error = entry
                .iter()
                .zip(expected)
                .map(|(a, b)| (f64::from(*a) - b).abs());
            assert!(error.fold(0.0, f64::max) < 1e-6, "entry {i} of {length}");
        }
    }
}

/// Thin matter: opacities are no differences of two numbers that are nearly 1.
#[test]
fn thin_steps_keep_their_colours() {
    let transfer = parse("(domain: data, color: (1, 1, 1), extinction: [(0, 1e-9), (1, 1e-9)])");
    let table = transfer.step_table(1024, 1.0).unwrap();
    assert!(
        (f64::from(table[7][0]) / 1e-9 - 1.0).abs() < 1e-6,
        "{:?}",
        table[7]
    );
}

#[test]
fn what_is_no_step_is_refused() {
    let transfer = parse("(domain: data, color: (1, 1, 1), extinction: [(0, 1), (1, 1)])");
    for length in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let refused = transfer.step_table(1024, length);
        assert!(
            matches!(refused, Err(OpticsError::SegmentLength(_))),
            "{length}"
        );
    }
    let refused = transfer.step_table(100, 1.0);
    assert!(matches!(refused, Err(OpticsError::TableSize { .. })));
}
