//! Speed against accuracy of other renderers and of volgraph, as one figure with a panel for each scene.

use std::fs;
use std::path::Path;

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use volgraph::bench::{PEER_VOLUMES, PeerPoint, PeerRow, PeerWork};
use volgraph::methods::front;
use volgraph::{Finding, Findings, Place};

use super::report::Report;
use crate::commands::drawing::{self, Axis, GRID, INK, Labels};

/// Width and height of a panel in SVG units, and of what is above and below all of them.
const PANEL: (u32, u32) = (640, 430);
const HEAD: u32 = 40;
const FOOT: u32 = 82;

/// The renderers in the order of their colours; volgraph is first.
const RENDERERS: [&str; 5] = ["volgraph", "VTK GPU", "VTK fixed-point", "vispy", "pygfx"];

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// A point of a renderer.
#[derive(Clone, Debug, PartialEq)]
struct Point {
    time: f64,
    error: f64,
    /// Its settings.
    label: String,
    /// Whether the processor draws it where a device does as well.
    is_software: bool,
}

impl Point {
    fn place(&self) -> (f64, f64) {
        (self.time, self.error)
    }
}

/// A scene: the points of each renderer.
struct Panel {
    title: String,
    work: PeerWork,
    /// By [`RENDERERS`].
    points: Vec<Vec<Point>>,
}

/// Draws what was measured and writes the file.
///
/// # Errors
/// Where no other renderer was timed, and where the file cannot be written.
pub fn write(report: &Report, file: &Path) -> Result<(), Findings> {
    let svg = figure(report)?;
    fs::write(file, svg).map_err(|error| {
        Finding::error("io", format!("the chart cannot be written: {error}"))
            .at(Place::whole_file(file))
            .help("name a file in a folder that you may write into")
            .into()
    })
}

fn figure(report: &Report) -> Result<String, Findings> {
    let panels = panels(report);
    if panels.is_empty() {
        let failed = report.peers.iter().find_map(|row| row.failed.as_deref());
        let message =
            "no other renderer was timed and held against a truth: there is nothing to chart";
        return Err(Finding::error("peers", message)
            .help(format!(
                "the first said: {}",
                failed.unwrap_or("nothing; a --filter may leave no renderer")
            ))
            .into());
    }
    drawn(report, &panels).map_err(|error| Finding::error("chart", error.to_string()).into())
}

fn panels(report: &Report) -> Vec<Panel> {
    let works = [PeerWork::Dvr, PeerWork::Mip, PeerWork::Isosurface];
    let scenes = works
        .into_iter()
        .flat_map(|work| PEER_VOLUMES.map(|scene| (work, scene)));
    let panels = scenes.map(|(work, (volume, field))| {
        let is_here = |row: &&PeerRow| row.job.work == work && row.volume == volume;
        let rows = report.peers.iter().filter(is_here);
        let mut points = vec![Vec::new(); RENDERERS.len()];
        for row in rows {
            let at = RENDERERS.iter().position(|it| *it == row.job.renderer());
            if let (Some(at), Some(time), Some(error)) = (at, row.frame_ms, row.error) {
                let step = row.job.step;
                points[at].push(Point {
                    time: time.median,
                    error,
                    label: step.map_or_else(|| "fixed step".to_owned(), |step| step.to_string()),
                    is_software: false,
                });
            }
        }
        let own = report.points.iter();
        let own = own.filter(|point| point.work == work && point.volume == volume);
        points[0] = own.filter_map(own_point).collect();
        for points in &mut points {
            points.sort_by(|a, b| a.time.total_cmp(&b.time));
        }
        Panel {
            title: format!("{}, {field}", title(work)),
            work,
            points,
        }
    });
    let has_others = |panel: &Panel| panel.points[1..].iter().any(|points| !points.is_empty());
    panels.filter(has_others).collect()
}

fn title(work: PeerWork) -> &'static str {
    match work {
        PeerWork::Dvr => "Volume rendering",
        PeerWork::Mip => "Maximum intensity projection",
        PeerWork::Isosurface => "Isosurface",
    }
}

fn own_point(point: &PeerPoint) -> Option<Point> {
    let settings = point.method.split(' ').filter_map(|set| {
        let (name, value) = set.split_once('=')?;
        (name != "renderer").then_some(value)
    });
    let software = point.is_software().then_some("software");
    let words: Vec<&str> = software.into_iter().chain(settings).collect();
    Some(Point {
        time: point.frame_ms.median,
        error: point.error?,
        label: words.join(" "),
        is_software: point.is_software(),
    })
}

