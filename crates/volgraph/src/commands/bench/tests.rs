//! The page and the file of a report of made-up numbers.

use volgraph::AdapterSummary;
use volgraph::bench::{Growth, GrowthAxis, Row, Table};
use volgraph_measure::timing::Summary;

use super::page;
use super::report::{Report, Volume};
use super::start_up::StartUp;
use super::tables::words;

fn report() -> Report {
    let mut report = Report::new(AdapterSummary {
        name: "made up".to_owned(),
        backend: "vulkan".to_owned(),
        class: "software".to_owned(),
        driver: "1.0".to_owned(),
    });
    report.volumes.push(Volume {
        name: "ball".to_owned(),
        dims: [8; 3],
        summary: "a <ball>".to_owned(),
    });
    report.name("mip", "maximum");
    report.name("mip", "maximum");
    let row = |stage: &str, own: f64| {
        Row::of(
            stage,
            &[0.0, 180.0],
            [&[own, 2.0 * own], &[10.0, 20.0], &[1.0, 1.0]],
            1 << 20,
        )
        .unwrap()
    };
    report.tables.push(Table {
        volume: "ball".to_owned(),
        size: [64, 48],
        technique: "mip".to_owned(),
        rows: vec![row("fragment", 40.0), row("compute", 25.0)],
    });
    let times =
        [(1.0, 2.0), (2.0, 4.0), (4.0, 8.0)].map(|(work, ms)| (format!("{work}"), work, vec![ms]));
    report
        .growth
        .push(Growth::of(GrowthAxis::Steps, "mip", times.to_vec()));
    report.start_up.push(StartUp {
        graph: "quickstart".to_owned(),
        size: [64, 48],
        cold_ms: 900.0,
        warm_ms: Summary::of(&[300.0]).unwrap(),
        warm_process_ms: Summary::of(&[350.0]).unwrap(),
        peak_resident_bytes: None,
        device_bytes: 3 << 20,
    });
    report
}

#[test]
fn a_page_says_rates_ratios_exponents_and_starts() {
    let mut report = report();
    let page = page::of(&report).unwrap();
    for text in [
        "Not all of it is measured",
        "64 × 48",
        "a &lt;ball&gt;",
        "12.5",
        "25.0",
        "2.50",
        "1.000 ± 0.000",
        "unknown",
        "3.0 MiB",
        "made up [vulkan, software]",
        "<svg",
    ] {
        assert!(page.contains(text), "no {text} in {page}");
    }
    // The bar is of the faster stage.
    assert!(
        page.contains("</i>2.50") && !page.contains("</i>4.00"),
        "{page}"
    );
    assert!(
        !page.contains("src=") && !page.contains("href="),
        "the page reads something from elsewhere"
    );
    report.is_complete = true;
    assert!(!page::of(&report).unwrap().contains("Not all of it"));
}

#[test]
fn a_file_has_all_frames_and_each_technique_once() {
    let json = serde_json::to_value(report()).unwrap();
    assert_eq!(json["techniques"].as_array().unwrap().len(), 1);
    assert_eq!(json["tables"][0]["rows"][1]["frames"][1]["ms"], 50.0);
    assert_eq!(json["tables"][0]["rows"][1]["frames"][1]["degrees"], 180.0);
    assert_eq!(json["growth"][0]["axis"], "steps");
    assert!((json["growth"][0]["fit"]["exponent"].as_f64().unwrap() - 1.0).abs() < 1e-9);
    assert_eq!(json["adapter"]["driver"], "1.0");
    assert!(json["start_up"][0]["peak_resident_bytes"].is_null());
}

#[test]
fn a_table_is_a_line_for_each_stage() {
    let text = words(&report().tables[0]);
    assert_eq!(text.lines().count(), 2);
    assert!(
        text.contains("ball 64x48 mip") && text.contains("2.50 of the limit"),
        "{text}"
    );
}
