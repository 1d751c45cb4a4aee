//! The plot of a ray: four panels over the distance, the walk as steps and the reference as thin lines beside it.
//!
//! Below the panels each segment is a tick: what was taken stands upright, what was skipped is an open box, what had ended
//! is a crossed one.

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use volgraph::ray::Status;
use volgraph::{Finding, Findings, RayStudy};

use crate::commands::drawing::{self, GRID, INK};

/// Width and height in SVG units.
const SIZE: (u32, u32) = (980, 940);
/// Heights of a panel and of what is above and below all.
const PANEL: u32 = 196;
const HEAD: u32 = 44;
const LEFT: u32 = 84;

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Drawn = Result<(), Box<dyn std::error::Error>>;
type Line = Vec<(f64, f64)>;

/// A curve of a panel: the walk's and the reference's.
struct Pair {
    name: &'static str,
    color: RGBColor,
    walk: Vec<Line>,
    truth: Vec<Line>,
}

/// One quantity over the distance.
struct Panel {
    title: &'static str,
    pairs: Vec<Pair>,
}

/// The plot as an SVG file.
///
/// # Errors
/// What the drawing library refused.
pub fn draw(study: &RayStudy) -> Result<String, Findings> {
    drawn(study)
        .map(|svg| drawing::standalone(&svg))
        .map_err(|error| Finding::error("drawing", error.to_string()).into())
}

fn drawn(study: &RayStudy) -> Result<String, Box<dyn std::error::Error>> {
    let mut svg = String::new();
    {
        let area = SVGBackend::with_string(&mut svg, SIZE).into_drawing_area();
        let [x, y] = study.pixel;
        let middle = Pos::new(HPos::Left, VPos::Center);
        let title = ("sans-serif", 16).into_font().color(&INK).pos(middle);
        let text = format!("pixel {x}, {y}: {} ({})", study.node, study.technique);
        area.draw_text(&text, &title, (LEFT as i32, 18))?;
        let small = ("sans-serif", 13).into_font().color(&INK).pos(middle);
        if let Some([near, far]) = study.interval {
            let end = study.segments.iter().map(|it| it.end).fold(far, f64::max);
            let note = match (&study.reference, &study.no_reference) {
                (Some(_), _) => "thick: the walk; thin, in ink: the reference in float64",
                _ => "the walk; there is no reference of it",
            };
            area.draw_text(note, &small, (LEFT as i32, 36))?;
            for (number, panel) in (0..).zip(panels(study)) {
                let top = HEAD + number * PANEL;
                let place = area.clone().shrink((0, top), (SIZE.0, PANEL));
                panel.draw(&place, (near, end))?;
            }
            let place = area.clone().shrink((0, HEAD + 4 * PANEL), (SIZE.0, 100));
            ticks(study, &place, (near, end))?;
        } else {
            area.draw_text("the ray misses the volume", &small, (LEFT as i32, 60))?;
        }
        area.present()?;
    }
    Ok(svg)
}

/// What the reference says, as one line.
fn truth(study: &RayStudy, value: impl Fn(&volgraph::ray::ProfilePoint) -> f64) -> Vec<Line> {
    let points = study.reference.iter().flat_map(|it| &it.points);
    let line = points.map(|point| (point.distance, value(point)));
    vec![line.filter(|(_, value)| value.is_finite()).collect()]
}

fn panels(study: &RayStudy) -> Vec<Panel> {
    let taken = || {
        study
            .segments
            .iter()
            .filter(|it| it.status == Status::Taken)
    };
    let scalars = taken().filter_map(|it| {
        let [front, back] = it.scalars?;
        Some(vec![(it.start, front), (it.end, back)])
    });
    let extinctions = taken().filter_map(|it| {
        let value = it.extinction.filter(|value| value.is_finite())?;
        Some(vec![(it.start, value), (it.end, value)])
    });
    let through = study.segments.iter();
    let through = through.flat_map(|it| {
        [
            (it.start, it.transmittance[0]),
            (it.end, it.transmittance[1]),
        ]
    });
    let channels = [
        ("red", RGBColor(0xd6, 0x3a, 0x3a)),
        ("green", RGBColor(0x2e, 0x9e, 0x4f)),
        ("blue", RGBColor(0x3b, 0x6f, 0xd8)),
    ];
    let colors = channels
        .into_iter()
        .enumerate()
        .map(|(channel, (name, color))| {
            let mut sum = 0.0;
            let mut line = Line::new();
            for segment in &study.segments {
                line.push((segment.start, sum));
                sum += segment.contribution[channel];
                line.push((segment.end, sum));
            }
            Pair {
                name,
                color,
                walk: vec![line],
                truth: truth(study, |point| point.color[channel]),
            }
        });
    let one = |color: usize, walk: Vec<Line>, truth: Vec<Line>| {
        vec![Pair {
            name: "",
            color: drawing::color(color),
            walk,
            truth,
        }]
    };
    vec![
        Panel {
            title: "scalar",
            pairs: one(0, scalars.collect(), truth(study, |point| point.scalar)),
        },
        Panel {
            title: "extinction per unit",
            pairs: one(1, extinctions.collect(), truth(study, |it| it.extinction)),
        },
        Panel {
            title: "transmittance",
            pairs: one(
                2,
                vec![through.collect()],
                truth(study, |it| it.transmittance),
            ),
        },
        Panel {
            title: "colour so far",
            pairs: colors.collect(),
        },
    ]
}

