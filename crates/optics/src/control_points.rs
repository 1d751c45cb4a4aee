//! Control points for editing: a transfer function as the points that a person moves, and back.

use std::path::Path;

use volgraph_report::{Finding, Findings};

use crate::color_map::sample;
use crate::curve::Curve;
use crate::transfer::{
    Absorption, ColorSource, MapUse, TransferFunction, extinction_from_opacity,
    opacity_from_extinction,
};

/// Colour and opacity at a scalar. Two at one scalar are a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ControlPoint {
    /// The scalar, in the unit of the domain.
    pub at: f64,
    /// Linear RGB, each 0 to 1; of a transfer function with a colour map the map's.
    pub color: [f64; 3],
    /// Opacity of one reference length, 0 to 1.
    pub opacity: f64,
}

impl TransferFunction {
    /// The points between which it is interpolated, in their order. A colour map stays what it is: only the points of
    /// the opacity are among them.
    #[must_use]
    pub fn control_points(&self) -> Vec<ControlPoint> {
        let (color, absorption) = (&self.color.curve, self.absorption.curve());
        let mut places: Vec<f64> = absorption.points().iter().map(|(at, _)| *at).collect();
        if self.color.map.is_none() {
            places.extend(color.points().iter().map(|(at, _)| *at));
        }
        places.sort_by(f64::total_cmp);
        places.dedup();
        let opacity = |value: f64| match &self.absorption {
            Absorption::Opacity(_) => value,
            Absorption::Extinction(_) => opacity_from_extinction(value),
        };
        let mut points = Vec::new();
        for at in places {
            let point = |color: [f64; 3], [absorption]: [f64; 1]| ControlPoint {
                at,
                color,
                opacity: opacity(absorption),
            };
            let left = point(color.before(at), absorption.before(at));
            let right = point(color.at(at), absorption.at(at));
            let is_step = (left.opacity - right.opacity).abs() > 1e-9
                || left
                    .color
                    .iter()
                    .zip(&right.color)
                    .any(|(a, b)| (a - b).abs() > 1e-9);
            if is_step {
                points.push(left);
            }
            points.push(right);
        }
        points
    }

    /// The same with other points: at least one, finite; colours and opacities are brought into 0 to 1, and the range
    /// of the tables is widened to hold them. A colour map stays, and the points' colours are then not looked at.
    ///
    /// # Errors
    /// What reading the text of it would find.
    pub fn with_control_points(&self, points: &[ControlPoint]) -> Result<Self, Findings> {
        let is_finite = |point: &ControlPoint| {
            point.at.is_finite()
                && point.opacity.is_finite()
                && point.color.iter().all(|c| c.is_finite())
        };
        if points.is_empty() || !points.iter().all(is_finite) {
            return Err(Finding::error(
                "no-points",
                "a transfer function needs a point, and finite numbers",
            )
            .into());
        }
        let mut points = points.to_vec();
        points.sort_by(|a, b| a.at.total_cmp(&b.at));
        let mut changed = self.clone();
        let (low, high) = self.range;
        changed.range = (low.min(points[0].at), high.max(points[points.len() - 1].at));
        let opacities = points
            .iter()
            .map(|point| (point.at, [point.opacity.clamp(0.0, 1.0)]));
        changed.absorption = match &self.absorption {
            Absorption::Opacity(_) => Absorption::Opacity(Curve::new(opacities.collect())),
            Absorption::Extinction(_) => Absorption::Extinction(Curve::new(
                opacities
                    .map(|(at, [opacity])| (at, [extinction_from_opacity(opacity)]))
                    .collect(),
            )),
        };
        if self.color.map.is_none() {
            let colors = points
                .iter()
                .map(|point| (point.at, point.color.map(|c| c.clamp(0.0, 1.0))));
            changed.color = ColorSource {
                curve: Curve::new(colors.collect()),
                map: None,
            };
        }
        changed.checked()
    }

    /// The same with the colours of a map (one of [`crate::color_map_names`]) laid over `from..to`.
    ///
    /// # Errors
    /// `unknown-color-map`, and what reading the text of it would find.
    pub fn with_color_map(
        &self,
        name: &str,
        from: f64,
        to: f64,
        is_reversed: bool,
    ) -> Result<Self, Findings> {
        let Some(colors) = sample(name) else {
            let message = format!("there is no colour map `{name}`");
            let near = volgraph_report::did_you_mean(name, crate::color_map_names());
            return Err(Finding::error("unknown-color-map", message)
                .help_opt(near)
                .into());
        };
        let mut changed = self.clone();
        changed.color = ColorSource {
            // Laid out anew when the text is read.
            curve: Curve::new(vec![(from, colors[0])]),
            map: Some(MapUse {
                name: name.to_owned(),
                from,
                to,
                is_reversed,
            }),
        };
        changed.checked()
    }

