// One step of curvature flow (van der Laan, Green, Sainz 2009, section 3.2). The surface moves by its mean curvature H:
// 2 H = div (grad z / sqrt(D)), D = 1 + |grad z|^2.
//
// Three departures. The surface moves by dt H along its normal, so by dt H sqrt(D) along the view. The paper has dt H,
// which leaves ripples at grazing angles. Lengths are meters, not pixels: a step smooths over a number of radii, not of
// pixels. Where a pixel is small, differences are taken over several. The second derivatives are those of nearness 1 /
// z: -z^2 (1/z)'' instead of z''. Nearness is linear across a plane on screen, z is not. So a plane stays unchanged,
// seen from anywhere.
#include "frame.glsl"
#include "liquid.glsl"

layout(location = 0) out float out_depth;

uniform sampler2D liquid_depth_map;
uniform sampler2D liquid_look_map;
uniform float reach;  // distance of the differences [radii]

const float stability = 0.4;  // dt / length^2, at most 1/2
const float gap = 8.0;  // a larger difference in depth belongs to another surface [radii]

float depth_at(ivec2 pixel) {
  return texelFetch(liquid_depth_map, clamp(pixel, ivec2(0), textureSize(liquid_depth_map, 0) - 1), 0).r;
}

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  float z = texelFetch(liquid_depth_map, pixel, 0).r;
  float moved = z;
  // A loop of one iteration or none: a software renderer computes both sides of a branch.
  for (int turn = z > 0.0 ? 0 : 1; turn < 1; ++turn) {
    float radius = texelFetch(liquid_look_map, pixel, 0).z;
    float size = pixel_size(z);
    float wanted = reach * radius;  // m
    int stride = max(int(wanted / size + 0.5), 1);
    float h = float(stride) * size;  // m
    // Strides are whole pixels; this dt keeps the amount of smoothing per step.
    float dt = stability * min(wanted * wanted, h * h);

    float left = depth_at(pixel - ivec2(stride, 0)), right = depth_at(pixel + ivec2(stride, 0));
    float below = depth_at(pixel - ivec2(0, stride)), above = depth_at(pixel + ivec2(0, stride));
    float limit = gap * radius;
    bool smooth_x = min(left, right) > 0.0 && max(abs(left - z), abs(right - z)) < limit;
    bool smooth_y = min(below, above) > 0.0 && max(abs(below - z), abs(above - z)) < limit;
    float m = 1.0 / z, scale = -z * z / (h * h);
    // Beyond its edge the surface is extrapolated linearly (section 3.2.1).
    float p = smooth_x ? (right - left) / (2.0 * h) : 0.0;
    float q = smooth_y ? (above - below) / (2.0 * h) : 0.0;
    float xx = smooth_x ? scale * (1.0 / right - 2.0 * m + 1.0 / left) : 0.0;
    float yy = smooth_y ? scale * (1.0 / above - 2.0 * m + 1.0 / below) : 0.0;
    // The mixed derivative is omitted: it needs four more neighbors and is small where z is smooth.
    float d = 1.0 + p * p + q * q;
    float twice_motion = ((1.0 + q * q) * xx + (1.0 + p * p) * yy) / d;
    moved = max(z + 0.5 * dt * twice_motion, 0.5 * z);
  }
  out_depth = moved;
}
