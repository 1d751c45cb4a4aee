//! Fronts, filters, spaces, errors and tables of peers; surveys in a file of their own.

mod surveys;

use volgraph_shader::ParamValue;

use super::filter::Wanted;
use super::peers::{Peers, ScenePeers, harness_volume};
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
        is_software: false,
        of_choice: None,
    }
}

fn space(axes: Vec<Axis>) -> MethodSpace {
    MethodSpace {
        node: "image".to_owned(),
        axes,
    }
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
    // The nearest come first.
    assert_eq!(near_front(&points, 1.6), [0, 1, 2, 4, 3, 5]);
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
    let base = space.method(&space.base());
    assert_eq!(base.text("step"), "1.0");
    // Bytes are exact in half floats, and that is what the graph's `auto` comes to.
    assert_eq!(base.text("volume_storage"), "r16float");

    let narrow = of("classify=post traverse=uniform step=0.5,2 reconstruct=trilinear stage=compute volume_storage=r8unorm early_termination=0 table_size=1024,2048").unwrap();
    // Two by the raycast's step and two by its table, and the software raycaster has both as well.
    assert_eq!(narrow.len(), 8);
    let narrow = of("renderer=device classify=post traverse=uniform step=0.5,2 reconstruct=trilinear stage=compute volume_storage=r8unorm early_termination=0 table_size=1024,2048").unwrap();
    assert_eq!(narrow.len(), 4);
    assert!(narrow.axes.iter().any(|axis| axis.name == "table_size"));
    for (wrong, code) in [
        ("classifi=post", "unknown-setting"),
        ("classify=pst", "unknown-choice"),
        ("step=-1", "bad-methods"),
        ("stage=gpu", "bad-methods"),
        ("classify=1..2", "bad-methods"),
        ("renderer=gpu", "bad-methods"),
        // It knows no other reconstruction.
        ("renderer=software reconstruct=tricubic", "bad-methods"),
    ] {
        let findings = of(wrong).unwrap_err();
        assert_eq!(findings.sorted()[0].code, code, "{wrong}");
    }
    assert_eq!(harness_volume(&scene.desc), Some("ml"));
}

