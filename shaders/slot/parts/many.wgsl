// Which parts of the ray are seen, from front to back? What `clip` leaves of it, cut where the `labels` change. Every
// walk through the volume goes over them, that of a shadow as well; each part is a ray of its own, whose entry is the
// part's start. So segments are whole from a cut on, and no technique needs to know of cuts. The first voxel behind a
// cut is a part of its own: light changes there from the cut's normal to the field's (see `surface_inner_normal`), and
// a segment across its end would make the picture depend on the step. With a part its label is selected: whoever looks
// at other parts in between selects the label back that was selected before (`labels_selected`).
#import "lib/volume.wgsl"
#import slot "clip"
#import slot "labels"

struct Parts {
    // The ray that is left to look at.
    rest: Ray,
    // World distance from the origin where the part that `clip` leaves ends.
    visible_end: f32,
    // How often the ray had changed its direction.
    bends: u32,
}

// Most parts of a ray that is not bent: whatever the slots say, it has an end of parts.
const PARTS_MAX: u32 = 4096u;

fn parts_begin(ray: Ray) -> Parts {
    return Parts(ray, ray.near, ray.bends);
}

// Moves the ray on to its next part; false where there is none. A ray that has been bent goes on from where it was.
fn parts_next(parts: ptr<function, Parts>, ray: ptr<function, Ray>) -> bool {
    // What is visible is the node's own matter, and no label's.
    labels_select(STRETCH_NO_LABEL);
    for (var turn = 0u; turn < PARTS_MAX; turn++) {
        if !parts_one_more(parts, ray) {
            return false;
        }
        if labels_is_visible((*ray).label) {
            labels_select((*ray).label);
            return true;
        }
    }
    return false;
}

// The next part, of whatever label.
fn parts_one_more(parts: ptr<function, Parts>, ray: ptr<function, Ray>) -> bool {
    if (*ray).bends != (*parts).bends {
        *parts = parts_begin(*ray);
    }
    var rest = (*parts).rest;
    var cut_normal = rest.cut_normal;
    var is_continued = rest.is_continued;
    if rest.near + volume_least() >= (*parts).visible_end {
        let visible = clip_next(rest);
        if visible.y <= visible.x + volume_least() {
            return false;
        }
        if visible.x > volume_least() {
            cut_normal = clip_normal(rest, visible.x);
            is_continued = false;
        }
        (*parts).visible_end = rest.near + visible.y;
        rest = ray_between(rest, visible.x, rest.far - rest.near);
    }
    let visible_length = (*parts).visible_end - rest.near;
    let is_cut = any(cut_normal != vec3f(0.0));
    let reach = select(visible_length, min(visible_length, volume.voxel), is_cut);
    var stretch = labels_next(rest, reach);
    if stretch.end + volume_least() >= reach {
        stretch = Stretch(reach, stretch.label, vec3f(0.0));
    }
    *ray = ray_between(rest, 0.0, stretch.end);
    (*ray).cut_normal = cut_normal;
    (*ray).is_continued = is_continued;
    (*ray).label = stretch.label;
    (*ray).visible_end = (*parts).visible_end;
    (*parts).rest = ray_between(rest, stretch.end, rest.far - rest.near);
    // The next part, if it begins here, begins where the label changes.
    (*parts).rest.cut_normal = stretch.normal;
    (*parts).rest.is_continued = all(stretch.normal == vec3f(0.0));
    return true;
}

// Whether more of a ray is visible right behind a distance from its entry where a part ends: clips may show a visible
// part piece by piece.
fn parts_go_on(ray: Ray, distance: f32) -> bool {
    let at = ray_position(ray, distance);
    let rest = ray_between(ray, distance, distance + volume_exit(at, ray.slope));
    let label = labels_selected();
    labels_select(STRETCH_NO_LABEL);
    let visible = clip_next(rest);
    labels_select(label);
    return visible.x <= volume_least() && visible.y > visible.x + volume_least();
}
