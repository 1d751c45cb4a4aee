//! What is set along a path: numbers on straight lines between their keys, all else from its key on.

use volgraph_report::{Finding, Findings, Place};
use volgraph_shader::ParamValue;

use super::keys::{Key, set};
use crate::overrides::ParamOverride;

/// The values of one parameter at their frames.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Track {
    name: String,
    values: Vec<(f64, ParamOverride)>,
    place: Place,
}

impl Track {
    /// The tracks of all that keys set, in the order in which it is first set.
    pub(super) fn of(keys: &[Key]) -> Result<Vec<Self>, Findings> {
        let mut findings = Findings::new();
        let mut tracks: Vec<Self> = Vec::new();
        for key in keys {
            for (set, place) in &key.sets {
                let value = (f64::from(key.at), set.clone());
                let mut known = tracks.iter_mut();
                let Some(track) = known.find(|track| track.values[0].1.sets_the_same(set)) else {
                    let slots = if set.is_slot { "slots." } else { "" };
                    tracks.push(Self {
                        name: format!("{}.{slots}{}", set.target, set.name),
                        values: vec![value],
                        place: place.clone(),
                    });
                    continue;
                };
                if form(&track.values[0].1.value) != form(&set.value) {
                    findings.push(
                        Finding::error(
                            "path",
                            format!("there is no way to `{}` from the value before", set.typed),
                        )
                        .at(place.clone())
                        .help("give a parameter values of one form at all keys")
                        .related(track.place.clone(), "first set here"),
                    );
                }
                track.values.push(value);
            }
        }
        findings.into_result(tracks)
    }

    /// Where it is first set.
    pub(super) fn place(&self) -> &Place {
        &self.place
    }

    /// What it is at a time.
    pub(super) fn at(&self, time: f64) -> ParamOverride {
        let next = self.values.partition_point(|(at, _)| *at <= time);
        let (from_time, from) = &self.values[next.saturating_sub(1)];
        let Some((to_time, to)) = self.values.get(next).filter(|_| next > 0) else {
            return from.clone();
        };
        let part = (time - from_time) / (to_time - from_time);
        if part <= 0.0 {
            return from.clone();
        }
        let value = between(&from.value, &to.value, part);
        // The name has been read before, so it can be read again.
        set(&self.name, value).unwrap_or_else(|_| from.clone())
    }
}

/// What has to be alike in all values of a parameter.
fn form(value: &ParamValue) -> (u8, usize) {
    match value {
        ParamValue::Int(_) | ParamValue::Float(_) => (0, 0),
        ParamValue::Vector(numbers) => (1, numbers.len()),
        ParamValue::Bool(_) => (2, 0),
        ParamValue::Text(_) => (3, 0),
    }
}

fn between(from: &ParamValue, to: &ParamValue, part: f64) -> ParamValue {
    let line = |from: f64, to: f64| from + part * (to - from);
    let number = |value: &ParamValue| match value {
        ParamValue::Int(whole) => Some(*whole as f64),
        ParamValue::Float(number) => Some(*number),
        _ => None,
    };
    match (from, to) {
        #[expect(clippy::cast_possible_truncation, reason = "between two of i64")]
        (ParamValue::Int(from), ParamValue::Int(to)) => {
            ParamValue::Int(line(*from as f64, *to as f64).round() as i64)
        }
        (ParamValue::Vector(from), ParamValue::Vector(to)) => {
            let pairs = from.iter().zip(to);
            ParamValue::Vector(pairs.map(|(from, to)| line(*from, *to)).collect())
        }
        (from, to) => match (number(from), number(to)) {
            (Some(from), Some(to)) => ParamValue::Float(line(from, to)),
            _ => from.clone(),
        },
    }
}
