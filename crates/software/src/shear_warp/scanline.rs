//! A row of the intermediate image on its way through all slabs, from front to back.

use glam::DVec3;

use super::ShearWarp;
use super::rows::{State, without};
use super::shear::{Frame, Shear};
use super::slab::{Plane, Slab, slabs};
use super::slices::{Voxel, between, trilinear};
use super::table::{SlabClassify, shortened};
use crate::lanes::{COUNT, Lanes};

/// The way of all rows.
pub(super) struct Scan<'a, L, T> {
    l: L,
    it: &'a ShearWarp<'a>,
    shear: &'a Shear,
    frame: &'a Frame,
    values: &'a [T],
    dims: [usize; 3],
    slabs: Vec<Slab>,
    buffer: usize,
    /// Whether pixels are as far apart as voxels.
    is_unit: bool,
    is_post: bool,
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::cast_precision_loss,
    clippy::cast_possible_wrap,
    reason = "places inside of images and volumes"
)]
impl<'a, L: Lanes, T: Voxel> Scan<'a, L, T> {
    pub(super) fn new(
        l: L,
        it: &'a ShearWarp<'a>,
        shear: &'a Shear,
        frame: &'a Frame,
        values: &'a [T],
    ) -> Self {
        let (slabs, buffer) = slabs(it, shear, frame);
        Self {
            l,
            it,
            shear,
            frame,
            values,
            dims: it.slices.dims,
            slabs,
            buffer,
            is_unit: frame.scale == 1.0,
            is_post: it.table.classify == SlabClassify::Post,
        }
    }

    pub(super) fn state(&self) -> State {
        State::new(self.frame.width, self.dims[0], self.buffer)
    }

    /// Draws a row of the intermediate image.
    pub(super) fn line(&self, state: &mut State, line: usize, pixels: &mut [[f32; 4]]) {
        self.l.run(
            #[inline(always)]
            || {
                state.reset();
                let v = self.frame.first[1] + line as f64 / self.frame.scale;
                self.draw(state, v);
                for (at, pixel) in pixels.iter_mut().enumerate() {
                    let [r, g, b, open] = state.color.each_ref().map(|channel| channel[at]);
                    *pixel = [r, g, b, 1.0 - open];
                }
            },
        );
    }

    fn u(&self, pixel: usize) -> f64 {
        self.frame.first[0] + pixel as f64 / self.frame.scale
    }

    /// The pixels whose coordinate is between two: the first, and that after the last.
    fn pixels(&self, [low, high]: [f64; 2]) -> [usize; 2] {
        let at = |u: f64| (u - self.frame.first[0]) * self.frame.scale;
        let width = self.frame.width as f64;
        let from = at(low).ceil().clamp(0.0, width);
        let to = (at(high).floor() + 1.0).clamp(0.0, width);
        [from as usize, (to as usize).max(from as usize)]
    }

    #[inline(always)]
    fn draw(&self, state: &mut State, v: f64) {
        let width = self.frame.width;
        for pixel in 0..width {
            let [from, to] = self.shear.interval([self.u(pixel), v]);
            state.intervals[pixel] = [from, to];
            if from >= to {
                state.links.close(pixel);
            }
        }
        for slab in &self.slabs {
            if state.links.open_from(0) >= width {
                break;
            }
            let ends = [slab.low, slab.high].map(|slice| v + slice * self.shear.slope[1]);
            let [low, high] = [self.shear.low[1], self.shear.high[1]];
            if ends[0].max(ends[1]) < low || ends[0].min(ends[1]) > high {
                state.last_parts.clear();
                continue;
            }
            let [first, last] = self.pixels(slab.any);
            let (first, last) = (first.saturating_sub(1), (last + 1).min(width));
            let is_whole = ends.iter().all(|end| (low..=high).contains(end))
                && slab.low >= self.shear.low[2]
                && slab.high <= self.shear.high[2];
            let [mut from, mut to] = [last; 2];
            if is_whole {
                let before_eye = self.before_eye(slab, v);
                let u = [
                    slab.whole[0].max(before_eye[0]),
                    slab.whole[1].min(before_eye[1]),
                ];
                [from, to] = self.pixels(u);
                [from, to] = if from < to { [from, to] } else { [last; 2] };
            }
            self.short(state, slab, v, [first, from.min(last)]);
            self.short(state, slab, v, [to.min(last), last]);
            self.parts(state, slab, v, [from, to]);
            self.whole(state, slab, v);
        }
    }

    /// The coordinates along a row where the eye is not behind the front of a slab.
    fn before_eye(&self, slab: &Slab, v: f64) -> [f64; 2] {
        let all = [f64::NEG_INFINITY, f64::INFINITY];
        let at_0 = self.shear.eye([0.0, v]);
        let per_u = self.shear.eye_per_u();
        let (front, sign) = if self.shear.is_rising {
            (slab.low, 1.0)
        } else {
            (slab.high, -1.0)
        };
        // Where sign · (at_0 + per_u · u) ≤ sign · front.
        let (room, slope) = (sign * (front - at_0), sign * per_u);
        match slope {
            slope if slope.abs() < 1e-12 && room >= 0.0 => all,
            slope if slope.abs() < 1e-12 => [0.0, -1.0],
            slope if slope > 0.0 => [f64::NEG_INFINITY, room / slope],
            slope => [room / slope, f64::INFINITY],
        }
    }

