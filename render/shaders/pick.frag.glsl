// Pick, element and depth of this pixel.
#include "frame.glsl"

uniform usampler2D pick_map;
uniform sampler2D depth_map;

layout(location = 0) out uvec4 out_pick;  // pick, element, depth along the view as the bits of a float, 0

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  uvec2 pick_and_element = texelFetch(pick_map, pixel, 0).rg;
  float z = 2.0 * texelFetch(depth_map, pixel, 0).r - 1.0;
  float depth = frame.projection[3][2] / (frame.projection[2][2] + z);
  out_pick = uvec4(pick_and_element, pick_and_element.r == 0u ? 0u : floatBitsToUint(depth), 0u);
}
