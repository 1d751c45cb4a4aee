//! The pages: of one graph, and the index of several. They read nothing but the pictures beside them.

use maud::{Markup, PreEscaped, html};
use serde_json::{Value, json};
use volgraph::Findings;
use volgraph::methods::{Measurement, TruthKind};
use volgraph_graph::print::CONVENTIONS;

use super::exhibit::{Exhibit, Metric, short};
use super::pictures::map_colors;
use super::plot::{self, Plot};
use crate::commands::html::Page;

const STYLE: &str = include_str!("page.css");
const SCRIPT: &str = include_str!("page.js");

/// The page of a graph.
pub fn of(exhibit: &Exhibit) -> Result<String, Findings> {
    let plot = plot::draw(exhibit)?;
    let front = exhibit.front();
    let points = points(exhibit);
    let first = front.last().copied().unwrap_or(0);
    let body = html! {
        h1 { (exhibit.name) ": speed against accuracy" }
        p { (exhibit.draws) }
        p class="soft" {
            (exhibit.survey.measured.len()) " of " (exhibit.survey.product) " methods, "
            (exhibit.size[0]) " × " (exhibit.size[1]) " pixels. "
            a href=(format!("{}.csv", exhibit.name)) { "table" } ", "
            a href=(format!("{}.svg", exhibit.name)) { "chart" } ", "
            a href=(format!("{}/truth.png", exhibit.name)) { "truth" }
        }
        div class="view" {
            div class="card chart" {
                (PreEscaped(with_hits(&plot)))
                (legend(exhibit, &plot))
                h2 { "The front" }
                p class="soft" { "No other method is both faster and more accurate. Errors: 1 is white." }
                div class="wide" { (table(exhibit, &front)) }
            }
            div class="card pictures" {
                div id="what" {}
                figure { img id="picture" alt="the picture by this method" width=(exhibit.size[0]) height=(exhibit.size[1]); }
                figure {
                    img id="map" alt="its errors" width=(exhibit.size[0]) height=(exhibit.size[1]);
                    figcaption {
                        div class="scale" style=(format!("background: linear-gradient(to right, {})", map_colors())) {}
                        div class="ends" { span { "0" } span id="map-end" {} }
                        div id="map-text" {}
                    }
                }
            }
        }
        (peers(exhibit))
        (refused(exhibit))
        details {
            summary { h2 style="display: inline" { "All methods" } }
            div class="wide" { (table(exhibit, &by_time(exhibit))) }
        }
        h2 { "How it was measured" }
        (how(exhibit))
        h2 { "Conventions" }
        table { @for (what, convention) in CONVENTIONS { tr { th { (what) } td { (convention) } } } }
        details { summary { "The graph" } pre { (exhibit.graph) } }
        script type="application/json" id="points" data-first=(first) { (PreEscaped(points)) }
        script { (PreEscaped(SCRIPT)) }
    };
    let title = format!("volgraph: {}", exhibit.name);
    Ok(page(&title, &exhibit.adapter).around(&body))
}

/// The page that leads to the others.
pub fn index(exhibits: &[Exhibit]) -> Result<String, Findings> {
    let mut cards = Vec::new();
    for exhibit in exhibits {
        let plot = plot::draw(exhibit)?;
        cards.push(html! {
            div class="card chart" {
                h2 style="margin-top: 0" { a href=(format!("{}.html", exhibit.name)) { (exhibit.name) } }
                p class="soft" { (exhibit.draws) }
                a href=(format!("{}.html", exhibit.name)) { (PreEscaped(&plot.svg)) }
                (legend(exhibit, &plot))
            }
        });
    }
    let adapter = exhibits.first().map_or("", |exhibit| &exhibit.adapter);
    let body = html! {
        h1 { "Speed against accuracy" }
        p class="soft" { (exhibits.len()) " graphs." }
        div class="charts" { @for card in cards { (card) } }
    };
    Ok(page("volgraph: charts", adapter).around(&body))
}

fn page<'p>(title: &'p str, adapter: &'p str) -> Page<'p> {
    Page {
        title,
        style: STYLE,
        adapter,
    }
}

/// The drawing with a place to point at for each measurement.
fn with_hits(plot: &Plot) -> String {
    let hits = html! {
        @for (i, (x, y)) in plot.places.iter().enumerate() {
            circle class="hit" tabindex="0" data-point=(i) cx=(x) cy=(y) r="9" {}
        }
    };
    let hits = format!("{}</svg>", hits.into_string());
    plot.svg.replacen("</svg>", &hits, 1)
}

