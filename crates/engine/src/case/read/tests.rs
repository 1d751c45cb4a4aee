//! Cases that are read, and everything wrong with others.

use super::*;
use crate::case::ExpectationKind;

const CASE: &str = "(\n test: 1, graph: \"../g.ron\", size: (32, 16), set: [\"image.step=0.5\"],\n expect: [\n  finite,\n  \
    stages_agree(max: 1e-4),\n  halving(param: \"image.step\", times: 3,\n    rmse: 0.01, order: 1.5),\n  \
    equals(graph: \"embedded:/graphs/quickstart.ron\", max: 0),\n  differs(set: [\"image.b=0\"], rmse: 0.1),\n ])";

fn parse(text: &str) -> Result<Case, Findings> {
    Case::parse(Path::new("tests/c.ron"), text)
}

#[test]
fn a_case_is_read_with_its_places() {
    let case = parse(CASE).unwrap();
    assert_eq!(case.graph.path, Path::new("tests/../g.ron"));
    assert_eq!(
        (case.size, case.set.len(), case.expect.len()),
        ([32, 16], 1, 5)
    );
    assert_eq!(
        case.expect[1].kind,
        ExpectationKind::StagesAgree { max: 1e-4 }
    );
    assert_eq!(
        (case.expect[2].place.line, case.expect[2].place.column),
        (6, 3)
    );
    assert_eq!(
        case.expect[2].text,
        "halving(param: \"image.step\", times: 3, rmse: 0.01, order: 1.5)"
    );
    let ExpectationKind::Equals { other, max } = &case.expect[3].kind else {
        panic!("{:?}", case.expect[3]);
    };
    assert_eq!(*max, 0.0);
    assert_eq!(
        other.graph.as_ref().unwrap().path,
        Path::new("embedded:/graphs/quickstart.ron")
    );
}

#[test]
fn everything_wrong_is_told_at_its_place() {
    let whole = |fields: &str| format!("({fields})");
    let with = |field: &str| {
        whole(&format!(
            "test: 1, graph: \"g.ron\", {field}, expect: [finite]"
        ))
    };
    let all = |expect: &str| whole(&format!("test: 1, graph: \"g.ron\",\nexpect: [{expect}]"));
    for (text, code, needle) in [
        (
            whole("test: 2, graph: \"g.ron\", expect: [finite]"),
            "case-version",
            "2,",
        ),
        (whole("test: 1, expect: [finite]"), "missing-field", "("),
        (whole("test: 1, graph: \"g.ron\""), "missing-field", "("),
        (
            whole("graph: \"g.ron\", expect: [finite]"),
            "missing-field",
            "(",
        ),
        (all(""), "missing-field", "("),
        (with("size: (0, 3)"), "bad-value", "(0, 3)"),
        (with("set: [\"step\"]"), "bad-set", "\"step\""),
        (with("sizes: (1, 3)"), "unknown-field", "sizes"),
        (all("finit"), "unknown-expectation", "finit"),
        (all("finite(max: 1)"), "unknown-field", "max"),
        (all("stages_agree"), "missing-field", "stages"),
        (all("stages_agree(max: -1)"), "bad-value", "-1"),
        (all("stages_agree(max: \"a\")"), "wrong-type", "\"a\""),
        (all("halving(rmse: 0.1)"), "missing-field", "halving"),
        (
            all("halving(param: \"image\", rmse: 0.1)"),
            "bad-value",
            "\"image\"",
        ),
        (all("halving(param: \"a.b\")"), "missing-field", "halving"),
        (
            all("halving(param: \"a.b\", times: 9, rmse: 1)"),
            "bad-value",
            "9",
        ),
        (
            all("halving(param: \"a.b\", from: 0, rmse: 1)"),
            "bad-value",
            "0,",
        ),
        (
            all("halving(param: \"a.b\", times: 1, rmse: 1, order: 2)"),
            "bad-value",
            "2)",
        ),
        (all("equals(max: 1)"), "missing-field", "equals"),
        (all("equals(set: [], max: 1)"), "missing-field", "equals"),
        // What nothing could fail.
        (all("differs(set: [\"a.b=1\"], rmse: 0)"), "bad-value", "0)"),
        (all("seen(at_least: 0)"), "bad-value", "0)"),
        (all("mirrored(max: 1, except: 1)"), "bad-value", "1)"),
        (all("rolled(max: 1, except: 1.0)"), "bad-value", "1.0)"),
        (all("order(param: \"a.b\", at_least: 0)"), "bad-value", "0)"),
        (all("picture(file: \"a.png\", flip: 1)"), "bad-value", "1)"),
    ] {
        let findings = parse(&text).unwrap_err();
        let told: Vec<_> = findings
            .sorted()
            .iter()
            .map(|finding| {
                let place = finding.place.as_ref().unwrap();
                (finding.code, (place.line, place.column))
            })
            .collect();
        let place = volgraph_report::line_column(&text, text.find(needle).unwrap());
        assert_eq!(told, [(code, place)], "{text}\n{findings}");
    }
    // All at once.
    let findings = parse(&all("finit, stages_agree(max: -1), halving(rmse: \"x\")")).unwrap_err();
    assert_eq!(findings.len(), 4, "{findings}");
}
