//! No text makes the reader panic, and what is written reads back equal.

#![expect(clippy::unwrap_used, reason = "a test that cannot go on may panic")]

use std::path::Path;

use proptest::prelude::*;
use volgraph_optics::{TransferFunction, color_map_names};
use volgraph_report::Findings;

fn parse(text: &str) -> Result<TransferFunction, Findings> {
    TransferFunction::parse(Path::new("t.ron"), text)
}

fn curve_of(value: impl Strategy<Value = String> + Clone) -> impl Strategy<Value = String> {
    proptest::collection::vec((-1e4..1e4, value), 2..6).prop_map(|mut points| {
        points.sort_by(|a, b| f64::total_cmp(&a.0, &b.0));
        let list: String = points
            .iter()
            .map(|(at, value)| format!("({at:?}, {value}),"))
            .collect();
        format!("[{list}]")
    })
}

fn valid_text() -> impl Strategy<Value = String> {
    let color = prop_oneof![
        (0.0..2.0, 0.0..2.0, 0.0..2.0).prop_map(|rgb: (f64, f64, f64)| format!("{rgb:?}")),
        "#[0-9a-fA-F]{6}".prop_map(|hex| format!("{hex:?}")),
    ];
    let map = (
        0..color_map_names().count(),
        any::<bool>(),
        -9e3..0.0,
        1.0..9e3,
    )
        .prop_map(|(which, reversed, from, to): (usize, bool, f64, f64)| {
            let name = color_map_names().nth(which).unwrap();
            format!("map(name: {name:?}, from: {from:?}, to: {to:?}, reversed: {reversed})")
        });
    let colors = prop_oneof![color.clone(), curve_of(color.boxed()), map];
    let absorption = prop_oneof![
        curve_of((0.0..=1.0).prop_map(|a: f64| format!("{a:?}")).boxed())
            .prop_map(|list| format!("opacity: {list}")),
        curve_of((0.0..1e5).prop_map(|a: f64| format!("{a:?}")).boxed())
            .prop_map(|list| format!("extinction: {list}")),
    ];
    let domain = prop_oneof![Just("data"), Just("data(from: -10000, to: 10000.5)")];
    let length = (1e-3..1e3, any::<bool>()).prop_map(|(l, world): (f64, bool)| {
        format!("({}: {l:?})", if world { "world" } else { "voxels" })
    });
    let refraction = proptest::option::of(curve_of(
        (1.0..=4.0).prop_map(|n: f64| format!("{n:?}")).boxed(),
    ))
    .prop_map(|list| list.map_or_else(String::new, |list| format!(", refraction: {list}")));
    (domain, length, colors, absorption, refraction, material()).prop_map(
        |(domain, length, colors, absorption, refraction, material)| {
            format!(
                "(domain: {domain}, reference_length: {length}, color: {colors}, {absorption}{refraction}{material})"
            )
        },
    )
}

/// Position, ambient, diffuse, specular and shininess.
type GivenPoint = (f64, Option<f64>, Option<f64>, f64, Option<f64>);

/// No field `material`, or one of points that give one value or several.
fn material() -> impl Strategy<Value = String> {
    let fraction = || proptest::option::of(0.0..=1.0);
    let shininess = proptest::option::of(1.0..=256.0);
    let point = (-1e4..1e4, fraction(), fraction(), 0.0..=1.0, shininess);
    proptest::collection::vec(point, 0..5).prop_map(|mut points: Vec<GivenPoint>| {
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut list = String::new();
        for (at, ambient, diffuse, specular, shininess) in &points {
            list += &format!("(at: {at:?}, specular: {specular:?}");
            for (name, value) in [
                ("shininess", shininess),
                ("ambient", ambient),
                ("diffuse", diffuse),
            ] {
                if let Some(value) = value {
                    list += &format!(", {name}: {value:?}");
                }
            }
            list += "), ";
        }
        if points.is_empty() {
            list
        } else {
            format!(", material: [{list}]")
        }
    })
}

