//! A picture by raycasting: one walk for eight pixels, tiles on all cores.

use rayon::prelude::*;
use volgraph_reference::Rays;
use volgraph_volume::Grid;

use crate::classify::{Integral1d, Post};
use crate::empty::DistanceMap;
use crate::grid::{Cells, Sampled, VoxelGrid};
use crate::lanes::{Lanes, Portable, Work, with_lanes};
use crate::packet::{Lens, Packet, SIZE};
use crate::scout::Spans;
use crate::tables::{Classify, Tables};
use crate::walk::{Classified, Walk};

/// What is drawn.
#[derive(Clone, Copy, Debug)]
pub struct Raycast<'a> {
    /// Where the volume is.
    pub placement: &'a Grid,
    /// Its voxels.
    pub voxels: &'a VoxelGrid,
    /// The transfer function, for steps of this length.
    pub tables: &'a Tables,
    /// What need not be looked at; all is where there is none.
    pub empty: Option<&'a DistanceMap>,
    /// World length of a segment.
    pub step_world: f32,
    /// A ray ends where less than this share of the light behind could still reach the eye.
    pub early_termination: f32,
}

/// Pixels of a tile to the right, and of a band of tiles down.
const TILE: [u32; 2] = [16, 8];

/// Packets of a tile in a row, and in all.
const ACROSS: u32 = TILE[0] / SIZE[0];
const PACKETS: usize = (ACROSS * TILE[1] / SIZE[1]) as usize;

struct Picture<'a> {
    raycast: &'a Raycast<'a>,
    rays: &'a Rays,
    behind: &'a [[f32; 4]],
    /// World length of a voxel's shortest side.
    voxel_world: f32,
}

impl Work for Picture<'_> {
    type Output = Vec<[f32; 4]>;
    fn with<L: Lanes>(self, lanes: L) -> Self::Output {
        let raycast = self.raycast;
        match (&raycast.voxels.cells, raycast.tables.classify) {
            (Cells::Faces(cells), Classify::Post) => self.draw::<_, _, Post<L>>(lanes, cells),
            (Cells::Edges(cells), Classify::Post) => self.draw::<_, _, Post<L>>(lanes, cells),
            (Cells::Singles(cells), Classify::Post) => self.draw::<_, _, Post<L>>(lanes, cells),
            (Cells::Faces(cells), _) => self.draw::<_, _, Integral1d<L>>(lanes, cells),
            (Cells::Edges(cells), _) => self.draw::<_, _, Integral1d<L>>(lanes, cells),
            (Cells::Singles(cells), _) => self.draw::<_, _, Integral1d<L>>(lanes, cells),
        }
    }
}

impl Picture<'_> {
    fn draw<L: Lanes, S: Sampled, C: Classified<L>>(&self, lanes: L, cells: &S) -> Vec<[f32; 4]> {
        let [width, height] = self.rays.size;
        let (columns, pixels) = (width as usize, width as usize * height as usize);
        let mut picture = self.behind.to_vec();
        picture.resize(pixels, [0.0; 4]);
        let lens = Lens::new(self.rays, self.raycast.placement);
        let [low, high] = lens.bounds();
        let bands = picture.par_chunks_mut(columns.max(1) * TILE[1] as usize);
        (0..height.div_ceil(TILE[1]))
            .into_par_iter()
            .zip(bands)
            .for_each(|(band, pixels)| {
                let top = band * TILE[1];
                if top >= high[1] || top + TILE[1] <= low[1] {
                    return;
                }
                let first = low[0] / SIZE[0] * SIZE[0];
                for left in (first..high[0]).step_by(TILE[0] as usize) {
                    lanes.run(
                        #[inline(always)]
                        || self.tile::<L, S, C>(lanes, cells, &lens, [left, top], pixels),
                    );
                }
            });
        picture
    }

    #[inline(always)]
    fn tile<L: Lanes, S: Sampled, C: Classified<L>>(
        &self,
        lanes: L,
        cells: &S,
        lens: &Lens<'_>,
        [left, top]: [u32; 2],
        pixels: &mut [[f32; 4]],
    ) {
        let width = self.rays.size[0];
        let place = |at: usize| {
            let [x, y] = [at as u32 % ACROSS * SIZE[0], at as u32 / ACROSS * SIZE[1]];
            [left + x, y]
        };
        // Functions of the standard library that take this one are not compiled for the machine's own instructions.
        let mut packets = [Packet::NONE; PACKETS];
        for (at, packet) in packets.iter_mut().enumerate() {
            let [x, y] = place(at);
            *packet = lens.packet(x, top + y);
        }
        let mut range = [f64::INFINITY, 0.0_f64];
        for packet in &packets {
            range = [range[0].min(packet.near[0]), range[1].max(packet.far)];
        }
        if range[0] > range[1] {
            return;
        }
        let raycast = self.raycast;
        let spans = raycast.empty.map_or(Spans::WHOLE, |map| {
            let scout = lens.scout([left, top], TILE, range);
            let least = raycast.step_world.max(self.voxel_world);
            scout.spans(map, raycast.voxels.dims, least)
        });
        for (at, packet) in packets.iter().enumerate() {
            if packet.far == 0.0 {
                continue;
            }
            let segments = spans.segments(packet, raycast.step_world);
            let shown = Walk::new(lanes, raycast, packet).shown::<S, C>(cells, segments);
            let [x, y] = place(at);
            for (lane, length) in packet.length.into_iter().enumerate() {
                let (right, down) = (lane as u32 % SIZE[0], lane as u32 / SIZE[0]);
                let at = ((y + down) * width + x + right) as usize;
                let [r, g, b, open] = [0, 1, 2, 3].map(|channel| shown[channel][lane]);
                // Beyond the right edge is the next row's pixel.
                if length > 0.0
                    && let Some(pixel) = pixels.get_mut(at)
                {
                    let color = [r, g, b, 1.0 - open];
                    *pixel = std::array::from_fn(|i| color[i] + open * pixel[i]);
                }
            }
        }
    }
}

impl Raycast<'_> {
    /// The picture of these rays, in rows from the top: linear premultiplied colours over those behind (over nothing where
    /// there are none).
    #[must_use]
    pub fn render(&self, rays: &Rays, behind: &[[f32; 4]]) -> Vec<[f32; 4]> {
        with_lanes(Picture {
            raycast: self,
            rays,
            behind,
            voxel_world: self.placement.min_spacing() as f32,
        })
    }

    /// The same without the machine's own instructions: to the same bits, and slower.
    #[must_use]
    pub fn render_portable(&self, rays: &Rays, behind: &[[f32; 4]]) -> Vec<[f32; 4]> {
        Picture {
            raycast: self,
            rays,
            behind,
            voxel_world: self.placement.min_spacing() as f32,
        }
        .with(Portable)
    }
}
