//! The points at which a case's expectations are looked at: combinations of what is swept, with each volume and camera.

use std::collections::BTreeSet;
use std::path::PathBuf;

use naga::valid::Capabilities;
use volgraph_report::ron_text::{Fields, Value};
use volgraph_report::{Finding, Findings, Place};
use volgraph_shader::{ParamSpec, ParamType, ParamValue, check_file};

use super::choice::{self, own_files};
use super::settings::setting;
use super::{Case, CaseOptions, Param, Set, Sweep, one_line};
use crate::ParamOverride;

/// Most points of a case: each costs pictures.
const MAX_POINTS: usize = 1024;

/// One setting to try.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Point {
    /// What is set, after the case's own.
    pub set: Vec<Set>,
    /// Which of the case's volumes is drawn; the graph's own where `None`.
    pub volume: Option<usize>,
    /// Which of the case's cameras looks; the graph's own where `None`.
    pub camera: Option<usize>,
    /// In words, such as `image.step=0.5, camera 2`; empty for the case's own settings.
    pub name: String,
}

/// A parameter that `all_params` cannot sweep, and why.
#[derive(Clone, Debug, PartialEq)]
pub struct Unswept {
    /// Its name.
    pub name: String,
    /// Why.
    pub why: &'static str,
}

impl Case {
    /// The points, in the order of the file, and the parameters of `all_params` that cannot be swept.
    ///
    /// # Errors
    /// `too-many-points`; for `all_params` also what is wrong with the shader under test.
    pub fn points(&self, options: &CaseOptions) -> Result<(Vec<Point>, Vec<Unswept>), Findings> {
        let mut unswept = Vec::new();
        let (settings, place) = match &self.sweep {
            Sweep::None => (vec![Vec::new()], None),
            Sweep::Product(axes) => (product(axes)?, axes.first().and_then(|axis| axis.first())),
            Sweep::AllParams { except, place } => {
                let found = self.each_param(options, except, place)?;
                unswept = found.1;
                (found.0, None)
            }
        };
        let indices = |count: usize| -> Vec<Option<usize>> {
            if count == 0 {
                vec![None]
            } else {
                (0..count).map(Some).collect()
            }
        };
        let (volumes, cameras) = (indices(self.volumes.len()), indices(self.cameras.len()));
        if settings.len() * volumes.len() * cameras.len() > MAX_POINTS {
            let place = place.map(|set| set.place.clone());
            return Err(too_many(place.unwrap_or_else(|| self.graph.place.clone())).into());
        }
        let mut points = Vec::new();
        for &volume in &volumes {
            for &camera in &cameras {
                for set in &settings {
                    points.push(self.point(set.clone(), volume, camera));
                }
            }
        }
        Ok((points, unswept))
    }

    /// The point with nothing swept, the first volume and the first camera.
    pub(super) fn own_point(&self) -> Point {
        let first = |is_empty: bool| (!is_empty).then_some(0);
        let (volume, camera) = (
            first(self.volumes.is_empty()),
            first(self.cameras.is_empty()),
        );
        Point {
            set: Vec::new(),
            volume,
            camera,
            name: String::new(),
        }
    }

    fn point(&self, set: Vec<Set>, volume: Option<usize>, camera: Option<usize>) -> Point {
        let mut parts: Vec<String> = set.iter().map(|set| set.value.typed.clone()).collect();
        if let (Some(at), true) = (volume, self.volumes.len() > 1) {
            parts.push(self.volumes[at].text.clone());
        }
        if let (Some(at), true) = (camera, self.cameras.len() > 1) {
            parts.push(self.cameras[at].text.clone());
        }
        Point {
            set,
            volume,
            camera,
            name: parts.join(", "),
        }
    }

    /// Each parameter of the slot under test at the ends and the middle of its range, or at each choice; the defaults
    /// come first.
    fn each_param(
        &self,
        options: &CaseOptions,
        except: &[String],
        place: &Place,
    ) -> Result<(Vec<Vec<Set>>, Vec<Unswept>), Findings> {
        let Some(slot) = self.slots.first() else {
            return Err(Finding::error("no-slot", "no slot is under test")
                .at(place.clone())
                .into());
        };
        let roots = self.shader_roots(options);
        let path = PathBuf::from(format!("slot/{}/{}.wgsl", slot.slot, slot.choice));
        let defaults = crate::registry().default_slots();
        let module = check_file(&roots, &path, &defaults, Capabilities::default())?;
        let files = own_files(&module.linked);
        let is_own = |spec: &&ParamSpec| {
            let file = spec.place.as_ref().map(|place| &place.file);
            file.is_some_and(|file| files.contains(&file.as_path()))
        };
        let specs: Vec<&ParamSpec> = module.params().iter().filter(is_own).collect();
        let known: BTreeSet<&str> = specs.iter().map(|spec| spec.name.as_str()).collect();
        let unknown = except.iter().filter(|name| !known.contains(name.as_str()));
        let unknown: Findings = unknown
            .map(|name| choice::unknown_param(name, &known, slot, place))
            .collect();
        unknown.into_result(())?;
        let (mut settings, mut unswept) = (vec![Vec::new()], Vec::new());
        for spec in specs {
            let skip = |why| Unswept {
                name: spec.name.clone(),
                why,
            };
            if except.contains(&spec.name) {
                unswept.push(skip("the case leaves it out"));
                continue;
            }
            let values = values(spec);
            if values.is_empty() {
                unswept.push(skip("its comment has neither @range nor @choices"));
            }
            let param = Param {
                node: self.node.clone(),
                name: spec.name.clone(),
                place: place.clone(),
            };
            for value in values {
                settings.push(vec![setting(&param, &value)?]);
            }
        }
        Ok((settings, unswept))
    }
}

