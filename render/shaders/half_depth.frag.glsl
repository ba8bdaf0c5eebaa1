// Distances along the view at half the resolution; 0 where there is no object.
#include "frame.glsl"

layout(location = 0) out float out_depth;
uniform sampler2D depth_map;

void main() {
  float depth = texelFetch(depth_map, ivec2(gl_FragCoord.xy) * 2, 0).r;
  // The floor in front of the near plane or behind the far plane was moved onto it.
  bool near = depth > 0.0 && depth < 1.0;
  out_depth = near ? frame.projection[3][2] / (2.0 * depth - 1.0 + frame.projection[2][2]) : 0.0;
}
