//! `volgraph test`: cases that are broken, and expectations that nothing could fail.

use crate::Scratch;

#[test]
fn broken_cases_of_a_folder_are_kept_and_fail() {
    let scratch = Scratch::new();
    let whole = "(test: 1, scene: \"fog\", size: (8, 8), expect: [finite])";
    scratch.write("tests/whole.ron", whole);
    // Other files of a folder are not told: what they are is no matter of tests.
    scratch.write(
        "tests/graph.ron",
        "(sources: { \"test\": volume(path: \"a\") ",
    );
    scratch.write("tests/points.ron", "// test: 1\n(points: [");
    scratch
        .run(&["test", "tests", "--list"])
        .listed(&["tests/whole.ron: finite"]);

    scratch.write(
        "tests/broken.ron",
        "// A case.\n(\n    test: 1,\n    scene: \"fog\"\n    expect: [finite],\n)\n",
    );
    scratch.write(
        "tests/versionless.ron",
        "(scene: \"fog\", expect: [finite])",
    );
    let long = format!("(test: 1, expect: [finite])\n// {}", "x".repeat(70_000));
    scratch.write("tests/long.ron", long);
    let run = scratch.run(&["test", "tests"]);
    run.refused(&["ron-syntax", "not-a-case", "missing-field"]);
    for told in [
        "tests/broken.ron:5:5",
        "a comma is missing",
        "add `test: 1`",
    ] {
        assert!(run.stderr.contains(told), "{told}: {run:?}");
    }
    for told in [
        "FAILED  tests/broken.ron: it cannot be run",
        "FAILED  tests/long.ron: it cannot be run",
        "FAILED  tests/versionless.ron: it cannot be run",
        "ok      tests/whole.ron: finite",
        "4 cases, 1 expectation, 3 cases cannot be run",
    ] {
        assert!(run.stdout.contains(told), "{told}: {run:?}");
    }
}

#[test]
fn what_cannot_fail_is_refused_with_a_remedy() {
    let scratch = Scratch::new();
    for (expectation, remedy) in [
        ("seen(at_least: 0)", "the least share that must be there"),
        ("mirrored(max: 1e-4, except: 1)", "leave out no more"),
        ("rolled(max: 1e-4, except: 1)", "leave out no more"),
        (
            "differs(set: [\"image.step=2\"], rmse: 0)",
            "the least error",
        ),
        (
            "order(param: \"image.step\", from: 1, at_least: 0)",
            "the least order",
        ),
        ("picture(file: \"a.png\", flip: 1)", "such as 0.01"),
        ("uniform(within: ((3, 3), (3, 3)), max: 0)", "a larger area"),
    ] {
        let text =
            format!("(test: 1, scene: \"fog\",\n expect: [finite],\n once: [{expectation}])");
        scratch.write("c.ron", text);
        for command in ["check", "test"] {
            let run = scratch.run(&[command, "c.ron"]);
            run.refused(&["bad-value"]);
            assert!(
                run.stderr.contains("c.ron:3:") && run.stderr.contains(remedy),
                "{expectation}: {run:?}"
            );
        }
    }
}

impl crate::Run {
    /// The lines on standard output, with exit code 0.
    fn listed(&self, lines: &[&str]) {
        let told: Vec<&str> = self.stdout.lines().collect();
        assert_eq!((self.code, told.as_slice()), (Some(0), lines), "{self:?}");
    }
}
