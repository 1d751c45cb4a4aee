//! The transfer function file: what is read, what is refused and where, and that writing loses nothing.

use std::path::Path;

use volgraph_optics::{
    Domain, Material, OpticsError, ReferenceLength, TransferFunction, color_map_names,
};
use volgraph_report::Findings;

fn parse(text: &str) -> Result<TransferFunction, Findings> {
    TransferFunction::parse(Path::new("t.ron"), text)
}

/// Code, line and column of each finding.
fn findings(text: &str) -> Vec<(&'static str, u32, u32)> {
    let findings = parse(text).expect_err(text);
    findings
        .sorted()
        .into_iter()
        .map(|finding| {
            let place = finding.place.as_ref().expect("every finding has a place");
            assert_eq!(place.file, Path::new("t.ron"));
            (finding.code, place.line, place.column)
        })
        .collect()
}

fn codes(text: &str) -> Vec<&'static str> {
    findings(text).into_iter().map(|(code, ..)| code).collect()
}

#[test]
fn both_forms_say_the_same() {
    let together = parse(
        r##"( // a comment
            points: [
                (at: 0.0, color: (0, 0, 0), opacity: 0),
                (at: 0.25, color: "#ff0000", opacity: 0.5),
                (at: 1, color: "#ffffff", opacity: 1.0),
            ],
        )"##,
    )
    .unwrap();
    let apart = parse(
        r##"(domain: normalised, reference_length: (voxels: 1),
            color: [(0, (0, 0, 0)), (0.25, (1, 0, 0)), (1, (1, 1, 1))],
            opacity: [(0, 0), (0.25, 0.5), (1, 1)])"##,
    )
    .unwrap();
    assert_eq!(together, apart);
    assert_eq!(together.digest(), apart.digest());
    assert_eq!(together.domain(), Domain::Normalised);
    assert_eq!(together.range(), (0.0, 1.0));
    assert_eq!(together.reference_length(), ReferenceLength::Voxels(1.0));
    assert_eq!(together.color(0.125), [0.5, 0.0, 0.0]);
    // Linear in opacity, then converted: -ln(1 - 1/4).
    assert!((together.extinction(0.125) - (4.0_f64 / 3.0).ln()).abs() < 1e-15);
    assert!((together.opacity(0.125) - 0.25).abs() < 1e-15);
    assert_eq!(together.extinction(1.0), 16.0);
    assert_eq!(together.extinction(f64::INFINITY), 16.0);
    assert_eq!(together.extinction(-5.0), 0.0);
    let cap = 1.0 - (-16.0_f64).exp();
    let knots = together.knots();
    assert_eq!(knots.len(), 4);
    assert!(
        (knots[2] - (0.25 + 0.75 * (cap - 0.5) / 0.5)).abs() < 1e-12,
        "{knots:?}"
    );
}

#[test]
fn extinction_is_linear_in_extinction() {
    let transfer = parse("(color: \"#808080\", extinction: [(0, 0), (1, 40)])").unwrap();
    assert_eq!(transfer.extinction(0.5), 20.0);
    let points = "(points: [(at: 0, color: (1, 1, 1), extinction: 0), (at: 1, color: (1, 1, 1), extinction: 40)])";
    assert_eq!(parse(points).unwrap().extinction(0.25), 10.0);
}

#[test]
fn tables_start_before_a_step_at_the_very_start() {
    // Values below the step are those before it, in tables as in the transfer function itself.
    for text in [
        "(domain: data, color: (1, 1, 1), opacity: [(2, 0), (2, 0.5), (4, 1)])",
        "(domain: data(from: 2, to: 4), color: (1, 1, 1), opacity: [(2, 0), (2, 0.5), (4, 1)])",
        "(domain: data, color: [(2, (0, 0, 0)), (2, (1, 1, 1)), (4, (0, 1, 0))], opacity: [(2, 0.25), (3, 1)])",
        "(domain: data, color: (1, 1, 1), opacity: [(2, 0), (4, 1)], refraction: [(2, 1), (2, 1.5)])",
        "(domain: data, color: (1, 1, 1), opacity: [(2, 0), (4, 1)],
          material: [(at: 2, diffuse: 1), (at: 2, diffuse: 0.5)])",
    ] {
        let transfer = parse(text).unwrap();
        let (low, high) = transfer.range();
        assert!(low < 2.0 && low > 1.99 && high == 4.0, "{text}: {low}");
        let table = transfer.post_table(8192).unwrap().entries;
        let below = transfer.color(1.0).map(|c| c as f32);
        assert_eq!(table[0][..3], below, "{text}");
        assert_eq!(table[0][3], transfer.extinction(1.0) as f32, "{text}");
        // The entry next to the step itself is the later one.
        let nearest = ((2.0 - low) / (high - low) * 8191.0).round() as usize;
        let late = f64::from(table[nearest][3]) - transfer.extinction(2.0);
        assert!(late.abs() < 1e-3, "{text}: {late}");
        let again = parse(&transfer.to_ron()).unwrap();
        assert_eq!(again, transfer, "{text}");
    }
    let no_step = "(domain: data, color: (1, 1, 1), opacity: [(2, 0), (3, 0.5), (3, 1)])";
    assert_eq!(parse(no_step).unwrap().range(), (2.0, 3.0));
}

