//! From several values per voxel to one scalar: one of them, the length of them all, or the brightness of a colour.

use rayon::prelude::*;
use volgraph_volume::{Component, Element, Trouble, VolumeError, Voxels, for_voxels};

use crate::axes::Axes;
use crate::contents::{Components, Contents};
use crate::load::LoadOptions;

/// Scalars, and colours where they were asked for.
#[derive(Debug)]
pub(crate) struct Taken {
    pub voxels: Voxels,
    pub colors: Option<Vec<[u8; 4]>>,
}

/// What the options name, or what the contents suggest; `None` where there is only one value.
pub(crate) fn component(
    contents: &Contents,
    options: &LoadOptions,
) -> Result<Option<Component>, VolumeError> {
    let count = contents.axes.component_count();
    let wrong =
        |cause: String, remedy: String| Err(VolumeError::Component(Trouble::new(cause, remedy)));
    let colors = contents.components == Components::Colors && (2..=4).contains(&count);
    match options.component {
        None if count == 1 => Ok(None),
        None if colors => Ok(Some(Component::Color)),
        None => wrong(
            format!("there are {count} values per voxel, and a volume takes one"),
            format!(
                "name one with the option `component`, 0 to {}, or take their `magnitude`",
                count - 1
            ),
        ),
        Some(Component::Index(index)) if u64::from(index) >= count => wrong(
            format!("there is no component {index}: there are {count} values per voxel"),
            if count == 1 {
                "leave the option out".to_owned()
            } else {
                format!("name one of 0 to {}", count - 1)
            },
        ),
        Some(Component::Color) if !(2..=4).contains(&count) => wrong(
            format!("a colour has two to four values, and a voxel here has {count}"),
            "name a component by its number, or take the `magnitude`".to_owned(),
        ),
        Some(component) => Ok(Some(component)),
    }
}

/// One scalar per voxel of values that lie in the order of `axes` without time.
pub(crate) fn take(
    axes: &Axes,
    values: Voxels,
    component: Option<Component>,
    components: Components,
) -> Taken {
    let one = |voxels| Taken {
        voxels,
        colors: None,
    };
    match component {
        None => one(axes.select(values, 0)),
        Some(Component::Index(index)) => one(axes.select(values, index.into())),
        Some(Component::Magnitude) => one(magnitude(axes, &values)),
        Some(Component::Color) => color(axes, &values, components),
    }
}

/// The Euclidean length: float64 where the values have 32 bits or more, float32 otherwise.
fn magnitude(axes: &Axes, values: &Voxels) -> Voxels {
    let count = axes.component_count();
    let mut squares = vec![0.0_f64; axes.voxel_count()];
    for component in 0..count {
        let one = axes.selected(values, component);
        for_voxels!(&one, one => squares
            .par_iter_mut()
            .zip(one.par_iter())
            .for_each(|(sum, value)| *sum += value.to_f64().powi(2)));
    }
    let wide = !matches!(values, Voxels::F32(_)) && values.scalar_type().size() >= 4;
    if wide {
        squares.par_iter_mut().for_each(|sum| *sum = sum.sqrt());
        return Voxels::F64(squares);
    }
    #[expect(clippy::cast_possible_truncation, reason = "float32 is what is wanted")]
    let lengths = squares.par_iter().map(|sum| sum.sqrt() as f32);
    Voxels::F32(lengths.collect())
}

/// Channels to eight bits: integers by their type's range, floats from 0 to 1.
fn color(axes: &Axes, values: &Voxels, components: Components) -> Taken {
    let count = axes.component_count();
    let channel = |component: u64| -> Vec<u8> {
        let one = axes.selected(values, component);
        let (low, high) = one.scalar_type().range().unwrap_or((0.0, 1.0));
        let low = low.max(0.0);
        let scale = 255.0 / (high - low);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "clamped to a byte"
        )]
        let byte = |value: f64| ((value - low) * scale).round().clamp(0.0, 255.0) as u8;
        for_voxels!(&one, one => one.par_iter().map(|value| byte(value.to_f64())).collect())
    };
    let channels: Vec<Vec<u8>> = (0..count).map(channel).collect();
    let at = |channel: usize, voxel: usize| channels[channel][voxel];
    let gray = components == Components::Colors && count == 2;
    let colors: Vec<[u8; 4]> = (0..axes.voxel_count())
        .into_par_iter()
        .map(|voxel| match count {
            2 if gray => {
                let value = at(0, voxel);
                [value, value, value, at(1, voxel)]
            }
            2 => [at(0, voxel), at(1, voxel), 0, 255],
            3 => [at(0, voxel), at(1, voxel), at(2, voxel), 255],
            _ => [at(0, voxel), at(1, voxel), at(2, voxel), at(3, voxel)],
        })
        .collect();
    let has_alpha = count == 4 || gray;
    // An alpha that is the same everywhere says nothing about the inside.
    let alpha_varies = has_alpha && colors.windows(2).any(|pair| pair[0][3] != pair[1][3]);
    let scalars = colors
        .par_iter()
        .map(|&[r, g, b, a]| if alpha_varies { a } else { luma([r, g, b]) });
    Taken {
        voxels: Voxels::U8(scalars.collect()),
        colors: Some(colors),
    }
}

/// The luma of Rec. 709 on encoded values, rounded.
fn luma([r, g, b]: [u8; 3]) -> u8 {
    let sum = 2126 * u32::from(r) + 7152 * u32::from(g) + 722 * u32::from(b);
    u8::try_from((sum + 5000) / 10000).unwrap_or(u8::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axes() -> Axes {
        Axes::new(vec![3, 2, 1, 1], vec![1, 2, 3]).unwrap()
    }

    #[test]
    fn a_length_is_taken_over_all_components_in_enough_digits() {
        let taken = |values: Voxels| {
            take(
                &axes(),
                values,
                Some(Component::Magnitude),
                Components::Values,
            )
            .voxels
        };
        assert_eq!(
            taken(vec![3.0_f32, 4.0, 0.0, 2.0, -3.0, 6.0].into()),
            vec![5.0_f32, 7.0].into()
        );
        assert_eq!(
            taken(vec![0_i16, 0, -9, 1, 2, -2].into()),
            vec![9.0_f32, 3.0].into()
        );
        assert_eq!(
            taken(vec![3_i32, 4, 0, 0, 0, 1 << 30].into()),
            vec![5.0_f64, f64::from(1 << 30)].into()
        );
    }

    #[test]
    fn a_colour_keeps_its_channels_and_gives_its_luma_or_alpha() {
        let taken = take(
            &axes(),
            vec![255_u8, 0, 0, 10, 20, 30].into(),
            Some(Component::Color),
            Components::Colors,
        );
        assert_eq!(taken.voxels, vec![54_u8, 19].into());
        assert_eq!(
            taken.colors.unwrap(),
            vec![[255, 0, 0, 255], [10, 20, 30, 255]]
        );
        let four = Axes::new(vec![4, 2], vec![1]).unwrap();
        let taken = take(
            &four,
            vec![65535_u16, 0, 0, 257, 0, 0, 0, 514].into(),
            Some(Component::Color),
            Components::Colors,
        );
        assert_eq!(taken.voxels, vec![1_u8, 2].into());
        assert_eq!(taken.colors.unwrap(), vec![[255, 0, 0, 1], [0, 0, 0, 2]]);
    }
}
