// Mean over 4 x 4 pixels, and therefore over all patterns of occlusion.frag.glsl, restricted to pixels in one
// plane.
#include "frame.glsl"
#include "occlusion.glsl"

in vec3 ray;
layout(location = 0) out vec2 out_occlusion;
uniform sampler2D normal_map;

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  ivec2 last = textureSize(occlusion_map, 0) - 1;
  float nearness = texelFetch(occlusion_map, pixel, 0).y;
  vec2 slope = slope_of_nearness(texelFetch(normal_map, pixel * 2, 0).xyz, ray, nearness);
  vec2 sum = vec2(0.0);
  for (int y = -2; y < 2; ++y) {
    for (int x = -2; x < 2; ++x) {
      vec2 other = texelFetch(occlusion_map, clamp(pixel + ivec2(x, y), ivec2(0), last), 0).xy;
      float expected = nearness + dot(slope, vec2(x, y));
      sum += vec2(other.x, 1.0) * max(1.0 - off_plane(other.y, expected, nearness, 0.3), 0.001);
    }
  }
  out_occlusion = vec2(pow(sum.x / sum.y, frame.occlusion.y), nearness);
}