#[test]
fn the_software_raycaster_is_a_method_where_it_draws_the_same_picture() {
    let of = |sets: &[&str], filters: &str| {
        let params = sets
            .iter()
            .map(|set| crate::ParamOverride::parse(set).unwrap());
        let overrides = crate::Overrides {
            params: params.collect(),
            ..crate::Overrides::default()
        };
        let folders = crate::ShaderFolders::default();
        let path = std::path::Path::new("embedded:/graphs/comparison.ron");
        let registry = crate::registry();
        let scene =
            crate::Scene::load(path, &overrides, &folders, registry, &crate::NoProgress).unwrap();
        let plan = crate::truth::plan_without_device(&scene, [16, 16]).unwrap();
        let filters = parse_filters(filters).unwrap();
        MethodSpace::of(&plan, &folders.roots(None), &scene.registry, &filters).unwrap()
    };
    let space = of(&[], "step=2 early_termination=0");
    let base = space.base();
    assert_eq!((space.axes[0].name.as_str(), base[0]), ("renderer", 0));
    assert!(!space.method(&base).is_software());
    let all = space.product(&base, |_| true);
    assert_eq!(all.len(), space.len());
    let named: Vec<String> = all.iter().map(|at| space.method(at).to_string()).collect();
    let software: Vec<&String> = named
        .iter()
        .filter(|it| it.starts_with("software"))
        .collect();
    let wanted = [
        "software classify=integral_1d attenuation=exact traverse=skip step=2.0 early_termination=0.0",
        "software classify=integral_1d attenuation=exact traverse=uniform step=2.0 early_termination=0.0",
        "software classify=integral_1d attenuation=four_lines traverse=skip step=2.0 early_termination=0.0",
        "software classify=integral_1d attenuation=four_lines traverse=uniform step=2.0 early_termination=0.0",
        "software classify=post traverse=skip step=2.0 early_termination=0.0",
        "software classify=post traverse=uniform step=2.0 early_termination=0.0",
    ];
    assert_eq!(software, wanted);
    let distinct: std::collections::BTreeSet<&String> = named.iter().collect();
    assert_eq!(distinct.len(), named.len());
    // Another renderer is a neighbour, and from there the way back is to the base.
    let there = space.neighbours(&base);
    let there = there
        .iter()
        .find(|at| space.method(at).is_software())
        .unwrap();
    let back = space.neighbours(there);
    assert!(back.contains(&base) && back.iter().all(|at| all.contains(at)));
    // Where it does not draw the same picture, it is no method.
    let has = |sets: &[&str], filters: &str| {
        let space = of(sets, filters);
        space
            .axes
            .iter()
            .any(|axis| axis.is_software || axis.name == "renderer")
    };
    assert!(has(&[], ""));
    assert!(has(&["image.slots.technique=mip"], ""));
    let toned = ["image.slots.technique=mip", "image.slots.tone=transfer"];
    assert!(!has(&toned, ""));
    assert!(!has(&["image.slots.technique=xray"], ""));
    assert!(!has(
        &["image.slots.classify=post"],
        "classify=preintegrated_2d"
    ));
    assert!(!has(&[], "reconstruct=tricubic"));
    // A software raycast has its own.
    let own = of(&["image.renderer=software"], "");
    let names: Vec<&str> = own.axes.iter().map(|axis| axis.name.as_str()).collect();
    assert_eq!(
        names,
        [
            "classify",
            "attenuation",
            "traverse",
            "step",
            "early_termination"
        ]
    );
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
    assert_eq!((peers.peers.len(), peers.unmeasured), (3, 2));
    assert_eq!(peers.peers[0].name, "one \"gpu\"");
    assert_eq!(peers.peers[0].core_rmse_8bit_steps, 0.8);
    assert_eq!(peers.peers[1].step, "auto");
    let graph = |text: &str| volgraph_graph::read::graph("t.ron".as_ref(), text).unwrap();
    let comparison = include_str!("../../../../graphs/comparison.ron");
    let of = |text: &str, size: u32| peers.of(&graph(text), [size; 2]);
    let shown = of(comparison, 512);
    assert_eq!(shown.peers.len(), 1);
    assert_eq!(shown.peers[0].name, "one \"gpu\"");
    let why = |scene: &ScenePeers| -> Vec<(usize, &str)> {
        scene.left_out.iter().map(|it| (it.rows, it.why)).collect()
    };
    assert_eq!(
        why(&shown),
        [
            (2, "without a time or an error"),
            (1, "of another volume"),
            (1, "not of emission and absorption"),
        ]
    );
    // Another transfer function, another volume, another size: nobody else drew that, and every row is told of.
    let other = comparison.replace("transfer/comparison.ron", "transfer/other.ron");
    let smaller = comparison.replace("128, 128, 128", "64, 64, 64");
    for (scene, reason) in [
        (of(&other, 512), "not of this graph's scene"),
        (of(&smaller, 512), "not of this graph's scene"),
        (of(comparison, 256), "of pictures of 512 × 512 pixels"),
    ] {
        assert!(scene.peers.is_empty());
        assert_eq!(
            why(&scene),
            [(2, "without a time or an error"), (3, reason)]
        );
    }

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
    let truth = picture(vec![[0.4, 0.4, 0.5, 1.0], [0.0; 4]]);
    let drawn = picture(vec![[0.403, 0.4, 0.6, 1.0], [0.0, 0.0, 0.0, 0.2]]);
    let errors = errors(&drawn, &truth, &[true, false]).unwrap();
    let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-7, "{a} is not {b}");
    close(errors.rmse, ((9e-6 + 0.01 + 0.04) / 8.0_f64).sqrt());
    close(errors.max, 0.2);
    close(errors.p999, 0.2);
    close(errors.core_rmse, ((9e-6 + 0.01) / 3.0_f64).sqrt());
    // 0.403 is 102.765 of 255 and becomes 103; 0.4 is 102, and 0.6 is 153.
    let step = 1.0 / 255.0;
    let rounded = ((step * step + 0.01) / 3.0_f64).sqrt();
    close(errors.core_rmse_8bit, rounded);
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
        size: [64, 64],
    };
    let core = core_pixels(&grid, &rays);
    for y in 0..64 {
        for x in 0..64 {
            let [across, up] = rays.place(x, y).map(|place| 8.0 * place.abs());
            let crossed = if up < 4.0 {
                2.0 * (4.0 * 2_f64.sqrt() - across)
            } else {
                0.0
            };
            assert_eq!(core[(y * 64 + x) as usize], crossed >= 4.0, "{x} {y}");
        }
    }
}
