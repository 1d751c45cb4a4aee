//! The chart: error over time, both logarithmic, as SVG.

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use volgraph::methods::Method;
use volgraph::renderer::RENDERER;
use volgraph::{Finding, Findings};

use crate::commands::drawing::{self, Axis, GRID, INK, Labels};

use super::exhibit::{Exhibit, Metric};

/// Width and height in SVG units.
pub const SIZE: (u32, u32) = (980, 640);

/// A chart.
pub struct Plot {
    /// The drawing.
    pub svg: String,
    /// Where each measurement is in it.
    pub places: Vec<(i32, i32)>,
    /// The axis that colours stand for, and its values with their colours as CSS writes them.
    pub colors: (String, Vec<(String, String)>),
}

/// Draws the chart of an exhibit.
pub fn draw(exhibit: &Exhibit) -> Result<Plot, Findings> {
    plotted(exhibit).map_err(|error| Finding::error("chart", error.to_string()).into())
}

fn plotted(exhibit: &Exhibit) -> Result<Plot, Box<dyn std::error::Error>> {
    let metric = exhibit.metric();
    let measured = &exhibit.survey.measured;
    let front = exhibit.front();
    let errors = measured.iter().map(|it| metric.of(it));
    let rounded = measured.iter().map(|it| metric.of_rounded(it));
    let rounded = rounded.filter(|_| metric == Metric::CoreSteps);
    let peers = exhibit
        .others
        .peers
        .iter()
        .map(|peer| peer.core_rmse_8bit_steps);
    let times = measured.iter().map(|it| it.steady_ms);
    let peer_times = exhibit.others.peers.iter().map(|peer| peer.median_ms);
    // Labels are left of the front, and right of peers.
    let right = if exhibit.others.peers.is_empty() {
        0.08
    } else {
        0.24
    };
    let x = Axis::decades(times.chain(peer_times), (0.24, right));
    let y = Axis::decades(errors.chain(rounded).chain(peers), (0.12, 0.07));
    let (group, colors) = groups(exhibit);

    let mut svg = String::new();
    let places = {
        let area = SVGBackend::with_string(&mut svg, SIZE).into_drawing_area();
        let mut chart = ChartBuilder::on(&area)
            .margin(16)
            .x_label_area_size(48)
            .y_label_area_size(76)
            .build_cartesian_2d(x.clone(), y.clone())?;
        let title = match metric {
            Metric::Rmse => "root mean squared error (linear, 1 is white)",
            Metric::CoreSteps => "root mean squared error of core pixels (8-bit steps)",
        };
        let text = ("sans-serif", 15).into_font().color(&INK);
        chart
            .configure_mesh()
            .axis_style(INK.stroke_width(1))
            .bold_line_style(GRID.stroke_width(1))
            .light_line_style(TRANSPARENT)
            .x_desc("milliseconds per frame, read back")
            .y_desc(title)
            .x_label_formatter(&|value| x.label(*value))
            .y_label_formatter(&|value| y.label(*value))
            .label_style(text.clone())
            .axis_desc_style(text.clone())
            .draw()?;
        let at = |i: usize| (measured[i].steady_ms, metric.of(&measured[i]));
        let color = |i: usize| {
            let value = group_of(&measured[i].method, &group);
            let known = colors.iter().position(|known| *known == value);
            drawing::color(known.unwrap_or(0))
        };
        if metric == Metric::CoreSteps {
            // The same methods with pictures rounded to 8 bits: a thin line up from each of the front.
            for i in &front {
                let (time, error) = at(*i);
                let high = metric.of_rounded(&measured[*i]);
                chart.draw_series([PathElement::new(
                    vec![(time, error), (time, high)],
                    color(*i).mix(0.7).stroke_width(1),
                )])?;
                chart.draw_series([Circle::new((time, high), 4, color(*i).stroke_width(2))])?;
            }
        }
        chart.draw_series([PathElement::new(
            front.iter().map(|i| at(*i)).collect::<Vec<_>>(),
            INK.mix(0.45).stroke_width(1),
        )])?;
        for i in (0..measured.len()).filter(|i| !front.contains(i)) {
            chart.draw_series([Circle::new(at(i), 4, color(i).mix(0.6).filled())])?;
        }
        for i in &front {
            chart.draw_series([Circle::new(at(*i), 6, color(*i).filled())])?;
        }
        if !measured.is_empty() {
            chart.draw_series([Circle::new(at(0), 10, INK.stroke_width(1))])?;
        }
        let peer_at = |i: usize| {
            let peer = &exhibit.others.peers[i];
            (peer.median_ms, peer.core_rmse_8bit_steps)
        };
        for i in 0..exhibit.others.peers.len() {
            chart.draw_series([Cross::new(peer_at(i), 6, INK.stroke_width(2))])?;
        }
        let places: Vec<(i32, i32)> = (0..measured.len())
            .map(|i| chart.backend_coord(&at(i)))
            .collect();
        let peer_places: Vec<(i32, i32)> = (0..exhibit.others.peers.len())
            .map(|i| chart.backend_coord(&peer_at(i)))
            .collect();
        // Labels last, over everything, where there is room.
        let mut labels = Labels::default();
        for place in places.iter().enumerate().filter(|(i, _)| front.contains(i)) {
            labels.keep(*place.1, 7);
        }
        let small = ("sans-serif", 13).into_font().color(&INK);
        let axes = labelled_axes(exhibit, &front);
        for i in &front {
            let label = exhibit.label(&measured[*i], &axes);
            if let Some(place) = labels.place(&label, places[*i], HPos::Right) {
                let style = small.pos(Pos::new(HPos::Right, VPos::Center));
                area.draw_text(&label, &style, place)?;
            }
        }
        for (i, peer) in exhibit.others.peers.iter().enumerate() {
            let label = format!("{} · {}", peer.name, peer.step);
            if let Some(place) = labels.place(&label, peer_places[i], HPos::Left) {
                let style = small.pos(Pos::new(HPos::Left, VPos::Center));
                area.draw_text(&label, &style, place)?;
            }
        }
        area.present()?;
        places
    };
    let legend = colors.iter().enumerate();
    let legend = legend.map(|(i, value)| (value.clone(), drawing::css(i)));
    Ok(Plot {
        svg: drawing::standalone(&svg),
        places,
        colors: (group, legend.collect()),
    })
}

