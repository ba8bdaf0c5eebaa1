// The endless floor, found by casting rays: it has no edge, and its depth is exact.
#include "frame.glsl"
#include "common.glsl"
#include "material.glsl"
#include "checker.glsl"
#include "ray.glsl"

in vec2 place;

void main() {
  vec3 direction = world_ray(place);
  float height = frame.eye.y - frame.ground.x;
  // From below the floor would hide everything, so it is seen from above only.
  if (height <= 0.0 || direction.y >= 0.0) discard;
  vec3 point = frame.eye.xyz - direction * (height / direction.y);
  vec4 clip = frame.projection * (frame.view * vec4(point, 1.0));
  // What lies beyond the planes that enclose the scene is kept: nothing else is there.
  gl_FragDepth = clamp(0.5 * clip.z / clip.w + 0.5, 0.0, 1.0);
  vec3 albedo = mix(frame.ground_second.rgb, frame.ground_colour.rgb, checker(point.xz / frame.ground.y));
  write_ground(albedo);
}
