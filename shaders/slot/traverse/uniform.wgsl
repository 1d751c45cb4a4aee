// Where the next segment ends: whole steps from the entry, all the way to the exit.
#import "lib/whole_steps.wgsl"
