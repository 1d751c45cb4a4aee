//! Surveys on a stand with a clock of its own.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::rc::Rc;

use volgraph_report::{Finding, Findings};
use volgraph_shader::ParamValue;

use super::{axis, space};
use crate::methods::*;

/// A stand whose times and errors are functions of the settings, on a machine that gets slower with every frame.
struct Fake {
    clock: f64,
    /// By how much each second slows the machine down.
    drift: f64,
    /// Every frame: method and number.
    log: Rc<RefCell<Vec<(String, u32)>>>,
    prepared: usize,
}

impl Fake {
    fn new() -> Self {
        Self {
            clock: 0.0,
            drift: 0.1,
            log: Rc::default(),
            prepared: 0,
        }
    }

    fn value(method: &Method, name: &str) -> f64 {
        match method.settings.iter().find(|it| it.name == name) {
            Some(Setting {
                value: ParamValue::Float(value),
                ..
            }) => *value,
            _ => 1.0,
        }
    }
}

fn errors_of(rmse: f64) -> Errors {
    Errors {
        rmse,
        max: rmse,
        p999: rmse,
        core_rmse: rmse,
        core_rmse_8bit: rmse,
        rmse_8bit: rmse,
    }
}

impl Frames for Fake {
    type Ready = Method;

    fn frame(&mut self, ready: &mut Method, number: u32) -> Result<f64, Findings> {
        self.log.borrow_mut().push((ready.to_string(), number));
        let time = 10.0 / Self::value(ready, "step") * (1.0 + self.drift * self.clock);
        self.clock += 1e-3 * time;
        Ok(time)
    }
}

impl Stand for Fake {
    fn prepare(&mut self, method: &Method) -> Result<(Method, Errors), Findings> {
        let (step, bad) = (Self::value(method, "step"), Self::value(method, "bad"));
        let worse = Self::value(method, "worse");
        if bad > 1.0 && step > 1.0 {
            return Err(Finding::error("bad-step", "too long a step for that").into());
        }
        self.prepared += 1;
        Ok((method.clone(), errors_of(1e-3 * step * step * bad * worse)))
    }

    fn bytes(&self, _ready: &Method) -> u64 {
        1 << 20
    }

    fn seconds(&self) -> f64 {
        self.clock
    }
}

struct Silent;

impl SurveyProgress for Silent {
    fn progress(&self, _what: &str, _done: usize, _total: usize) {}
}

#[test]
fn methods_are_drawn_in_turn_there_and_back() {
    let mut fake = Fake::new();
    let log = Rc::clone(&fake.log);
    let space = space(vec![axis("step", &[1.0, 2.0, 4.0], 0)]);
    let mut methods: Vec<Method> = (0..3).map(|at| space.method(&[at])).collect();
    let mut ready: Vec<&mut Method> = methods.iter_mut().collect();
    let times = alternate(&mut fake, &mut ready, 5..8, |_, _| true);
    assert!(times.iter().all(|times| times.as_ref().unwrap().len() == 3));
    let log: Vec<String> = log
        .borrow()
        .iter()
        .map(|(method, frame)| format!("{frame}:{}", method.trim_start_matches("step=")))
        .collect();
    assert_eq!(
        log,
        [
            "5:1.0", "5:2.0", "5:4.0", "6:4.0", "6:2.0", "6:1.0", "7:1.0", "7:2.0", "7:4.0"
        ]
    );
}

#[test]
fn a_whole_space_is_measured_and_drift_cancels() {
    let space = space(vec![
        axis("step", &[0.5, 1.0, 2.0, 4.0], 1),
        axis("bad", &[1.0, 3.0], 0),
    ]);
    let mut fake = Fake::new();
    let options = SurveyOptions {
        max_bytes: 3 << 20,
        ..SurveyOptions::default()
    };
    let survey = survey(&mut fake, &space, &options, &Silent).unwrap();
    assert_eq!((survey.product, survey.measured.len()), (8, 6));
    assert_eq!(survey.measured[0].method.to_string(), "step=1.0 bad=1.0");
    // What is refused is told.
    assert_eq!(survey.refused.len(), 2);
    assert!(survey.refused.iter().all(|(method, why)| {
        Fake::value(method, "bad") == 3.0 && why.starts_with("bad-step: too long")
    }));
    // The machine slowed down by several percent on the way, and ratios do not show it: two frames of one round are at
    // most 0.2 s apart.
    for measured in &survey.measured {
        let expected = 1.0 / Fake::value(&measured.method, "step");
        assert!(
            (measured.ratio.median / expected - 1.0).abs() < 0.01,
            "{} {:?}",
            measured.method,
            measured.ratio
        );
    }
    assert!(
        survey.base_ms.max / survey.base_ms.min > 1.05,
        "{:?}",
        survey.base_ms
    );
    let front: Vec<String> = survey
        .measured
        .iter()
        .filter(|it| it.is_front)
        .map(|it| it.method.to_string())
        .collect();
    assert_eq!(front.len(), 4, "{front:?}");
    assert!(front.iter().all(|method| method.ends_with("bad=1.0")));
    // What is on the front was timed for longer.
    let rounds = options.rounds as usize;
    for measured in survey.measured.iter().skip(1) {
        let expected = if measured.is_front {
            rounds
        } else {
            options.scout_rounds as usize
        };
        assert_eq!(measured.time_ms.n, expected, "{}", measured.method);
    }
}