    /// The same with the colours of its map as points of its own, to be edited.
    #[must_use]
    pub fn without_color_map(&self) -> Self {
        let mut changed = self.clone();
        changed.color.map = None;
        changed
    }

    /// The name of its colour map, where it has one.
    #[must_use]
    pub fn color_map(&self) -> Option<&str> {
        self.color.map.as_ref().map(|map| map.name.as_str())
    }

    fn checked(&self) -> Result<Self, Findings> {
        Self::parse(Path::new("edited transfer function"), &self.to_ron())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> TransferFunction {
        TransferFunction::parse(Path::new("test.ron"), text).unwrap()
    }

    #[test]
    fn points_come_back_as_they_were() {
        let text = r##"(domain: data, points: [(at: 0, color: "#102030", opacity: 0), (at: 5, color: "#ffffff", opacity: 0.5),
            (at: 5, color: "#ff0000", opacity: 0.75), (at: 9, color: "#ff0000", opacity: 1)])"##;
        let transfer = read(text);
        let points = transfer.control_points();
        let shape: Vec<(f64, f64)> = points
            .iter()
            .map(|point| (point.at, point.opacity))
            .collect();
        assert_eq!(shape, [(0.0, 0.0), (5.0, 0.5), (5.0, 0.75), (9.0, 1.0)]);
        let again = transfer.with_control_points(&points).unwrap();
        assert_eq!(again, transfer);
        // A step at the first of them, wherever numbers round to.
        for at in [-7.0, 0.0, 0.1, 1.0 / 3.0, 5e3] {
            let end = at + 1.5;
            let transfer = read(&format!(
                "(domain: data, color: [({at:?}, (0, 0, 1)), ({end:?}, (1, 0, 0))], opacity: [({at:?}, 0), ({at:?}, 0.5), ({end:?}, 1)])"
            ));
            let points = transfer.control_points();
            assert_eq!(points.len(), 3, "{points:?}");
            let again = transfer.with_control_points(&points).unwrap();
            for s in [at - 1.0, at, at + 0.4, end, end + 1.0] {
                assert_eq!(
                    (again.color(s), again.opacity(s)),
                    (transfer.color(s), transfer.opacity(s))
                );
            }
        }
    }

    #[test]
    fn a_moved_point_widens_the_range_and_opacities_are_kept_within_bounds() {
        let transfer = read(
            r##"(domain: data, points: [(at: 0, color: "#000000", opacity: 0), (at: 5, color: "#ffffff", opacity: 0.5)])"##,
        );
        let mut points = transfer.control_points();
        points[1].at = 7.0;
        points[1].opacity = 3.0;
        let moved = transfer.with_control_points(&points).unwrap();
        assert_eq!(moved.range(), (0.0, 7.0));
        assert_eq!(moved.control_points()[1].opacity, 1.0);
        points[0].at = f64::NAN;
        assert!(transfer.with_control_points(&points).is_err());
        assert!(transfer.with_control_points(&[]).is_err());
    }

    #[test]
    fn colour_maps_come_and_go() {
        let transfer = read(
            r##"(domain: data, points: [(at: 0, color: "#000000", opacity: 0), (at: 5, color: "#ffffff", opacity: 0.5)])"##,
        );
        let mapped = transfer.with_color_map("viridis", 0.0, 5.0, false).unwrap();
        assert_eq!(mapped.color_map(), Some("viridis"));
        assert_eq!(mapped.control_points().len(), 2);
        // Opacities of a mapped one are edited without its colours.
        let mut points = mapped.control_points();
        points[0].opacity = 0.25;
        let edited = mapped.with_control_points(&points).unwrap();
        assert_eq!(edited.color_map(), Some("viridis"));
        assert_eq!(edited.color(2.5), mapped.color(2.5));
        let free = mapped.without_color_map();
        assert_eq!(free.color(2.5), mapped.color(2.5));
        assert!(free.control_points().len() > 100);
        assert!(transfer.with_color_map("virids", 0.0, 5.0, false).is_err());
    }
}
