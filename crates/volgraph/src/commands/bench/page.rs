//! The page of a report: rates and ratios, bars of the ratios, curves of growth, starts.

use maud::{Markup, PreEscaped, html};
use volgraph::Findings;
use volgraph::bench::{Growth, GrowthAxis, Row, Table};

use super::growth::exponent;
use super::one::mib;
use super::peers::error_words;
use super::report::Report;
use crate::commands::drawing::{Axis, Curve, Drawing, Mark, css, inline, short};
use crate::commands::html::Page;

/// The look of charts' pages, and bars.
const STYLE: &str = concat!(
    include_str!("../chart/page.css"),
    "
.bars { display: grid; grid-template-columns: max-content 1fr; gap: .3rem .8rem; align-items: center; font-size: 13px; margin-top: .6rem; }
.bar { display: flex; align-items: center; gap: .4rem; height: 1.05rem; font-size: 12px; }
.bar i { display: block; height: .75rem; border-radius: 2px; }
tr.group td { padding-top: .9rem; font-weight: 600; }
"
);

/// The document.
pub fn of(report: &Report) -> Result<String, Findings> {
    let curves = curves(report)?;
    let body = html! {
        h1 { "How fast it draws" }
        @if !report.is_complete {
            p { b { "Not all of it is measured yet" } ", or it was interrupted: this is what there is." }
        }
        (start_up(report))
        (tables(report))
        (curves)
        (peers(report))
        (how(report))
    };
    let adapter = report.adapter.to_string();
    let page = Page {
        title: "volgraph: speed",
        style: STYLE,
        adapter: &adapter,
    };
    Ok(page.around(&body))
}

fn start_up(report: &Report) -> Markup {
    html! {
        @if !report.start_up.is_empty() {
            h2 { "Start and memory" }
            p class="soft" {
                "From the program's start until its first picture is in memory; cold: with empty caches, warm: with those that the \
                 cold start left, median of " (report.start_up[0].warm_ms.n) ". Host: the most that the process held in the main memory \
                 until then, where a software adapter keeps its device memory as well. Device: textures and buffers."
            }
            div class="wide" { table {
                tr { th { "graph" } th { "size" } th class="n" { "cold ms" } th class="n" { "warm ms" }
                     th class="n" { "whole program ms" } th class="n" { "host" } th class="n" { "device" } }
                @for start in &report.start_up {
                    tr {
                        td { (start.graph) }
                        td { (size(start.size)) }
                        td class="n" { (format!("{:.0}", start.cold_ms)) }
                        td class="n" { (format!("{:.0}", start.warm_ms.median)) }
                        td class="n" { (format!("{:.0}", start.warm_process_ms.median)) }
                        td class="n" { (start.peak_resident_bytes.map_or_else(|| "unknown".to_owned(), mib)) }
                        td class="n" { (mib(start.device_bytes)) }
                    }
                }
            } }
        }
    }
}

fn size([width, height]: [u32; 2]) -> String {
    format!("{width} × {height}")
}

/// The tables of a volume at a size.
type Group<'r> = ((&'r str, [u32; 2]), Vec<&'r Table>);

/// The tables by volume and size, in the order of the report.
fn groups(report: &Report) -> Vec<Group<'_>> {
    let mut groups: Vec<Group<'_>> = Vec::new();
    for table in &report.tables {
        let key = (table.volume.as_str(), table.size);
        match groups.iter_mut().find(|(there, _)| *there == key) {
            Some((_, tables)) => tables.push(table),
            None => groups.push((key, vec![table])),
        }
    }
    groups
}

fn tables(report: &Report) -> Markup {
    let groups = groups(report);
    html! {
        @if !groups.is_empty() {
            h2 { "Times the limit" }
            p class="soft" {
                "The limit (fetch_only) walks the same rays with the same step and adds the samples up: one trilinear fetch and one \
                 addition a step. Bars are median ratios to it in the technique's faster stage; 1 is the limit. Less than 1 is where \
                 a technique ends rays early or leaps over what is empty."
            }
            (bars(&groups))
            h2 { "Frame rates" }
            p class="soft" {
                "Frames a second over a rotation about the vertical axis: of the slowest view, of all together, of the fastest. \
                 Limit: times the limit in the same stage; net: the same without what an empty frame costs (" b { "–" }
                " where the limit is not told from it)."
            }
            @for ((volume, at), tables) in &groups {
                div class="card" style="margin-top: 1rem" {
                    h2 style="margin-top: 0" { (volume) ", " (size(*at)) }
                    @if let Some(volume) = report.volumes.iter().find(|there| there.name == *volume) {
                        p class="soft" { (volume.summary) }
                    }
                    div class="wide" { (group(report, tables)) }
                }
            }
        }
    }
}

