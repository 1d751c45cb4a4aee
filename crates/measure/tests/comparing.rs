//! Each figure, on pictures whose difference is known; and each seen to react to what it is there for.

#![expect(clippy::unwrap_used, reason = "a test that cannot go on may panic")]

use volgraph_measure::{
    Channel, MeasureError, WorstPixel, WorstValue, compare, compare_without_flip, flip_mean,
};
use volgraph_picture::{Layer, LayerValues, Picture};

fn filled(width: u32, height: u32, color: [f32; 4]) -> Picture {
    Picture::from_color(width, height, vec![color; (width * height) as usize]).unwrap()
}

const GRAY: [f32; 4] = [0.25, 0.25, 0.25, 1.0];

#[test]
fn equal_pictures_have_no_difference() {
    let mut picture = filled(40, 30, GRAY);
    picture.depth = Some(vec![f32::INFINITY; 1200]);
    picture.opacity = Some(vec![0.5; 1200]);
    let comparison = compare(&picture, &picture).unwrap();
    assert_eq!(
        (comparison.rmse, comparison.p999, comparison.max.error),
        (0.0, 0.0, 0.0)
    );
    assert_eq!(comparison.psnr_db, f64::INFINITY);
    assert_eq!(comparison.mean_error, [0.0; 4]);
    assert_eq!(comparison.flip, Some(0.0));
    let depth = comparison.depth.unwrap();
    assert_eq!(
        (depth.compared, depth.one_sided, depth.rmse, depth.max),
        (0, 0, 0.0, None)
    );
    assert_eq!(comparison.opacity.unwrap().compared, 1200);
}

#[test]
fn one_wrong_component_is_found_with_its_place() {
    let truth = filled(50, 40, GRAY);
    let mut picture = truth.clone();
    picture.color[7 * 50 + 13][2] -= 0.125;
    let comparison = compare_without_flip(&picture, &truth).unwrap();
    assert_eq!(
        comparison.max,
        WorstPixel {
            error: 0.125,
            x: 13,
            y: 7,
            channel: Channel::Blue
        }
    );
    assert!((comparison.rmse - 0.125 / 8000.0_f64.sqrt()).abs() < 1e-15);
    assert!((comparison.mean_error[2] + 0.125 / 2000.0).abs() < 1e-15);
    assert_eq!(comparison.mean_error[0], 0.0);
    // One pixel of 2000 is inside the 0.1 % that the percentile leaves out (2 pixels), three are not.
    assert_eq!(comparison.p999, 0.0);
    picture.color[0][3] = 0.5;
    picture.color[1][0] = 0.75;
    let comparison = compare_without_flip(&picture, &truth).unwrap();
    assert_eq!(comparison.p999, 0.125);
    assert_eq!(comparison.max.error, 0.5);
    assert_eq!(comparison.max.channel, Channel::Alpha);
}

#[test]
fn an_even_offset_has_known_figures() {
    let truth = filled(20, 20, GRAY);
    let picture = filled(20, 20, GRAY.map(|c| c + 0.125));
    let comparison = compare_without_flip(&picture, &truth).unwrap();
    assert!((comparison.rmse - 0.125).abs() < 1e-15);
    assert!((comparison.psnr_db - 18.061_799_739_838_87).abs() < 1e-12);
    assert_eq!(
        (comparison.p999, comparison.mean_error),
        (0.125, [0.125; 4])
    );
    let swapped = compare_without_flip(&truth, &picture).unwrap();
    assert_eq!(swapped.mean_error, [-0.125; 4]);
}

#[test]
fn flip_spans_0_to_1_and_sees_what_people_see() {
    let (black, white) = (
        filled(64, 64, [0.0, 0.0, 0.0, 1.0]),
        filled(64, 64, [1.0; 4]),
    );
    let flip = |a: &Picture, b: &Picture| flip_mean(a, b).unwrap().unwrap();
    assert_eq!(flip(&white, &white), 0.0);
    let most = flip(&white, &black);
    println!("white against black: {most}");
    assert!((0.95..=1.0).contains(&most), "{most}");
    // A stripe is seen, a shift of one code in one channel hardly, and a larger error more than a smaller one.
    let stripe = |value: f32| {
        let mut picture = filled(64, 64, GRAY);
        for y in 0..64 {
            picture.color[y * 64 + 32] = [value, value, value, 1.0];
        }
        picture
    };
    let gray = filled(64, 64, GRAY);
    let (faint, strong) = (flip(&stripe(0.3), &gray), flip(&stripe(0.9), &gray));
    println!("stripes: {faint}, {strong}");
    assert!(
        0.001 < faint && faint < strong && strong < 0.5,
        "{faint} {strong}"
    );
    let shifted = filled(64, 64, [0.2525, 0.25, 0.25, 1.0]);
    assert!(flip(&shifted, &gray) < 0.03);
    // Alpha alone does not show over black.
    assert_eq!(flip(&filled(64, 64, [0.25, 0.25, 0.25, 0.5]), &gray), 0.0);
    assert!(flip(&filled(1, 1, GRAY), &filled(1, 1, [0.0; 4])) > 0.1);
}