/// Scalar, linear red, green and blue, opacity.
type Point = (f64, f64, f64, f64, f64);

/// Control points, some of them at one scalar, in any domain; and where they are.
fn pointed_text() -> impl Strategy<Value = (String, Vec<f64>)> {
    let place = prop_oneof![-1e4..1e4, (-8..8_i8).prop_map(f64::from)];
    let part = || 0.0..=1.0;
    let point = (place, part(), part(), part(), part());
    let domain = prop_oneof![Just("data"), Just("data(from: -10000, to: 10000.5)")];
    (domain, proptest::collection::vec(point, 2..8)).prop_map(
        |(domain, mut points): (&str, Vec<Point>)| {
            points.sort_by(|a, b| a.0.total_cmp(&b.0));
            let list: String = points
                .iter()
                .map(|(at, r, g, b, opacity)| {
                    format!("(at: {at:?}, color: ({r:?}, {g:?}, {b:?}), opacity: {opacity:?}),")
                })
                .collect();
            let places = points.iter().map(|point| point.0).collect();
            (format!("(domain: {domain}, points: [{list}])"), places)
        },
    )
}

fn is_near(a: f64, b: f64) -> bool {
    // Steps that are smaller are none.
    (a - b).abs() <= 2e-9
}

proptest! {
    #[test]
    fn control_points_are_what_was_written((text, places) in pointed_text()) {
        let Ok(transfer) = parse(&text) else {
            // All at one scalar.
            prop_assert!(places.first() == places.last(), "{}", text);
            return Ok(());
        };
        let written = transfer.to_ron();
        let read = parse(&written).map_err(|findings| TestCaseError::fail(findings.to_string()))?;
        prop_assert_eq!(&read, &transfer);
        let points = transfer.control_points();
        let again = transfer.with_control_points(&points).map_err(|findings| TestCaseError::fail(findings.to_string()))?;
        prop_assert_eq!(again.range(), transfer.range());
        let middles = places.windows(2).map(|pair| 0.5 * (pair[0] + pair[1]));
        for s in places.iter().copied().chain(middles).chain([-2e4, 2e4]) {
            prop_assert!(is_near(again.opacity(s), transfer.opacity(s)), "{} at {}", text, s);
            for (a, b) in again.color(s).into_iter().zip(transfer.color(s)) {
                prop_assert!(is_near(a, b), "{} at {}", text, s);
            }
        }
    }

    #[test]
    fn no_text_panics(text in ".{0,200}") {
        let _ = parse(&text);
    }

    #[test]
    fn no_text_of_known_words_panics(words in proptest::collection::vec(prop_oneof![
        Just("("), Just(")"), Just("["), Just("]"), Just(","), Just(":"), Just("points:"), Just("color:"),
        Just("opacity:"), Just("at:"), Just("map"), Just("name:"), Just("\"gray\""), Just("\"#\u{e9}\""),
        Just("1e400"), Just("-0.0"), Just("NaN"), Just("domain:"), Just("data"), Just("refraction:"), Just("0"), Just("1"),
        Just("material:"), Just("ambient:"), Just("shininess:"),
    ], 0..40)) {
        let _ = parse(&format!("({})", words.concat()));
    }

    #[test]
    fn a_damaged_text_does_not_panic(text in valid_text(), at in any::<prop::sample::Index>(), by in any::<char>()) {
        let mut chars: Vec<char> = text.chars().collect();
        let at = at.index(chars.len());
        chars[at] = by;
        let _ = parse(&chars.into_iter().collect::<String>());
    }

    #[test]
    fn what_is_written_reads_back_equal(text in valid_text()) {
        let transfer = parse(&text).map_err(|findings| TestCaseError::fail(findings.to_string()))?;
        let written = transfer.to_ron();
        let again = parse(&written).map_err(|findings| TestCaseError::fail(findings.to_string()))?;
        prop_assert_eq!(&again, &transfer);
        prop_assert_eq!(again.to_ron(), written);
        prop_assert_eq!(again.digest(), transfer.digest());
    }
}
