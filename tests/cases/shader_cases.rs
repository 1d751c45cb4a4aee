//! volgraph's own shader tests: the cases in `tests/shaders`, which `volgraph test tests/shaders` runs as well, and that
//! no choice of the slots that make a picture is without one.

use std::collections::BTreeSet;

use volgraph::Case;
use volgraph::case::{RunOptions, Sweep, assert_folder_with, find};
use volgraph_tests::repository::choices;
use volgraph_tests::root;

/// The slots whose choices each have a case.
const SLOTS: [&str; 9] = [
    "technique",
    "classify",
    "reconstruct",
    "gradient",
    "light",
    "clip",
    "traverse",
    "tone",
    "shadow",
];

#[test]
fn every_case_holds() {
    let options = RunOptions {
        jobs: 2,
        ..RunOptions::default()
    };
    assert_folder_with(root().join("tests/shaders"), &options);
}

/// The choices that a case draws with: those under test, those that it sets, and those that it sweeps.
fn drawn(case: &Case) -> BTreeSet<(String, String)> {
    let under_test = case
        .slots
        .iter()
        .map(|slot| (slot.slot.clone(), slot.choice.clone()));
    let swept = match &case.sweep {
        Sweep::Product(axes) => axes.concat(),
        _ => Vec::new(),
    };
    let set = case.set.iter().chain(&swept).map(|set| &set.value);
    let set = set
        .filter(|set| set.is_slot)
        .map(|set| (set.name.clone(), set.value.to_string().replace('"', "")));
    under_test.chain(set).collect()
}

#[test]
fn every_choice_has_a_case() {
    let files = find(&[root().join("tests/shaders")]).unwrap();
    let drawn: BTreeSet<(String, String)> = files
        .iter()
        .flat_map(|file| drawn(&Case::load(file).unwrap()))
        .collect();
    let mut missing = Vec::new();
    for slot in SLOTS {
        for choice in choices(slot) {
            if !drawn.contains(&(slot.to_owned(), choice.clone())) {
                missing.push(format!("{slot}/{choice}"));
            }
        }
    }
    assert!(
        missing.is_empty(),
        "no case in tests/shaders for {missing:?}"
    );
}
