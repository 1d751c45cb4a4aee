//! Curves as SVG: errors over a parameter, both logarithmic, with the slope of an order to hold them against.

use anyhow::anyhow;
use plotters::prelude::{
    ChartBuilder, Circle, IntoDrawingArea, LineSeries, RGBColor, SVGBackend, Text,
};
use plotters::style::{Color, IntoFont};

const SIZE: (u32, u32) = (420, 260);
const INK: RGBColor = RGBColor(216, 220, 224);
const FAINT: RGBColor = RGBColor(90, 98, 106);
const LINE: RGBColor = RGBColor(110, 180, 255);
const SLOPE: RGBColor = RGBColor(230, 160, 80);

/// A curve over a parameter.
pub struct Plot<'p> {
    /// What is along the horizontal axis.
    pub x: &'p str,
    /// What is along the vertical one.
    pub y: &'p str,
    pub points: &'p [(f64, f64)],
    /// The order whose slope is drawn through the last point.
    pub order: Option<f64>,
    /// A bound that is drawn as a level line.
    pub bound: Option<f64>,
}

/// The curve as an SVG element; `None` where there are fewer than two values above 0.
pub fn svg(plot: &Plot<'_>) -> anyhow::Result<Option<String>> {
    let is_shown = |(x, y): &&(f64, f64)| *x > 0.0 && *y > 0.0 && x.is_finite() && y.is_finite();
    let points: Vec<(f64, f64)> = plot.points.iter().filter(is_shown).copied().collect();
    if points.len() < 2 {
        return Ok(None);
    }
    let mut text = String::new();
    draw(plot, &points, &mut text).map_err(|why| anyhow!("a chart cannot be drawn: {why}"))?;
    Ok(Some(text))
}

/// A value of a parameter with three digits.
fn short(value: f64) -> String {
    let digits = (2.0 - value.abs().log10().floor()).clamp(0.0, 9.0);
    let scale = 10_f64.powf(digits);
    format!("{}", (value * scale).round() / scale)
}

fn draw(plot: &Plot<'_>, points: &[(f64, f64)], text: &mut String) -> Result<(), String> {
    let fail = |error: &dyn std::fmt::Display| error.to_string();
    // Both axes are logarithmic: powers of two of what is halved along, powers of ten up.
    let points: Vec<(f64, f64)> = points.iter().map(|(x, y)| (x.log2(), y.log10())).collect();
    let last = points
        .iter()
        .copied()
        .reduce(|a, b| if b.0 < a.0 { b } else { a })
        .unwrap_or_default();
    let ends = |pick: fn(&(f64, f64)) -> f64| {
        let values = || points.iter().map(pick);
        (
            values().fold(f64::INFINITY, f64::min),
            values().fold(f64::NEG_INFINITY, f64::max),
        )
    };
    let (x, y) = (ends(|point| point.0), ends(|point| point.1));
    let bound = plot.bound.filter(|bound| *bound > 0.0).map(f64::log10);
    let low = bound.map_or(y.0, |bound| y.0.min(bound)) - 0.3;
    let high = bound.map_or(y.1, |bound| y.1.max(bound)) + 0.3;
    let area = SVGBackend::with_string(text, SIZE).into_drawing_area();
    let mut chart = ChartBuilder::on(&area)
        .margin(8)
        .margin_right(20)
        .x_label_area_size(34)
        .y_label_area_size(64)
        .build_cartesian_2d(x.0 - 0.3..x.1 + 0.3, low..high)
        .map_err(|error| fail(&error))?;
    let style = ("sans-serif", 12).into_font().color(&INK);
    chart
        .configure_mesh()
        .disable_mesh()
        .axis_style(FAINT)
        .label_style(style.clone())
        .x_desc(plot.x)
        .y_desc(plot.y)
        .x_labels(6)
        .y_labels(6)
        .x_label_formatter(&|value| short(value.exp2()))
        .y_label_formatter(&|value| format!("{:.1e}", 10_f64.powf(*value)))
        .draw()
        .map_err(|error| fail(&error))?;
    if let Some(order) = plot.order {
        // Through the last point, as far as the chart goes.
        let at = |x: f64| (x, last.1 + (x - last.0) * order * 2_f64.log10());
        let line = [at(x.0), at(x.1)];
        let line = line.into_iter().map(|(x, y)| (x, y.clamp(low, high)));
        let slope = LineSeries::new(line, SLOPE.stroke_width(1));
        chart.draw_series(slope).map_err(|error| fail(&error))?;
        let (label_x, label_y) = at(0.5 * (x.0 + x.1));
        let label = Text::new(
            format!("order {order}"),
            (label_x, (label_y - 0.2).clamp(low, high)),
            ("sans-serif", 12).into_font().color(&SLOPE),
        );
        chart.draw_series([label]).map_err(|error| fail(&error))?;
    }
    if let Some(bound) = bound {
        let level = LineSeries::new([(x.0, bound), (x.1, bound)], SLOPE.stroke_width(1));
        chart.draw_series(level).map_err(|error| fail(&error))?;
    }
    let line = LineSeries::new(points.iter().copied(), LINE.stroke_width(2));
    chart.draw_series(line).map_err(|error| fail(&error))?;
    let dots = points
        .iter()
        .map(|point| Circle::new(*point, 3, LINE.filled()));
    chart.draw_series(dots).map_err(|error| fail(&error))?;
    area.present().map_err(|error| fail(&error))?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_has_its_points_and_none_without_two() {
        let points = [(1.0, 0.1), (0.5, 0.025), (0.25, 0.0)];
        let mut plot = Plot {
            x: "image.step",
            y: "rmse <b>",
            points: &points,
            order: Some(2.0),
            bound: Some(0.01),
        };
        let text = svg(&plot).unwrap().unwrap();
        assert_eq!(text.matches("<circle").count(), 2);
        assert!(
            text.contains("order 2") && text.contains("rmse &lt;b&gt;"),
            "{text}"
        );
        plot.points = &points[1..];
        assert!(svg(&plot).unwrap().is_none());
    }
}
