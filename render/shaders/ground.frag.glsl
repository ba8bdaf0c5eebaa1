// The infinite floor, found by ray casting: it has no edge, and its depth is exact.
#include "frame.glsl"
#include "common.glsl"
#include "material.glsl"
#include "checker.glsl"

in vec3 ray;

void main() {
  float height = frame.eye.y - frame.ground.x;
  // Visible from above only: from below it would hide everything.
  if (height <= 0.0 || ray.y >= 0.0) discard;
  float depth = -height / ray.y;  // along the view: each ray's component along the view is 1
  vec3 point = frame.eye.xyz + ray * depth;
  float clip = frame.projection[3][2] / depth - frame.projection[2][2];
  // Points beyond the near and far planes are kept: there is no other object.
  gl_FragDepth = clamp(0.5 * clip + 0.5, 0.0, 1.0);
  // Distant tiles would be distracting.
  float near = exp(-3.0 * depth / frame.ground.w);
  float tile = mix(0.5, checker(point.xz / frame.ground.y), near);
  vec3 albedo = mix(frame.ground_second.rgb, frame.ground_color.rgb, tile);
  write_ground(albedo);
}