#[test]
fn data_units_span_what_is_given() {
    let range = |text: &str| parse(text).unwrap().range();
    assert_eq!(
        range(
            "(domain: data, color: [(-5, (0,0,0)), (10, (1,1,1))], opacity: [(-1000, 0), (3, 1)])"
        ),
        (-1000.0, 10.0)
    );
    let map = "(domain: data, color: map(name: \"turbo\", to: 50), opacity: [(0, 0), (20, 1)])";
    assert_eq!(range(map), (0.0, 50.0));
    assert_eq!(
        range("(domain: data(from: 1, to: 9), color: (1, 1, 1), opacity: [(5, 1)])"),
        (1.0, 9.0)
    );
    assert_eq!(
        codes("(domain: data, color: (1, 1, 1), opacity: [(5, 1)])"),
        ["empty-range"]
    );
    assert_eq!(
        codes("(domain: data, color: (1, 1, 1), opacity: [(5, 0), (5, 1)])"),
        ["empty-range"]
    );
}

#[test]
fn a_map_runs_where_it_is_told_and_turns_round() {
    let read = |reversed: bool| {
        parse(&format!(
            "(color: map(name: \"gray\", from: 0.2, to: 0.7, reversed: {reversed}), opacity: [(0, 1)])"
        ))
        .unwrap()
    };
    for (s, gray) in [(0.0, 0.0), (0.2, 0.0), (0.45, 0.5), (0.7, 1.0), (1.0, 1.0)] {
        for (value, truth) in [
            (read(false).color(s), gray),
            (read(true).color(s), 1.0 - gray),
        ] {
            assert!(
                value.iter().all(|c| (c - truth).abs() < 1e-12),
                "{s}: {value:?}"
            );
        }
    }
    for name in color_map_names() {
        parse(&format!("(color: map(name: {name:?}), opacity: [(0, 1)])")).expect(name);
    }
}

#[test]
fn everything_wrong_is_found_at_once_at_its_place() {
    let text = r#"(
    domain: nrmalised,
    reference_length: voxels(1.0),
    color: map(name: "virids", form: 1),
    opacity: [(0.5, 1.5), (0.2, -1), (0.9, NaN), (1.0)],
    colour: 1,
)"#;
    assert_eq!(
        findings(text),
        [
            ("unknown-domain", 2, 13),
            ("wrong-type", 3, 23),
            ("unknown-color-map", 4, 22),
            ("unknown-field", 4, 32),
            ("out-of-range", 5, 21),
            ("decreasing", 5, 28),
            ("out-of-range", 5, 33),
            ("wrong-type", 5, 44),
            ("wrong-type", 5, 50),
            ("unknown-field", 6, 5),
        ]
    );
    let all = parse(text).unwrap_err().to_string();
    for help in [
        "did you mean `normalised`?",
        "(voxels: 1.0)",
        "did you mean `viridis`?",
        "did you mean `from`?",
    ] {
        assert!(all.contains(help), "{help} is not in\n{all}");
    }
}