impl Panel {
    fn draw(&self, area: &Area<'_>, (near, far): (f64, f64)) -> Drawn {
        let lines = self
            .pairs
            .iter()
            .flat_map(|it| it.walk.iter().chain(&it.truth));
        let values = lines.flatten().map(|point| point.1);
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
            (low.min(value), high.max(value))
        });
        let (low, high) = if low <= high { (low, high) } else { (0.0, 1.0) };
        let room = 0.06 * (high - low).max(1e-9 * high.abs()).max(1e-12);
        let mut chart = ChartBuilder::on(area)
            .margin_left(14)
            .margin_right(20)
            .margin_top(8)
            .x_label_area_size(22)
            .y_label_area_size(LEFT - 14)
            .build_cartesian_2d(near..far, low - room..high + room)?;
        let text = ("sans-serif", 12).into_font().color(&INK);
        chart
            .configure_mesh()
            .axis_style(INK.stroke_width(1))
            .bold_line_style(GRID.stroke_width(1))
            .light_line_style(TRANSPARENT)
            .label_style(text.clone())
            .axis_desc_style(("sans-serif", 14).into_font().color(&INK))
            .y_desc(self.title)
            .y_labels(5)
            .x_labels(9)
            .y_label_formatter(&|value| label(*value))
            .x_label_formatter(&|value| label(*value))
            .draw()?;
        for pair in &self.pairs {
            for line in &pair.walk {
                let style = pair.color.mix(0.85).stroke_width(3);
                chart.draw_series([PathElement::new(line.clone(), style)])?;
            }
        }
        for line in self.pairs.iter().flat_map(|pair| &pair.truth) {
            chart.draw_series([PathElement::new(line.clone(), INK.stroke_width(1))])?;
        }
        let named = self.pairs.iter().filter(|pair| !pair.name.is_empty());
        for (number, pair) in (0..).zip(named) {
            let place = (LEFT as i32 + 14, 22 + 16 * number);
            let left = Pos::new(HPos::Left, VPos::Center);
            area.draw(&Circle::new(place, 4, pair.color.filled()))?;
            area.draw_text(pair.name, &text.pos(left), (place.0 + 10, place.1))?;
        }
        Ok(())
    }
}

/// The stretches of the walk, each in its status' mark.
fn ticks(study: &RayStudy, area: &Area<'_>, (near, far): (f64, f64)) -> Drawn {
    let (left, right) = (LEFT as i32, SIZE.0 as i32 - 20);
    let place = |distance: f64| {
        let part = ((distance - near) / (far - near)).clamp(0.0, 1.0);
        #[expect(clippy::cast_possible_truncation, reason = "pixels")]
        let at = (part * f64::from(right - left)).round() as i32;
        left + at
    };
    let text = ("sans-serif", 12).into_font().color(&INK);
    let style = text.pos(Pos::new(HPos::Left, VPos::Center));
    let (top, bottom) = (8, 28);
    let (taken, skipped, ended) = (drawing::color(0), drawing::color(4), drawing::color(3));
    for segment in &study.segments {
        let (from, to) = (place(segment.start), place(segment.end));
        match segment.status {
            Status::Taken => {
                let tick = vec![(from, top), (from, bottom)];
                area.draw(&PathElement::new(tick, taken.stroke_width(1)))?;
                area.draw(&PathElement::new(
                    vec![(from, bottom), (to, bottom)],
                    taken.stroke_width(1),
                ))?;
            }
            Status::Skipped => open_box(area, (from, to), (top + 5, bottom - 5), skipped)?,
            Status::Ended => {
                open_box(area, (from, to), (top, bottom), ended)?;
                for line in [[(from, top), (to, bottom)], [(from, bottom), (to, top)]] {
                    area.draw(&PathElement::new(line.to_vec(), ended.stroke_width(1)))?;
                }
            }
        }
    }
    let mut at = left;
    for (color, status, what) in [
        (taken, Status::Taken, "sampled"),
        (
            skipped,
            Status::Skipped,
            "leapt over: nothing is seen there",
        ),
        (ended, Status::Ended, "early ray termination"),
    ] {
        let count = study
            .segments
            .iter()
            .filter(|it| it.status == status)
            .count();
        let label = format!("{count} {} ({what})", status.name());
        area.draw(&Rectangle::new([(at, 46), (at + 10, 56)], color.filled()))?;
        area.draw_text(&label, &style, (at + 16, 51))?;
        at += 40 + 7 * label.chars().count() as i32;
    }
    let what = "world distance from the ray's origin";
    let right = text.pos(Pos::new(HPos::Left, VPos::Center));
    area.draw_text(what, &right, (left, 76))?;
    Ok(())
}

fn open_box(area: &Area<'_>, x: (i32, i32), y: (i32, i32), color: RGBColor) -> Drawn {
    let corners = [(x.0, y.0), (x.1, y.1)];
    area.draw(&Rectangle::new(corners, color.mix(0.25).filled()))?;
    area.draw(&Rectangle::new(corners, color.stroke_width(1)))?;
    Ok(())
}

/// A number in few digits.
fn label(value: f64) -> String {
    if value.abs() < 1e-12 {
        "0".to_owned()
    } else if (1e-3..1e5).contains(&value.abs()) {
        format!("{}", (value * 1e4).round() / 1e4)
    } else {
        format!("{value:.1e}")
    }
}