/// The values at which a parameter is tried.
fn values(spec: &ParamSpec) -> Vec<String> {
    if let ParamType::Choice(choices) = &spec.ty {
        return choices.clone();
    }
    let Some((low, high)) = spec.range else {
        return Vec::new();
    };
    let numbers = |value: f64| match spec.ty {
        ParamType::Vector(n) => Some(list(value, n, false)),
        ParamType::IntVector(n) | ParamType::UintVector(n) => Some(list(value, n, true)),
        ParamType::Int | ParamType::Uint => Some(format!("{value:.0}")),
        ParamType::Float => Some(format!("{value:?}")),
        ParamType::Bool | ParamType::Choice(_) | ParamType::Text => None,
    };
    let mut values: Vec<String> = Vec::new();
    for value in [low, 0.5 * (low + high), high] {
        let is_default = match &spec.default {
            ParamValue::Float(given) => *given == value,
            ParamValue::Int(given) => *given as f64 == value,
            _ => false,
        };
        values.extend(numbers(value).filter(|text| !is_default && !values.contains(text)));
    }
    values
}

fn list(value: f64, count: usize, is_whole: bool) -> String {
    let one = if is_whole {
        format!("{value:.0}")
    } else {
        format!("{value:?}")
    };
    format!("[{}]", vec![one; count].join(", "))
}

/// All combinations, the last axis fastest.
fn product(axes: &[Vec<Set>]) -> Result<Vec<Vec<Set>>, Finding> {
    let mut points = vec![Vec::new()];
    for axis in axes {
        if points.len() * axis.len() > MAX_POINTS {
            let place = axis.first().map(|set| set.place.clone());
            return Err(too_many(place.unwrap_or_else(|| Place::whole_file(""))));
        }
        let longer = points.iter().flat_map(|point| {
            axis.iter().map(move |set| {
                let mut point: Vec<Set> = point.clone();
                point.push(set.clone());
                point
            })
        });
        points = longer.collect();
    }
    Ok(points)
}

fn too_many(place: Place) -> Finding {
    let message = format!("more than {MAX_POINTS} combinations are refused");
    Finding::error("too-many-points", message)
        .at(place)
        .help("sweep less at once: write several cases")
}

/// Reads a sweep: a map of lists, or `all_params`.
pub(super) fn read(value: &Value<'_>, has_slot: bool) -> Result<Sweep, Findings> {
    if value.text().starts_with('{') {
        return product_of(value);
    }
    let (name, entries) = value.variant()?;
    let mut findings = Findings::new();
    if name != "all_params" {
        let finding = value.error("unknown-sweep", format!("nothing is known of `{name}`"));
        findings.push(finding.help("write `all_params`, or `{ \"image.step\": [0.5, 1, 2] }`"));
        return Err(findings);
    }
    let mut fields = Fields::new(entries);
    let except = fields.take("except").and_then(|value| {
        let items = findings.take(value.items())?;
        let names = items.iter().map(Value::string);
        findings.take(names.collect::<Result<Vec<_>, _>>())
    });
    fields.finish(&mut findings);
    if !has_slot {
        let finding = value.error("no-slot", "`all_params` are those of the slot under test");
        findings.push(finding.help("name it: `slot: (technique: \"glow\")`"));
    }
    findings.into_result(Sweep::AllParams {
        except: except.unwrap_or_default(),
        place: value.place(),
    })
}

fn product_of(value: &Value<'_>) -> Result<Sweep, Findings> {
    let mut findings = Findings::new();
    let mut axes = Vec::new();
    for entry in value.entries()? {
        let items = findings.take(entry.value.items()).unwrap_or_default();
        if items.is_empty() && !findings.has_errors() {
            findings.push(
                entry
                    .value
                    .error("bad-value", "there is nothing to sweep here"),
            );
        }
        let mut axis = Vec::new();
        for item in items {
            let text = one_line(item.text());
            // A choice is set without its quotes, as on the command line.
            let bare = item.string().unwrap_or(text);
            let typed = format!("{}={bare}", entry.name);
            match ParamOverride::parse(&typed) {
                Ok(value) => axis.push(Set {
                    value,
                    place: item.place(),
                }),
                Err(message) => {
                    let finding = Finding::error("bad-set", message).at(entry.name_place.clone());
                    findings.push(
                        finding.help("name it as `\"image.step\"` or `\"image.slots.classify\"`"),
                    );
                    break;
                }
            }
        }
        axes.push(axis);
    }
    findings.into_result(Sweep::Product(axes))
}
