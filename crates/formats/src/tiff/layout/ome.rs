//! OME-XML in the description of a TIFF file's first page.
//! Source: <https://docs.openmicroscopy.org/ome-model/6.3.1/ome-tiff/specification.html>.

use glam::DVec3;
use roxmltree::{Document, Node};
use volgraph_volume::{Trouble, VolumeError};

use super::{Layout, unit};
use crate::load::LoadOptions;
use crate::tiff::pages::Pages;

fn bad(cause: String) -> VolumeError {
    VolumeError::BadValue(Trouble::new(cause, "save the file anew as OME-TIFF"))
}

/// An element's child of a name, in any namespace.
fn children<'d, 'x: 'd>(
    node: Node<'d, 'x>,
    name: &'static str,
) -> impl Iterator<Item = Node<'d, 'x>> {
    node.children()
        .filter(move |child| child.tag_name().name() == name)
}

pub(super) fn layout(
    pages: &Pages<'_>,
    text: &str,
    options: &LoadOptions,
) -> Result<Layout, VolumeError> {
    let document = Document::parse(text).map_err(|error| {
        VolumeError::HeaderSyntax(Trouble::new(
            format!("the OME-XML of the first page cannot be read: {error}"),
            "save the file anew as OME-TIFF",
        ))
    })?;
    let root = document.root_element();
    let images: Vec<Node<'_, '_>> = children(root, "Image").collect();
    let image = pick(&images, options)?;
    let pixels = children(image, "Pixels").next();
    let pixels = pixels.ok_or_else(|| bad("the OME-XML has an image without pixels".into()))?;
    let sizes = Sizes::of(pixels)?;
    let order = sizes.order(pixels, pages, images.len() == 1)?;
    let length = |name: &str| {
        let value: f64 = pixels.attribute(name)?.parse().ok()?;
        Some(value).filter(|value| value.is_finite() && *value > 0.0)
    };
    let mut layout = super::plain(pages);
    let version = root
        .tag_name()
        .namespace()
        .and_then(|uri| uri.rsplit('/').next());
    layout.format = format!("OME-TIFF {}", version.unwrap_or_default())
        .trim_end()
        .to_owned();
    (layout.channels, layout.slices, layout.steps) = (sizes.channels, sizes.slices, sizes.steps);
    layout.order = order;
    if let Some(x) = length("PhysicalSizeX") {
        let y = length("PhysicalSizeY").unwrap_or(x);
        let z = length("PhysicalSizeZ");
        if z.is_none() && sizes.slices > 1 {
            let text = "no spacing of the slices is said: they are taken to be as far apart as the columns";
            layout.warnings.push(text.into());
        }
        let units = ["X", "Y", "Z"].map(|axis| {
            let unit = pixels.attribute(format!("PhysicalSize{axis}Unit").as_str());
            unit.unwrap_or("µm").to_owned()
        });
        let unlike = units[1] != units[0] || z.is_some() && units[2] != units[0];
        if unlike {
            return Err(VolumeError::Unsupported(Trouble::new(
                format!("lengths in several units: {}", units.join(", ")),
                "save the file with one unit of length",
            )));
        }
        layout.spacing = DVec3::new(x, y, z.unwrap_or(x));
        layout.length_unit = Some(unit(&units[0]));
    }
    layout.interval = length("TimeIncrement");
    let time_unit = pixels.attribute("TimeIncrementUnit").unwrap_or("s");
    layout.time_unit = layout.interval.map(|_| time_unit.to_owned());
    if let Some(name) = image.attribute("Name") {
        layout
            .facts
            .push(("image".into(), name.chars().take(200).collect()));
    }
    let channels = children(pixels, "Channel").filter_map(|channel| channel.attribute("Name"));
    let channels: Vec<&str> = channels.take(64).collect();
    if !channels.is_empty() {
        layout.facts.push(("channels".into(), channels.join(", ")));
    }
    Ok(layout)
}

/// The one image, or the one that the options name.
fn pick<'d, 'x>(
    images: &[Node<'d, 'x>],
    options: &LoadOptions,
) -> Result<Node<'d, 'x>, VolumeError> {
    let label = |image: &Node<'_, '_>| {
        let text = |name| image.attribute(name).unwrap_or_default();
        format!("{} {}", text("ID"), text("Name")).trim().to_owned()
    };
    let fits: Vec<Node<'d, 'x>> = match &options.part {
        Some(part) => {
            let exact = |image: &&Node<'_, '_>| {
                [image.attribute("ID"), image.attribute("Name")].contains(&Some(part.as_str()))
            };
            let exact: Vec<_> = images.iter().filter(exact).copied().collect();
            let partly = || {
                images
                    .iter()
                    .filter(|image| label(image).contains(part.as_str()))
            };
            if exact.is_empty() {
                partly().copied().collect()
            } else {
                exact
            }
        }
        None => images.to_vec(),
    };
    if let [image] = fits.as_slice() {
        return Ok(*image);
    }
    let names: Vec<String> = images.iter().take(30).map(label).collect();
    if names.is_empty() {
        return Err(bad("the OME-XML has no image".into()));
    }
    Err(VolumeError::Option(Trouble::new(
        format!("the file has {} images: {}", images.len(), names.join("; ")),
        "name one of them with the option `part`",
    )))
}

