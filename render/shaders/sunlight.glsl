// Visible fraction of the sun at a surface: percentage-closer soft shadows (Fernando 2005). The mean distance
// of the blockers determines the blur of the shadow. Samples of one picture see the sun at different
// positions, so many samples need little blur.
//
// A software renderer computes both sides of a branch; only loops end when no pixel continues. Costly code is
// therefore in loops that do no iteration where the sun's visibility is known.

// Depth from the sun. Compared here, without interpolation: on a CPU that costs half as much as the sampler's
// comparison of four texels. The rotated patterns hide the difference.
uniform sampler2D shadow_map;

// A number in [0, 1) for each pixel, evenly distributed among neighbors (Jimenez 2014, interleaved gradient
// noise), and different in each sample.
float pixel_noise(vec2 pixel) {
  return fract(52.9829189 * fract(dot(pixel, vec2(0.06711056, 0.00583715))) + frame.sample_info.z);
}

int blocker_taps() { return frame.sun_size.w > 0.5 ? 5 : 8; }
int shadow_taps() { return frame.sun_size.w > 0.5 ? 8 : 14; }

// Rotation by the golden angle, about 137.5 degrees. Points at r = sqrt((i + 0.5) / n), each rotated by it relative to
// the previous one, cover the unit disk evenly (Vogel's spiral). Arrays of constants would be stored in memory per
// pixel.
const mat2 golden_turn = mat2(-0.73736888, 0.67549029, -0.67549029, -0.73736888);

// Visibility of the sun at the current pixel: 1 lit to 0 dark.
float sun_visibility(SurfacePoint surface) {
  float facing = dot(surface.normal, frame.to_sun.xyz);
  float texel = frame.shadow_size.z;
  vec3 lifted = surface.point + surface.normal * (texel * (2.2 - 1.6 * facing));
  vec3 p = (frame.shadow * vec4(lifted, 1.0)).xyz;
  // Displacement of blockers in the map over the sun's disk, per depth in the map, which covers a cube.
  float spread = frame.sun_size.x;
  float texel_uv = texel / frame.shadow_size.x;
  float search = max(spread * clamp(p.z, 0.0, 1.0), 2.0 * texel_uv);
  // The map is wide enough that nothing near its rim is in shadow.
  bool inside = frame.shadow_size.w > 0.5 && surface.kind != kind_sky && facing > 0.0 && all(lessThan(abs(p.xy - 0.5), vec2(0.5 - search)));

  // The plane of the surface in the map: z changes by dot(slope, xy). Without it, wide filters would take the
  // surface for its own blocker.
  vec3 plane = mat3(frame.shadow) * surface.normal;
  vec2 slope = clamp(-plane.xy / min(plane.z, -1e-6), vec2(-4.0), vec2(4.0));
  float depth = p.z - 0.5 * texel_uv;
  // A half circle without sines, which are costly here; slight unevenness does not matter.
  float t = 2.0 * pixel_noise(gl_FragCoord.xy) - 1.0;
  vec2 direction = vec2(1.0 - t * t, 2.0 * t) / (1.0 + t * t);

  vec2 found = vec2(0.0);  // sum of the blockers' distances, and their number
  int taps = inside ? blocker_taps() : 0;
  for (int i = 0; i < taps; ++i) {
    vec2 offset = direction * (search * sqrt((float(i) + 0.5) / float(blocker_taps())));
    float blocker = textureLod(shadow_map, p.xy + offset, 0.0).r;
    // Nothing was drawn at 1, the far end of the map.
    if (blocker < min(depth + dot(slope, offset), 1.0)) found += vec2(p.z - blocker, 1.0);
    direction = golden_turn * direction;
  }

  float radius = clamp(spread * frame.sun_size.y * found.x / max(found.y, 1.0), 1.2 * texel_uv, search);
  float dark = 0.0;
  taps = found.y > 0.0 ? shadow_taps() : 0;
  for (int i = 0; i < taps; ++i) {
    vec2 offset = direction * (radius * sqrt((float(i) + 0.5) / float(shadow_taps())));
    float blocker = textureLod(shadow_map, p.xy + offset, 0.0).r;
    if (blocker < min(depth + dot(slope, offset), 1.0)) dark += 1.0;
    direction = golden_turn * direction;
  }
  return 1.0 - dark / float(shadow_taps());
}
