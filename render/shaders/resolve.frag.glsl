// The mean of the samples, encoded. Alpha is luma, for smooth_edges.frag.glsl.
#include "common.glsl"

layout(location = 0) out vec4 out_colour;
uniform sampler2D colour_map;
uniform float scale;
uniform float alpha_is_luma;

void main() {
  vec3 colour = texelFetch(colour_map, ivec2(gl_FragCoord.xy), 0).rgb * scale;
  colour = srgb_of_linear(clamp(colour, 0.0, 1.0));
  out_colour = vec4(colour, alpha_is_luma > 0.5 ? dot(colour, vec3(0.299, 0.587, 0.114)) : 1.0);
}
