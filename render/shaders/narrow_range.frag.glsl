// The narrow-range filter (Truong and Yuksel 2018): a separable Gaussian blur of depth, in which depths
// far behind are clamped to a little behind, and depths far in front are ignored. "Far" follows from the range of
// depths sampled so far, so surfaces at grazing angles stay connected. Pairs of opposite samples are used or omitted
// together, or the surface would tilt at edges.
//
// One deviation: it averages nearness 1 / z, which is linear across a plane on screen, so planes are unchanged.
#include "frame.glsl"
#include "liquid.glsl"

layout(location = 0) out float out_depth;

uniform sampler2D liquid_depth_map;
uniform sampler2D liquid_look_map;
uniform float axis;       // 0: x, 1: y
uniform float deviation;  // standard deviation of the Gaussian [radii]

const int most_taps = 12;          // per side; small pixels are skipped
const float reach = 2.5;           // deviations
const float narrow_range = 5.0;    // delta: maximum depth difference of neighbors on one surface [radii]
const float behind = 1.0;          // mu: distance to which farther depths are clamped [radii]

float depth_at(ivec2 pixel) {
  return texelFetch(liquid_depth_map, clamp(pixel, ivec2(0), textureSize(liquid_depth_map, 0) - 1), 0).r;
}

// Accumulated depth of a pixel.
struct Blur {
  float limit;              // depth to which far depths are clamped [m]
  float delta;              // m
  float nearest, farthest;  // range of the depths sampled so far [m]
  vec2 sum;                 // sums of nearness and of weights
};

void add(inout Blur blur, vec2 pair, float weight) {
  pair = mix(pair, vec2(1e30), equal(pair, vec2(0.0)));  // empty pixels are far
  bvec2 far = greaterThan(pair, vec2(blur.farthest));
  float least = min(pair.x, pair.y);
  float greatest = max(far.x ? 0.0 : pair.x, far.y ? 0.0 : pair.y);
  bool taken = least >= blur.nearest;
  pair = mix(pair, vec2(blur.limit), far);
  blur.sum += (taken ? weight : 0.0) * vec2(1.0 / pair.x + 1.0 / pair.y, 2.0);
  blur.nearest = taken ? min(blur.nearest, least - blur.delta) : blur.nearest;
  blur.farthest = taken ? max(blur.farthest, greatest + blur.delta) : blur.farthest;
}

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  float z = texelFetch(liquid_depth_map, pixel, 0).r;
  float radius = texelFetch(liquid_look_map, pixel, 0).z;
  float sigma = z > 0.0 ? deviation * radius / pixel_size(z) : 0.0;  // pixels
  float ends = reach * sigma;
  float stride = max(ends / float(most_taps), 1.0);
  float delta = narrow_range * radius;
  Blur blur = Blur(z + behind * radius, delta, z - delta, z + delta, vec2(z > 0.0 ? 1.0 / z : 0.0, 1.0));
#ifdef CLEAN_UP
  // Removes the residue of the separable passes at the scale of their strides: pairs of 5 x 5 pixels, or more for
  // longer strides.
  int part = int(0.5 * stride + 0.75);
  for (int i = z > 0.0 ? 1 : 13; i <= 12; ++i) {
    ivec2 offset = i <= 2 ? ivec2(i, 0) : ivec2((i - 3) % 5 - 2, (i - 3) / 5 + 1);
    float steps2 = float(offset.x * offset.x + offset.y * offset.y);
    offset *= part;
    add(blur, vec2(depth_at(pixel + offset), depth_at(pixel - offset)), exp(-0.25 * steps2));
  }
#else
  ivec2 along = axis < 0.5 ? ivec2(1, 0) : ivec2(0, 1);
  int taps = min(int(ends / stride), most_taps);
  for (int i = 1; i <= taps; ++i) {
    int steps = int(float(i) * stride + 0.5);
    float part = float(steps) / sigma;
    add(blur, vec2(depth_at(pixel + along * steps), depth_at(pixel - along * steps)), exp(-0.5 * part * part));
  }
#endif
  out_depth = z > 0.0 ? blur.sum.y / blur.sum.x : 0.0;
}
