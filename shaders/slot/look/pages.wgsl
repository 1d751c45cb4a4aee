// What is known of a brick? A page table tells whether anything of it is seen, and whether it is read from a coarser
// level: its segments are as much longer as its voxels.
#import "lib/brick_look.wgsl"
#import "lib/pages.wgsl"

// Segments of as many steps at most: two to the power of this.
const LOOK_PAGES_LEVEL: u32 = 6u;

// Long segments as well.
fn look_least() -> u32 {
    return 2u;
}

fn look_at(brick: vec3i) -> BrickLook {
    let page = pages_at(brick);
    let whole = select(page.level, 0u, page.is_unseen && !page.is_all_unseen);
    let low = (brick >> vec3u(whole)) << vec3u(whole);
    return BrickLook(!page.is_unseen, low, low + vec3i(1i << whole), min(page.level, LOOK_PAGES_LEVEL));
}
