//! Surveys with a clock of their own, fronts, filters and tables of peers.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::rc::Rc;

use volgraph_report::{Finding, Findings};
use volgraph_shader::ParamValue;

use super::filter::Wanted;
use super::peers::{Peers, harness_volume};
use super::*;

fn axis(name: &str, values: &[f64], base: usize) -> Axis {
    Axis {
        name: name.to_owned(),
        is_slot: false,
        values: values
            .iter()
            .map(|value| ParamValue::Float(*value))
            .collect(),
        base,
    }
}

fn space(axes: Vec<Axis>) -> MethodSpace {
    MethodSpace {
        node: "image".to_owned(),
        axes,
    }
}

/// A stand whose times and errors are functions of the settings, on a machine that gets slower with every frame.
struct Fake {
    clock: f64,
    /// Every frame: method and number.
    log: Rc<RefCell<Vec<(String, u32)>>>,
    prepared: usize,
}

impl Fake {
    fn new() -> Self {
        Self {
            clock: 0.0,
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

impl Stand for Fake {
    type Ready = Method;

    fn prepare(&mut self, method: &Method) -> Result<(Method, Errors), Findings> {
        let (step, bad) = (Self::value(method, "step"), Self::value(method, "bad"));
        let worse = Self::value(method, "worse");
        if bad > 1.0 && step > 1.0 {
            return Err(Finding::error("bad-step", "too long a step for that").into());
        }
        self.prepared += 1;
        Ok((method.clone(), errors_of(1e-3 * step * step * bad * worse)))
    }

    fn frame(&mut self, ready: &mut Method, number: u32) -> Result<f64, Findings> {
        self.log.borrow_mut().push((ready.to_string(), number));
        // Each second slows the machine down by a tenth.
        let time = 10.0 / Self::value(ready, "step") * (1.0 + 0.1 * self.clock);
        self.clock += 1e-3 * time;
        Ok(time)
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
fn a_front_is_what_nothing_beats_in_both() {
    let points = [
        (4.0, 1.0),
        (1.0, 4.0),
        (2.0, 2.0),
        (3.0, 3.0),
        (2.0, 2.0),
        (2.0, 3.0),
    ];
    assert_eq!(front(&points), [1, 2, 0]);
    assert_eq!(front(&[]), [0_usize; 0]);
    // Of two equal ones on it both; (3, 3) is beaten one and a half times over, and (2, 3) in error alone.
    assert_eq!(near_front(&points, 1.2), [0, 1, 2, 4]);
    assert_eq!(near_front(&points, 1.6), [0, 1, 2, 3, 4, 5]);
    // The definition, over a grid of points.
    let points: Vec<(f64, f64)> = (0..60_u32)
        .map(|i| (f64::from(i * 37 % 61), f64::from(i * 53 % 59)))
        .collect();
    let found = front(&points);
    for (at, point) in points.iter().enumerate() {
        let is_beaten = points.iter().any(|other| {
            other.0 <= point.0 && other.1 <= point.1 && (other.0 < point.0 || other.1 < point.1)
        });
        assert_eq!(found.contains(&at), !is_beaten, "{point:?}");
    }
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
    // The machine slowed down by tens of percent on the way, and ratios do not show it: two frames of one round are at
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
        survey.base_ms.max / survey.base_ms.min > 1.1,
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
fn filters_are_lists_ranges_and_stars() {
    let filters = parse_filters("classify=post,preintegrated_2d  step=0.25..4 stage=*").unwrap();
    let names: Vec<&str> = filters.iter().map(|filter| filter.name.as_str()).collect();
    assert_eq!(names, ["classify", "step", "stage"]);
    assert_eq!(
        filters[0].wanted[1],
        Wanted::Value("preintegrated_2d".to_owned())
    );
    assert_eq!(filters[1].wanted[0].doubles(), [0.25, 0.5, 1.0, 2.0, 4.0]);
    assert_eq!(filters[2].wanted, [Wanted::All]);
    let doubles = |text: &str| Filter::parse(text).unwrap().wanted[0].doubles();
    assert_eq!(doubles("step=0.5..3"), [0.5, 1.0, 2.0, 3.0]);
    assert_eq!(doubles("step=1..1"), [1.0]);
    for wrong in [
        "step",
        "step=",
        "=1",
        "step=0..4",
        "step=4..1",
        "step=1,,2",
        "step=a..b",
        "a=1 a=2",
    ] {
        assert!(parse_filters(wrong).is_err(), "{wrong}");
    }
}

#[test]
fn the_space_of_a_plan_has_what_its_raycast_offers() {
    let overrides = crate::Overrides::default();
    let folders = crate::ShaderFolders::default();
    let path = std::path::Path::new("embedded:/graphs/comparison.ron");
    let scene = crate::Scene::load(
        path,
        &overrides,
        &folders,
        crate::registry(),
        &crate::NoProgress,
    )
    .unwrap();
    let plan = crate::truth::plan_without_device(&scene, [16, 16]).unwrap();
    let roots = folders.roots(None);
    let of = |text: &str| {
        MethodSpace::of(
            &plan,
            &roots,
            &scene.registry,
            &parse_filters(text).unwrap(),
        )
    };
    let space = of("").unwrap();
    let axis = |name: &str| space.axes.iter().find(|axis| axis.name == name);
    for slot in ["classify", "traverse", "reconstruct"] {
        let values: Vec<String> = axis(slot)
            .unwrap()
            .values
            .iter()
            .map(ToString::to_string)
            .collect();
        assert_eq!(values, roots.choices(slot), "{slot}");
    }
    // What the shader does not use is no method; what only picks another choice neither.
    assert!(axis("gradient").is_none());
    let stages: Vec<String> = axis("stage")
        .unwrap()
        .values
        .iter()
        .map(ToString::to_string)
        .collect();
    assert_eq!(stages, ["fragment", "compute"]);
    assert_eq!(axis("step").unwrap().values.len(), 5);
    assert_eq!(space.method(&space.base()).text("step"), "1.0");

    let narrow = of("classify=post step=0.5,2 reconstruct=trilinear stage=compute volume_storage=r8unorm early_termination=0 table_size=1024,2048").unwrap();
    assert_eq!(narrow.len(), 4);
    assert!(narrow.axes.iter().any(|axis| axis.name == "table_size"));
    for (wrong, code) in [
        ("classifi=post", "unknown-setting"),
        ("classify=pst", "unknown-choice"),
        ("step=-1", "bad-methods"),
        ("stage=gpu", "bad-methods"),
        ("classify=1..2", "bad-methods"),
    ] {
        let findings = of(wrong).unwrap_err();
        assert_eq!(findings.sorted()[0].code, code, "{wrong}");
    }
    assert_eq!(harness_volume(&scene.desc), Some("ml"));
}

const TABLE: &str = "\
peer\tmode\tvolume\tstep_vox\tmedian_ms\tmin_ms\tmax_ms\tn\tfirst_frame_ms\trmse8\tpsnr_db\trmse8_core\tmaxabs8\tloadavg\tnote
one \"gpu\"\tcomposite\tml\t1\t42.5\t40.0\t50.1\t9\t200\t0.9\t49.0\t0.8\t12.0\t1.0\t
one \"gpu\"\tcomposite\tc60\tauto\t52.5\t40.0\t50.1\t9\t200\t0.9\t49.0\t0.7\t12.0\t1.0\t
two\tcomposite_shade\tml\t1\t42.5\t40.0\t50.1\t9\t200\t\t\t\t\t1.0\t
three\tmip\tml\t1\t42.5\t40.0\t50.1\t9\t200\t0.1\t60\t0.1\t1\t1.0\t
four\ttranslucent\tml\t1\t\t\t\t\t\t\t\t\t\t1.0\tTIMEOUT 120s
";

#[test]
fn tables_of_peers_are_read_and_matched_with_their_scene() {
    let peers = Peers::parse(TABLE).unwrap();
    assert_eq!((peers.peers.len(), peers.left_out), (3, 2));
    assert_eq!(peers.peers[0].name, "one \"gpu\"");
    assert_eq!(peers.peers[0].core_rmse_8bit_steps, 0.8);
    assert_eq!(peers.peers[1].step, "auto");
    let graph = |text: &str| volgraph_graph::read::graph("t.ron".as_ref(), text).unwrap();
    let comparison = include_str!("../../../../graphs/comparison.ron");
    let names =
        |graph| -> Vec<String> { peers.of(&graph).into_iter().map(|peer| peer.name).collect() };
    assert_eq!(names(graph(comparison)), ["one \"gpu\""]);
    // Another transfer function, another volume: nobody else drew that.
    let other = comparison.replace("transfer/comparison.ron", "transfer/other.ron");
    assert!(names(graph(&other)).is_empty());
    assert!(names(graph(&comparison.replace("128, 128, 128", "64, 64, 64"))).is_empty());

    for wrong in [
        TABLE.replace("median_ms", "median"),
        TABLE.replace("42.5", "fast"),
    ] {
        let findings = Peers::parse(&wrong).unwrap_err();
        assert_eq!(findings.sorted()[0].code, "bad-peers");
    }
}

#[test]
fn errors_are_of_all_pixels_and_of_the_core() {
    let picture = |colors: Vec<[f32; 4]>| crate::Picture::from_color(2, 1, colors).unwrap();
    let truth = picture(vec![[0.5, 0.5, 0.5, 1.0], [0.0; 4]]);
    let drawn = picture(vec![[0.5, 0.5, 0.6, 1.0], [0.0, 0.0, 0.0, 0.2]]);
    let errors = errors(&drawn, &truth, &[true, false]).unwrap();
    let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-7, "{a} is not {b}");
    close(errors.rmse, ((0.01 + 0.04) / 8.0_f64).sqrt());
    close(errors.max, 0.2);
    close(errors.p999, 0.2);
    close(errors.core_rmse, (0.01 / 3.0_f64).sqrt());
    // 0.5 becomes 128 of 255, 0.6 becomes 153.
    let [low, high] = [128.0 / 255.0 - 0.5, 153.0 / 255.0 - 0.5];
    close(
        errors.core_rmse_8bit,
        ((2.0 * low * low + high * high) / 3.0_f64).sqrt(),
    );
}

#[test]
fn core_pixels_cross_four_voxels_between_voxel_centres() {
    use glam::DVec3;
    // 9 samples a unit apart: 0 to 8 on each axis. Parallel rays along the diagonal of x and y, aside by a
    // and b: they cross √2 (8 - √2 |a|) voxels where |b| is under 4.
    let grid = volgraph_volume::Grid::axis_aligned([9; 3], DVec3::ONE, DVec3::ZERO);
    let forward = DVec3::new(1.0, 1.0, 0.0).normalize();
    let rays = volgraph_reference::Rays {
        eye: DVec3::splat(4.0) - 20.0 * forward,
        right: DVec3::new(1.0, -1.0, 0.0).normalize(),
        up: DVec3::Z,
        forward,
        half_extent: [8.0, 8.0],
        is_orthographic: true,
        size: [32, 32],
    };
    let core = core_pixels(&grid, &rays);
    for y in 0..32 {
        for x in 0..32 {
            let [across, up] = rays.place(x, y).map(|place| 8.0 * place.abs());
            let crossed = if up < 4.0 {
                2.0 * (4.0 * 2_f64.sqrt() - across)
            } else {
                0.0
            };
            assert_eq!(core[(y * 32 + x) as usize], crossed >= 4.0, "{x} {y}");
        }
    }
}
