//! Light on opaque surfaces: `lib/phong.wgsl` on points of eight rays.

use glam::{DMat3, DVec3};
use volgraph_optics::Material;
use volgraph_reference::{Lamp, Place};
use volgraph_volume::Grid;

use crate::lanes::{Lanes, three};

/// Most lights.
const MOST: usize = 4;

/// Lights and a material, as single floats, in world units from the middle of the volume's box.
#[derive(Clone, Debug)]
pub(crate) struct Shine {
    lamps: [Single; MOST],
    count: usize,
    material: Material,
    /// World vectors of the index axes, and the world position of the first voxel.
    axes: [[f32; 3]; 3],
    origin: [f32; 3],
    /// World normals of planes of equal index coordinates, of the length of a voxel by that of the smallest spacing.
    pub(crate) normals: [[f32; 3]; 3],
}

#[derive(Clone, Copy, Debug)]
struct Single {
    place: SinglePlace,
    color: [f32; 3],
}

#[derive(Clone, Copy, Debug)]
enum SinglePlace {
    Eye,
    Towards([f32; 3]),
    At([f32; 3]),
}

fn columns(matrix: DMat3) -> [[f32; 3]; 3] {
    [matrix.x_axis, matrix.y_axis, matrix.z_axis].map(|axis| axis.as_vec3().to_array())
}

impl Shine {
    pub(crate) fn new(placement: &Grid, lamps: &[Lamp], material: Material) -> Self {
        let (low, high) = placement.box_index();
        let world_from_index = placement.world_from_index;
        let centre = world_from_index.transform_point3(0.5 * (low + high));
        let single = |v: DVec3| v.as_vec3().to_array();
        let mut all = [Single {
            place: SinglePlace::Eye,
            color: [0.0; 3],
        }; MOST];
        for (to, lamp) in all.iter_mut().zip(lamps) {
            let place = match lamp.place {
                Place::Eye => SinglePlace::Eye,
                Place::Towards(direction) => SinglePlace::Towards(single(direction)),
                Place::At(point) => SinglePlace::At(single(point - centre)),
            };
            #[expect(clippy::cast_possible_truncation, reason = "light is f32")]
            let color = lamp.color.map(|channel| channel as f32);
            *to = Single { place, color };
        }
        let normals = world_from_index.matrix3.inverse().transpose() * placement.min_spacing();
        Self {
            lamps: all,
            count: lamps.len().min(MOST),
            material,
            axes: columns(world_from_index.matrix3),
            origin: single(world_from_index.translation - centre),
            normals: columns(normals),
        }
    }

    /// A sum of three world vectors.
    #[inline(always)]
    fn sum<L: Lanes>(l: L, vectors: &[[f32; 3]; 3], by: [L::F; 3]) -> [L::F; 3] {
        three(
            #[inline(always)]
            |axis| {
                let [x, y, z] = three(
                    #[inline(always)]
                    |i| l.splat(vectors[i][axis]),
                );
                l.mul_add(by[2], z, l.mul_add(by[1], y, l.mul(by[0], x)))
            },
        )
    }

    /// World directions of slopes of index coordinates.
    #[inline(always)]
    pub(crate) fn direction<L: Lanes>(&self, l: L, slope: [L::F; 3]) -> [L::F; 3] {
        Self::sum(l, &self.axes, slope)
    }

    /// World normals, towards the eye, of gradients in index coordinates, as shares of the data's range; where the field is
    /// flat, the directions back.
    #[inline(always)]
    pub(crate) fn normal<L: Lanes>(
        &self,
        l: L,
        gradient: [L::F; 3],
        direction: [L::F; 3],
    ) -> [L::F; 3] {
        let given = Self::sum(l, &self.normals, gradient);
        let square = dot(l, given, given);
        let is_flat = l.less(square, l.splat(1e-30));
        let magnitude = l.sqrt(l.max(square, l.splat(1e-30)));
        let zero = l.splat(0.0);
        let is_away = l.less(zero, dot(l, given, direction));
        let signed = l.select(is_away, l.sub(zero, magnitude), magnitude);
        three(
            #[inline(always)]
            |axis| {
                let normal = l.div(given[axis], signed);
                l.select(is_flat, l.sub(zero, direction[axis]), normal)
            },
        )
    }

    /// Linear colours towards the eye of points at index coordinates.
    #[inline(always)]
    #[expect(clippy::cast_possible_truncation, reason = "light is f32")]
    pub(crate) fn color<L: Lanes>(
        &self,
        l: L,
        color: [f32; 3],
        at: [L::F; 3],
        normal: [L::F; 3],
        direction: [L::F; 3],
    ) -> [L::F; 3] {
        let (zero, one) = (l.splat(0.0), l.splat(1.0));
        let to_eye = three(
            #[inline(always)]
            |axis| l.sub(zero, direction[axis]),
        );
        let from_origin = Self::sum(l, &self.axes, at);
        let world = three(
            #[inline(always)]
            |axis| l.add(from_origin[axis], l.splat(self.origin[axis])),
        );
        let shininess = l.splat(self.material.shininess as f32);
        let [mut diffuse, mut specular] = [[zero; 3]; 2];
        for lamp in &self.lamps[..self.count] {
            let towards = match lamp.place {
                SinglePlace::Eye => to_eye,
                SinglePlace::Towards(towards) => three(
                    #[inline(always)]
                    |axis| l.splat(towards[axis]),
                ),
                SinglePlace::At(place) => {
                    let towards = three(
                        #[inline(always)]
                        |axis| l.sub(l.splat(place[axis]), world[axis]),
                    );
                    unit(l, towards)
                }
            };
            let facing = dot(l, normal, towards);
            let is_lit = l.less(zero, facing);
            let half_way = three(
                #[inline(always)]
                |axis| {
                    let both = l.add(towards[axis], to_eye[axis]);
                    l.mul_add(l.splat(1e-6), normal[axis], both)
                },
            );
            let sharp = l.clamp(dot(l, normal, unit(l, half_way)), l.splat(1e-30), one);
            let halvings = l.mul(shininess, l.sub(zero, l.log2(sharp)));
            let highlight = l.halved(l.max(halvings, zero));
            let facing = l.select(is_lit, facing, zero);
            let highlight = l.select(is_lit, highlight, zero);
            for channel in 0..3 {
                let light = l.splat(lamp.color[channel]);
                diffuse[channel] = l.mul_add(light, facing, diffuse[channel]);
                specular[channel] = l.mul_add(light, highlight, specular[channel]);
            }
        }
        let material = &self.material;
        let [ambient, matt, sharp] = [
            material.ambient as f32,
            material.diffuse as f32,
            material.specular as f32,
        ];
        three(
            #[inline(always)]
            |channel| {
                let own = l.splat(color[channel] * ambient);
                let matt = l.splat(color[channel] * matt);
                let lit = l.mul_add(matt, diffuse[channel], own);
                l.mul_add(l.splat(sharp), specular[channel], lit)
            },
        )
    }
}

#[inline(always)]
fn dot<L: Lanes>(l: L, a: [L::F; 3], b: [L::F; 3]) -> L::F {
    l.mul_add(a[2], b[2], l.mul_add(a[1], b[1], l.mul(a[0], b[0])))
}

#[inline(always)]
fn unit<L: Lanes>(l: L, a: [L::F; 3]) -> [L::F; 3] {
    let length = l.sqrt(l.max(dot(l, a, a), l.splat(1e-36)));
    three(
        #[inline(always)]
        |axis| l.div(a[axis], length),
    )
}
