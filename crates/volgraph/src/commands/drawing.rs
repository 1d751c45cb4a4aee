//! Curves as SVG, over logarithmic or named axes, in the reader's light or dark colours.
//!
//! Ink and grid are drawn in two colours that nothing else has, and replaced by what the page around a drawing says
//! ([`inline`]) or by a style sheet of its own ([`standalone`]).

mod labels;

use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use volgraph::Finding;

pub use self::labels::Labels;

pub const INK: RGBColor = RGBColor(1, 1, 1);
pub const GRID: RGBColor = RGBColor(2, 2, 2);

/// Colours that are told apart in light and dark and by the colour-blind (Okabe and Ito 2008, and two more).
const COLORS: [RGBColor; 8] = [
    RGBColor(0x2f, 0x86, 0xc8),
    RGBColor(0xd5, 0x5e, 0x00),
    RGBColor(0x00, 0x9e, 0x73),
    RGBColor(0xcc, 0x79, 0xa7),
    RGBColor(0xe6, 0x9f, 0x00),
    RGBColor(0x8a, 0x6f, 0xdf),
    RGBColor(0x56, 0xb4, 0xe9),
    RGBColor(0x99, 0x99, 0x33),
];

const STYLE: &str = "<style>
svg { color: #1b1f24; --grid: #dde1e6; background: #ffffff; font-family: system-ui, sans-serif; }
@media (prefers-color-scheme: dark) { svg { color: #d8dce0; --grid: #353a41; background: #191c20; } }
text { font-family: system-ui, sans-serif; stroke: none; }
</style>
";

/// The colour of a curve by its number.
pub fn color(number: usize) -> RGBColor {
    COLORS[number % COLORS.len()]
}

/// The same as CSS writes it.
pub fn css(number: usize) -> String {
    let RGBColor(r, g, b) = color(number);
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// A drawing for a page: in the colour of the text around it.
pub fn inline(svg: &str) -> String {
    svg.replace("\"#010101\"", "\"currentColor\"")
        .replace("\"#020202\"", "\"var(--grid, #8885)\"")
}

/// A drawing for a file.
pub fn standalone(svg: &str) -> String {
    inline(svg).replacen('>', &format!(">\n{STYLE}"), 1)
}

/// An axis with its own places for lines and labels.
#[derive(Clone)]
pub struct Axis {
    low: f64,
    high: f64,
    is_logarithmic: bool,
    marks: Vec<(f64, String)>,
}

impl Axis {
    /// Tens around the values above 0, with so much room at both ends as a part of the whole.
    pub fn decades(values: impl Iterator<Item = f64>, room: (f64, f64)) -> Self {
        let mut axis = Self::around(values, room);
        let decades = (axis.high / axis.low).log10();
        let parts: &[f64] = if decades < 2.2 {
            &[1.0, 2.0, 5.0]
        } else {
            &[1.0]
        };
        #[expect(clippy::cast_possible_truncation, reason = "exponents are small")]
        let (first, last) = (
            axis.low.log10().floor() as i32,
            axis.high.log10().ceil() as i32,
        );
        let marks = (first..=last)
            .flat_map(|exponent| parts.iter().map(move |part| part * 10_f64.powi(exponent)));
        axis.marks = marks
            .filter(|mark| (axis.low..=axis.high).contains(mark))
            .map(|mark| (mark, short(mark)))
            .collect();
        axis
    }

    /// The values above 0, each with a mark.
    pub fn values(values: &[f64]) -> Self {
        let mut axis = Self::around(values.iter().copied(), (0.06, 0.06));
        axis.marks = values.iter().map(|value| (*value, short(*value))).collect();
        axis.marks.sort_by(|a, b| a.0.total_cmp(&b.0));
        axis.marks.dedup_by(|a, b| a.0 == b.0);
        axis
    }

    /// Whole numbers from 1 on, in place of what has no size.
    pub fn numbers(count: usize) -> Self {
        Self {
            low: 0.5,
            high: count as f64 + 0.5,
            is_logarithmic: false,
            marks: (1..=count).map(|at| (at as f64, at.to_string())).collect(),
        }
    }

    fn around(values: impl Iterator<Item = f64>, room: (f64, f64)) -> Self {
        let (low, high) = values
            .filter(|value| *value > 0.0 && value.is_finite())
            .fold((f64::INFINITY, 0.0_f64), |(low, high), value| {
                (low.min(value), high.max(value))
            });
        let (low, high) = if low <= high { (low, high) } else { (1.0, 1.0) };
        // At least a factor of three is seen.
        let span = (high / low).log10().max(0.5);
        let middle = 0.5 * (high.log10() + low.log10());
        let (from, to) = (middle - 0.5 * span, middle + 0.5 * span);
        Self {
            low: 10_f64.powf(from - room.0 * span),
            high: 10_f64.powf(to + room.1 * span),
            is_logarithmic: true,
            marks: Vec::new(),
        }
    }

    /// The label of the mark at a place.
    pub fn label(&self, at: f64) -> String {
        let mark = self.marks.iter().find(|(mark, _)| *mark == at);
        mark.map_or_else(String::new, |(_, label)| label.clone())
    }

    fn part(&self, value: f64) -> f64 {
        if self.is_logarithmic {
            (value.max(self.low) / self.low).log10() / (self.high / self.low).log10()
        } else {
            (value - self.low) / (self.high - self.low)
        }
    }
}

impl Ranged for Axis {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, (from, to): (i32, i32)) -> i32 {
        #[expect(clippy::cast_possible_truncation, reason = "pixels")]
        let at = (f64::from(to - from) * self.part(*value)).round() as i32;
        from + at
    }

    fn key_points<Hint: KeyPointHint>(&self, _hint: Hint) -> Vec<f64> {
        self.marks.iter().map(|(mark, _)| *mark).collect()
    }

    fn range(&self) -> std::ops::Range<f64> {
        self.low..self.high
    }
}

// Labels are asked of the axis itself.
impl ValueFormatter<f64> for Axis {
    fn format(value: &f64) -> String {
        short(*value)
    }
}

/// A number in few digits.
pub fn short(value: f64) -> String {
    if (0.001..10_000.0).contains(&value) {
        format!("{}", (value * 1e6).round() / 1e6)
    } else {
        format!("{value:.0e}")
    }
}

/// How a point is shown.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Mark {
    /// A point like the others.
    Full,
    /// One that does not count.
    Hollow,
    /// One where something is wrong.
    Cross,
}

/// A curve.
pub struct Curve {
    /// What it is, beside its colour above the drawing; the page says so where it is empty.
    pub name: String,
    /// Its points in their order.
    pub points: Vec<(f64, f64, Mark)>,
    /// Whether a line goes through them.
    pub is_joined: bool,
    /// Thin lines that belong to it: a bound, a slope.
    pub lines: Vec<Vec<(f64, f64)>>,
}

/// Curves over an axis; the other one has decades.
pub struct Drawing<'d> {
    /// Width and height in SVG units.
    pub size: (u32, u32),
    /// Above the drawing, where it is not empty.
    pub title: &'d str,
    /// What is along the horizontal axis.
    pub x: &'d str,
    /// What is along the vertical one.
    pub y: &'d str,
    /// The horizontal axis.
    pub axis: Axis,
    /// The curves, each in the colour of its number.
    pub curves: Vec<Curve>,
}

impl Drawing<'_> {
    /// The SVG text, for [`inline`] or [`standalone`].
    ///
    /// # Errors
    /// What the drawing library refused.
    pub fn svg(&self) -> Result<String, Finding> {
        self.drawn()
            .map_err(|error| Finding::error("drawing", format!("a curve cannot be drawn: {error}")))
    }

    fn drawn(&self) -> Result<String, Box<dyn std::error::Error>> {
        let heights = self.curves.iter().flat_map(|curve| {
            let lines = curve.lines.iter().flatten().map(|point| point.1);
            curve.points.iter().map(|point| point.1).chain(lines)
        });
        let vertical = Axis::decades(heights, (0.1, 0.1));
        let mut svg = String::new();
        {
            let area = SVGBackend::with_string(&mut svg, self.size).into_drawing_area();
            let text = ("sans-serif", 12).into_font().color(&INK);
            let names = self.curves.iter().filter(|curve| !curve.name.is_empty());
            let head = u32::from(!self.title.is_empty()) + names.count() as u32;
            let mut chart = ChartBuilder::on(&area)
                .margin(8)
                .margin_right(20)
                .margin_top(8 + 18 * head)
                .x_label_area_size(36)
                .y_label_area_size(58)
                .build_cartesian_2d(self.axis.clone(), vertical.clone())?;
            chart
                .configure_mesh()
                .axis_style(INK.stroke_width(1))
                .bold_line_style(GRID.stroke_width(1))
                .light_line_style(TRANSPARENT)
                .label_style(text.clone())
                .x_label_formatter(&|x| self.axis.label(*x))
                .y_label_formatter(&|y| vertical.label(*y))
                .x_desc(self.x)
                .y_desc(self.y)
                .draw()?;
            for (number, curve) in self.curves.iter().enumerate() {
                let color = color(number);
                for line in &curve.lines {
                    let style = color.mix(0.55).stroke_width(1);
                    chart.draw_series([PathElement::new(line.clone(), style)])?;
                }
                let points = || curve.points.iter().filter(|point| point.1 > 0.0);
                if curve.is_joined {
                    let line: Vec<(f64, f64)> = points().map(|(x, y, _)| (*x, *y)).collect();
                    chart.draw_series([PathElement::new(line, color.stroke_width(2))])?;
                }
                for (x, y, mark) in points() {
                    let at = (*x, *y);
                    match mark {
                        Mark::Full => chart.draw_series([Circle::new(at, 3, color.filled())])?,
                        Mark::Hollow => {
                            chart.draw_series([Circle::new(at, 4, color.stroke_width(2))])?
                        }
                        Mark::Cross => {
                            chart.draw_series([Cross::new(at, 6, color.stroke_width(2))])?;
                            chart.draw_series([Circle::new(at, 3, color.filled())])?
                        }
                    };
                }
            }
            let middle = Pos::new(HPos::Left, VPos::Center);
            let mut y = 14;
            if !self.title.is_empty() {
                let title = ("sans-serif", 14).into_font().color(&INK).pos(middle);
                area.draw_text(self.title, &title, (66, y))?;
                y += 18;
            }
            for (number, curve) in self.curves.iter().enumerate() {
                if !curve.name.is_empty() {
                    area.draw(&Circle::new((72, y), 4, color(number).filled()))?;
                    area.draw_text(&curve.name, &text.pos(middle), (84, y))?;
                    y += 18;
                }
            }
            area.present()?;
        }
        Ok(svg)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decades_map_and_mark_evenly() {
        let axis = Axis {
            low: 1e-4,
            high: 1.0,
            ..Axis::decades([1e-4, 1.0].into_iter(), (0.0, 0.0))
        };
        assert_eq!(
            [1e-4, 1e-3, 1e-2, 0.1, 1.0, 0.0].map(|value| axis.map(&value, (0, 400))),
            [0, 100, 200, 300, 400, 0]
        );
        let marks: Vec<String> = Axis::decades([1e-4, 1.0].into_iter(), (0.01, 0.01))
            .marks
            .into_iter()
            .map(|(_, label)| label)
            .collect();
        assert_eq!(marks, ["1e-4", "0.001", "0.01", "0.1", "1"]);
        // One value, and none that can be drawn.
        for values in [vec![3.0], vec![0.0], vec![]] {
            let axis = Axis::decades(values.into_iter(), (0.1, 0.1));
            assert!(axis.low < axis.high && axis.low > 0.0);
        }
    }

    #[test]
    fn a_drawing_has_its_points_and_says_what_they_are() {
        let drawing = Drawing {
            size: (420, 260),
            title: "a < b",
            x: "step",
            y: "rmse",
            axis: Axis::values(&[1.0, 0.5, 0.25]),
            curves: vec![Curve {
                name: "colour: order 2".to_owned(),
                points: vec![
                    (1.0, 0.1, Mark::Full),
                    (0.5, 0.025, Mark::Cross),
                    (0.25, 0.0, Mark::Hollow),
                ],
                is_joined: true,
                lines: vec![vec![(1.0, 0.1), (0.25, 0.00625)]],
            }],
        };
        let svg = drawing.svg().unwrap();
        // Nothing at 0 on a logarithmic axis; the third circle is that beside the name.
        assert_eq!(svg.matches("<circle").count(), 3, "{svg}");
        assert!(
            svg.contains("colour: order 2") && svg.contains("a &lt; b"),
            "{svg}"
        );
        assert!(svg.contains("0.25") && svg.contains("rmse"), "{svg}");
        let page = inline(&svg);
        assert!(
            !page.contains("#010101") && page.contains("currentColor"),
            "{page}"
        );
        assert!(!page.contains("<style>") && standalone(&svg).contains("<style>"));
    }
}
