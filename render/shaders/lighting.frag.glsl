// Lights each pixel from the result of the material pass, and tone-maps it for the screen. Tone mapping here keeps the
// colors of lines drawn later. It also makes edges between bright and dark as smooth as others.
#include "frame.glsl"
#include "common.glsl"
#include "surface_point.glsl"
#include "lighting.glsl"
#include "occlusion.glsl"
#include "sunlight.glsl"
#ifdef LIQUIDS
#include "sun_through_liquid.glsl"
#endif
#ifdef CAUSTICS
#include "caustics.glsl"
#endif
#include "tone.glsl"

in vec3 ray;
layout(location = 0) out vec4 out_color;

uniform sampler2D albedo_map;

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  SurfacePoint surface = surface_point(pixel, ray);
  vec3 to_eye = -normalize(ray);
  vec3 sky = sky_behind(-to_eye);
  vec4 albedo = texelFetch(albedo_map, pixel, 0);
  Material material;
  material.albedo = albedo.rgb * albedo.rgb;
  material.roughness = albedo.a;
  bool translucent = surface.code >= 17.0, solid = surface.kind == kind_surface && !translucent;
  material.metalness = solid ? floor(surface.code - 1.0) / 15.0 : 0.0;
  material.sheen = solid ? fract(surface.code) / 0.9 : 0.0;
  material.translucency = translucent ? surface.code - 17.0 : 0.0;

  float open = sky_visibility(gl_FragCoord.xy, surface.normal, ray, surface.depth);
  vec3 sun = vec3(sun_visibility(surface));
#ifdef LIQUIDS
  sun *= sun_through_liquid(surface);
#endif
#ifdef CAUSTICS
  sun *= caustics(surface);
#endif
  vec3 color = lit(material, surface.normal, to_eye, sun, open);
  float visible = surface.kind == kind_sky ? 0.0 : (surface.kind == kind_ground ? ground_visibility(surface.point) : 1.0);
  out_color = vec4(tone_mapped(mix(sky, color, visible)), 1.0);
}
