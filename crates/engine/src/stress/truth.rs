//! What the pixels of a point should be.

use rayon::prelude::*;
use volgraph_nodes::reference::rays;
use volgraph_reference::{Field, Ray, Silent};
use volgraph_report::{Finding, Findings};

use super::case::{Case, Point, Truth};
use super::judge::Pixels;
use super::stand::{Stand, view, volume};
use crate::scene::Scene;
use crate::truth::{TruthOptions, plan_without_device};

/// Far below all bounds.
const TOLERANCE: f64 = 1e-7;

/// The truth of a point.
pub(super) fn of(stand: &mut Stand, case: &Case, point: &Point) -> Result<Pixels, Findings> {
    let size = case.size;
    if let Truth::Picture(sets) = &case.truth {
        let scene = point.scene.clone().with(sets);
        return stand.draw(&scene, size)?.pixels(case.quantity);
    }
    let scene = stand.load(&point.scene)?;
    let values = match &case.truth {
        Truth::Reference => reference(&scene, size)?,
        Truth::FirstCrossing { share } => first_crossings(&scene, size, *share)?,
        Truth::Form(form) => {
            let view = view(&scene, size)?;
            pixels(size)
                .map(|pixel| form(&view, pixel, point.at))
                .collect()
        }
        Truth::Picture(_) => Vec::new(),
    };
    Ok(Pixels { size, values })
}

fn pixels([width, height]: [u32; 2]) -> impl Iterator<Item = [u32; 2]> {
    (0..height).flat_map(move |y| (0..width).map(move |x| [x, y]))
}

fn reference(scene: &Scene, size: [u32; 2]) -> Result<Vec<Option<[f64; 4]>>, Findings> {
    let plan = plan_without_device(scene, size)?;
    let options = TruthOptions {
        tolerance: TOLERANCE,
        cache: None,
    };
    let truth = crate::Truth::of(&plan, &plan.view(), &options, &Silent)?;
    Ok(truth.rendered.color.into_iter().map(Some).collect())
}

/// The share of the data's range that no picture in f32 can tell.
const ROUNDING: f64 = 1e-5;

fn first_crossings(
    scene: &Scene,
    size: [u32; 2],
    share: f64,
) -> Result<Vec<Option<[f64; 4]>>, Findings> {
    let view = view(scene, size)?;
    let volume = volume(scene).ok_or_else(|| Finding::error("internal", "there is no volume"))?;
    let field = Field::new(volume);
    let rays = rays(&view);
    let (low, high) = field.range();
    let level = low + share * (high - low);
    let off = ROUNDING * (high - low);
    let voxel = field.min_spacing();
    let all: Vec<[u32; 2]> = pixels(size).collect();
    Ok(all
        .into_par_iter()
        .map(|[x, y]| {
            let ray = rays.ray(x, y);
            let depth = |level: f64| first_crossing(&field, &ray, level) / voxel;
            let [before, at, behind] = [level - off, level, level + off].map(depth);
            let is_same = |other: f64| other == at || (other - at).abs() < 0.1;
            (is_same(before) && is_same(behind)).then_some([at, 0.0, 0.0, 0.0])
        })
        .collect())
}

/// World distance to where the field reaches a level from below; infinite where it does not.
fn first_crossing(field: &Field, ray: &Ray, level: f64) -> f64 {
    let Some((near, far)) = field.interval(ray) else {
        return f64::INFINITY;
    };
    let inner = Ray {
        origin: ray.at(near),
        ..*ray
    };
    let mut found = f64::INFINITY;
    field.walk(&inner, (0.0, far - near), false, |curve| {
        if curve.at(0.0) >= level {
            found = near + curve.start;
            return true;
        }
        let mut low = 0.0;
        for high in curve.turns().as_slice().iter().copied().chain([1.0]) {
            if curve.at(high) >= level {
                found = near + curve.distance(rise(|w| curve.at(w) - level, low, high));
                return true;
            }
            low = high;
        }
        false
    });
    found
}

/// Where a function that is below 0 at `low` and not at `high`, and rises in between, is 0: halved to the last bit.
fn rise(of: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if of(middle) < 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    high
}
