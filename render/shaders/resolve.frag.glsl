// The mean of the samples, encoded.
#include "common.glsl"

layout(location = 0) out vec4 out_colour;
uniform sampler2D colour_map;
uniform float scale;

void main() {
  vec3 colour = texelFetch(colour_map, ivec2(gl_FragCoord.xy), 0).rgb * scale;
  out_colour = vec4(srgb_of_linear(clamp(colour, 0.0, 1.0)), 1.0);
}
