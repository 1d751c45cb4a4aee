//! A picture packet by packet, tiles on all cores.

use rayon::prelude::*;
use volgraph_reference::Rays;
use volgraph_volume::Grid;

use crate::lanes::{COUNT, Lanes};
use crate::packet::{Lens, Packet, SIZE};

/// What eight rays show.
pub(crate) trait Shown<L: Lanes>: Sync {
    /// Premultiplied colour, and the share of what is behind that goes through. Of a packet of which some ray meets the box.
    fn shown(&self, l: L, packet: &Packet) -> [[f32; COUNT]; 4];
}

/// The picture of rays over what is behind them, in rows from the top.
pub(crate) fn draw<L: Lanes>(
    l: L,
    placement: &Grid,
    rays: &Rays,
    behind: &[[f32; 4]],
    shows: &impl Shown<L>,
) -> Vec<[f32; 4]> {
    let [width, height] = rays.size;
    let (columns, pixels) = (width as usize, width as usize * height as usize);
    let mut picture = behind.to_vec();
    picture.resize(pixels, [0.0; 4]);
    let lens = Lens::new(rays, placement);
    let [low, high] = lens.bounds();
    let bands = picture.par_chunks_mut(columns.max(1) * SIZE[1] as usize);
    let bands = (0..height.div_ceil(SIZE[1])).into_par_iter().zip(bands);
    bands.for_each(|(band, pixels)| {
        let top = band * SIZE[1];
        if top >= high[1] || top + SIZE[1] <= low[1] {
            return;
        }
        l.run(
            #[inline(always)]
            || {
                let mut left = low[0] / SIZE[0] * SIZE[0];
                while left < high[0] {
                    let packet = lens.packet(left, top);
                    if packet.far != 0.0 {
                        let shown = shows.shown(l, &packet);
                        compose(&packet, &shown, left, width, pixels);
                    }
                    left += SIZE[0];
                }
            },
        );
    });
    picture
}

#[inline(always)]
fn compose(
    packet: &Packet,
    shown: &[[f32; COUNT]; 4],
    left: u32,
    width: u32,
    pixels: &mut [[f32; 4]],
) {
    for (lane, length) in packet.length.into_iter().enumerate() {
        let (right, down) = (lane as u32 % SIZE[0], lane as u32 / SIZE[0]);
        let at = (down * width + left + right) as usize;
        let open = shown[3][lane];
        let color = [shown[0][lane], shown[1][lane], shown[2][lane], 1.0 - open];
        // Beyond the right edge is the next row's pixel.
        if length > 0.0
            && let Some(pixel) = pixels.get_mut(at)
        {
            for channel in 0..4 {
                pixel[channel] = color[channel] + open * pixel[channel];
            }
        }
    }
}
