//! Where a transfer function absorbs anything at all.

use std::path::Path;

use volgraph_optics::TransferFunction;

#[test]
fn what_absorbs_is_told_without_the_scalars_where_it_begins() {
    let absorbing = |text: &str| {
        TransferFunction::parse(Path::new("t.ron"), text)
            .unwrap()
            .absorbing()
    };
    let inf = f64::INFINITY;
    let after = |at: f64| at.next_up();
    let before = |at: f64| at.next_down();
    // A ramp from 0 does not take 0 in.
    assert_eq!(
        absorbing("(color: (1, 1, 1), opacity: [(0, 0), (1, 0.5)])"),
        [(0.0, inf)]
    );
    // Two peaks, and what begins at once.
    assert_eq!(
        absorbing(
            "(color: (1, 1, 1), opacity: [(0, 0), (0.1, 0), (0.2, 0.5), (0.3, 0), (0.6, 0), (0.6, 0.3), (0.7, 0.3), (0.7, 0)])"
        ),
        [(0.1, 0.3), (before(0.6), after(0.7))]
    );
    // Neighbours that both absorb are one interval, and the ends of the range hold beyond it.
    assert_eq!(
        absorbing("(color: (1, 1, 1), extinction: [(0, 2), (0.5, 0), (0.8, 1), (1, 0)])"),
        [(-inf, 0.5), (0.5, 1.0)]
    );
    assert_eq!(absorbing("(color: (1, 1, 1), opacity: [(0, 0)])"), []);
    assert_eq!(
        absorbing("(color: (1, 1, 1), opacity: [(0, 0.5)])"),
        [(-inf, inf)]
    );
}