fn group(report: &Report, tables: &[&Table]) -> Markup {
    let doc = |name: &str| {
        let named = report
            .techniques
            .iter()
            .find(|technique| technique.name == name);
        named.map_or("", |technique| technique.doc.as_str())
    };
    html! {
        table {
            tr { th { "technique" } th { "stage" } th class="n" { "min" } th class="n" { "average" } th class="n" { "max" }
                 th class="n" { "median ms" } th class="n" { "limit ms" } th class="n" { "empty ms" } th class="n" { "× limit" } th class="n" { "net" }
                 th class="n" { "frames" } th class="n" { "device" } }
            @for table in tables {
                @for (at, row) in table.rows.iter().enumerate() {
                    tr {
                        td title=(doc(&table.technique)) { @if at == 0 { (table.technique) } }
                        td { (row.stage) }
                        (cells(row))
                    }
                }
            }
        }
    }
}

fn cells(row: &Row) -> Markup {
    let (Some([min, average, max]), Some(frame), Some(limit), Some(empty), Some(ratio)) = (
        row.fps,
        row.frame_ms,
        row.limit_ms,
        row.empty_ms,
        row.to_limit,
    ) else {
        return html! { td colspan="10" class="soft" { "refused: " (row.refused.as_deref().unwrap_or_default()) } };
    };
    html! {
        @for rate in [min, average, max] { td class="n" { (rate_text(rate)) } }
        td class="n" { (format!("{:.1}", frame.median)) }
        td class="n" { (format!("{:.1}", limit.median)) }
        td class="n" { (format!("{:.1}", empty.median)) }
        td class="n" { b { (format!("{:.2}", ratio.median)) } }
        td class="n" { (row.to_limit_net.map_or_else(|| "–".to_owned(), |net| format!("{net:.2}"))) }
        td class="n" { (frame.n) }
        td class="n" { (mib(row.device_bytes)) }
    }
}

fn rate_text(rate: f64) -> String {
    if rate < 10.0 {
        format!("{rate:.2}")
    } else {
        format!("{rate:.1}")
    }
}

/// The ratio of a table's faster stage.
fn best(table: &Table) -> Option<f64> {
    let measured = table
        .rows
        .iter()
        .filter_map(|row| Some((row.frame_ms?.median, row.to_limit?.median)));
    measured
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, ratio)| ratio)
}

