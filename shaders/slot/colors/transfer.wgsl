// Where do a segment's colours come from? From the transfer function, as its classification has made them.
#import "lib/classified.wgsl"

fn colors_segment(classified: Classified, ray: Ray, segment: Segment) -> Classified {
    return classified;
}
