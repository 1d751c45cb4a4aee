//! What matter looks like: of the whole volume, or of one label.

use glam::DVec3;
use volgraph_optics::Material;

use crate::matter::{Materials, Matter};

/// All that may differ from label to label.
#[derive(Clone, Debug)]
pub struct Look {
    /// Colours and extinctions, where a technique asks for them.
    pub matter: Option<Matter>,
    /// What it makes of light.
    pub materials: Materials,
    /// The lights; `None` where nothing is lit.
    pub lamps: Option<Vec<Lamp>>,
    /// Isosurfaces. Of techniques that draw a solid the first one bounds it.
    pub layers: Vec<Layer>,
    /// Whether the solid is below its isovalue.
    pub is_solid_below: bool,
    /// What a projected scalar looks like.
    pub tone: Tone,
}

/// An isosurface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layer {
    /// The scalar on it, in data units.
    pub level: f64,
    /// Linear colour, not premultiplied.
    pub color: [f64; 3],
    /// Its opacity.
    pub opacity: f64,
}

/// A light; none grows weaker with its distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lamp {
    /// Where it is.
    pub place: Place,
    /// Linear colour, as bright as it is.
    pub color: [f64; 3],
}

/// Where a light is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Place {
    /// At the eye.
    Eye,
    /// In this unit world direction.
    Towards(DVec3),
    /// At this world position.
    At(DVec3),
}

/// A window of scalars.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Window {
    /// The scalar that shows nothing, in data units.
    pub low: f64,
    /// How much more shows most; not 0.
    pub span: f64,
}

impl Window {
    /// 0 at the low end, 1 at the high end.
    #[must_use]
    pub fn share(&self, scalar: f64) -> f64 {
        (scalar - self.low) / self.span
    }
}

/// What a projected scalar looks like.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Tone {
    /// What the matter makes of it over one reference length.
    Matter,
    /// From nothing to one linear colour.
    Window(Window, [f64; 3]),
}

impl Look {
    /// Matter without light.
    #[must_use]
    pub fn unlit(matter: Matter) -> Self {
        Self {
            matter: Some(matter),
            materials: Materials::NONE,
            lamps: None,
            layers: Vec::new(),
            is_solid_below: false,
            tone: Tone::Matter,
        }
    }

    /// No component of what matter and surfaces show is larger.
    pub(crate) fn brightest(&self) -> f64 {
        let of_matter = self.matter.as_ref().map_or(0.0, Matter::brightest);
        let of_layers = self.layers.iter().flat_map(|layer| layer.color);
        let color = of_layers.fold(of_matter, f64::max);
        let Some(lamps) = &self.lamps else {
            return color;
        };
        let lit: f64 = lamps
            .iter()
            .map(|lamp| lamp.color.into_iter().fold(0.0, f64::max))
            .sum();
        // Of a transfer function's materials no value but the shininess is more than 1.
        let share = |given: f64| {
            if self.materials.by_transfer {
                1.0
            } else {
                given
            }
        };
        let Material {
            ambient,
            diffuse,
            specular,
            shininess: _,
        } = self.materials.default;
        let shown = color * (share(ambient) + share(diffuse) * lit) + share(specular) * lit;
        // What is flat is not lit.
        color.max(shown)
    }

    /// Linear premultiplied colour of a projected scalar.
    pub(crate) fn toned(&self, scalar: f64) -> [f64; 4] {
        match (&self.tone, &self.matter) {
            (Tone::Window(window, color), _) => {
                let share = window.share(scalar).clamp(0.0, 1.0);
                let [r, g, b] = color.map(|channel| channel * share);
                [r, g, b, share]
            }
            (Tone::Matter, Some(matter)) => {
                let (color, opacity) = matter.over_reference(scalar);
                let [r, g, b] = color.map(|channel| channel * opacity);
                [r, g, b, opacity]
            }
            (Tone::Matter, None) => [0.0; 4],
        }
    }

    /// The material of a surface where the field has a scalar.
    pub(crate) fn material_at(&self, scalar: f64) -> Material {
        match &self.matter {
            Some(matter) if self.materials.by_transfer => {
                matter.material(matter.part_of(scalar), scalar)
            }
            _ => self.materials.default,
        }
    }

    /// Whether a scalar is that of the solid.
    pub(crate) fn is_solid(&self, scalar: f64) -> bool {
        let bounds = self.layers.first();
        bounds.is_some_and(|layer| (scalar >= layer.level) != self.is_solid_below)
    }
}
