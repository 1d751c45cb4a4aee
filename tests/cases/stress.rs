//! The breaking points that `volgraph stress` knows, on every adapter: what must hold holds, and what is known to fail fails
//! by as much as it is known to.

use std::collections::BTreeMap;

use volgraph::stress::{Expect, Stand, Verdict, cases};
use volgraph::{AdapterChoice, ShaderFolders};
use volgraph_tests::adapters;

/// The largest error, and the pixels with holes and the like of all that were judged, of each method that is known to
/// fail, where it is worst.
const KNOWN: &[(&str, &str, f64, f64)] = &[
    ("narrow-transfer", "gauss2", 0.878, 0.248),
    ("narrow-transfer", "post", 0.88, 0.314),
    ("narrow-transfer", "simpson", 0.88, 0.242),
    ("discontinuous-transfer", "gauss2", 0.637, 0.01),
    ("discontinuous-transfer", "post", 0.894, 0.0187),
    ("discontinuous-transfer", "simpson", 0.304, 0.00125),
    ("opacity-1", "post", 1.0, 0.0112),
    ("carson", "post at any step", 0.0644, 0.0),
    ("thin-shell", "linear", 12.8, 0.21),
    ("thin-shell", "bisection", 13.2, 0.21),
    ("grazing-isosurface", "linear", 4.6, 0.000625),
    ("grazing-isosurface", "bisection", 4.63, 0.000625),
    ("two-roots", "linear", 1.24, 0.0619),
    ("two-roots", "bisection", 0.00045, 0.0619),
    ("weak-gradients", "stored, 8 bits", 0.83, 0.0),
    ("refractive-step", "refraction", 0.33, 0.0),
    ("cut-through-samples", "naive", 0.0253, 0.0),
];

/// What is measured on one device may be so many times as large, or as small, on another.
const FACTOR: f64 = 1.6;

#[test]
fn what_must_hold_holds_and_what_is_known_to_fail_fails_as_much() {
    let known: BTreeMap<(&str, &str), (f64, f64)> = KNOWN
        .iter()
        .map(|(case, method, error, defects)| ((*case, *method), (*error, *defects)))
        .collect();
    let folders = ShaderFolders::default();
    for backend in adapters() {
        let mut stand = Stand::open(&AdapterChoice::new(Some(&backend)), &folders).unwrap();
        let mut wrong = Vec::new();
        let mut failed = Vec::new();
        for case in cases(&folders) {
            let report = stand.run(&case).unwrap();
            for method in &report.methods {
                let worst = method.worst();
                let what = format!(
                    "{backend}, {}, {} at {}: {} (bound {:.1e})",
                    report.name,
                    method.name,
                    report.labels[method.worst],
                    worst.words(),
                    worst.bound
                );
                if matches!(method.verdict, Verdict::Broken | Verdict::HoldsNow) {
                    wrong.push(what);
                    continue;
                }
                if method.expect != Expect::Fails {
                    continue;
                }
                let Some((error, defects)) = known.get(&(report.name, method.name.as_str())) else {
                    wrong.push(format!("{what}: its size is not listed"));
                    continue;
                };
                failed.push((report.name, method.name.clone()));
                let count = worst.holes + worst.phantoms + worst.specks + worst.non_finite;
                let share = count as f64 / worst.judged as f64;
                let is_near = |seen: f64, listed: f64| {
                    seen <= listed * FACTOR + 2e-3 && listed <= seen * FACTOR + 2e-3
                };
                if !is_near(worst.error, *error) || !is_near(share, *defects) {
                    wrong.push(format!("{what}: {error} and {defects} are listed"));
                }
            }
        }
        let gone = known
            .keys()
            .filter(|(case, method)| !failed.iter().any(|it| it.0 == *case && it.1 == *method));
        wrong.extend(
            gone.map(|it| format!("{backend}, {it:?} is listed, and there is no such failure")),
        );
        assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    }
}
