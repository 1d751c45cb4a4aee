//! Errors over what is swept, as a drawing (SVG).

use plotters::prelude::*;
use volgraph::Finding;
use volgraph::stress::CaseReport;

/// Width and height of a drawing.
const SIZE: (u32, u32) = (460, 260);

/// Told apart also by those who see red and green alike (Okabe and Ito 2008).
const COLORS: [RGBColor; 8] = [
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
    RGBColor(0, 158, 115),
    RGBColor(240, 228, 66),
    RGBColor(204, 121, 167),
    RGBColor(213, 94, 0),
    RGBColor(160, 160, 160),
    RGBColor(120, 120, 255),
];

const INK: RGBColor = RGBColor(216, 220, 224);
const FAINT: RGBColor = RGBColor(60, 66, 72);

/// The colour of a method, as in the drawing.
pub fn color(method: usize) -> String {
    let RGBColor(r, g, b) = COLORS[method % COLORS.len()];
    format!("rgb({r},{g},{b})")
}

/// The drawing: the logarithm of each method's largest error over the swept number, and thin what it may be; a cross where
/// it has holes or worse.
pub fn svg(report: &CaseReport) -> Result<String, Finding> {
    draw(report)
        .map_err(|error| Finding::error("internal", format!("a curve cannot be drawn: {error}")))
}

fn draw(report: &CaseReport) -> Result<String, Box<dyn std::error::Error>> {
    let place = |at: usize| {
        if is_number_line(report) {
            report.at[at].log10()
        } else {
            at as f64
        }
    };
    let last = report.at.len().saturating_sub(1);
    let (a, b) = (place(0), place(last));
    let margin = 0.06 * (b - a).abs().max(0.5);
    let xs = a.min(b) - margin..a.max(b) + margin;
    let height = |value: f64| value.max(1e-9).log10();
    let errors = report
        .methods
        .iter()
        .flat_map(|method| &method.points)
        .flat_map(|measured| [measured.error, measured.bound])
        .filter(|value| value.is_finite() && *value > 0.0)
        .map(height);
    let (mut low, mut high) = errors.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), it| {
        (low.min(it), high.max(it))
    });
    if low > high {
        (low, high) = (-6.0, 0.0);
    }
    let mut text = String::new();
    {
        let area = SVGBackend::with_string(&mut text, SIZE).into_drawing_area();
        let mut chart = ChartBuilder::on(&area)
            .margin(8)
            .x_label_area_size(34)
            .y_label_area_size(52)
            .build_cartesian_2d(xs, (low - 0.3).floor()..(high + 0.3).ceil())?;
        let label = |x: f64| {
            let near =
                (0..=last).min_by(|a, b| (place(*a) - x).abs().total_cmp(&(place(*b) - x).abs()));
            match near {
                _ if is_number_line(report) => short(10.0_f64.powf(x)),
                Some(at) if (place(at) - x).abs() < 1e-6 => format!("{}", at + 1),
                _ => String::new(),
            }
        };
        chart
            .configure_mesh()
            .axis_style(INK)
            .bold_line_style(FAINT)
            .light_line_style(TRANSPARENT)
            .label_style(("sans-serif", 12).into_font().color(&INK))
            .x_labels(report.at.len().clamp(2, 8))
            .y_labels(6)
            .x_label_formatter(&|x| label(*x))
            .y_label_formatter(&|y| {
                let is_whole = (y - y.round()).abs() < 1e-3;
                if is_whole {
                    format!("1e{y:.0}")
                } else {
                    String::new()
                }
            })
            .x_desc(report.swept)
            .y_desc(format!("error ({})", report.unit))
            .draw()?;
        for (number, method) in report.methods.iter().enumerate() {
            let color = COLORS[number % COLORS.len()];
            let drawn = |at: &usize| method.points[*at].refused.is_none();
            let line = (0..=last)
                .filter(drawn)
                .map(|at| (place(at), height(method.points[at].error)));
            let path = PathElement::new(line.clone().collect::<Vec<_>>(), color.stroke_width(2));
            chart.draw_series([path])?;
            chart.draw_series(line.map(|point| Circle::new(point, 3, color.filled())))?;
            let bounds = (0..=last)
                .filter(|at| method.points[*at].bound.is_finite())
                .map(|at| (place(at), height(method.points[at].bound)));
            let path =
                PathElement::new(bounds.collect::<Vec<_>>(), color.mix(0.45).stroke_width(1));
            chart.draw_series([path])?;
            let crosses = (0..=last)
                .filter(|at| {
                    let it = &method.points[*at];
                    it.holes + it.phantoms + it.specks + it.non_finite > 0
                })
                .map(|at| {
                    Cross::new(
                        (place(at), height(method.points[at].error)),
                        6,
                        color.stroke_width(2),
                    )
                });
            chart.draw_series(crosses)?;
        }
        area.present()?;
    }
    Ok(text)
}

/// Whether the swept numbers are sizes, and no mere names.
fn is_number_line(report: &CaseReport) -> bool {
    report.at.iter().all(|at| *at > 0.0)
        && report
            .at
            .iter()
            .zip(&report.labels)
            .all(|(at, label)| label.parse() == Ok(*at) || *label == format!("{at:e}"))
}

fn short(value: f64) -> String {
    if (0.01..10_000.0).contains(&value) {
        let text = format!("{value:.3}");
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        format!("{value:.0e}")
    }
}
