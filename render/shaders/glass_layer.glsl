// Points where rays enter glass, or leave it.
#include "octahedron.glsl"
#include "liquid.glsl"

layout(location = 0) out vec4 out_point;  // normal, unfolded; depth along the view [m]; number of the surface
#ifdef TARGET_GLASS_ENTRY
layout(location = 1) out vec4 out_look;  // tint; thickness of the wall, or 0 for a sheet [m]
#endif

uniform vec4 color_first;  // tint
uniform float has_normals;
uniform float number;  // of the surface, from 1
uniform float thickness;  // of the wall [m]; 0: a sheet
uniform float layer;
uniform float glass_part;  // as GlassPart
uniform float glass_scale;  // pixels of the picture per pixel along an edge
uniform sampler2D depth_map;
uniform sampler2D liquid_depth_map;
uniform sampler2D glass_entry_map;  // target glass_entry: of the layer behind; target glass_exit: of this layer

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy), of_picture = pixel * int(glass_scale);
  float depth = -(frame.view * vec4(world_point, 1.0)).z;
  vec4 known = texelFetch(glass_entry_map, pixel, 0);
#ifdef TARGET_GLASS_ENTRY
  if (layer > 0.0 && depth >= known.z) discard;  // where there was no layer behind, known.z is 0
  if (depth > opaque_depth(texelFetch(depth_map, of_picture, 0).r)) discard;
  if (glass_part > 0.5) {
    float liquid = texelFetch(liquid_depth_map, of_picture, 0).r;
    bool behind = liquid > 0.0 && depth > liquid;
    if (behind != (glass_part < 1.5)) discard;
  }
  out_look = vec4(color_first.rgb, thickness);
#else
  if (known.w != number || depth < known.z) discard;
#endif
  vec3 to_eye = frame.eye.xyz - world_point;
  vec3 flat_normal = cross(dFdx(world_point), dFdy(world_point));
  vec3 normal = has_normals > 0.5 ? world_normal : flat_normal;
  normal = dot(normal, normal) > 0.0 ? normalize(normal) : normalize(to_eye);
  // Entries face the eye, exits face away.
  float facing = dot(normal, to_eye);
#ifdef TARGET_GLASS_ENTRY
  normal = facing < 0.0 ? -normal : normal;
#else
  normal = facing > 0.0 ? -normal : normal;
#endif
  out_point = vec4(unfolded(normal), depth, number);
}
