// The infinite floor by ray casting: it has no edge, and its depth is exact.
#include "frame.glsl"
#include "common.glsl"
#include "material.glsl"
#include "checker.glsl"

in vec3 ray;

void main() {
  float height = frame.eye.y - frame.ground.x;
  // Visible only from above: from below the floor would hide everything.
  if (height <= 0.0 || ray.y >= 0.0) discard;
  float depth = -height / ray.y;  // along the view, as the ray advances by 1 there
  vec3 point = frame.eye.xyz + ray * depth;
  float clip = frame.projection[3][2] / depth - frame.projection[2][2];
  // Keeps the floor beyond the near and far planes: there are no other objects.
  gl_FragDepth = clamp(0.5 * clip + 0.5, 0.0, 1.0);
  // Fades distant tiles, which would be distracting.
  float near = exp(-3.0 * depth / frame.ground.w);
  float tile = mix(0.5, checker(point.xz / frame.ground.y), near);
  vec3 albedo = mix(frame.ground_second.rgb, frame.ground_color.rgb, tile);
  write_ground(albedo);
}
