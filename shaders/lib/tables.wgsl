// The tables of one transfer function.

@group(2) @binding(1) var transfer_table: texture_2d<f32>;
@group(2) @binding(2) var preintegration_table: texture_2d<f32>;
@group(2) @binding(6) var integral_table: texture_2d<f32>;
@group(2) @binding(7) var preintegration_half_table: texture_2d<f32>;
