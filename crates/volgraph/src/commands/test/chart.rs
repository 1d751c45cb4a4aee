//! Curves of cases: errors over a parameter, with the slope of an order or the bound that they are held against.

use volgraph::Findings;

use crate::commands::drawing::{Axis, Curve, Drawing, Mark, inline};

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
///
/// # Errors
/// What the drawing library refused.
pub fn svg(plot: &Plot<'_>) -> Result<Option<String>, Findings> {
    let is_shown = |(x, y): &&(f64, f64)| *x > 0.0 && *y > 0.0 && x.is_finite() && y.is_finite();
    let points: Vec<(f64, f64)> = plot.points.iter().filter(is_shown).copied().collect();
    let by_x = |a: &&(f64, f64), b: &&(f64, f64)| a.0.total_cmp(&b.0);
    let (Some(&first), Some(&last)) = (points.iter().min_by(by_x), points.iter().max_by(by_x))
    else {
        return Ok(None);
    };
    if points.len() < 2 {
        return Ok(None);
    }
    let ends = |at: &dyn Fn(f64) -> f64| vec![(first.0, at(first.0)), (last.0, at(last.0))];
    let slope = plot
        .order
        .map(|order| ends(&|x| first.1 * (x / first.0).powf(order)));
    let level = plot.bound.filter(|bound| *bound > 0.0);
    let level = level.map(|bound| ends(&|_| bound));
    let name = |what: &str, value: Option<f64>| value.map(|value| format!("thin: {what} {value}"));
    let thin = name("order", plot.order).or_else(|| name("bound", plot.bound));
    let steps: Vec<f64> = points.iter().map(|point| point.0).collect();
    let drawing = Drawing {
        size: (420, 260),
        title: "",
        x: plot.x,
        y: plot.y,
        axis: Axis::values(&steps),
        curves: vec![Curve {
            name: thin.unwrap_or_default(),
            points: points.iter().map(|(x, y)| (*x, *y, Mark::Full)).collect(),
            is_joined: true,
            lines: slope.into_iter().chain(level).collect(),
        }],
    };
    Ok(Some(inline(&drawing.svg()?)))
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
            bound: None,
        };
        let text = svg(&plot).unwrap().unwrap();
        // One more beside the words.
        assert_eq!(text.matches("<circle").count(), 2 + 1);
        assert!(
            text.contains("order 2") && text.contains("rmse &lt;b&gt;"),
            "{text}"
        );
        plot.points = &points[1..];
        assert!(svg(&plot).unwrap().is_none());
    }
}
