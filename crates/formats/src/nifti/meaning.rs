//! Units and the meaning of the values, from their codes.

use std::collections::BTreeMap;

use volgraph_volume::Values;

use super::header::Header;
use crate::contents::Contents;

/// What the intent codes say of the values; labels are apart.
const INTENTS: [(i32, &str); 34] = [
    (2, "correlation"),
    (3, "t statistic"),
    (4, "F statistic"),
    (5, "z score"),
    (6, "chi-squared statistic"),
    (7, "beta statistic"),
    (8, "binomial statistic"),
    (9, "gamma statistic"),
    (10, "Poisson statistic"),
    (11, "normal statistic"),
    (12, "noncentral F statistic"),
    (13, "noncentral chi-squared statistic"),
    (14, "logistic statistic"),
    (15, "Laplace statistic"),
    (16, "uniform statistic"),
    (17, "noncentral t statistic"),
    (18, "Weibull statistic"),
    (19, "chi statistic"),
    (20, "inverse Gaussian statistic"),
    (21, "extreme value statistic"),
    (22, "p-value"),
    (23, "-ln p-value"),
    (24, "-log10 p-value"),
    (1001, "estimate"),
    (1004, "matrix"),
    (1005, "symmetric matrix"),
    (1006, "displacement"),
    (1007, "vector"),
    (1008, "point"),
    (1010, "quaternion"),
    (1011, "dimensionless"),
    (2001, "time series"),
    (2003, "RGB"),
    (2004, "RGBA"),
];

/// Intents whose values are labels: an index into some set of labels, and NeuroNames.
const LABELS: [i32; 2] = [1002, 1003];

/// Fills in what the header says beside grid and values.
pub(super) fn tell(header: &Header, contents: &mut Contents) {
    let about = &mut contents.about;
    about.length_unit = match header.units & 0o7 {
        1 => Some("m".to_owned()),
        2 => Some("mm".to_owned()),
        3 => Some("µm".to_owned()),
        _ => None,
    };
    contents.time_unit = match header.units & 0o70 {
        8 => Some("s".to_owned()),
        16 => Some("ms".to_owned()),
        24 => Some("µs".to_owned()),
        32 => Some("Hz".to_owned()),
        40 => Some("ppm".to_owned()),
        48 => Some("rad/s".to_owned()),
        _ => None,
    };
    let known = INTENTS.iter().find(|(code, _)| *code == header.intent);
    about.values = if LABELS.contains(&header.intent) {
        Values::Labels(BTreeMap::new())
    } else if !header.intent_name.is_empty() {
        Values::Named(header.intent_name.clone())
    } else {
        known.map_or(Values::Unknown, |(_, name)| {
            Values::Named((*name).to_owned())
        })
    };
    let mut fact = |name: &str, value: &str| {
        if !value.is_empty() {
            about.facts.push((name.to_owned(), value.to_owned()));
        }
    };
    fact("description", &header.description);
    let intent = known.map_or("", |(_, name)| *name);
    fact("intent", intent);
    let code = if header.sform > 0 {
        header.sform
    } else {
        header.qform
    };
    let space = match code {
        1 => "scanner",
        2 => "aligned to another file",
        3 => "Talairach",
        4 => "MNI 152",
        5 => "a template",
        _ => "",
    };
    fact("space", space);
    if header.intent_name.is_empty() || LABELS.contains(&header.intent) {
        fact("intent name", &header.intent_name);
    }
}