#[test]
fn each_wrong_file_has_its_code() {
    for (text, expected) in [
        ("", "ron-syntax"),
        ("(color: )", "ron-syntax"),
        ("[]", "wrong-type"),
        ("()", "missing-field"),
        ("(color: (1, 1, 1))", "missing-field"),
        ("(opacity: [(0, 1)])", "missing-field"),
        ("(color: (1, 1, 1), opacity: [])", "no-points"),
        ("(points: [])", "no-points"),
        ("(points: [(at: 0, color: (1, 1, 1))])", "missing-field"),
        ("(points: [(at: 0, opacity: 1)])", "missing-field"),
        (
            "(points: [(color: (1, 1, 1), opacity: 1)])",
            "missing-field",
        ),
        (
            "(points: [(at: 0, color: (1, 1, 1), opacity: 1, extinction: 1)])",
            "exclusive-fields",
        ),
        (
            "(points: [(at: 0, color: (1, 1, 1), opacity: 1), (at: 1, color: (1, 1, 1), extinction: 1)])",
            "exclusive-fields",
        ),
        (
            "(points: [(at: 0, color: (1, 1, 1), opacity: 1)], color: (1, 1, 1))",
            "exclusive-fields",
        ),
        (
            "(color: (1, 1, 1), opacity: [(0, 1)], extinction: [(0, 1)])",
            "exclusive-fields",
        ),
        ("(color: (1, 1, 1), opacity: [(1.5, 1)])", "out-of-range"),
        (
            "(domain: data, color: (1, 1, 1), opacity: [(-1e31, 0), (0, 1)])",
            "out-of-range",
        ),
        (
            "(domain: data(from: 0, to: 1), color: (1, 1, 1), opacity: [(2, 1)])",
            "out-of-range",
        ),
        (
            "(domain: data(from: 0), color: (1, 1, 1), opacity: [(0, 1)])",
            "missing-field",
        ),
        (
            "(domain: data(from: 1, to: 0), color: (1, 1, 1), opacity: [(0, 1)])",
            "bad-range",
        ),
        (
            "(color: map(name: \"gray\", from: 1, to: 0), opacity: [(0, 1)])",
            "bad-range",
        ),
        ("(color: map(from: 0), opacity: [(0, 1)])", "missing-field"),
        (
            "(color: mop(name: \"gray\"), opacity: [(0, 1)])",
            "wrong-type",
        ),
        ("(color: \"red\", opacity: [(0, 1)])", "bad-color"),
        ("(color: (-1, 0, 0), opacity: [(0, 1)])", "bad-color"),
        ("(color: (1, 1), opacity: [(0, 1)])", "wrong-type"),
        ("(color: (1, 1, 1), extinction: [(0, -1)])", "out-of-range"),
        (
            "(color: (1, 1, 1), opacity: [(0, 1)], reference_length: (voxels: 0))",
            "out-of-range",
        ),
        (
            "(color: (1, 1, 1), opacity: [(0, 1)], reference_length: ())",
            "missing-field",
        ),
        (
            "(color: (1, 1, 1), opacity: [(0, 1)], reference_length: (voxels: 1, world: 1))",
            "exclusive-fields",
        ),
        (
            "(color: (1, 1, 1), color: (1, 1, 1), opacity: [(0, 1)])",
            "duplicate",
        ),
        (
            "(color: (1, 1, 1), opacity: [(0, 1)], material: [])",
            "no-points",
        ),
        (
            "(color: (1, 1, 1), opacity: [(0, 1)], material: [(at: 0)])",
            "missing-field",
        ),
        (
            "(color: (1, 1, 1), opacity: [(0, 1)], material: [(diffuse: 0.5)])",
            "missing-field",
        ),
        (
            "(color: (1, 1, 1), opacity: [(0, 1)], material: [(at: 2, diffuse: 0.5)])",
            "out-of-range",
        ),
        (
            "(color: (1, 1, 1), opacity: [(0, 1)], material: [(at: 0, shininess: 0.5)])",
            "out-of-range",
        ),
        (
            "(color: (1, 1, 1), opacity: [(0, 1)], material: (diffuse: 0.5))",
            "wrong-type",
        ),
    ] {
        assert!(codes(text).contains(&expected), "{text}: {:?}", codes(text));
    }
    let many = "(at: 0, diffuse: 1), ".repeat(4097);
    assert_eq!(
        codes(&format!(
            "(color: (1, 1, 1), opacity: [(0, 1)], material: [{many}])"
        )),
        ["too-large"]
    );
    let many = "(0, 1), ".repeat(5000);
    assert_eq!(
        codes(&format!("(color: (1, 1, 1), opacity: [{many}])")),
        ["too-large"]
    );
    assert_eq!(codes(&" ".repeat(300 << 10)), ["too-large"]);
}