    /// The pixels of a range in which a slab may show something.
    fn parts(&self, state: &mut State, slab: &Slab, v: f64, [from, to]: [usize; 2]) {
        state.parts.clear();
        if from >= to {
            return;
        }
        let Some(runs) = self.runs() else {
            state.parts.push([from, to]);
            return;
        };
        let plane = &slab.front;
        let (row, ..) = between(v + plane.slice * self.shear.slope[1], self.dims[1]);
        let pixel = |voxel: u32| ((f64::from(voxel) - plane.start) * self.frame.scale).ceil();
        let (least, most) = (from as f64, to as f64);
        for [start, end] in runs.row(slab.of_runs, row) {
            // Outer voxels go on to the box.
            let start = if *start == 0 { least } else { pixel(*start) };
            let end = match *end as usize {
                end if end >= runs.length() => most,
                _ => pixel(*end),
            };
            let (start, end) = (start.clamp(least, most), end.clamp(least, most));
            if start < end {
                state.parts.push([start as usize, end as usize]);
            }
        }
    }

    fn runs(&self) -> Option<&'a super::Runs> {
        // They hold for rays that move by a voxel at most from slice to slice.
        let is_main = self
            .shear
            .slope
            .iter()
            .all(|slope| slope.abs() < 1.0 + 1e-9);
        self.it.runs.filter(|_| is_main)
    }

    /// Pixels whose rays pass a slab from plane to plane.
    #[inline(always)]
    fn whole(&self, state: &mut State, slab: &Slab, v: f64) {
        let parts = std::mem::take(&mut state.parts);
        let last_parts = std::mem::take(&mut state.last_parts);
        if !self.is_post {
            without(
                &parts,
                &last_parts,
                #[inline(always)]
                |part| self.fill(state, &slab.front, v, part),
            );
        }
        for part in &parts {
            self.composite(state, slab, v, *part);
        }
        state.last_parts = parts;
        state.parts = last_parts;
    }

    /// Scalars of pixels into the buffer slice.
    #[inline(always)]
    fn fill(&self, state: &mut State, plane: &Plane, v: f64, [from, to]: [usize; 2]) {
        self.blend(&mut state.line, plane, v, [from, to]);
        for at in (from..to).step_by(COUNT) {
            let scalars = self.scalars(&state.line, plane, at);
            keep(self.l, &mut state.buffer, plane, [at, to], scalars);
        }
    }

    #[inline(always)]
    fn composite(&self, state: &mut State, slab: &Slab, v: f64, [from, to]: [usize; 2]) {
        let l = self.l;
        let mut at = state.links.open_from(from);
        if at >= to {
            return;
        }
        self.blend(&mut state.line, &slab.back, v, [at, to]);
        let bound = l.splat(self.it.early_termination);
        let places = l.floats(PLACES);
        while at < to {
            let back = self.scalars(&state.line, &slab.back, at);
            let shown = if self.is_post {
                self.it.table.look(l, back, back)
            } else {
                let front = load(l, &state.buffer, (slab.front.buffer + at as isize) as usize);
                keep(l, &mut state.buffer, &slab.back, [at, to], back);
                self.it.table.look(l, front, back)
            };
            let open = load(l, &state.color[3], at);
            let is_part = l.less(places, l.splat((to - at) as f32));
            let active = l.both(is_part, l.at_least(open, bound));
            for channel in 0..3 {
                let before = load(l, &state.color[channel], at);
                let shown = l.select(active, shown[channel], l.splat(0.0));
                store(
                    l,
                    &mut state.color[channel],
                    at,
                    l.mul_add(open, shown, before),
                );
            }
            let after = l.mul(open, l.select(active, shown[3], l.splat(1.0)));
            store(l, &mut state.color[3], at, after);
            let mut done = l.bits(l.both(active, l.less(after, bound)));
            while done != 0 {
                state.links.close(at + done.trailing_zeros() as usize);
                done &= done - 1;
            }
            at = state.links.open_from((at + COUNT).min(to));
        }
    }

    /// Voxels of a plane between the rows that a row of pixels meets, as far as these pixels reach.
    #[inline(always)]
    fn blend(&self, line: &mut [f32], plane: &Plane, v: f64, [from, to]: [usize; 2]) {
        let [length, rows, _] = self.dims;
        let voxel = |pixel: usize| (plane.start + pixel as f64 / self.frame.scale).floor() as isize;
        let (first, end) = (voxel(from) - 1, voxel(to - 1) + 3);
        let low = first.clamp(0, length as isize - 1) as usize;
        let high = end.clamp(low as isize + 1, length as isize) as usize;
        let (y0, y1, wy) = between(v + plane.slice * self.shear.slope[1], rows);
        let (z0, z1, wz) = plane.between;
        let row = |z: usize, y: usize| &self.values[(z * rows + y) * length..][low..high];
        let to = &mut line[low + 1..=high];
        let mix = |a: f32, b: f32, share: f32| (b - a) * share + a;
        for ((to, a), b) in to.iter_mut().zip(row(z0, y0)).zip(row(z0, y1)) {
            *to = mix(a.scalar(), b.scalar(), wy);
        }
        if wz > 0.0 {
            for ((to, a), b) in to.iter_mut().zip(row(z1, y0)).zip(row(z1, y1)) {
                *to = mix(*to, mix(a.scalar(), b.scalar(), wy), wz);
            }
        }
        // Clamped in the outer half voxel.
        if low == 0 {
            line[0] = line[1];
        }
        if high == length {
            line[length + 1] = line[length];
        }
    }

    /// Scalars of a plane at eight pixels.
    #[inline(always)]
    fn scalars(&self, line: &[f32], plane: &Plane, at: usize) -> L::F {
        let l = self.l;
        if self.is_unit {
            let whole = plane.start.floor();
            let share = l.splat((plane.start - whole) as f32);
            let cell = (whole as isize + 1 + at as isize).max(0) as usize;
            return l.mix(load(l, line, cell), load(l, line, cell + 1), share);
        }
        let pixel = l.add(l.floats(PLACES), l.splat(at as f32));
        let per_pixel = l.splat(self.frame.scale.recip() as f32);
        let place = l.mul_add(pixel, per_pixel, l.splat((plane.start + 1.0) as f32));
        let place = l.max(place, l.splat(0.0));
        let cell = l.truncated(place);
        let words: &[u32] = bytemuck::cast_slice(line);
        let a = l.of_bits(l.gather(words, cell));
        let b = l.of_bits(l.gather(words, l.add_whole(cell, l.whole(1))));
        l.mix(a, b, l.sub(place, l.float(cell)))
    }

    /// Pixels whose rays pass a slab in part: the box or the eye's plane cuts it.
    #[inline(always)]
    fn short(&self, state: &mut State, slab: &Slab, v: f64, [first, end]: [usize; 2]) {
        let l = self.l;
        let runs = self.runs();
        let mut pixel = state.links.open_from(first);
        while pixel < end {
            let at = pixel;
            pixel = state.links.open_from(at + 1);
            let [from, to] = state.intervals[at];
            let (low, high) = (slab.low.max(from), slab.high.min(to));
            if high - low <= 1e-9 {
                continue;
            }
            let middle = 0.5 * (low + high);
            let [front, back] = match (self.is_post, self.shear.is_rising) {
                (true, _) => [middle; 2],
                (_, true) => [low, high],
                _ => [high, low],
            };
            let u = self.u(at);
            let slope = self.shear.slope;
            let point = |z: f64| DVec3::new(u + z * slope[0], v + z * slope[1], z);
            if let Some(runs) = runs {
                let start = point(front);
                let (x, ..) = between(start.x, self.dims[0]);
                let (y, ..) = between(start.y, self.dims[1]);
                let slab = ((middle + 1.0).floor().max(0.0) as usize).min(self.dims[2]);
                let is_in = |[from, to]: &[u32; 2]| (*from as usize..*to as usize).contains(&x);
                if !runs.row(slab, y).iter().any(is_in) {
                    continue;
                }
            }
            let scalar = |z: f64| l.splat(trilinear(self.values, self.dims, point(z)));
            let shown = self.it.table.look(l, scalar(front), scalar(back));
            let shown = [0, 1, 2, 3].map(|i| l.array(shown[i])[0]);
            let share = (high - low) * f64::from(self.it.slices_per_voxel);
            let shown = shortened(shown, share.min(1.0) as f32);
            let open = state.color[3][at];
            for (channel, shown) in state.color.iter_mut().zip(&shown[..3]) {
                channel[at] += open * shown;
            }
            let open = open * shown[3];
            state.color[3][at] = open;
            if open < self.it.early_termination {
                state.links.close(at);
            }
        }
    }
}

const PLACES: [f32; COUNT] = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0];

#[inline(always)]
fn load<L: Lanes>(l: L, values: &[f32], at: usize) -> L::F {
    let mut eight = [0.0; COUNT];
    eight.copy_from_slice(&values[at..at + COUNT]);
    l.floats(eight)
}

#[inline(always)]
fn store<L: Lanes>(l: L, values: &mut [f32], at: usize, eight: L::F) {
    values[at..at + COUNT].copy_from_slice(&l.array(eight));
}

/// Scalars from a pixel on into a plane's buffer, of no pixel from `to` on.
#[inline(always)]
#[expect(
    clippy::cast_sign_loss,
    clippy::cast_possible_wrap,
    reason = "buffers begin before the first pixel of the box"
)]
fn keep<L: Lanes>(l: L, buffer: &mut [f32], plane: &Plane, [at, to]: [usize; 2], scalars: L::F) {
    let count = (to - at).min(COUNT);
    let start = (plane.buffer + at as isize) as usize;
    buffer[start..start + count].copy_from_slice(&l.array(scalars)[..count]);
}
