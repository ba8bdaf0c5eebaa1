// How much of the sun a point sees.

// The same map read in two ways: compared (with interpolation), and as it is.
uniform sampler2DShadow shadow_map;
uniform sampler2D shadow_depth;

const int blocker_taps = 8;
const int shadow_taps = 16;

// Point i of n, evenly spread over the unit disk (Vogel's spiral), turned by an angle.
vec2 disk_point(int i, int n, float angle) {
  float r = sqrt((float(i) + 0.5) / float(n));
  float a = 2.39996323 * float(i) + angle;
  return r * vec2(cos(a), sin(a));
}

// A number in [0, 1) for each pixel, well spread among neighbours (Jimenez 2014, interleaved gradient noise),
// and other ones in each sample.
float pixel_noise(vec2 pixel) {
  return fract(52.9829189 * fract(dot(pixel, vec2(0.06711056, 0.00583715))) + frame.sample_info.z);
}

// 1 lit, 0 dark. Percentage-closer soft shadows (Fernando 2005): the mean distance of what hides the sun says
// how blurred its shadow is. Samples of one picture see the sun at other places each, so that many of them
// need little blur. `normal` is the surface's, `angle` turns the pattern.
float sun_visibility(vec3 point, vec3 normal, float angle) {
  if (frame.shadow_size.w < 0.5) return 1.0;
  float texel = frame.shadow_size.z;
  float slant = 1.0 - clamp(dot(normal, frame.to_sun.xyz), 0.0, 1.0);
  vec3 p = (frame.shadow * vec4(point + normal * (texel * (0.6 + 1.6 * slant)), 1.0)).xyz;
  if (any(greaterThan(abs(p.xy - 0.5), vec2(0.5)))) return 1.0;

  // The plane of the surface in the map: z changes by dot(slope, xy). Without it, wide filters see the
  // surface itself as its own blocker.
  vec2 extent = frame.shadow_size.xy;  // width and depth of the map in metres
  vec3 plane = (mat3(frame.shadow) * normal) * vec3(extent.x * extent.x, extent.x * extent.x, extent.y * extent.y);
  vec2 slope = clamp(-plane.xy / min(plane.z, -1e-6), vec2(-4.0 * extent.x / extent.y), vec2(4.0 * extent.x / extent.y));

  // How far blockers move in the map with the sun, per depth in the map.
  float spread = frame.sun_size.x * extent.y / extent.x;
  float texel_uv = texel / extent.x;
  float search = max(spread * clamp(p.z, 0.0, 1.0), 2.0 * texel_uv);
  float bias = 0.5 * texel / extent.y;
  float sum = 0.0, count = 0.0;
  for (int i = 0; i < blocker_taps; ++i) {
    vec2 offset = search * disk_point(i, blocker_taps, angle);
    float depth = textureLod(shadow_depth, p.xy + offset, 0.0).r;
    float limit = p.z + dot(slope, offset) - bias;
    if (depth < limit) {
      sum += p.z - depth;
      count += 1.0;
    }
  }
  if (count == 0.0) return 1.0;
  float radius = max(spread * frame.sun_size.y * max(sum / count, 0.0), 1.2 * texel_uv);
  float lit = 0.0;
  for (int i = 0; i < shadow_taps; ++i) {
    vec2 offset = radius * disk_point(i, shadow_taps, angle);
    // Depth beyond the map's end is compared as its end: behind it nothing was drawn.
    lit += textureLod(shadow_map, vec3(p.xy + offset, min(p.z + dot(slope, offset) - bias, 1.0)), 0.0);
  }
  return lit / float(shadow_taps);
}
