//! A study as a drawing: errors over steps, one colour for each quantity; points that are not fitted are hollow.

use volgraph::Finding;
use volgraph::verify::{Quantity, Study};
use volgraph_measure::PointRole;

use crate::commands::drawing::{Axis, Curve, Drawing, Mark, standalone};

/// The drawing.
///
/// # Errors
/// What the drawing library refused.
pub fn study(study: &Study, name: &str) -> Result<String, Finding> {
    let points = study
        .quantities
        .iter()
        .flat_map(|it| &it.convergence.points);
    let steps: Vec<f64> = points.map(|point| point.step).collect();
    let drawing = Drawing {
        size: (640, 420),
        title: &format!("{name}: error over {}", study.axis.name()),
        x: &format!(
            "{}, {} (hollow points are not fitted)",
            study.axis.name(),
            study.axis.unit()
        ),
        y: "root mean square error",
        axis: Axis::values(&steps),
        curves: study.quantities.iter().map(curve).collect(),
    };
    Ok(standalone(&drawing.svg()?))
}

fn curve(quantity: &Quantity) -> Curve {
    let convergence = &quantity.convergence;
    let order = quantity.order_said();
    let declared = quantity.declared.as_ref();
    let declared = declared.map_or(String::new(), |it| format!(" (declared {})", it.order));
    let points = convergence.points.iter().map(|point| {
        let mark = match point.role {
            PointRole::Fitted => Mark::Full,
            _ => Mark::Hollow,
        };
        (point.step, point.error, mark)
    });
    Curve {
        name: format!("{}: {order}{declared}", quantity.name),
        points: points.collect(),
        is_joined: false,
        lines: fit(quantity).into_iter().collect(),
    }
}

/// The fitted line, from the first of its points to the last.
fn fit(quantity: &Quantity) -> Option<Vec<(f64, f64)>> {
    let order = quantity.convergence.order?;
    let fitted: Vec<(f64, f64)> = quantity
        .convergence
        .fitted()
        .map(|point| (point.step.ln(), point.error.ln()))
        .collect();
    let n = fitted.len() as f64;
    let mean = |of: fn(&(f64, f64)) -> f64| fitted.iter().map(of).sum::<f64>() / n;
    let (x, y) = (mean(|it| it.0), mean(|it| it.1));
    let end = |(at, _): &(f64, f64)| (at.exp(), (y + order * (at - x)).exp());
    Some(vec![end(fitted.first()?), end(fitted.last()?)])
}
