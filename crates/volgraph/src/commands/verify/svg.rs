//! A study as a drawing: errors over steps, both axes logarithmic, one colour for each quantity.

use std::fmt::Write;

use volgraph::verify::{Quantity, Study};
use volgraph_measure::PointRole;

const WIDTH: f64 = 640.0;
const HEIGHT: f64 = 420.0;
const LEFT: f64 = 70.0;
const RIGHT: f64 = 20.0;
const TOP: f64 = 48.0;
const BOTTOM: f64 = 52.0;
/// Told apart by the colour-blind as well (Okabe and Ito).
const COLORS: [&str; 3] = ["#0072b2", "#d55e00", "#009e73"];

/// From logarithms to the drawing.
struct Frame {
    x: (f64, f64),
    y: (f64, f64),
}

impl Frame {
    fn of(study: &Study) -> Option<Self> {
        let points = || {
            let all = study
                .quantities
                .iter()
                .flat_map(|it| &it.convergence.points);
            all.filter(|point| point.error > 0.0)
        };
        let span = |values: &mut dyn Iterator<Item = f64>| {
            values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
                (low.min(value), high.max(value))
            })
        };
        let (x0, x1) = span(&mut points().map(|it| it.step.log10()));
        let (y0, y1) = span(&mut points().map(|it| it.error.log10()));
        let is_there = x0 < x1 && y0.is_finite();
        is_there.then(|| Self {
            x: (x0 - 0.08, x1 + 0.08),
            y: (y0.floor(), y1.ceil().max(y0.floor() + 1.0)),
        })
    }

    fn at(&self, x: f64, y: f64) -> (f64, f64) {
        let (across, up) = (
            (x - self.x.0) / (self.x.1 - self.x.0),
            (y - self.y.0) / (self.y.1 - self.y.0),
        );
        (
            LEFT + across * (WIDTH - LEFT - RIGHT),
            HEIGHT - BOTTOM - up * (HEIGHT - TOP - BOTTOM),
        )
    }
}

/// The drawing.
pub fn study(study: &Study, name: &str) -> String {
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" width=\"{WIDTH}\" height=\"{HEIGHT}\" \
         font-family=\"sans-serif\" font-size=\"12\">\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n\
         <text x=\"{LEFT}\" y=\"18\" font-size=\"14\">{}: error over {}</text>\n",
        escaped(name),
        study.axis.name()
    );
    if let Some(frame) = Frame::of(study) {
        axes(&mut svg, &frame, study);
        for (quantity, color) in study.quantities.iter().zip(COLORS) {
            curve(&mut svg, &frame, quantity, color);
        }
    }
    legend(&mut svg, study);
    svg.push_str("</svg>\n");
    svg
}

// Writing to a String does not fail, here and below.
fn axes(svg: &mut String, frame: &Frame, study: &Study) {
    let (left, bottom) = frame.at(frame.x.0, frame.y.0);
    let (right, top) = frame.at(frame.x.1, frame.y.1);
    for decade in frame.y.0 as i32..=frame.y.1 as i32 {
        let (_, y) = frame.at(frame.x.0, f64::from(decade));
        let _ = writeln!(
            svg,
            "<line x1=\"{left:.1}\" x2=\"{right:.1}\" y1=\"{y:.1}\" y2=\"{y:.1}\" stroke=\"#ddd\"/>\
             <text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">1e{decade}</text>",
            left - 6.0,
            y + 4.0
        );
    }
    let mut steps: Vec<f64> = study
        .quantities
        .iter()
        .flat_map(|it| it.convergence.points.iter().map(|point| point.step))
        .collect();
    steps.sort_by(f64::total_cmp);
    steps.dedup();
    for step in steps {
        let (x, _) = frame.at(step.log10(), frame.y.0);
        let label = format!("{step:.4}");
        let _ = writeln!(
            svg,
            "<line x1=\"{x:.1}\" x2=\"{x:.1}\" y1=\"{top:.1}\" y2=\"{bottom:.1}\" stroke=\"#eee\"/>\
             <text x=\"{x:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>",
            bottom + 18.0,
            label.trim_end_matches('0').trim_end_matches('.')
        );
    }
    let _ = writeln!(
        svg,
        "<rect x=\"{left:.1}\" y=\"{top:.1}\" width=\"{:.1}\" height=\"{:.1}\" fill=\"none\" stroke=\"#444\"/>\
         <text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}, {} (hollow points are not fitted)</text>\
         <text transform=\"translate(16 {:.1}) rotate(-90)\" text-anchor=\"middle\">root mean square error</text>",
        right - left,
        bottom - top,
        0.5 * (left + right),
        HEIGHT - 12.0,
        study.axis.name(),
        study.axis.unit(),
        0.5 * (top + bottom)
    );
}

fn curve(svg: &mut String, frame: &Frame, quantity: &Quantity, color: &str) {
    let fitted: Vec<(f64, f64)> = quantity
        .convergence
        .fitted()
        .map(|point| (point.step.log10(), point.error.log10()))
        .collect();
    if let (Some(order), Some(first), Some(last)) =
        (quantity.convergence.order, fitted.first(), fitted.last())
    {
        let n = fitted.len() as f64;
        let mean = |of: fn(&(f64, f64)) -> f64| fitted.iter().map(of).sum::<f64>() / n;
        let (x, y) = (mean(|it| it.0), mean(|it| it.1));
        let end = |to: f64| frame.at(to, y + order * (to - x));
        let ((x1, y1), (x2, y2)) = (end(first.0), end(last.0));
        let _ = writeln!(
            svg,
            "<line x1=\"{x1:.1}\" y1=\"{y1:.1}\" x2=\"{x2:.1}\" y2=\"{y2:.1}\" stroke=\"{color}\" stroke-width=\"1.5\"/>"
        );
    }
    for point in quantity
        .convergence
        .points
        .iter()
        .filter(|it| it.error > 0.0)
    {
        let (x, y) = frame.at(point.step.log10(), point.error.log10());
        // Points that are not fitted are hollow.
        let fill = if point.role == PointRole::Fitted {
            color
        } else {
            "white"
        };
        let _ = writeln!(
            svg,
            "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"4\" fill=\"{fill}\" stroke=\"{color}\" stroke-width=\"1.5\"/>"
        );
    }
}

fn legend(svg: &mut String, study: &Study) {
    let mut x = LEFT;
    for (quantity, color) in study.quantities.iter().zip(COLORS) {
        let order = match quantity.convergence.order {
            Some(order) => format!("order {order:.2}"),
            None if quantity.convergence.is_exact => "exact to the floor".to_owned(),
            None => "no order told".to_owned(),
        };
        let declared = quantity.declared.as_ref();
        let declared = declared.map_or(String::new(), |it| format!(" (declared {})", it.order));
        let label = format!("{}: {order}{declared}", quantity.name);
        let _ = writeln!(
            svg,
            "<circle cx=\"{:.1}\" cy=\"34\" r=\"4\" fill=\"{color}\"/><text x=\"{:.1}\" y=\"38\">{label}</text>",
            x + 4.0,
            x + 13.0
        );
        x += 26.0 + 6.6 * label.len() as f64;
    }
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}
