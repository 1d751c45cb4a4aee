// Where the next segment ends: whole steps from the entry, but for those through bricks of which the technique sees
// nothing, by what its file says after `@skips`. The picture is that of `uniform`.
#import "lib/whole_steps.wgsl"