#[test]
fn depth_and_opacity_are_compared_where_both_have_them() {
    let mut truth = filled(3, 2, GRAY);
    let mut picture = truth.clone();
    truth.depth = Some(vec![1.0, 2.0, f32::INFINITY, f32::INFINITY, 3.0, 4.0]);
    assert_eq!(compare_without_flip(&picture, &truth).unwrap().depth, None);
    picture.depth = Some(vec![1.0, 2.5, f32::INFINITY, 7.0, 2.0, f32::NEG_INFINITY]);
    picture.opacity = Some(vec![0.5; 6]);
    truth.opacity = Some(vec![0.25; 6]);
    let comparison = compare_without_flip(&picture, &truth).unwrap();
    let depth = comparison.depth.unwrap();
    assert_eq!((depth.compared, depth.one_sided), (3, 2));
    assert_eq!(
        depth.max,
        Some(WorstValue {
            error: 1.0,
            x: 1,
            y: 1
        })
    );
    assert!((depth.rmse - (1.25_f64 / 3.0).sqrt()).abs() < 1e-15);
    assert!((depth.mean_error + 0.5 / 3.0).abs() < 1e-15);
    assert_eq!(depth.p999, 1.0);
    let opacity = comparison.opacity.unwrap();
    assert_eq!((opacity.rmse, opacity.mean_error), (0.25, 0.25));
}

#[test]
fn what_is_not_a_number_is_never_passed_over() {
    let good = filled(4, 4, GRAY);
    for value in [f32::NAN, f32::INFINITY] {
        let mut bad = good.clone();
        bad.color[6][1] = value;
        bad.color[9][3] = value;
        for (a, b, counts) in [
            (&bad, &good, (2, 0)),
            (&good, &bad, (0, 2)),
            (&bad, &bad, (2, 2)),
        ] {
            match compare(a, b).unwrap_err() {
                MeasureError::NotANumber {
                    buffer,
                    in_a,
                    in_b,
                    x: 2,
                    y: 1,
                } => {
                    assert_eq!((&*buffer, (in_a, in_b)), ("colour", counts));
                }
                other => panic!("{other}"),
            }
        }
    }
    let mut deep = good.clone();
    deep.depth = Some(vec![1.0; 16]);
    let mut bad = deep.clone();
    bad.depth.as_mut().unwrap()[3] = f32::NAN;
    let told = compare(&deep, &bad).unwrap_err();
    assert!(
        matches!(&told, MeasureError::NotANumber { buffer, in_b: 1, x: 3, y: 0, .. } if buffer == "depth"),
        "{told}"
    );
    // A layer of vectors is told by its name, and by the pixel.
    let mut layered = good;
    layered.layers.push(Layer {
        name: "normal".to_owned(),
        values: LayerValues::Vector(vec![[0.5; 4]; 16]),
    });
    let mut bad = layered.clone();
    bad.layers[0].values = LayerValues::Vector({
        let mut values = vec![[0.5; 4]; 16];
        values[7][2] = f32::NAN;
        values
    });
    let told = compare(&layered, &bad).unwrap_err();
    assert!(
        matches!(&told, MeasureError::NotANumber { buffer, x: 3, y: 1, .. } if buffer == "normal"),
        "{told}"
    );
}

#[test]
fn different_sizes_and_broken_pictures_are_errors() {
    let error = compare(&filled(4, 3, GRAY), &filled(3, 4, GRAY)).unwrap_err();
    assert!(matches!(
        error,
        MeasureError::Sizes {
            a: (4, 3),
            b: (3, 4)
        }
    ));
    assert!(error.to_string().contains("4 × 3 and 3 × 4"), "{error}");
    let mut broken = filled(4, 3, GRAY);
    broken.color.pop();
    assert!(matches!(
        compare(&broken, &filled(4, 3, GRAY)),
        Err(MeasureError::Picture(_))
    ));
    assert!(matches!(
        compare(&Picture::default(), &Picture::default()),
        Err(MeasureError::Picture(_))
    ));
}

#[test]
fn a_comparison_serialises() {
    let comparison = compare(&filled(8, 8, GRAY), &filled(8, 8, GRAY)).unwrap();
    let json = serde_json::to_value(&comparison).unwrap();
    assert_eq!(json["rmse"], 0.0);
    assert_eq!(json["psnr_db"], serde_json::Value::Null);
    assert_eq!(json["max"]["channel"], "red");
}
