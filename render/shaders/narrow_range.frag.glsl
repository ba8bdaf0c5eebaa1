// The narrow-range filter (Truong and Yuksel 2018): a Gaussian blur of depth, along one axis at a time.
// Samples far behind count as a little behind; samples far in front are ignored. "Far" is relative to the
// range of depths found so far, so a surface seen at a grazing angle stays connected. Pairs of opposite
// samples are used or ignored together: otherwise the surface would tilt at edges.
//
// One departure: the mean is that of nearness 1 / z, which is linear across a plane on screen, so planes stay
// unchanged.
#include "frame.glsl"
#include "liquid.glsl"

layout(location = 0) out float out_depth;

uniform sampler2D liquid_depth_map;
uniform sampler2D liquid_look_map;
uniform float axis;       // 0: x, 1: y
uniform float deviation;  // of the Gaussian [radii]

const int max_taps = 12;  // on each side; where pixels are small, some are skipped
const float reach = 2.5;           // deviations
const float narrow_range = 5.0;  // delta: largest depth difference of neighbors on one surface [radii]
const float behind = 1.0;  // mu: depth at which farther samples are placed [radii]

float depth_at(ivec2 pixel) {
  return texelFetch(liquid_depth_map, clamp(pixel, ivec2(0), textureSize(liquid_depth_map, 0) - 1), 0).r;
}

// State of a pixel's blur.
struct Blur {
  float limit;  // depth at which samples far behind are placed [m]
  float delta;              // m
  float nearest, farthest;  // range found so far [m]
  vec2 sum;                 // of nearness, and of weights
};

void add(inout Blur blur, vec2 pair, float weight) {
  pair = mix(pair, vec2(1e30), equal(pair, vec2(0.0)));  // where there is no liquid, depth is infinite
  bvec2 far = greaterThan(pair, vec2(blur.farthest));
  float nearer = min(pair.x, pair.y);
  float farther = max(far.x ? 0.0 : pair.x, far.y ? 0.0 : pair.y);
  bool taken = nearer >= blur.nearest;
  pair = mix(pair, vec2(blur.limit), far);
  blur.sum += (taken ? weight : 0.0) * vec2(1.0 / pair.x + 1.0 / pair.y, 2.0);
  blur.nearest = taken ? min(blur.nearest, nearer - blur.delta) : blur.nearest;
  blur.farthest = taken ? max(blur.farthest, farther + blur.delta) : blur.farthest;
}

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  float z = texelFetch(liquid_depth_map, pixel, 0).r;
  float radius = texelFetch(liquid_look_map, pixel, 0).z;
  float sigma = z > 0.0 ? deviation * radius / pixel_size(z) : 0.0;  // pixels
  float ends = reach * sigma;
  float stride = max(ends / float(max_taps), 1.0);
  float delta = narrow_range * radius;
  Blur blur = Blur(z + behind * radius, delta, z - delta, z + delta, vec2(z > 0.0 ? 1.0 / z : 0.0, 1.0));
#ifdef CLEAN_UP
  // Cleans up after the passes along the axes, at the scale of their strides. It takes pairs in a window of 5 x 5
  // pixels, or more where strides were longer.
  int part = int(0.5 * stride + 0.75);
  for (int i = z > 0.0 ? 1 : 13; i <= 12; ++i) {
    ivec2 offset = i <= 2 ? ivec2(i, 0) : ivec2((i - 3) % 5 - 2, (i - 3) / 5 + 1);
    float steps2 = float(offset.x * offset.x + offset.y * offset.y);
    offset *= part;
    add(blur, vec2(depth_at(pixel + offset), depth_at(pixel - offset)), exp(-0.25 * steps2));
  }
#else
  ivec2 along = axis < 0.5 ? ivec2(1, 0) : ivec2(0, 1);
  int taps = min(int(ends / stride), max_taps);
  for (int i = 1; i <= taps; ++i) {
    int steps = int(float(i) * stride + 0.5);
    float part = float(steps) / sigma;
    add(blur, vec2(depth_at(pixel + along * steps), depth_at(pixel - along * steps)), exp(-0.5 * part * part));
  }
#endif
  out_depth = z > 0.0 ? blur.sum.y / blur.sum.x : 0.0;
}
