//! A study as a plot of characters: both axes logarithmic, the fitted line in dots.

use volgraph_measure::{Convergence, PointRole};

const COLUMNS: usize = 49;
const ROWS: usize = 11;

/// The plot, in lines; empty where there is nothing to plot.
pub fn text(convergence: &Convergence, unit: &str) -> String {
    let points: Vec<(f64, f64, PointRole)> = convergence
        .points
        .iter()
        .filter(|point| point.error > 0.0)
        .map(|point| (point.step.log10(), point.error.log10(), point.role))
        .collect();
    if points.len() < 2 {
        return String::new();
    }
    let span = |values: Vec<f64>| {
        let low = values.iter().copied().fold(f64::INFINITY, f64::min);
        let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        (low, (high - low).max(1e-3))
    };
    let (x0, width) = span(points.iter().map(|it| it.0).collect());
    let (y0, height) = span(points.iter().map(|it| it.1).collect());
    let column = |x: f64| ((x - x0) / width * (COLUMNS - 1) as f64).round() as usize;
    let row = |y: f64| (ROWS - 1) as f64 - ((y - y0) / height * (ROWS - 1) as f64).round();
    let mut cells = vec![[' '; COLUMNS]; ROWS];
    let fitted: Vec<_> = points
        .iter()
        .filter(|it| it.2 == PointRole::Fitted)
        .collect();
    if let (Some(order), false) = (convergence.order, fitted.is_empty()) {
        let n = fitted.len() as f64;
        let x = fitted.iter().map(|it| it.0).sum::<f64>() / n;
        let y = fitted.iter().map(|it| it.1).sum::<f64>() / n;
        let place = |at: usize| x0 + width * at as f64 / (COLUMNS - 1) as f64;
        let line = (0..COLUMNS).map(|at| (at, row(y + order * (place(at) - x))));
        for (at, row) in line.filter(|(_, row)| (0.0..ROWS as f64).contains(row)) {
            cells[row as usize][at] = '·';
        }
    }
    for (x, y, role) in &points {
        cells[row(*y) as usize][column(*x)] = match role {
            PointRole::Fitted => '●',
            PointRole::Floor => '-',
            PointRole::Coarse => '○',
        };
    }
    let mut text = String::new();
    for (at, line) in cells.iter().enumerate() {
        let label = match at {
            0 => format!("{:8.1e}", 10_f64.powf(y0 + height)),
            _ if at == ROWS - 1 => format!("{:8.1e}", 10_f64.powf(y0)),
            _ => String::new(),
        };
        let line: String = line.iter().collect();
        text.push_str(&format!("  {label:>8} │{}\n", line.trim_end()));
    }
    let least = 10_f64.powf(x0);
    let most = format!("{:.4} {unit}", 10_f64.powf(x0 + width));
    text.push_str(&format!("  {:8} └{}\n", "", "─".repeat(COLUMNS)));
    text.push_str(&format!("  {:8}  {:<20.4}{most:>29}\n", "", least));
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_lie_on_the_plot_and_on_their_line() {
        let errors = [0.4, 0.1, 0.025, 1e-7, 1e-7];
        let steps = [1.0, 0.5, 0.25, 0.125, 0.0625];
        let plot = text(&Convergence::of(&steps, &errors, 1e-7, 1e-5), "voxels");
        let count = |c: char| plot.chars().filter(|it| *it == c).count();
        assert_eq!((count('●'), count('-')), (3, 2 + 2), "{plot}");
        assert!(count('·') > 10, "{plot}");
        assert!(
            plot.contains("4.0e-1") && plot.contains("1.0000 voxels"),
            "{plot}"
        );
        // Nothing to plot, nothing plotted: zeros have no logarithm.
        assert_eq!(
            text(&Convergence::of(&steps, &[0.0; 5], 1e-7, 1e-5), "voxels"),
            ""
        );
    }
}
