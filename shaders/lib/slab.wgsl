// Slabs between two planes across the view, as segments of a ray.
#import "lib/classified.wgsl"
#import slot "classify"
