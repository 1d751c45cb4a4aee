//! The ray under the cursor: what the walk met along it, with the reference beside: why a pixel has its value.

use egui::{Color32, ScrollArea, Ui};
use egui_plot::{Legend, Line, Plot, PlotPoints, Points};
use volgraph_engine::ray::{ProfilePoint, RaySegment, Status};
use volgraph_engine::{Probe, RayStudy};

use crate::worker::Told;

const WALK: Color32 = Color32::from_rgb(255, 170, 60);
const TRUTH: Color32 = Color32::from_rgb(90, 170, 255);

pub(crate) fn show(ui: &mut Ui, told: &Told) {
    let study = match &told.ray {
        Some(Ok(study)) => study,
        Some(Err(findings)) => return super::messages::findings(ui, findings),
        None if told.is_studying => {
            ui.weak("Walking along the ray…");
            return;
        }
        None => {
            ui.weak("Click into the view to study the ray of a pixel.");
            return;
        }
    };
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        head(ui, study, told.is_studying);
        if study.segments.is_empty() {
            ui.weak("The ray misses the volume.");
            return;
        }
        // Side by side where there is room, so that a low panel shows all of them.
        let columns = if ui.available_width() > 640.0 { 3 } else { 1 };
        let height = match columns {
            3 => (ui.available_height() - 24.0).max(110.0),
            _ => 130.0,
        };
        ui.columns(columns, |columns| {
            let last = columns.len() - 1;
            scalar(&mut columns[0], height, study);
            extinction(&mut columns[last.min(1)], height, study);
            light(&mut columns[last], height, study);
        });
    });
}

/// The reference's value along the ray.
fn truth(study: &RayStudy, value: fn(&ProfilePoint) -> f64) -> Vec<[f64; 2]> {
    let points = study
        .reference
        .as_ref()
        .map_or(&[][..], |profile| &profile.points);
    points
        .iter()
        .map(|point| [point.distance, value(point)])
        .collect()
}

fn scalar(ui: &mut Ui, height: f32, study: &RayStudy) {
    let scalars = ends(study, |segment| segment.scalars);
    plot(ui, "scalar", height, |plot| {
        line(plot, "reference", TRUTH, truth(study, |point| point.scalar));
        line(plot, "walk", WALK, scalars.clone());
        ticks(plot, study, &scalars);
    });
}

fn extinction(ui: &mut Ui, height: f32, study: &RayStudy) {
    plot(ui, "extinction", height, |plot| {
        line(
            plot,
            "reference",
            TRUTH,
            truth(study, |point| point.extinction),
        );
        let walked = steps(study, |segment| {
            segment.extinction.filter(|value| value.is_finite())
        });
        line(plot, "walk", WALK, walked);
    });
}

/// What is left of the light behind, and the colour so far.
fn light(ui: &mut Ui, height: f32, study: &RayStudy) {
    plot(ui, "transmittance and colour", height, |plot| {
        line(
            plot,
            "reference",
            TRUTH,
            truth(study, |point| point.transmittance),
        );
        let left = study.segments.iter().flat_map(|segment| {
            [
                [segment.start, segment.transmittance[0]],
                [segment.end, segment.transmittance[1]],
            ]
        });
        line(plot, "transmittance", WALK, left.collect());
        let channels = [
            Color32::from_rgb(255, 90, 90),
            Color32::from_rgb(90, 220, 90),
            Color32::from_rgb(110, 140, 255),
        ];
        for (channel, (name, color)) in ["red", "green", "blue"]
            .into_iter()
            .zip(channels)
            .enumerate()
        {
            let mut sum = 0.0;
            let so_far = study.segments.iter().map(|segment| {
                sum += segment.contribution[channel];
                [segment.end, sum]
            });
            line(plot, name, color, so_far.collect());
        }
    });
}