fn drawn(report: &Report, panels: &[Panel]) -> Result<String, Box<dyn std::error::Error>> {
    let columns = panels.len().min(2);
    let rows = panels.len().div_ceil(columns);
    let size = (
        PANEL.0 * u32::try_from(columns)?,
        PANEL.1 * u32::try_from(rows)? + HEAD + FOOT,
    );
    let mut svg = String::new();
    {
        let root = SVGBackend::with_string(&mut svg, size).into_drawing_area();
        let (head, rest) = root.split_vertically(HEAD);
        let (middle, foot) = rest.split_vertically(size.1 - HEAD - FOOT);
        legend(&head, panels)?;
        for (area, panel) in middle.split_evenly((rows, columns)).iter().zip(panels) {
            let alike = || panels.iter().filter(|other| other.work == panel.work);
            draw_panel(area, panel, axes(alike()))?;
        }
        let text = ("sans-serif", 13).into_font().color(&INK);
        for (line, words) in caption(report).iter().enumerate() {
            foot.draw_text(words, &text, (24, 6 + 18 * i32::try_from(line)?))?;
        }
        root.present()?;
    }
    Ok(drawing::standalone(&svg))
}

/// Names and colours.
fn legend(area: &Area<'_>, panels: &[Panel]) -> Result<(), Box<dyn std::error::Error>> {
    let text = ("sans-serif", 15).into_font().color(&INK);
    let text = text.pos(Pos::new(HPos::Left, VPos::Center));
    let mut x = 24;
    for (number, name) in RENDERERS.into_iter().enumerate() {
        if panels.iter().all(|panel| panel.points[number].is_empty()) {
            continue;
        }
        let color = drawing::color(number);
        area.draw(&Circle::new((x + 6, 22), 6, color.filled()))?;
        let words = if number == 0 {
            "volgraph (hollow: on the processor), its front joined"
        } else {
            name
        };
        area.draw_text(words, &text, (x + 18, 22))?;
        x += 48 + 8 * i32::try_from(words.chars().count())?;
    }
    Ok(())
}

/// The axes of panels of the same work.
fn axes<'p>(panels: impl Iterator<Item = &'p Panel>) -> (Axis, Axis) {
    let mut points = Vec::new();
    let mut bound = None;
    for panel in panels {
        points.extend(panel.points.iter().flatten().map(Point::place));
        bound = panel.work.most_error();
    }
    let errors = points.iter().map(|point| point.1).chain(bound);
    (
        Axis::decades(points.iter().map(|point| point.0), (0.3, 0.16)),
        Axis::decades(errors, (0.08, 0.1)),
    )
}

fn draw_panel(
    area: &Area<'_>,
    panel: &Panel,
    (x, y): (Axis, Axis),
) -> Result<(), Box<dyn std::error::Error>> {
    let text = ("sans-serif", 14).into_font().color(&INK);
    let mut chart = ChartBuilder::on(area)
        .margin(14)
        .margin_top(34)
        .x_label_area_size(42)
        .y_label_area_size(58)
        .build_cartesian_2d(x.clone(), y.clone())?;
    chart
        .configure_mesh()
        .axis_style(INK.stroke_width(1))
        .bold_line_style(GRID.stroke_width(1))
        .light_line_style(TRANSPARENT)
        .x_desc("milliseconds per frame")
        .y_desc("RMSE (1/255)")
        .x_label_formatter(&|value| x.label(*value))
        .y_label_formatter(&|value| y.label(*value))
        .label_style(text.clone())
        .axis_desc_style(text.clone())
        .draw()?;
    let mut labels = Labels::default();
    let ends = [x.range().start, x.range().end];
    if let Some(bound) = panel.work.most_error() {
        let line: Vec<(f64, f64)> = ends.iter().map(|x| (*x, bound)).collect();
        chart.draw_series(DashedLineSeries::new(
            line,
            6,
            5,
            INK.mix(0.55).stroke_width(1),
        ))?;
    }
    let own = &panel.points[0];
    let pairs: Vec<(f64, f64)> = own.iter().map(Point::place).collect();
    let best = front(&pairs);
    for (number, points) in panel.points.iter().enumerate() {
        let color = drawing::color(number);
        let line: Vec<(f64, f64)> = match number {
            0 => best.iter().map(|at| pairs[*at]).collect(),
            _ => points.iter().map(Point::place).collect(),
        };
        chart.draw_series([PathElement::new(line, color.stroke_width(2))])?;
        for (at, point) in points.iter().enumerate() {
            let is_best = number > 0 || best.contains(&at);
            let radius = if is_best { 6 } else { 4 };
            let style = if point.is_software {
                color.stroke_width(2)
            } else if is_best {
                color.filled()
            } else {
                color.mix(0.5).filled()
            };
            chart.draw_series([Circle::new(point.place(), radius, style)])?;
            labels.keep(chart.backend_coord(&point.place()), radius);
        }
    }
    // Names beside the last of each, then settings, where there is room.
    let small = ("sans-serif", 12).into_font().color(&INK);
    let mut write = |words: &str, at: (i32, i32), side: HPos| {
        let Some(place) = labels.place(words, at, side) else {
            return Ok(());
        };
        let place = (
            place.0 - area.get_pixel_range().0.start,
            place.1 - area.get_pixel_range().1.start,
        );
        area.draw_text(words, &small.pos(Pos::new(side, VPos::Center)), place)
    };
    for (number, points) in panel.points.iter().enumerate().skip(1) {
        if let Some(point) = points.first() {
            let words = format!("{} · {}", RENDERERS[number], point.label);
            write(&words, chart.backend_coord(&point.place()), HPos::Right)?;
        }
        for point in points.iter().skip(1) {
            write(
                &point.label,
                chart.backend_coord(&point.place()),
                HPos::Left,
            )?;
        }
    }
    for at in best {
        write(&own[at].label, chart.backend_coord(&pairs[at]), HPos::Right)?;
    }
    let title = ("sans-serif", 16).into_font().color(&INK);
    area.draw_text(
        &panel.title,
        &title.pos(Pos::new(HPos::Left, VPos::Center)),
        (72, 18),
    )?;
    Ok(())
}