#[test]
fn a_material_runs_between_the_points_that_give_it() {
    let text =
        "(color: (1, 1, 1), opacity: [(0, 1)], material: [(at: 0.2, ambient: 0.1, diffuse: 0.4),
        (at: 0.3, specular: 0.5), (at: 0.4, diffuse: 0.8, shininess: 9), (at: 0.4, diffuse: 0)])";
    let transfer = parse(text).unwrap();
    let default = Material {
        ambient: 0.7,
        diffuse: 0.7,
        specular: 0.7,
        shininess: 70.0,
    };
    let values = |s: f64| {
        let material = transfer.material(s, default);
        [
            material.ambient,
            material.diffuse,
            material.specular,
            material.shininess,
        ]
    };
    // Each for itself: the second point does not bend the diffuse fraction, and single points are constants.
    for (s, diffuse) in [(0.0, 0.4), (0.2, 0.4), (0.3, 0.6), (0.4, 0.0), (1.0, 0.0)] {
        let [ambient, value, specular, shininess] = values(s);
        assert_eq!((ambient, specular, shininess), (0.1, 0.5, 9.0));
        assert!((value - diffuse).abs() < 1e-12, "{s}: {value}");
    }
    let none = parse("(color: (1, 1, 1), opacity: [(0, 1)])").unwrap();
    assert_eq!(none.material(0.5, default), default);
    assert!(transfer.has_material() && !none.has_material());
    // A file that says nothing of it has the text, and so the digest, that it always had.
    assert!(!none.to_ron().contains("material"));
    assert_eq!(
        none.to_ron(),
        transfer
            .to_ron()
            .split("    material")
            .next()
            .unwrap()
            .to_owned()
            + ")\n"
    );
    assert_ne!(none.digest(), transfer.digest());
    assert_eq!(parse(&transfer.to_ron()).unwrap(), transfer);
    // Positions in data units widen the range as others do.
    let data = "(domain: data, color: (1, 1, 1), opacity: [(0, 0), (2, 1)], material: [(at: 5, diffuse: 1)])";
    assert_eq!(parse(data).unwrap().range(), (0.0, 5.0));
}

#[test]
fn everything_wrong_with_a_material_is_found_at_its_place() {
    let text = "(color: (1, 1, 1), opacity: [(0, 1)], material: [
    (at: 0.5, ambient: 1.5, diffuse: -0.1),
    (at: 0.2, specular: NaN),
    (at: 0.9, shininess: 300, shinines: 1),
    (at: 0.9),
    5,
])";
    assert_eq!(
        findings(text),
        [
            ("out-of-range", 2, 24),
            ("out-of-range", 2, 38),
            ("decreasing", 3, 10),
            ("wrong-type", 3, 25),
            ("out-of-range", 4, 26),
            ("unknown-field", 4, 31),
            ("missing-field", 5, 5),
            ("wrong-type", 6, 5),
        ]
    );
    let all = parse(text).unwrap_err().to_string();
    assert!(all.contains("did you mean `shininess`?"), "{all}");
}

#[test]
fn files_are_read_and_missing_ones_named() {
    let path = std::env::temp_dir().join(format!("volgraph-optics-{}.ron", std::process::id()));
    let text = "(color: (1, 1, 1), opacity: [(0, 1)])";
    std::fs::write(&path, text).unwrap();
    let loaded = TransferFunction::load(&path);
    std::fs::write(&path, [0xff, 0xfe, 0x00]).unwrap();
    let binary = TransferFunction::load(&path);
    std::fs::remove_file(&path).unwrap();
    assert_eq!(loaded.unwrap(), parse(text).unwrap());
    for error in [
        binary.unwrap_err(),
        TransferFunction::load(&path).unwrap_err(),
    ] {
        let finding = error.sorted()[0].clone();
        assert_eq!(finding.code, "io");
        assert_eq!(finding.place.unwrap().file, path);
    }
}

