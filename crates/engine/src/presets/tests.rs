//! What presets come to, and how volumes are known.

use std::path::Path;

use glam::DVec3;
use volgraph_volume::Grid;

use super::*;

fn volume(values: Vec<f32>) -> Volume {
    let grid = Grid::axis_aligned([values.len() as u32, 1, 1], DVec3::ONE, DVec3::ZERO);
    Volume::new("v", grid, values.into()).unwrap()
}

/// Half air, a third tissue, the rest bone.
fn ct(offset: f32) -> Volume {
    let value = |i: u16| match i % 6 {
        0..3 => -1000.0 + f32::from(i % 7),
        3 | 4 => 40.0,
        _ => 900.0,
    };
    volume((0..600).map(|i| value(i) + offset).collect())
}

fn parse(text: &str) -> TransferFunction {
    TransferFunction::parse(Path::new("t.ron"), text).unwrap_or_else(|found| panic!("{found}"))
}

#[test]
fn hounsfield_units_are_known_by_air_and_water() {
    assert_eq!(hounsfield_offset(&ct(0.0)), Some(0.0));
    assert_eq!(hounsfield_offset(&ct(1024.0)), Some(1024.0));
    assert_eq!(hounsfield_offset(&volume(vec![0.0, 100.0, 255.0])), None);
    let bone = preset("ct-bone").unwrap();
    assert_eq!(
        bone.text(&volume(vec![0.0, 255.0])).unwrap_err().code,
        "not-hounsfield"
    );
    let [plain, stored] = [0.0, 1024.0].map(|offset| parse(&bone.text(&ct(offset)).unwrap()));
    for at in [-900.0, -250.0, 300.0, 700.0] {
        assert_eq!(plain.extinction(at), stored.extinction(at + 1024.0));
    }
}

#[test]
fn every_preset_is_a_transfer_function_of_any_volume() {
    let volumes = [
        ct(0.0),
        volume(vec![7.0]),
        volume(vec![f32::NAN, f32::NAN]),
        volume(vec![0.0, 1e-30]),
        volume(vec![-3e28, 3e28]),
        volume((0..99).map(|i| (i * i) as f32).collect()),
    ];
    for preset in presets() {
        assert!(super::preset(preset.name) == Ok(preset));
        for volume in &volumes {
            match preset.text(volume) {
                Ok(text) => assert_eq!(parse(&text), parse(&parse(&text).to_ron())),
                Err(finding) => assert_eq!(finding.code, "not-hounsfield"),
            }
        }
    }
    assert_eq!(
        super::preset("ct-bones").unwrap_err().code,
        "unknown-preset"
    );
}

#[test]
fn a_share_is_what_is_counted() {
    let volume = volume((0..1000).map(|i| i as f32).collect());
    let transfer = parse(
        "(domain: data, color: (1, 1, 1), opacity: [(0, 0), (750, 0), (750, 0.5), (999, 0.5)])",
    );
    let share = |bins| visible_share(&volume, &volume.histogram(bins), &transfer);
    assert!((share(1000) - 0.25).abs() < 2e-3, "{}", share(1000));
    assert!((share(10) - 0.25).abs() < 2e-2, "{}", share(10));
    let clear = parse("(domain: range, color: (1, 1, 1), opacity: [(0, 0), (1, 0)])");
    assert_eq!(visible_share(&volume, &volume.histogram(16), &clear), 0.0);
}

#[test]
fn two_heaps_are_parted_between_them() {
    let heap = |i: i32| {
        if i % 4 == 0 {
            80.0 + (i % 9) as f32
        } else {
            (i % 11) as f32
        }
    };
    let (low, high) = foreground(&volume((0..4000).map(heap).collect()));
    assert!((10.0..80.0).contains(&low) && high >= 87.0, "{low} {high}");
}

#[test]
fn only_what_comes_before_the_content_is_leading() {
    assert_eq!(
        leading_comments("// a\n\n// b\n(x: 1) // c\n"),
        "// a\n\n// b\n"
    );
    assert_eq!(leading_comments("(\n// a\n)"), "");
}