/// Sizes over the pages.
struct Sizes {
    channels: usize,
    slices: usize,
    steps: usize,
    /// The axes over the pages by their letters, the fastest first.
    axes: [u8; 3],
}

impl Sizes {
    fn of(pixels: Node<'_, '_>) -> Result<Self, VolumeError> {
        let size = |name: &str| {
            let value = pixels.attribute(name).unwrap_or("1").parse::<usize>().ok();
            let value = value.filter(|size| (1..1 << 24).contains(size));
            value.ok_or_else(|| bad(format!("the OME-XML's {name} is no size")))
        };
        let samples = children(pixels, "Channel").next();
        let samples =
            samples.and_then(|channel| channel.attribute("SamplesPerPixel")?.parse().ok());
        let samples = samples.unwrap_or(1_usize).max(1);
        let order = pixels
            .attribute("DimensionOrder")
            .unwrap_or("XYZCT")
            .as_bytes();
        let axes: Option<[u8; 3]> = order.get(2..).and_then(|axes| axes.try_into().ok());
        let axes = axes.filter(|axes| b"ZCT".iter().all(|axis| axes.contains(axis)));
        Ok(Self {
            channels: (size("SizeC")? / samples).max(1),
            slices: size("SizeZ")?,
            steps: size("SizeT")?,
            axes: axes.ok_or_else(|| bad("the OME-XML's DimensionOrder is none".into()))?,
        })
    }

    fn size(&self, axis: u8) -> usize {
        match axis {
            b'C' => self.channels,
            b'Z' => self.slices,
            _ => self.steps,
        }
    }

    /// The page of each channel, slice and step.
    fn order(
        &self,
        pixels: Node<'_, '_>,
        pages: &Pages<'_>,
        only_image: bool,
    ) -> Result<Vec<usize>, VolumeError> {
        let count = pages.count();
        let needed = self
            .channels
            .checked_mul(self.slices)
            .and_then(|n| n.checked_mul(self.steps));
        let needed = needed.filter(|&needed| needed <= count).ok_or_else(|| {
            VolumeError::DataTooShort(Trouble::new(
                format!(
                    "the OME-XML says {} channels, {} slices and {} time steps, the file has {count} pages",
                    self.channels, self.slices, self.steps
                ),
                "give a file that holds all its pages itself, or fetch it again",
            ))
        })?;
        let mut order = vec![None; needed];
        let parts: Vec<Node<'_, '_>> = children(pixels, "TiffData").collect();
        let mut place = |at: [usize; 3], page: usize| -> Option<()> {
            // `at` is along the axes in their order.
            let along = |letter: u8| {
                let axis = self.axes.iter().position(|axis| *axis == letter)?;
                Some(at[axis]).filter(|&index| index < self.size(letter))
            };
            let (c, z, t) = (along(b'C')?, along(b'Z')?, along(b'T')?);
            let slot = order.get_mut((t * self.slices + z) * self.channels + c)?;
            *slot = Some(page).filter(|page| *page < count);
            Some(())
        };
        let mut run = |first: [usize; 3], page: usize, length: usize| {
            let mut at = first;
            for page in page..page.saturating_add(length) {
                if place(at, page).is_none() {
                    break;
                }
                for (axis, letter) in self.axes.iter().enumerate() {
                    at[axis] += 1;
                    if at[axis] < self.size(*letter) || axis == 2 {
                        break;
                    }
                    at[axis] = 0;
                }
            }
        };
        if parts.is_empty() && only_image {
            run([0; 3], 0, needed);
        }
        for part in parts {
            let elsewhere = children(part, "UUID").any(|uuid| {
                let file = uuid.attribute("FileName");
                let own = pages
                    .input
                    .path
                    .file_name()
                    .map(|name| name.to_string_lossy());
                file.is_some_and(|file| own.is_none_or(|own| file != own))
            });
            let number = |name: &str| {
                part.attribute(name)
                    .and_then(|text| text.parse::<usize>().ok())
            };
            let ifd = number("IFD");
            let length = number("PlaneCount").unwrap_or(if ifd.is_some() { 1 } else { needed });
            let first = self.axes.map(|axis| {
                let letter = char::from(axis);
                number(&format!("First{letter}")).unwrap_or(0)
            });
            // A file that was renamed still holds its own pages; one that has too few does not.
            if !elsewhere || needed == count {
                run(first, ifd.unwrap_or(0), length.min(needed));
            }
        }
        order.into_iter().collect::<Option<_>>().ok_or_else(|| {
            VolumeError::Unsupported(Trouble::new(
                "the OME-XML does not place each page of this file: some are in other files",
                "join the files to one OME-TIFF",
            ))
        })
    }
}