fn legend(exhibit: &Exhibit, plot: &Plot) -> Markup {
    let (axis, colors) = &plot.colors;
    html! {
        div class="legend" {
            span class="soft" { (axis) ":" }
            @for (value, color) in colors {
                span { span class="dot" style=(format!("background: {color}")) {} (value) }
            }
            span class="soft" { "line and large points: the front; ring: the graph's own settings" }
            @if exhibit.metric() == Metric::CoreSteps {
                span class="soft" { "open points: the front rounded to 8 bits; crosses: other renderers, in 8 bits" }
            }
        }
    }
}

/// What the script knows of each measurement.
fn points(exhibit: &Exhibit) -> String {
    let axes = exhibit.varied();
    let measured = exhibit.survey.measured.iter();
    let points = measured.map(|measured| point(exhibit, measured, &axes));
    let points = Value::Array(points.collect()).to_string();
    // Nothing in it can end the element that it is in.
    points.replace('<', "\\u003c")
}

fn point(exhibit: &Exhibit, measured: &Measurement, axes: &[&str]) -> Value {
    let (errors, time) = (&measured.errors, &measured.time_ms);
    let settings = axes
        .iter()
        .map(|axis| [axis.replace('_', " "), short(&measured.method.text(axis))]);
    let figures = [
        ("time", format!("{:.2} ms", measured.steady_ms)),
        (
            "least, most",
            format!("{:.1}, {:.1} ms", time.min, time.max),
        ),
        ("frames", time.n.to_string()),
        (
            "to the graph's own",
            format!("× {:.3}", measured.ratio.median),
        ),
        ("rmse", error(errors.rmse)),
        ("maximum", error(errors.max)),
        ("99.9 %", error(errors.p999)),
        ("core, 8-bit steps", error(errors.core_rmse * 255.0)),
        ("core, in 8 bits", error(errors.core_rmse_8bit * 255.0)),
    ];
    let figures = figures.map(|(name, value)| [name.to_owned(), value]);
    let rows: Vec<[String; 2]> = settings.chain(figures).collect();
    let files = exhibit.pictures.get(&measured.method.to_string());
    json!({
        "title": exhibit.label(measured, axes),
        "rows": rows,
        "picture": files.map(|files| &files.picture),
        "map": files.map(|files| &files.map),
        "map_end": files.map(|files| format!("{:e} and more", 1.0 / files.amplification)),
        "amplification": files.map(|files| files.amplification),
    })
}

fn error(value: f64) -> String {
    format!("{value:.2e}")
}

/// All measurements by rising time.
fn by_time(exhibit: &Exhibit) -> Vec<usize> {
    let measured = &exhibit.survey.measured;
    let mut all: Vec<usize> = (0..measured.len()).collect();
    all.sort_by(|a, b| measured[*a].steady_ms.total_cmp(&measured[*b].steady_ms));
    all
}

fn table(exhibit: &Exhibit, which: &[usize]) -> Markup {
    let axes = exhibit.varied();
    html! {
        table {
            tr {
                @for axis in &axes { th { (axis.replace('_', " ")) } }
                th class="n" { "ms" } th class="n" { "least" } th class="n" { "most" } th class="n" { "frames" }
                th class="n" { "ratio" } th class="n" { "rmse" } th class="n" { "max" } th class="n" { "p99.9" }
                th class="n" { "core steps" } th class="n" { "in 8 bits" }
            }
            @for measured in which.iter().map(|at| &exhibit.survey.measured[*at]) {
                tr {
                    @for axis in &axes { td { (short(&measured.method.text(axis))) } }
                    td class="n" { (format!("{:.2}", measured.steady_ms)) }
                    td class="n" { (format!("{:.2}", measured.time_ms.min)) }
                    td class="n" { (format!("{:.2}", measured.time_ms.max)) }
                    td class="n" { (measured.time_ms.n) }
                    td class="n" { (format!("{:.3}", measured.ratio.median)) }
                    td class="n" { (error(measured.errors.rmse)) }
                    td class="n" { (error(measured.errors.max)) }
                    td class="n" { (error(measured.errors.p999)) }
                    td class="n" { (format!("{:.3}", measured.errors.core_rmse * 255.0)) }
                    td class="n" { (format!("{:.3}", measured.errors.core_rmse_8bit * 255.0)) }
                }
            }
        }
    }
}

fn refused(exhibit: &Exhibit) -> Markup {
    let refused = &exhibit.survey.refused;
    html! {
        @if !refused.is_empty() {
            h2 { "Refused" }
            p class="soft" { (refused.len()) " methods that the scene does not take, and why." }
            div class="wide" { table {
                @for (method, why) in refused { tr { td { (method) } td { (why) } } }
            } }
        }
    }
}

