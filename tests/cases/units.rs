//! Scalars in their three units mean the same: the range of the data, that of the stored type, the data's own values.

use volgraph_measure::compare_without_flip;
use volgraph_tests::{Stage, adapters, graph, render};

/// Whole numbers of 16 bits from 100 to 300 along x, as scans store them.
fn stage(slots: &str, params: &str, transfer: &str) -> Stage {
    let dims = [21, 6, 6];
    let mut bytes = Vec::new();
    for i in 0..dims[0] * dims[1] * dims[2] {
        bytes.extend((100 + 10 * (i % dims[0]) as i16).to_le_bytes());
    }
    Stage::new()
        .with("v_21x6x6_int16.raw", bytes)
        .with("transfer.ron", transfer)
        .with(
            "graph.ron",
            graph(
                r#"path: "v_21x6x6_int16.raw""#,
                "orbit(azimuth: 40, elevation: 20)",
                "{}",
                slots,
                params,
            ),
        )
}

fn transfer(domain: &str, at: impl Fn(f64) -> f64) -> String {
    let [a, b, c] = [0.2, 0.5, 0.9].map(at);
    format!(
        "(domain: {domain}, points: [(at: {a:?}, color: (1, 0, 0), opacity: 0), (at: {b:?}, color: (0, 1, 0), opacity: 0.2), \
         (at: {c:?}, color: (0, 0, 1), opacity: 0.4)])"
    )
}

#[test]
fn the_units_of_scalars_are_one_another() {
    let data = |share: f64| 100.0 + 200.0 * share;
    let normalised = |share: f64| (data(share) + 32768.0) / 65535.0;
    let transfers = [
        transfer("range", |share| share),
        transfer("normalised", normalised),
        transfer("data(from: 100, to: 300)", data),
    ];
    let params = |unit: &str, prefix: &str, values: [f64; 2]| {
        let [low, high] = values;
        match prefix {
            "window" => format!(
                r#"{{ "window_unit": "{unit}", "window_low": {low:?}, "window_high": {high:?} }}"#
            ),
            _ => format!(r#"{{ "isovalue_unit": "{unit}", "isovalue": {high:?} }}"#),
        }
    };
    for backend in adapters() {
        let pictures = |slots: &str, prefix: &str| {
            let draw = |unit: &str, values, transfer: &str| {
                let params = match prefix {
                    "" => "{}".to_owned(),
                    _ => params(unit, prefix, values),
                };
                render(&stage(slots, &params, transfer), &[], &backend, [48, 40]).0
            };
            [
                draw("range", [0.25, 0.75], &transfers[0]),
                draw(
                    "normalised",
                    [normalised(0.25), normalised(0.75)],
                    &transfers[1],
                ),
                draw("data", [data(0.25), data(0.75)], &transfers[2]),
            ]
        };
        for (slots, prefix) in [
            ("{}", ""),
            (r#"{ "classify": "preintegrated_2d" }"#, ""),
            (r#"{ "technique": "mip" }"#, "window"),
            (
                r#"{ "technique": "isosurface", "light": "phong" }"#,
                "isovalue",
            ),
        ] {
            let [range, normalised, data] = pictures(slots, prefix);
            assert!(
                range.color.iter().any(|color| color != &range.color[0]),
                "{slots} is empty"
            );
            for (unit, other) in [("normalised", normalised), ("data", data)] {
                // A table over all that 16 bits can hold has an entry for eight of these values.
                if unit == "normalised" && prefix.is_empty() {
                    continue;
                }
                let worst = compare_without_flip(&range, &other).unwrap().max;
                // A normalised value of 16 bits has f32's digits over all of the type's range: 1/256 of a unit of 200.
                assert!(worst.error < 2e-3, "{backend} {slots} {unit}: {worst:?}");
            }
        }
    }
}
