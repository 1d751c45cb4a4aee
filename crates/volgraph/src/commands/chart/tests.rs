//! Pages and tables of two methods and three peers.

use volgraph::methods::peers::{LeftOut, Peer, ScenePeers};
use volgraph::methods::{Axis, Errors, Measurement, MethodSpace, Survey, SurveyOptions, TruthKind};
use volgraph_measure::timing::Summary;
use volgraph_shader::ParamValue;

use super::exhibit::Exhibit;
use super::{page, table};

/// Two methods: 10 ms with an error of 1/255, 20 ms with a tenth of it.
fn exhibit() -> Exhibit {
    let space = MethodSpace {
        node: "image".to_owned(),
        axes: vec![Axis {
            name: "step".to_owned(),
            is_slot: false,
            values: vec![
                ParamValue::Float(1.0),
                ParamValue::Text("</script>".to_owned()),
            ],
            base: 0,
            is_software: false,
            of_choice: None,
        }],
    };
    let summary = |median: f64| Summary {
        min: median,
        median,
        max: median,
        n: 3,
    };
    let measured = [(10.0, 1.0 / 255.0), (20.0, 0.1 / 255.0)];
    let measured = measured
        .iter()
        .enumerate()
        .map(|(i, (ms, error))| Measurement {
            method: space.method(&[i]),
            errors: Errors {
                rmse: *error,
                max: *error,
                p999: *error,
                core_rmse: *error,
                core_rmse_8bit: *error + 0.2 / 255.0,
                rmse_8bit: *error + 0.2 / 255.0,
            },
            time_ms: summary(*ms),
            ratio: summary(ms / 10.0),
            steady_ms: *ms,
            is_refined: true,
            is_front: true,
        });
    let peer = |name: &str, ms: f64, error: f64| Peer {
        name: name.to_owned(),
        mode: "composite".to_owned(),
        volume: "ml".to_owned(),
        step: "1".to_owned(),
        median_ms: ms,
        min_ms: ms,
        max_ms: ms,
        frames: 9,
        core_rmse_8bit_steps: error,
    };
    Exhibit {
        name: "ball".to_owned(),
        draws: "A ball.".to_owned(),
        graph: "// </script>".to_owned(),
        size: [8, 8],
        adapter: "some <adapter>".to_owned(),
        filters: String::new(),
        set: Vec::new(),
        others: ScenePeers {
            peers: vec![
                peer("slow & wrong", 30.0, 0.5),
                peer("fast", 5.0, 0.5),
                peer("exact", 30.0, 0.29),
            ],
            left_out: vec![LeftOut {
                rows: 2,
                why: "of another volume",
            }],
        },
        truth: TruthKind::Reference,
        truth_bound: Some(1e-9),
        fine_step: 1.0 / 32.0,
        truth_seconds: 7.0,
        core_pixels: 12,
        pictures: [].into(),
        survey: Survey {
            measured: measured.collect(),
            refused: vec![(space.method(&[1]), "bad: </script>".to_owned())],
            product: 2,
            base_ms: summary(10.0),
            options: SurveyOptions::default(),
            seconds: 1.0,
        },
        space,
    }
}

#[test]
fn peers_are_beaten_in_both_or_not_at_all() {
    let exhibit = exhibit();
    let beaten = exhibit.beaten();
    // 0.3 of rounded error at 20 ms: better than 0.5 at 30 ms, not than 0.29.
    let by = beaten.iter().map(|row| row.by.map(|by| by.steady_ms));
    assert_eq!(by.collect::<Vec<_>>(), [Some(20.0), None, None]);
}

#[test]
fn texts_are_escaped_and_every_method_is_there() {
    let exhibit = exhibit();
    let page = page::of(&exhibit).unwrap();
    assert_eq!(page.matches("class=\"hit\"").count(), 2);
    // The page's own two scripts, and no other end of one.
    assert_eq!(page.matches("</script>").count(), 2);
    assert!(page.contains("some &lt;adapter&gt;") && page.contains("slow &amp; wrong"));
    assert!(page.contains("0.29 of them") && page.contains("1.0e-9"));
    // What is not shown or not counted is said, on the page and in the terminal.
    assert!(page.contains("2 rows of another volume") && page.contains("It took 7 s"));
    let text = exhibit.to_text();
    assert!(
        text.contains("not shown: 2 rows of another volume"),
        "{text}"
    );
    assert!(text.contains("after 7 s for the truth"), "{text}");
    let mut alone = self::exhibit();
    alone.others.peers.clear();
    let page = page::of(&alone).unwrap();
    assert!(page.contains("2 rows of another volume") && !page.contains("0.29 of them"));
    let index = page::index(&[exhibit]).unwrap();
    assert!(index.contains("href=\"ball.html\""));
}

#[test]
fn tables_have_as_many_fields_in_each_row() {
    let table = table::csv(&exhibit()).unwrap();
    let mut reader = csv::Reader::from_reader(table.as_bytes());
    let columns = reader.headers().unwrap().len();
    let rows: Vec<csv::StringRecord> = reader.records().collect::<Result<_, _>>().unwrap();
    assert_eq!(rows.len(), 3);
    assert!(rows.iter().all(|row| row.len() == columns));
    assert_eq!(&rows[2][columns - 1], "bad: </script>");
}