#[test]
fn the_post_table_samples_evenly_to_both_ends() {
    let transfer =
        parse("(domain: data, color: (1, 0.5, 0), extinction: [(-10, 0), (30, 8)])").unwrap();
    let table = transfer.post_table(1025).unwrap();
    assert_eq!(table.entries.len(), 1025);
    for (i, entry) in table.entries.iter().enumerate() {
        assert_eq!(entry[..3], [1.0, 0.5, 0.0]);
        assert!(
            (f64::from(entry[3]) - 8.0 * i as f64 / 1024.0).abs() < 1e-6,
            "entry {i}"
        );
    }
    for n in [0, 1, 1023, 8193] {
        assert!(
            matches!(transfer.post_table(n), Err(OpticsError::TableSize { .. })),
            "{n}"
        );
    }
}

#[test]
fn the_refractive_index_is_linear_between_points_and_1_where_none_is_given() {
    let base = "(domain: data, color: (1, 1, 1), opacity: [(0, 0), (1, 1)]";
    let plain = parse(&format!("{base})")).unwrap();
    assert_eq!(plain.refractive_index(0.3), 1.0);
    assert!(!plain.to_ron().contains("refraction"));
    // Its positions widen the range; a step takes the later value.
    let glass = parse(&format!(
        "{base}, refraction: [(-1, 1), (1, 2), (1, 1.5), (3, 1.5)])"
    ))
    .unwrap();
    assert_eq!(glass.range(), (-1.0, 3.0));
    for (s, index) in [(-9.0, 1.0), (0.0, 1.5), (1.0, 1.5), (9.0, 1.5)] {
        assert_eq!(glass.refractive_index(s), index, "at {s}");
    }
    assert_eq!(glass.refraction_span(), Some((-1.0, 1.0)));
    assert_eq!(plain.refraction_span(), None);
    let flat = parse(&format!("{base}, refraction: [(0, 1.5), (1, 1.5)])")).unwrap();
    assert_eq!(flat.refraction_span(), None);
    let table = glass.refraction_table(1025).unwrap();
    assert_eq!((table[0], table[256], table[1024]), (1.0, 1.5, 1.5));
    assert!(matches!(
        glass.refraction_table(7),
        Err(OpticsError::TableSize { .. })
    ));
    for (list, code) in [
        ("[(0, 0.9)]", "out-of-range"),
        ("[(0, 4.1)]", "out-of-range"),
        ("[]", "no-points"),
        ("1.5", "wrong-type"),
        ("[(1, 1.5), (0, 1)]", "decreasing"),
    ] {
        assert_eq!(codes(&format!("{base}, refraction: {list})")), [code]);
    }
}

#[test]
fn reference_lengths_turn_extinction_into_world_units() {
    // Opacity 0.5 for two voxels of 0.25: the same over half a world unit.
    let transfer =
        parse("(color: (1, 1, 1), opacity: [(0, 0.5)], reference_length: (voxels: 2))").unwrap();
    let factor = transfer.reference_length().extinction_per_world(0.25);
    assert!((transfer.extinction(0.0) * factor * 0.5 - 2.0_f64.ln()).abs() < 1e-15);
    assert_eq!(ReferenceLength::World(4.0).extinction_per_world(0.25), 0.25);
}

#[test]
fn the_digest_sees_every_part() {
    let base = "(domain: normalised, reference_length: (voxels: 1), color: (1, 1, 1), opacity: [(0, 0.5)])";
    let digest = |text: &str| parse(text).expect(text).digest();
    for (from, to) in [
        ("normalised", "data(from: 0, to: 1)"),
        ("voxels: 1", "voxels: 2"),
        ("voxels", "world"),
        ("(1, 1, 1)", "(1, 1, 0.5)"),
        ("0.5)", "0.25)"),
        ("opacity", "extinction"),
        ("0.5)]", "0.5)], refraction: [(0, 1)]"),
    ] {
        assert_ne!(
            digest(base),
            digest(&base.replace(from, to)),
            "{from} to {to}"
        );
    }
    assert_eq!(
        digest(base),
        digest(&base.replace("(1, 1, 1)", "\"#ffffff\" /* white */"))
    );
    let with =
        |material: &str| digest(&base.replace("0.5)]", &format!("0.5)], material: [{material}]")));
    let material = with("(at: 0.5, ambient: 0.5)");
    for other in [
        "(at: 0.6, ambient: 0.5)",
        "(at: 0.5, ambient: 0.6)",
        "(at: 0.5, diffuse: 0.5)",
        "(at: 0.5, ambient: 0.5, specular: 0.5)",
    ] {
        assert_ne!(with(other), material, "{other}");
    }
    assert_ne!(digest(base), material);
}
