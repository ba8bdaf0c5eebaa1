// How much of the sun each pixel sees: percentage-closer soft shadows (Fernando 2005). The mean distance of what
// hides the sun says how blurred its shadow is. Samples of one picture see the sun at other places each, so
// that many of them need little blur.
//
// The target was cleared to 1. A pixel leaves by `discard` as soon as it is known to be lit: a software
// renderer goes on through the rest of the shader after any other exit.
#include "frame.glsl"
#include "surface_point.glsl"

in vec3 ray;
layout(location = 0) out float out_visibility;

// Depth as the sun sees it. Compared here, without interpolation: on a CPU that costs half as much as the
// sampler's comparison of four texels, and the turned patterns hide the difference.
uniform sampler2D shadow_map;

const int blocker_taps = 8;
const int shadow_taps = 16;
// Points evenly spread over the unit disk: Vogel's spiral, r = sqrt((i + 0.5) / n), angle = 2.4 i.
const vec2 blocker_disk[8] = vec2[8](
    vec2(0.2500, 0.0000), vec2(-0.3193, 0.2925), vec2(0.0489, -0.5569), vec2(0.4024, 0.5249),
    vec2(-0.7385, -0.1306), vec2(0.6996, -0.4450), vec2(-0.2340, 0.8705), vec2(-0.4463, -0.8593));
const vec2 shadow_disk[16] = vec2[16](
    vec2(0.1768, 0.0000), vec2(-0.2258, 0.2068), vec2(0.0346, -0.3938), vec2(0.2846, 0.3712),
    vec2(-0.5222, -0.0924), vec2(0.4947, -0.3147), vec2(-0.1655, 0.6155), vec2(-0.3156, -0.6076),
    vec2(0.6846, 0.2500), vec2(-0.7123, 0.2940), vec2(0.3434, -0.7337), vec2(0.2537, 0.8089),
    vec2(-0.7647, -0.4432), vec2(0.8971, -0.1972), vec2(-0.5475, 0.7788), vec2(-0.1265, -0.9761));

// A number in [0, 1) for each pixel, well spread among neighbours (Jimenez 2014, interleaved gradient noise),
// and other ones in each sample.
float pixel_noise(vec2 pixel) {
  return fract(52.9829189 * fract(dot(pixel, vec2(0.06711056, 0.00583715))) + frame.sample_info.z);
}

void main() {
  SurfacePoint surface = surface_point(ivec2(gl_FragCoord.xy), ray);
  float facing = dot(surface.normal, frame.to_sun.xyz);
  if (surface.kind == kind_sky || facing <= 0.0) discard;
  float texel = frame.shadow_size.z;
  vec3 lifted = surface.point + surface.normal * (texel * (2.2 - 1.6 * facing));
  vec3 p = (frame.shadow * vec4(lifted, 1.0)).xyz;
  if (any(greaterThan(abs(p.xy - 0.5), vec2(0.5)))) discard;

  // The plane of the surface in the map: z changes by dot(slope, xy). Without it, wide filters see the
  // surface itself as its own blocker.
  vec2 extent = frame.shadow_size.xy;  // width and depth of the map in metres
  vec3 plane = (mat3(frame.shadow) * surface.normal) * vec3(extent.x * extent.x, extent.x * extent.x, extent.y * extent.y);
  vec2 slope = clamp(-plane.xy / min(plane.z, -1e-6), vec2(-4.0 * extent.x / extent.y), vec2(4.0 * extent.x / extent.y));

  // How far blockers move in the map with the sun, per depth in the map.
  float spread = frame.sun_size.x * extent.y / extent.x;
  float texel_uv = texel / extent.x;
  float search = max(spread * clamp(p.z, 0.0, 1.0), 2.0 * texel_uv);
  float bias = 0.5 * texel / extent.y;
  float sum = 0.0, count = 0.0;
  float angle = 6.2831853 * pixel_noise(gl_FragCoord.xy);
  mat2 turn = mat2(cos(angle), sin(angle), -sin(angle), cos(angle));
  for (int i = 0; i < blocker_taps; ++i) {
    vec2 offset = search * (turn * blocker_disk[i]);
    float depth = textureLod(shadow_map, p.xy + offset, 0.0).r;
    float limit = min(p.z + dot(slope, offset) - bias, 1.0);  // behind the map's end nothing was drawn
    if (depth < limit) {
      sum += p.z - depth;
      count += 1.0;
    }
  }
  if (count == 0.0) discard;
  float radius = max(spread * frame.sun_size.y * max(sum / count, 0.0), 1.2 * texel_uv);
  float lit = 0.0;
  for (int i = 0; i < shadow_taps; ++i) {
    vec2 offset = radius * (turn * shadow_disk[i]);
    float limit = min(p.z + dot(slope, offset) - bias, 1.0);
    lit += step(limit, textureLod(shadow_map, p.xy + offset, 0.0).r);
  }
  out_visibility = lit / float(shadow_taps);
}
