//! Pictures against a float64 walk along each ray, fine enough to be the truth at these bounds.

use glam::DVec3;
use volgraph::{Picture, View};
use volgraph_optics::TransferFunction;
use volgraph_tests::slabs::{middles, slabs};
use volgraph_tests::{STAGES, adapters, box_interval, open, ray, root};
use volgraph_volume::Volume;
use volgraph_volume::analytic::{AnalyticField, sample};

const SIZE: [u32; 2] = [40, 40];
/// Samples to a voxel of the truth; twice as many change it by less than a hundredth of the bounds below.
const FINE: f64 = 24.0;

/// Emission and absorption of the volume along each ray, by midpoints a fraction of a voxel apart, in float64.
fn truth(volume: &Volume, transfer: &TransferFunction, view: &View) -> Vec<[f64; 4]> {
    let grid = volume.grid();
    let index_from_world = grid.world_from_index.inverse();
    let voxel = grid.min_spacing();
    let pixels = (0..view.size[1]).flat_map(|y| (0..view.size[0]).map(move |x| (x, y)));
    pixels
        .map(|(x, y)| {
            let (origin, direction) = ray(view, x, y);
            let half = DVec3::splat(0.5);
            let Some((near, far)) = box_interval((origin, direction), -half, half) else {
                return [0.0; 4];
            };
            let count = ((far - near) / voxel * FINE).ceil().max(1.0);
            let depth = (far - near) / count / voxel;
            slabs(middles(count as u32).map(|share| {
                let world = origin + direction * (near + share * (far - near));
                let scalar = volume.trilinear(index_from_world.transform_point3(world)) / 255.0;
                (transfer.color(scalar), transfer.extinction(scalar) * depth)
            }))
        })
        .collect()
}

/// Root mean square of the colour's error, of 255, over the pixels whose ray goes through four voxels and more: those
/// of the silhouette are too few to say anything.
fn rmse(picture: &Picture, view: &View, truth: &[[f64; 4]]) -> f64 {
    let mut squares = Vec::new();
    for (at, (pixel, truth)) in (0..).zip(picture.color.iter().zip(truth)) {
        let half = DVec3::splat(0.5 - 0.5 / 128.0);
        let interval = box_interval(ray(view, at % view.size[0], at / view.size[0]), -half, half);
        if interval.is_none_or(|(near, far)| far - near < 4.0 / 128.0) {
            continue;
        }
        squares.extend((0..3).map(|channel| (f64::from(pixel[channel]) - truth[channel]).powi(2)));
    }
    255.0 * (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
}

#[test]
fn the_error_is_what_the_quadrature_makes_and_falls_with_the_step() {
    let graph = root().join("graphs/comparison.ron");
    let text = std::fs::read_to_string(root().join("graphs/transfer/comparison.ron")).unwrap();
    let transfer = TransferFunction::parse("comparison.ron".as_ref(), &text).unwrap();
    for field in ["marschner_lobb", "c60"] {
        let analytic = AnalyticField::by_name(field, &[]).unwrap();
        let volume = sample(&analytic, [128; 3], volgraph_volume::ScalarType::U8).unwrap();
        let set_field = format!("volume.field={field}");
        let mut reference: Option<Vec<[f64; 4]>> = None;
        for backend in adapters() {
            for form in STAGES {
                let stage = format!("image.stage={form}");
                let mut error = |classify: &str, step: f64, more: &[&str]| {
                    let classify = format!("image.slots.classify={classify}");
                    let step = format!("image.step={step}");
                    let mut sets = vec![set_field.as_str(), &stage, &classify, &step];
                    sets.extend(more);
                    let mut session = open(&graph, &sets, &backend, SIZE).unwrap();
                    let picture = session.render().unwrap().0;
                    let view = session.view();
                    rmse(
                        &picture,
                        view,
                        reference.get_or_insert_with(|| truth(&volume, &transfer, view)),
                    )
                };
                let to_the_end = ["image.early_termination=0"];
                for (classify, bounds) in
                    [("post", [0.15, 0.06]), ("preintegrated_2d", [0.35, 0.12])]
                {
                    let errors = [1.0, 0.5].map(|step| error(classify, step, &[]));
                    for (error, bound) in errors.iter().zip(bounds) {
                        assert!(
                            error <= &bound,
                            "{field} {backend} {form} {classify}: {errors:?}"
                        );
                    }
                    // The two forms run the same walk (see `agreement`), so the order is looked at once.
                    if form != STAGES[0] {
                        continue;
                    }
                    // Both are of order 2: half of the step is a quarter of the error, give or take the noise of
                    // pixels, once early termination is no floor any more.
                    let errors = [1.0, 0.5].map(|step| error(classify, step, &to_the_end));
                    let ratio = errors[0] / errors[1];
                    assert!(
                        (2.5..6.0).contains(&ratio),
                        "{field} {backend} {form} {classify}: {errors:?}"
                    );
                }
                assert!(
                    form != STAGES[0] || error("post", 4.0, &to_the_end) > 0.3,
                    "a step of four voxels must be seen to be wrong"
                );
            }
        }
    }
}
