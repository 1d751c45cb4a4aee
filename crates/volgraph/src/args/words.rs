//! What single words of the command line mean: sizes, types, bounds, slots, files, cameras.

use std::path::PathBuf;

use volgraph::CameraDesc;
use volgraph_volume::ScalarType;

pub(super) fn parse_size(text: &str) -> Result<[u32; 2], String> {
    let (width, height) = text
        .split_once('x')
        .ok_or("write it as WIDTHxHEIGHT, such as 512x512")?;
    let side = |text: &str| match text.parse::<u32>() {
        Ok(n) if n > 0 => Ok(n),
        _ => Err(format!("`{text}` is not a number of pixels of at least 1")),
    };
    Ok([side(width)?, side(height)?])
}

pub(super) fn parse_dims(text: &str) -> Result<[u32; 3], String> {
    let side = |side: &str| side.parse().ok().filter(|n| *n > 0);
    let sides: Option<Vec<u32>> = text.split('x').map(side).collect();
    sides
        .and_then(|sides| <[u32; 3]>::try_from(sides).ok())
        .ok_or_else(|| "write it as XxYxZ, such as 256x256x128".to_owned())
}

pub(super) fn parse_type(text: &str) -> Result<ScalarType, String> {
    ScalarType::parse(text).ok_or_else(|| {
        let names: Vec<&str> = ScalarType::ALL
            .iter()
            .map(|scalar_type| scalar_type.name())
            .collect();
        format!("types are {}", names.join(", "))
    })
}

pub(super) fn parse_bound(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(bound) if bound >= 0.0 => Ok(bound),
        _ => Err("give a number of at least 0".to_owned()),
    }
}

pub(super) fn parse_slot(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((slot, choice)) if !slot.is_empty() && !choice.is_empty() => {
            Ok((slot.to_owned(), choice.to_owned()))
        }
        _ => Err("write it as SLOT=CHOICE, such as light=phong".to_owned()),
    }
}

/// A name and a file; the name is empty where there is none. Whatever stands before a `=` is a name, if no file can be
/// meant by it.
pub(super) fn parse_volume(text: &str) -> Result<(String, PathBuf), String> {
    let named = text
        .split_once('=')
        .filter(|(name, _)| !name.contains(['/', '\\', '.']));
    match named {
        Some((name, file)) if !name.is_empty() && !file.is_empty() => {
            Ok((name.to_owned(), PathBuf::from(file)))
        }
        None if !text.is_empty() => Ok((String::new(), PathBuf::from(text))),
        _ => Err("write it as NAME=FILE, with the name of a source of the graph".to_owned()),
    }
}

pub(super) fn parse_camera(text: &str) -> Result<CameraDesc, String> {
    volgraph_graph::read::camera_text("--camera".as_ref(), text)
        .map_err(|findings| findings.to_string())
}
