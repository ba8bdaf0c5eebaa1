// The infinite floor, found by ray casting: it has no edge, and its depth is exact. Square slabs of concrete
// with thin joints.
#include "frame.glsl"
#include "common.glsl"
#include "material.glsl"
#include "noise.glsl"

in vec3 ray;

const float joint = 0.012;  // width, in slabs

// Share of a pixel of this width, centered at p, that the joints at whole numbers cover.
vec2 joint_coverage(vec2 p, vec2 width) {
  vec2 off = abs(fract(p - 0.5) - 0.5);
  vec2 covered = clamp(0.5 * (width + joint) - off, vec2(0.0), min(width, vec2(joint))) / width;
  return mix(covered, vec2(joint), smoothstep(vec2(0.5), vec2(1.0), width));
}

// Concrete: differences between slabs, stains and grain; each ends where a pixel covers it.
float concrete(vec2 p, float width) {
  float slab = (cell_noise(ivec2(floor(p))) - 0.5) * (1.0 - smoothstep(0.3, 1.2, width));
  float stain = (value_noise(p * 2.3) - 0.5) * (1.0 - smoothstep(0.15, 0.5, width));
  float patch_ = (value_noise(p * 9.1 + 31.0) - 0.5) * (1.0 - smoothstep(0.04, 0.12, width));
  float grain = (value_noise(p * 67.0 + 7.0) - 0.5) * (1.0 - smoothstep(0.006, 0.018, width));
  return slab * 0.16 + stain * 0.18 + patch_ * 0.10 + grain * 0.06;
}

void main() {
  float height = frame.eye.y - frame.ground.x;
  // Visible from above only: from below it would hide everything.
  if (height <= 0.0 || ray.y >= 0.0) discard;
  float depth = -height / ray.y;  // along the view: each ray's component along the view is 1
  vec3 point = frame.eye.xyz + ray * depth;
  float clip = frame.projection[3][2] / depth - frame.projection[2][2];
  // Points beyond the near and far planes are kept: there is no other object.
  gl_FragDepth = clamp(0.5 * clip + 0.5, 0.0, 1.0);
  vec2 p = point.xz / frame.ground.y;
  vec2 width = max(max(abs(dFdx(p)), abs(dFdy(p))), vec2(1e-5));
  vec2 joints = joint_coverage(p, width);
  float shade = 0.5 + concrete(clamp(p, vec2(-1e6), vec2(1e6)), max(width.x, width.y));
  // Distant joints would shimmer.
  float near = exp(-2.0 * depth / frame.ground.w);
  float dark = (1.0 - (1.0 - joints.x) * (1.0 - joints.y)) * near;
  vec3 albedo = mix(frame.ground_second.rgb, frame.ground_color.rgb, 2.0 * shade - 0.5) * (1.0 - 0.7 * dark);
  write_ground(albedo);
}
