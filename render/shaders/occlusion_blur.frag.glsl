// The mean of 4 x 4 pixels, so of all patterns of occlusion.frag.glsl, that lie about as far away.
#include "frame.glsl"

layout(location = 0) out vec2 out_occlusion;
uniform sampler2D occlusion_map;

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  ivec2 last = textureSize(occlusion_map, 0) - 1;
  float depth = texelFetch(occlusion_map, pixel, 0).y;
  vec2 sum = vec2(0.0);
  float tolerance = 0.3 * frame.occlusion.x;
  for (int y = -2; y < 2; ++y) {
    for (int x = -2; x < 2; ++x) {
      vec2 other = texelFetch(occlusion_map, clamp(pixel + ivec2(x, y), ivec2(0), last), 0).xy;
      float weight = max(1.0 - abs(other.y - depth) / tolerance, 0.001);
      sum += vec2(other.x, 1.0) * weight;
    }
  }
  out_occlusion = vec2(pow(clamp(sum.x / sum.y, 0.0, 1.0), frame.occlusion.y), depth);
}