/// The axis that colours stand for, and its values: the classification, or else the first that varies.
fn groups(exhibit: &Exhibit) -> (String, Vec<String>) {
    let varied = exhibit.varied();
    let group = ["classify"]
        .into_iter()
        .find(|name| varied.contains(name))
        .or(varied.first().copied())
        .unwrap_or("classify");
    let axes = exhibit.space.axes.iter().filter(|axis| axis.name == group);
    let values = axes.flat_map(|axis| {
        let values = axis.values.iter();
        values.map(|value| group_name(&value.to_string(), axis.is_software))
    });
    (group.to_owned(), values.collect())
}

fn group_name(value: &str, is_software: bool) -> String {
    let software = if is_software { "software " } else { "" };
    format!("{software}{value}")
}

/// The group of a method: what the software raycaster draws is one of its own.
fn group_of(method: &Method, group: &str) -> String {
    group_name(
        &method.text(group),
        method.is_software() && group != RENDERER,
    )
}

/// The axes on which methods of the front differ.
fn labelled_axes<'e>(exhibit: &'e Exhibit, front: &[usize]) -> Vec<&'e str> {
    let value = |i: &usize, axis: &str| exhibit.survey.measured[*i].method.text(axis);
    let mut axes = exhibit.varied();
    axes.retain(|axis| {
        let first = front.first().map(|i| value(i, axis));
        front.iter().any(|i| Some(value(i, axis)) != first)
    });
    axes
}
