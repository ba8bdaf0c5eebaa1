// The narrow-range filter (Truong and Yuksel 2018): a Gaussian blur of depth, along one axis at a time, in which what
// lies far behind counts as a little behind, and what lies far before does not count. "Far" is told from the range of
// depths met on the way, so surfaces seen at a grazing angle are one. Pairs of opposite samples are taken or left
// together, or the surface would tilt at edges.
//
// One departure: the mean is that of nearness 1 / z, which is linear across a plane on screen, so planes stay.
#include "frame.glsl"
#include "liquid.glsl"

layout(location = 0) out float out_depth;

uniform sampler2D liquid_depth_map;
uniform sampler2D liquid_look_map;
uniform float axis;       // 0: x, 1: y
uniform float deviation;  // of the Gaussian [radii]

const int most_taps = 12;          // on each side; where pixels are small some are passed over
const float reach = 2.5;           // deviations
const float narrow_range = 3.0;    // delta: how far apart in depth neighbours of one surface are [radii]
const float behind = 1.0;          // mu: where what is farther is taken to be [radii]

float depth_at(ivec2 pixel) {
  return texelFetch(liquid_depth_map, clamp(pixel, ivec2(0), textureSize(liquid_depth_map, 0) - 1), 0).r;
}

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  ivec2 along = axis < 0.5 ? ivec2(1, 0) : ivec2(0, 1);
  float z = texelFetch(liquid_depth_map, pixel, 0).r;
  float radius = texelFetch(liquid_look_map, pixel, 0).z;
  float sigma = z > 0.0 ? deviation * radius / pixel_size(z) : 0.0;  // pixels
  float ends = reach * sigma;
  float stride = max(ends / float(most_taps), 1.0);
  int taps = min(int(ends / stride), most_taps);
  float delta = narrow_range * radius, limit = z + behind * radius;
  float nearest = z - delta, farthest = z + delta;
  vec2 sum = vec2(z > 0.0 ? 1.0 / z : 0.0, 1.0);
  for (int i = 1; i <= taps; ++i) {
    int steps = int(float(i) * stride + 0.5);
    vec2 pair = vec2(depth_at(pixel + along * steps), depth_at(pixel - along * steps));
    pair = mix(pair, vec2(1e30), equal(pair, vec2(0.0)));  // where nothing is, all is far
    bvec2 far = greaterThan(pair, vec2(farthest));
    float least = min(pair.x, pair.y);
    float greatest = max(far.x ? z : pair.x, far.y ? z : pair.y);
    float part = float(steps) / sigma;
    float weight = least < nearest ? 0.0 : exp(-0.5 * part * part);
    pair = mix(pair, vec2(limit), far);
    sum += weight * vec2(1.0 / pair.x + 1.0 / pair.y, 2.0);
    nearest = least < nearest ? nearest : min(nearest, least - delta);
    farthest = least < nearest ? farthest : max(farthest, greatest + delta);
  }
  out_depth = z > 0.0 ? sum.y / sum.x : 0.0;
}
