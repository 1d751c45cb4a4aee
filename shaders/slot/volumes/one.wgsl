// Which volume is read: the only one.
#import "lib/placement.wgsl"

@group(1) @binding(0) var<uniform> volume: Volume;