fn head(ui: &mut Ui, study: &RayStudy, is_studying: bool) {
    let count = |status: Status| {
        study
            .segments
            .iter()
            .filter(|segment| segment.status == status)
            .count()
    };
    ui.horizontal_wrapped(|ui| {
        ui.strong(format!("pixel {}, {}", study.pixel[0], study.pixel[1]));
        ui.label(format!("{} by {}", study.node, study.technique));
        ui.label(format!(
            "{} segments taken, {} skipped, {} ended, {} samples",
            count(Status::Taken),
            count(Status::Skipped),
            count(Status::Ended),
            study.samples
        ));
        if is_studying {
            ui.spinner();
        }
    });
    ui.horizontal_wrapped(|ui| {
        ui.label(format!("sum {}", numbers(&study.sum())));
        ui.label(format!("over the background {}", numbers(&study.over)));
        ui.label(format!("pixel {}", numbers(&study.picture)));
        if let Some(profile) = &study.reference {
            ui.label(format!("reference {}", numbers(&profile.over)));
        }
        if let Some(error) = study.error() {
            ui.strong(format!("error {error:.2e}"));
        }
        if let Some(why) = &study.no_reference {
            ui.weak(format!("no reference: {why}"));
        }
    });
    for (what, probe) in [("hit", &study.hit), ("strongest", &study.strongest)] {
        if let Some(probe) = probe {
            probed(ui, what, probe);
        }
    }
}

/// What the volume is at a place.
fn probed(ui: &mut Ui, what: &str, probe: &Probe) {
    ui.horizontal_wrapped(|ui| {
        ui.label(format!("{what} at {}", numbers(&probe.world)));
        if let Some(voxel) = probe.voxel {
            ui.label(format!("voxel {voxel:?}"));
        }
        if let Some(value) = probe.value {
            ui.strong(format!("value {value:.5}"));
        }
        if let Some(gradient) = probe.gradient {
            ui.label(format!("gradient {}", numbers(&gradient)));
        }
        if let Some(name) = &probe.label_name {
            ui.label(name);
        }
    });
}

fn numbers(values: &[f64]) -> String {
    let shown: Vec<String> = values.iter().map(|value| format!("{value:.4}")).collect();
    format!("({})", shown.join(", "))
}

/// Values at the ends of the segments that have them.
fn ends(study: &RayStudy, of: impl Fn(&RaySegment) -> Option<[f64; 2]>) -> Vec<[f64; 2]> {
    let segments = study.segments.iter();
    let pairs = segments.filter_map(|segment| {
        of(segment).map(|[front, back]| [[segment.start, front], [segment.end, back]])
    });
    pairs.flatten().collect()
}

/// Values that hold over a segment.
fn steps(study: &RayStudy, of: impl Fn(&RaySegment) -> Option<f64>) -> Vec<[f64; 2]> {
    ends(study, |segment| of(segment).map(|value| [value, value]))
}

fn plot<'a>(
    ui: &mut Ui,
    name: &str,
    height: f32,
    add: impl FnOnce(&mut egui_plot::PlotUi<'a>) + 'a,
) {
    ui.small(name);
    Plot::new(name)
        .height(height)
        .link_axis(egui::Id::unique("ray distance"), [true, false])
        .link_cursor(egui::Id::unique("ray cursor"), [true, false])
        .legend(Legend::default())
        .allow_scroll(false)
        .show(ui, add);
}

fn line(plot: &mut egui_plot::PlotUi<'_>, name: &str, color: Color32, points: Vec<[f64; 2]>) {
    if !points.is_empty() {
        plot.line(Line::new(name.to_owned(), PlotPoints::from(points)).color(color));
    }
}

/// What became of each segment, below the curve.
fn ticks(plot: &mut egui_plot::PlotUi<'_>, study: &RayStudy, values: &[[f64; 2]]) {
    let foot = values
        .iter()
        .map(|[_, value]| *value)
        .fold(f64::INFINITY, f64::min);
    let foot = if foot.is_finite() { foot } else { 0.0 };
    for (status, color) in [
        (Status::Taken, WALK),
        (Status::Skipped, Color32::GRAY),
        (Status::Ended, Color32::RED),
    ] {
        let places = study
            .segments
            .iter()
            .filter(|segment| segment.status == status);
        let places: Vec<[f64; 2]> = places
            .map(|segment| [0.5 * (segment.start + segment.end), foot])
            .collect();
        if !places.is_empty() {
            plot.points(
                Points::new(status.name(), PlotPoints::from(places))
                    .radius(2.0)
                    .color(color),
            );
        }
    }
}
