//! A ray as a table.

use std::fmt::Write as _;

use volgraph::ray::{RaySegment, Status};
use volgraph::{Probe, RayStudy};

/// Rows at the start and at the end of a long walk, and around the segment that contributes most.
const ENDS: usize = 6;
const AROUND: usize = 3;

/// The study in words; of long walks the middle is left out unless `with_all`.
pub fn of(study: &RayStudy, with_all: bool) -> String {
    let [x, y] = study.pixel;
    // Writing to a String does not fail.
    let mut text = format!(
        "pixel {x}, {y}: raycast `{}`, technique {}\n",
        study.node, study.technique
    );
    let _ = writeln!(
        text,
        "ray        from {} towards {}",
        vector(study.origin, 4),
        vector(study.direction, 5)
    );
    if let (Some([near, far]), Some([entry, exit])) = (study.interval, study.ends) {
        let _ = writeln!(
            text,
            "box        entered at {near:.4}, {}; left at {far:.4}, {}",
            vector(entry, 4),
            vector(exit, 4)
        );
    } else {
        text.push_str("box        the ray misses the volume\n");
    }
    if study.bends > 0 {
        let _ = writeln!(
            text,
            "bends      {}; distances count along the ray's way",
            study.bends
        );
    }
    if !study.segments.is_empty() {
        table(&mut text, study, with_all);
    }
    colors(&mut text, study);
    if let Some(hit) = &study.hit {
        let what = format!("hit, at {:.4}", study.depth.unwrap_or_default());
        probe(&mut text, &what, hit);
    }
    if let (Some(strongest), Some(segment)) = (&study.strongest, study.strongest_segment()) {
        let what = format!("segment {}, which contributes most", segment.index);
        probe(&mut text, &what, strongest);
    }
    text.truncate(text.trim_end().len());
    text
}

fn table(text: &mut String, study: &RayStudy, with_all: bool) {
    let count = |status: Status| {
        let of_it = study.segments.iter().filter(|it| it.status == status);
        let lengths = of_it.clone().map(|it| it.end - it.start);
        let length = lengths.fold(0.0, |sum, length| sum + length);
        format!("{} {} ({length:.4} long)", of_it.count(), status.name())
    };
    let _ = writeln!(
        text,
        "walk       {}, {}, {}; {} samples\n",
        count(Status::Taken),
        count(Status::Skipped),
        count(Status::Ended),
        study.samples
    );
    let _ = writeln!(
        text,
        "{:>6} {:<8}{:>10}{:>10}{:>11}{:>11}{:>11}{:>9}{:>9}  contribution (linear rgb)",
        "#", "", "start", "end", "front", "back", "extinction", "opacity", "left"
    );
    let last = study.segments.len().saturating_sub(1);
    let strongest = study.strongest_segment().map(|it| it.index);
    let is_shown = |at: usize| {
        with_all
            || study.segments.len() <= 4 * ENDS
            || at < ENDS
            || at + ENDS > last
            || strongest.is_some_and(|it| it.abs_diff(at) <= AROUND)
    };
    let mut left_out = 0_usize;
    for segment in &study.segments {
        if !is_shown(segment.index) {
            left_out += 1;
            continue;
        }
        tell_left_out(text, &mut left_out);
        row(text, segment, strongest == Some(segment.index));
    }
    tell_left_out(text, &mut left_out);
    if study.untold > 0 {
        let _ = writeln!(
            text,
            "{:>6} {} more were not written down",
            "", study.untold
        );
    }
    text.push('\n');
}

fn tell_left_out(text: &mut String, left_out: &mut usize) {
    if *left_out > 0 {
        let _ = writeln!(text, "{:>6} {left_out} more", "…");
    }
    *left_out = 0;
}

fn row(text: &mut String, segment: &RaySegment, is_strongest: bool) {
    let or_none = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), number);
    let [front, back] = segment.scalars.map_or([None; 2], |it| it.map(Some));
    let [r, g, b] = segment.contribution.map(|value| format!("{value:>9.6}"));
    let mark = if is_strongest { "  ←" } else { "" };
    let _ = writeln!(
        text,
        "{:>6} {:<8}{:>10.4}{:>10.4}{:>11}{:>11}{:>11}{:>9.5}{:>9.5}  {r} {g} {b}{mark}",
        segment.index,
        segment.status.name(),
        segment.start,
        segment.end,
        or_none(front),
        or_none(back),
        or_none(segment.extinction),
        segment.opacity,
        segment.transmittance[1]
    );
}

fn colors(text: &mut String, study: &RayStudy) {
    let line = |text: &mut String, name: &str, [r, g, b, a]: [f64; 4]| {
        let _ = writeln!(text, "{name:<22}{r:>10.6}{g:>10.6}{b:>10.6}{a:>10.6}");
    };
    let _ = writeln!(
        text,
        "{:<22}{:>10}{:>10}{:>10}{:>10}",
        "linear premultiplied", "red", "green", "blue", "alpha"
    );
    line(text, "sum of segments", study.sum());
    line(text, "what is behind", study.behind);
    line(text, "over what is behind", study.over);
    line(text, "pixel of the picture", study.picture);
    match (&study.reference, study.error(), &study.no_reference) {
        (Some(reference), Some(error), _) => {
            line(text, "reference", reference.color);
            line(text, "reference, over it", reference.over);
            let _ = writeln!(
                text,
                "the pixel is {error:.2e} from the reference, which is within {:.1e}",
                reference.error
            );
        }
        (_, _, Some(why)) => {
            let _ = writeln!(text, "no reference: {why}");
        }
        _ => {}
    }
    text.push('\n');
}

fn probe(text: &mut String, what: &str, probe: &Probe) {
    let _ = writeln!(text, "probe at the {what}");
    let _ = writeln!(
        text,
        "  world      {}\n  index      {}",
        vector(probe.world, 4),
        vector(probe.index, 4)
    );
    let (Some(voxel), Some(value), Some(gradient)) = (probe.voxel, probe.value, probe.gradient)
    else {
        text.push_str("  it is not in the volume\n");
        return;
    };
    let length = gradient.iter().map(|it| it * it).sum::<f64>().sqrt();
    let [x, y, z] = voxel;
    let _ = writeln!(
        text,
        "  voxel      {x}, {y}, {z}\n  value      {}\n  gradient   {} per world unit, {} long",
        number(value),
        gradient.map(number).join(", "),
        number(length)
    );
    if let Some(label) = probe.label {
        let name = probe.label_name.as_deref().unwrap_or_default();
        let _ = writeln!(text, "  label      {label} {name}");
    }
}

fn vector(values: [f64; 3], digits: usize) -> String {
    let [x, y, z] = values;
    format!("({x:.digits$}, {y:.digits$}, {z:.digits$})")
}

/// A number with five digits.
fn number(value: f64) -> String {
    let size = value.abs();
    if value == 0.0 || value.fract() == 0.0 && size < 1e7 {
        format!("{value}")
    } else if (1e-3..1e6).contains(&size) {
        let digits = (4.0 - size.log10().floor()).clamp(0.0, 6.0) as usize;
        format!("{value:.digits$}")
    } else {
        format!("{value:.3e}")
    }
}
