// Where the next segment ends: whole steps from the entry, as many as `step_tolerance` allows where it is, by how much the
// scalar and the transfer function bend there; through bricks of which nothing is seen in one leap.
#import "lib/whole_steps.wgsl"