#[test]
fn every_batch_has_the_base_in_each_round() {
    let space = space(vec![axis("step", &[0.5, 1.0, 2.0, 4.0, 8.0], 1)]);
    let mut fake = Fake::new();
    let log = Rc::clone(&fake.log);
    let options = SurveyOptions {
        max_bytes: 2 << 20,
        ..SurveyOptions::default()
    };
    survey(&mut fake, &space, &options, &Silent).unwrap();
    let mut rounds: Vec<BTreeMap<String, usize>> = vec![BTreeMap::new()];
    let mut last = 0;
    for (method, frame) in log.borrow().iter() {
        if *frame != last {
            rounds.push(BTreeMap::new());
            last = *frame;
        }
        *rounds
            .last_mut()
            .unwrap()
            .entry(method.clone())
            .or_default() += 1;
    }
    for round in &rounds[1..] {
        assert_eq!(round.get("step=1.0"), Some(&1), "{round:?}");
        // The limit of bytes is passed by one method at most.
        assert!(
            round.len() <= 3 && round.values().all(|n| *n == 1),
            "{round:?}"
        );
    }
}

#[test]
fn a_large_space_is_searched_from_the_front_outwards_and_within_its_time() {
    let many: Vec<f64> = (0..7).map(|i| 2_f64.powi(i - 3)).collect();
    let more: Vec<f64> = (0..6).map(|i| 1.0 + f64::from(i)).collect();
    let space = space(vec![
        axis("step", &many, 3),
        axis("bad", &more, 2),
        axis("worse", &more, 0),
    ]);
    let options = SurveyOptions {
        seconds: 1e9,
        ..SurveyOptions::default()
    };
    let found = survey(&mut Fake::new(), &space, &options, &Silent).unwrap();
    assert_eq!(found.product, 7 * 6 * 6);
    assert!(found.measured.len() + found.refused.len() < found.product);
    // The truth: without `bad` every step is on the front.
    let steps: Vec<f64> = found
        .measured
        .iter()
        .filter(|it| it.is_front && Fake::value(&it.method, "bad") == 1.0)
        .map(|it| Fake::value(&it.method, "step"))
        .collect();
    assert!(many.iter().all(|step| steps.contains(step)), "{steps:?}");
    // No method twice.
    let mut names: Vec<String> = found
        .measured
        .iter()
        .map(|it| it.method.to_string())
        .collect();
    names.sort();
    names.dedup();
    assert_eq!(names.len(), found.measured.len());

    let options = SurveyOptions {
        seconds: 0.0,
        ..SurveyOptions::default()
    };
    let mut fake = Fake::new();
    let short = survey(&mut fake, &space, &options, &Silent).unwrap();
    assert_eq!((short.measured.len(), fake.prepared), (1, 1));
    assert_eq!(short.measured[0].ratio.median, 1.0);
}

#[test]
fn a_survey_passes_its_time_by_a_batch_at_most() {
    let doubles: Vec<f64> = (0..7).map(|i| 2_f64.powi(i)).collect();
    let many: Vec<f64> = (1..=16).map(f64::from).collect();
    let space = space(vec![
        axis("step", &doubles, 0),
        axis("classify", &many, 0),
        axis("traverse", &many, 0),
    ]);
    let options = SurveyOptions {
        seconds: 5.0,
        ..SurveyOptions::default()
    };
    let found = survey(&mut Fake::new(), &space, &options, &Silent).unwrap();
    // Sixteen methods and the base, a frame that is not timed and three that are, each of 16 ms at most.
    let batch = 17.0 * 4.0 * 0.016;
    assert!(
        found.seconds <= options.seconds + batch,
        "{}",
        found.seconds
    );
    assert!((40..found.product).contains(&found.measured.len()));
}

#[test]
fn where_the_time_is_over_the_nearest_to_the_front_are_refined() {
    let doubles: Vec<f64> = (0..8).map(|i| 2_f64.powi(i)).collect();
    let factors: Vec<f64> = (1..=8).map(f64::from).collect();
    // Errors of the same step are in the ratio of `worse`, which takes no time.
    let space = space(vec![axis("worse", &factors, 0), axis("step", &doubles, 0)]);
    let options = SurveyOptions {
        seconds: 0.0,
        slack: 1e9,
        ..SurveyOptions::default()
    };
    let mut steady = Fake::new();
    steady.drift = 0.0;
    let found = survey(&mut steady, &space, &options, &Silent).unwrap();
    // A small space is measured as a whole, and then there is time for one batch.
    assert_eq!(found.measured.len(), 64);
    let refined = |worse: f64| {
        let measured = found.measured.iter().filter(|it| it.is_refined);
        measured
            .filter(|it| Fake::value(&it.method, "worse") == worse)
            .count()
    };
    let counts: Vec<usize> = factors.iter().map(|worse| refined(*worse)).collect();
    assert_eq!(counts, [8, 8, 1, 0, 0, 0, 0, 0]);
}