fn peers(exhibit: &Exhibit) -> Markup {
    let beaten = exhibit.beaten();
    let axes = exhibit.varied();
    html! {
        @let left_out = exhibit.others.left_out_words();
        @if !beaten.is_empty() || left_out.is_some() {
            h2 { "Other renderers" }
        }
        @if let Some(left_out) = left_out {
            p class="soft" { "Not shown of the table that was given: " (left_out) "." }
        }
        @if !beaten.is_empty() {
            p {
                "Errors are in 8-bit steps (1/255) over red, green and blue of the " (exhibit.core_pixels)
                " core pixels, whose rays cross at least 4 voxels between voxel centres, each renderer against the float64 truth of its own \
                 conventions. Theirs are of 8-bit pictures, which alone makes about 0.29 of them; so the method beside each is judged \
                 by its picture rounded to 8 bits. Their times are from the table that was given: they are comparable where it was \
                 made on this machine, at about this time."
            }
            div class="wide" { table {
                tr {
                    th { "renderer" } th { "mode" } th { "step" } th class="n" { "ms" } th class="n" { "least" }
                    th class="n" { "most" } th class="n" { "error" } th { "faster and more accurate" }
                    th class="n" { "ms" } th class="n" { "error" }
                }
                @for row in &beaten {
                    tr {
                        td { (row.peer.name) } td { (row.peer.mode) } td { (row.peer.step) }
                        td class="n" { (format!("{:.1}", row.peer.median_ms)) }
                        td class="n" { (format!("{:.1}", row.peer.min_ms)) }
                        td class="n" { (format!("{:.1}", row.peer.max_ms)) }
                        td class="n" { (format!("{:.3}", row.peer.core_rmse_8bit_steps)) }
                        @match row.by {
                            Some(by) => {
                                td { (exhibit.label(by, &axes)) }
                                td class="n" { (format!("{:.1}", by.steady_ms)) }
                                td class="n" { (format!("{:.3}", Metric::CoreSteps.of_rounded(by))) }
                            }
                            None => { td class="soft" { "none" } td {} td {} }
                        }
                    }
                }
            } }
        }
    }
}

fn how(exhibit: &Exhibit) -> Markup {
    let survey = &exhibit.survey;
    let options = &survey.options;
    let truth = match exhibit.truth {
        TruthKind::Reference => format!(
            "the float64 reference, which integrates each ray of the trilinear field; every pixel of it is within {:.1e}",
            exhibit.truth_bound.unwrap_or(0.0)
        ),
        TruthKind::Fine => format!(
            "the same graph at a step of 1/{:.0} voxel on the device, in f32, for the reference does not compute it (or was not asked to); \
             its own error is not known, and methods cannot be told apart below about 1e-5",
            1.0 / exhibit.fine_step
        ),
    };
    let whole = if survey.product <= options.max_whole {
        "All of them were measured."
    } else {
        "First all combinations of classification, traversal and step, and each other setting alone; then whatever differs \
         in one setting from what is near the front."
    };
    let set = if exhibit.set.is_empty() {
        "nothing".to_owned()
    } else {
        exhibit.set.join(", ")
    };
    html! {
        p { b { "Truth: " } (truth) ". It took " (format!("{:.0}", exhibit.truth_seconds)) " s." }
        p { b { "Errors: " } "of linear premultiplied red, green, blue and alpha in the graph's own view, 1 is white: the root of the mean \
            square, the largest, and the 99.9th percentile of the pixels' largest. Core steps: of red, green and blue of the "
            (exhibit.core_pixels) " pixels whose rays cross at least 4 voxels between voxel centres, times 255; in 8 bits: of the picture rounded \
            to 8 bits a component without sRGB encoding." }
        p { b { "Times: " } "from drawing until the colours, 4 × 32 bits a pixel, are in memory; the camera turns by one degree a frame. In each round \
            every method that is on the device draws one frame, forwards in one round and backwards in the next, the graph's own settings always \
            among them. ms is the median ratio to those of the same round, times their median of all rounds ("
            (format!("{:.2} ms of {} frames, {:.2} to {:.2}", survey.base_ms.median, survey.base_ms.n, survey.base_ms.min, survey.base_ms.max))
            "): slow drifts of the machine cancel. least and most are as they were measured. "
            (options.scout_rounds) " frames of each method after " (options.warm_up) " that was not timed, up to " (options.rounds)
            " of those within a factor of " (options.slack) " of the front." }
        p { b { "Methods: " } (survey.product) " combinations. " (whole) " It took " (format!("{:.0}", survey.seconds)) " s of "
            (options.seconds) ", besides the truth. Narrowed by: " (if exhibit.filters.is_empty() { "nothing" } else { &exhibit.filters })
            ". Set: " (set) "." }
        @if !exhibit.shared().is_empty() { p { b { "All with: " } (exhibit.shared().join(", ")) "." } }
    }
}
