// Lights what the material pass has found at each pixel, and maps it to what a screen shows: lines drawn over it keep
// their colours, and edges between bright and dark are as smooth as others.
#include "frame.glsl"
#include "common.glsl"
#include "ray.glsl"
#include "lighting.glsl"
#include "shadow.glsl"
#include "occlusion.glsl"
#include "tone.glsl"

in vec2 place;
layout(location = 0) out vec4 out_colour;

uniform sampler2D albedo_map;
uniform sampler2D normal_map;
uniform sampler2D depth_map;

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  vec4 stored = texelFetch(normal_map, pixel, 0);
  vec3 ray = world_ray(place);
  vec3 to_eye = -normalize(ray);
  if (stored.w == 0.0) {
    out_colour = vec4(tone_mapped(sky_light(-to_eye)), 1.0);
    return;
  }
  vec4 albedo = texelFetch(albedo_map, pixel, 0);
  Material material;
  material.albedo = albedo.rgb * albedo.rgb;
  material.roughness = albedo.a;
  material.metalness = stored.w > 0.0 ? floor(stored.w - 1.0) / 15.0 : 0.0;
  material.sheen = stored.w > 0.0 ? fract(stored.w) / 0.9 : 0.0;
  vec3 normal = normalize(stored.xyz);
  vec3 point;
  if (stored.w < 0.0) {
    point = frame.eye.xyz + ray * ((frame.ground.x - frame.eye.y) / ray.y);
  } else {
    point = world_of_depth(place, texelFetch(depth_map, pixel, 0).r);
  }
  float depth = dot(point - frame.eye.xyz, -frame.inverse_view[2].xyz);
  float open = sky_visibility(gl_FragCoord.xy, depth);
  float sun = 0.0;
  if (dot(normal, frame.to_sun.xyz) > 0.0) {
    sun = sun_visibility(point, normal, 6.2831853 * pixel_noise(gl_FragCoord.xy));
  }
  vec3 colour = lit(material, normal, to_eye, sun, open);
  if (stored.w < 0.0) colour = mix(sky_light(-to_eye), colour, ground_visibility(point));
  out_colour = vec4(tone_mapped(colour), 1.0);
}