fn bars(groups: &[Group<'_>]) -> Markup {
    let mut names: Vec<&str> = Vec::new();
    for table in groups.iter().flat_map(|(_, tables)| tables) {
        if !names.contains(&table.technique.as_str()) {
            names.push(&table.technique);
        }
    }
    let all = groups
        .iter()
        .flat_map(|(_, tables)| tables.iter().filter_map(|table| best(table)));
    let most = all.fold(1.0, f64::max);
    html! {
        div class="card" {
            div class="legend" {
                @for (at, ((volume, at_size), _)) in groups.iter().enumerate() {
                    span { span class="dot" style=(format!("background: {}", css(at))) {} (volume) " " (size(*at_size)) }
                }
            }
            div class="bars" {
                @for name in names {
                    div { (name) }
                    div {
                        @for (at, (_, tables)) in groups.iter().enumerate() {
                            @if let Some(ratio) = tables.iter().find(|table| table.technique == name).and_then(|table| best(table)) {
                                div class="bar" {
                                    i style=(format!("width: {:.2}%; background: {}", 90.0 * ratio / most, css(at))) {}
                                    (format!("{ratio:.2}"))
                                }
                            }
                        }
                    }
                }
            }
        }
    }
}

fn curves(report: &Report) -> Result<Markup, Findings> {
    if report.growth.is_empty() {
        return Ok(html! {});
    }
    let mut cards = Vec::new();
    for axis in GrowthAxis::ALL {
        let curves: Vec<&Growth> = report
            .growth
            .iter()
            .filter(|curve| curve.axis == axis)
            .collect();
        if curves.is_empty() {
            continue;
        }
        let svg = drawing(axis, &curves)?;
        cards.push(html! {
            div class="card chart" {
                h2 style="margin-top: 0" { (axis.words()) }
                (PreEscaped(inline(&svg)))
                div class="wide" { table {
                    tr { th { "technique" } th class="n" { "exponent" } th { "range" } th { "median ms" } }
                    @for curve in &curves {
                        tr {
                            td { (curve.technique) }
                            td class="n" { (exponent(curve)) }
                            td { @if let (Some(first), Some(last)) = (curve.points.first(), curve.points.last()) { (first.label) " to " (last.label) } }
                            td { (curve.points.iter().map(|point| format!("{:.1}", point.frame_ms.median)).collect::<Vec<_>>().join(", ")) }
                        }
                        @for why in &curve.refused { tr { td {} td colspan="3" class="soft" { "not drawn: " (why) } } }
                    }
                } }
            }
        });
    }
    Ok(html! {
        h2 { "Growth" }
        p class="soft" {
            "Median milliseconds of a frame, over what grows, both logarithmic. The line is the power that fits best over the whole range; \
             the exponent is its slope, with its standard error. Nothing is subtracted, so that a fixed cost makes it smaller. Voxels: \
             at a step of one voxel, so that twice the side is twice the samples of a ray, an exponent of 1/3."
        }
        div class="charts" { @for card in cards { (card) } }
    })
}

fn drawing(axis: GrowthAxis, curves: &[&Growth]) -> Result<String, Findings> {
    let works = || {
        curves
            .iter()
            .flat_map(|curve| curve.points.iter().map(|point| point.work))
    };
    let drawn = curves.iter().map(|curve| {
        let line = curve
            .fit
            .map(|fit| vec![(fit.from, fit.at(fit.from)), (fit.to, fit.at(fit.to))]);
        Curve {
            name: format!("{}: {}", curve.technique, exponent(curve)),
            points: curve
                .points
                .iter()
                .map(|point| (point.work, point.frame_ms.median, Mark::Full))
                .collect(),
            is_joined: false,
            lines: line.into_iter().collect(),
        }
    });
    let drawing = Drawing {
        size: (560, 340),
        title: "",
        x: axis.words(),
        y: "ms",
        axis: Axis::decades(works(), (0.06, 0.06)),
        curves: drawn.collect(),
    };
    Ok(drawing.svg()?)
}

fn peers(report: &Report) -> Markup {
    html! {
        @if !report.peers.is_empty() {
            h2 { "Other renderers" }
            p class="soft" {
                "128³ bytes into 512 × 512 pixels. In each round a renderer draws its frames in a process of its own, then volgraph draws the same \
                 views, by the fastest of its methods that is accurate enough: 1 for volume rendering, 0.6 for projections. × volgraph: the median \
                 ratio of the medians of rounds. Errors are in 8-bit steps over core pixels, against the float64 reference, of pictures \
                 rounded to 8 bits, which alone makes about 0.29; of VTK, which draws the box between voxel centres, against the reference of that box. No error is \
                 told of isosurfaces, which each renderer lights by its own model."
            }
            div class="wide" { table {
                tr { th { "volume" } th { "renderer, mode, step" } th class="n" { "ms" } th class="n" { "error" }
                     th { "volgraph" } th class="n" { "ms" } th class="n" { "error" } th class="n" { "× volgraph" } th class="n" { "rounds" } }
                @for row in &report.peers {
                    tr {
                        td { (row.volume) }
                        td { (row.job.name()) }
                        @if let (None, Some(theirs), Some(ours), Some(ratio)) = (&row.failed, row.frame_ms, row.method_ms, row.ratio) {
                            td class="n" { (format!("{:.1}", theirs.median)) }
                            td class="n" { (error_words(row.error)) }
                            td { (row.method) }
                            td class="n" { (format!("{:.1}", ours.median)) }
                            td class="n" { (error_words(row.method_error)) }
                            td class="n" { b { (format!("{:.2}", ratio.median)) } }
                            td class="n" { (ratio.n) }
                        } @else {
                            td colspan="7" class="soft" { "not timed: " (row.failed.as_deref().unwrap_or_default()) }
                        }
                    }
                }
            } }
        }
    }
}

fn how(report: &Report) -> Markup {
    html! {
        h2 { "How it was measured" }
        @if !report.tables.is_empty() {
            p { b { "Frames: " } "from drawing until the colours, 4 × 32 bits a pixel, are in memory. Up to " (report.views) " views around the vertical axis, "
                (short(report.turn_degrees)) "° apart, in an order of which every beginning is spread; the frames column says how many were drawn in \
                 the time that was given. The step is " (short(report.step_voxels)) " voxel, for all techniques and the limit." }
            p { b { "Ratios: " } "in each round every stage of a technique, its limit and an empty frame draw the same view in turn, forwards in one round \
                and backwards in the next. The ratio is the median of those of frames of one round, so that slow drifts of the machine cancel. An empty frame \
                is the limit with one sample a ray: the rays' set-up, clearing, and reading back. The limit takes all samples of a ray, whatever the technique \
                skips or ends early." }
            p { b { "Techniques" } }
            table { @for technique in &report.techniques { tr { td { (technique.name) } td { (technique.doc) } } } }
        }
        @if !report.growth.is_empty() {
            p { b { "Growth: " } "all points of a curve are drawn in turn. Dense: marschner_lobb, sparse: c60, occupied: a ball in an empty box. Rays leap over \
                what is empty." }
        }
    }
}
