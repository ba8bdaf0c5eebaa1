#include "frame.glsl"
#include "common.glsl"

in vec3 world_point;
in vec3 world_normal;
in vec3 checker_point;
in vec4 vertex_color;

#ifdef TARGET_PICK
layout(location = 0) out uvec2 picked;
uniform uint pick;

void main() { picked = uvec2(pick, 0u); }
#endif

#if defined(TARGET_GLASS_ENTRY) || defined(TARGET_GLASS_EXIT)
#include "glass_layer.glsl"
#endif

#ifdef TARGET_SUNLIGHT
#include "glass_sunlight.glsl"
#endif

#ifdef TARGET_DEPTH
void main() {}
#endif

#ifdef TARGET_MATERIAL
#include "material.glsl"
#include "pattern.glsl"

uniform vec4 color_first;
uniform vec4 color_second;
uniform vec4 look;          // roughness, metalness, sheen, edge of a pattern's field or 0
uniform vec4 fabric;        // Pattern, strength of the weave, translucency
uniform float has_colors;  // 1 where vertices have colors
uniform float has_normals;
#ifdef PRINT
uniform sampler2D print_map;
#endif

#ifdef WIREFRAME
in vec3 corner;
uniform float wire_width;  // pixels

float wire() {
  vec3 change = fwidth(corner);
  vec3 distance = corner / max(change, vec3(1e-9));
  float nearest = min(min(distance.x, distance.y), distance.z);
  // Where triangles are smaller than a few pixels, lines would cover the surface.
  float density = max(max(change.x, change.y), change.z);
  return (1.0 - smoothstep(0.5 * wire_width - 0.5, 0.5 * wire_width + 0.5, nearest)) * (1.0 - 0.85 * clamp(2.0 * density, 0.0, 1.0));
}
#endif

void main() {
  vec3 to_eye = frame.eye.xyz - world_point;
  vec3 flat_normal = cross(dFdx(world_point), dFdy(world_point));
  vec3 normal = has_normals > 0.5 ? world_normal : flat_normal;
  normal = dot(normal, normal) > 0.0 ? normalize(normal) : normalize(to_eye);
  // Both sides are lit. The face, not the interpolated normal, determines the visible side.
  float side = dot(flat_normal, to_eye) * dot(flat_normal, normal);
  if (side < 0.0) normal = -normal;

  vec3 albedo = color_first.rgb;
#ifdef PRINT
  vec4 ink = texture(print_map, checker_point.xy);
  albedo = mix(albedo, ink.rgb, ink.a);
#else
  if (look.w > 0.0) {
    vec3 p = checker_point / look.w;
    int pattern = int(fabric.x + 0.5);
    albedo = mix(color_second.rgb, albedo, printed(pattern, p));
    if (pattern == pattern_strands) albedo *= strands(p.x);
    if (fabric.y > 0.0) albedo *= mix(1.0, weave(p), fabric.y);
  }
#endif
  if (has_colors > 0.5) albedo = vertex_color.rgb;
#ifdef WIREFRAME
  albedo = mix(albedo, albedo * 0.08, wire());
#endif
  if (fabric.z > 0.0) {
    write_translucent(albedo, normal, look.x, fabric.z);
  } else {
    write_material(albedo, normal, look.x, look.y, look.z);
  }
}
#endif
