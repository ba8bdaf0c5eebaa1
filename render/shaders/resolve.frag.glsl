// The mean of the samples, encoded. Alpha is luma, for smooth_edges.frag.glsl.
#include "common.glsl"

layout(location = 0) out vec4 out_color;
uniform sampler2D color_map;
uniform float scale;
uniform float alpha_is_luma;

void main() {
  vec3 color = texelFetch(color_map, ivec2(gl_FragCoord.xy), 0).rgb * scale;
  color = srgb_of_linear(clamp(color, 0.0, 1.0));
  out_color = vec4(color, alpha_is_luma > 0.5 ? dot(color, vec3(0.299, 0.587, 0.114)) : 1.0);
}
