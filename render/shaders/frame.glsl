// Uniforms shared by all shaders of a pass; render/passes/pass_context.h documents them.
layout(std140) uniform Frame {
  mat4 view;
  mat4 projection;
  mat4 inverse_view;
  mat4 inverse_projection;
  mat4 shadow;
  vec4 eye;
  vec4 size;
  vec4 to_sun;
  vec4 sky;
  vec4 horizon;
  vec4 floor_light;
  vec4 shadow_size;
  vec4 sun_size;
  vec4 ground;
  vec4 ground_color;
  vec4 ground_second;
  vec4 sample_info;
  vec4 occlusion;
  vec4 irradiance[9];
} frame;
