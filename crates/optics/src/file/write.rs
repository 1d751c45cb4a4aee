//! The canonical text of a transfer function, in the grammar that the reader reads.

use std::fmt::Write as _;

use crate::material::{Material, MaterialPoint};
use crate::transfer::{Absorption, Domain, MapUse, ReferenceLength, TransferFunction};

/// The canonical text: colour and opacity apart, every default spelled out, numbers in full.
pub(crate) fn write(transfer: &TransferFunction) -> String {
    let (from, to) = transfer.range;
    let domain = match transfer.domain {
        Domain::Normalised => "normalised".to_owned(),
        Domain::Range => "range".to_owned(),
        Domain::Data => format!("data(from: {from:?}, to: {to:?})"),
    };
    let reference_length = match transfer.reference_length {
        ReferenceLength::Voxels(length) => format!("(voxels: {length:?})"),
        ReferenceLength::World(length) => format!("(world: {length:?})"),
    };
    let color = match &transfer.color.map {
        Some(MapUse {
            name,
            from,
            to,
            is_reversed,
        }) => {
            format!("map(name: {name:?}, from: {from:?}, to: {to:?}, reversed: {is_reversed})")
        }
        None => match transfer.color.curve.points() {
            [(_, [r, g, b])] => format!("({r:?}, {g:?}, {b:?})"),
            points => list(points, |[r, g, b]| format!("({r:?}, {g:?}, {b:?})")),
        },
    };
    let absorption = match &transfer.absorption {
        Absorption::Opacity(_) => "opacity",
        Absorption::Extinction(_) => "extinction",
    };
    let absorbed = list(transfer.absorption.curve().points(), |[value]| {
        format!("{value:?}")
    });
    // Only where the file has them: the texts, and digests, of those without stay what they were.
    let refraction = transfer
        .refraction
        .as_ref()
        .map_or_else(String::new, |curve| {
            let indices = list(curve.points(), |[index]| format!("{index:?}"));
            format!("    refraction: {indices},\n")
        });
    let material = match transfer.material.points() {
        [] => String::new(),
        points => material_list(points),
    };
    format!(
        "(\n    domain: {domain},\n    reference_length: {reference_length},\n    color: {color},\n    \
         {absorption}: {absorbed},\n{refraction}{material})\n"
    )
}

fn material_list(points: &[MaterialPoint]) -> String {
    let mut text = "    material: [".to_owned();
    for (at, values) in points {
        // Writing to a String cannot fail.
        let _ = write!(text, "\n        (at: {at:?}");
        for (name, value) in Material::NAMES.iter().zip(values) {
            if let Some(value) = value {
                let _ = write!(text, ", {name}: {value:?}");
            }
        }
        text.push_str("),");
    }
    text.push_str("\n    ],\n");
    text
}

fn list<const N: usize>(points: &[(f64, [f64; N])], value: impl Fn([f64; N]) -> String) -> String {
    let mut text = "[".to_owned();
    for (at, point) in points {
        // Writing to a String cannot fail.
        let _ = write!(text, "\n        ({at:?}, {}),", value(*point));
    }
    text.push_str("\n    ]");
    text
}
