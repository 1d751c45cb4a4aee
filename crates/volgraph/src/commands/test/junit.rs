//! The results as JUnit XML: a suite for each case, a test for each expectation at each setting.

use std::time::Duration;

use quick_junit::{NonSuccessKind, Report, TestCase, TestCaseStatus, TestSuite};
use volgraph::case::{CaseReport, Outcome, Verdict};

/// The text of the file.
pub fn xml(reports: &[CaseReport]) -> anyhow::Result<String> {
    let mut report = Report::new("volgraph test");
    report.set_time(seconds(reports.iter().map(|report| report.seconds).sum()));
    report.add_test_suites(reports.iter().map(suite));
    Ok(report.to_string()?)
}

fn suite(report: &CaseReport) -> TestSuite {
    let file = report.file.display().to_string();
    let mut suite = TestSuite::new(file.as_str());
    suite.set_time(seconds(report.seconds));
    match &report.result {
        None => {
            let mut status = TestCaseStatus::skipped();
            status.set_message("a case before it failed");
            suite.add_test_case(TestCase::new("case", status));
        }
        Some(Err(findings)) => {
            let mut status = TestCaseStatus::non_success(NonSuccessKind::Error);
            status.set_message("it cannot be run");
            status.set_description(findings.to_string());
            suite.add_test_case(TestCase::new("case", status));
        }
        Some(Ok(outcomes)) => {
            suite.add_test_cases(outcomes.iter().map(|outcome| test(&file, outcome)));
        }
    }
    suite
}

fn test(file: &str, outcome: &Outcome) -> TestCase {
    let status = match outcome.verdict {
        Verdict::Passed => TestCaseStatus::success(),
        Verdict::NotRun => {
            let mut status = TestCaseStatus::skipped();
            status.set_message(outcome.detail.as_str());
            status
        }
        Verdict::Failed => {
            let is_measured = outcome.findings.is_empty();
            let kind = if is_measured {
                NonSuccessKind::Failure
            } else {
                NonSuccessKind::Error
            };
            let mut status = TestCaseStatus::non_success(kind);
            status.set_message(outcome.detail.as_str());
            if !is_measured {
                status.set_description(outcome.findings.to_string());
            }
            status
        }
    };
    let mut test = TestCase::new(outcome.name(), status);
    test.set_classname(file);
    test.set_time(seconds(outcome.seconds));
    if outcome.passed() {
        test.set_system_out(outcome.detail.as_str());
    }
    test
}

fn seconds(seconds: f64) -> Duration {
    Duration::try_from_secs_f64(seconds).unwrap_or_default()
}
