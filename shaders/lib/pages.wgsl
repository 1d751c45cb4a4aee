// A volume in bricks of several levels, those that matter in a pool: a page table says which brick of the pool has the
// scalars of each brick of the finest level (Hadwiger et al. 2012, Fogal et al. 2013).
#import "lib/bricks.wgsl"
#import "lib/nearest_sampler.wgsl"

struct Pages {
    // Voxels along the edge of a brick; in the pool there is one more on each side.
    edge: f32,
    // Texture coordinates of the pool for one of its texels, and its texels.
    per_texel: vec3f,
    texels: vec3f,
}

@group(1) @binding(44) var brick_pool: texture_3d<f32>;
@group(1) @binding(45) var page_table: texture_3d<f32>;
@group(1) @binding(46) var<uniform> pages: Pages;

struct Page {
    // Which brick of the pool, along each axis.
    slot: vec3f,
    // Voxels of its level are so many halvings larger.
    level: u32,
    // Whether nothing is seen of this brick of the finest level, and whether nothing is of the whole brick of its level.
    is_unseen: bool,
    is_all_unseen: bool,
}

// The page of a brick of the finest level.
fn pages_at(brick: vec3i) -> Page {
    let place = (vec3f(brick) + 0.5) / vec3f(bricks.dims);
    let texel = vec4u(textureSampleLevel(page_table, nearest_sampler, place, 0.0) * 255.0 + 0.5);
    return Page(vec3f(texel.xyz), texel.w & 31u, (texel.w & 128u) != 0u, (texel.w & 64u) != 0u);
}

// 0.5 to the power of a level, exactly.
fn pages_shrink(level: u32) -> f32 {
    return bitcast<f32>((127u - level) << 23u);
}

// Where a position of a volume of so many voxels is in the pool, in texels.
fn pages_place(position: vec3f, dims: vec3f) -> vec3f {
    let brick = bricks_at(bricks_place(position));
    let page = pages_at(brick);
    let shrink = pages_shrink(page.level);
    let first = floor(vec3f(brick) * shrink) * pages.edge;
    // The voxels around a brick reach half a voxel beyond it.
    let within = clamp(position * ceil(dims * shrink) - first, vec3f(-0.5), vec3f(pages.edge + 0.5));
    return page.slot * (pages.edge + 2.0) + 1.0 + within;
}