/// What the figure is of.
fn caption(report: &Report) -> Vec<String> {
    let mut lines = vec![
        format!(
            "{}, volgraph {}. 128³ bytes into 512 × 512 pixels, each frame read back; medians of frames that renderers draw in turn. Numbers are",
            report.adapter, report.volgraph
        ),
        "steps in voxels. Error: of pictures rounded to 8 bits (which alone makes about 0.29), over pixels whose rays cross 4 voxels or more, against the".to_owned(),
        "float64 reference: of whole voxels, and for VTK, which draws no more, of the box between their centres. Dashed: the error that is asked for.".to_owned(),
    ];
    let failed: Vec<String> = report
        .peers
        .iter()
        .filter(|row| row.failed.is_some())
        .map(|row| format!("{} ({})", row.job.name(), row.volume))
        .collect();
    if !failed.is_empty() {
        lines.push(format!("Not timed: {}.", failed.join(", ")));
    }
    lines
}

#[cfg(test)]
mod tests {
    use volgraph::AdapterSummary;
    use volgraph::bench::{CHART_JOBS, PEER_JOBS};
    use volgraph_measure::timing::Summary;

    use super::*;

    fn report() -> Report {
        let mut report = Report::new(AdapterSummary {
            name: "made up".to_owned(),
            backend: "vulkan".to_owned(),
            class: "software".to_owned(),
            driver: "1.0".to_owned(),
        });
        let ms = |ms: f64| Summary::of(&[ms]).ok();
        for (number, job) in PEER_JOBS.iter().chain(&CHART_JOBS).enumerate() {
            let number = number as f64;
            report.peers.push(PeerRow {
                volume: "c60".to_owned(),
                job: job.clone(),
                error: job
                    .work
                    .most_error()
                    .map(|most| most * (1.5 - 0.05 * number)),
                frame_ms: ms(100.0 + 40.0 * number),
                ratio: None,
                method: String::new(),
                method_error: None,
                method_ms: None,
                failed: None,
            });
        }
        report.peers[1].failed = Some("no display".to_owned());
        report.peers[1].frame_ms = None;
        let point = |method: &str, error: f64, time: f64| PeerPoint {
            volume: "c60".to_owned(),
            work: PeerWork::Dvr,
            method: method.to_owned(),
            error: Some(error),
            frame_ms: ms(time).unwrap(),
        };
        report.points = vec![
            point("renderer=software classify=post step=2", 0.6, 9.0),
            point("classify=post step=1", 0.7, 60.0),
            point("classify=preintegrated_2d step=0.5", 0.3, 200.0),
        ];
        report
    }

    #[test]
    fn a_figure_shows_each_renderer_the_front_and_what_was_not_timed() {
        let report = report();
        let svg = figure(&report).unwrap();
        for words in [
            "Volume rendering, c60",
            "Maximum intensity projection, c60",
            "software post 2",
            "preintegrated_2d 0.5",
            "VTK fixed-point · 1",
            "pygfx · fixed step",
            "Not timed: vtk-gpu-egl/composite/0.5 (c60).",
            "made up",
        ] {
            assert!(svg.contains(words), "{words}: {svg}");
        }
        // What is slower and less exact than another method of volgraph has a point and no name; isosurfaces have no errors.
        assert!(!svg.contains("post 1<") && !svg.contains("Isosurface"));
        let timed = report
            .peers
            .iter()
            .filter(|row| row.error.is_some() && row.frame_ms.is_some());
        // The names above have a circle each.
        assert_eq!(
            svg.matches("<circle").count(),
            timed.count() + report.points.len() + RENDERERS.len()
        );
        assert!(svg.contains("prefers-color-scheme") && !svg.contains("#010101"));
    }

    #[test]
    fn without_other_renderers_there_is_no_figure() {
        let mut report = report();
        for row in &mut report.peers {
            row.frame_ms = None;
            row.failed = Some("no module named vtk".to_owned());
        }
        let finding = figure(&report).unwrap_err().to_string();
        assert!(finding.contains("no other renderer was timed"), "{finding}");
    }
}
