// Sunlight transmitted by liquids, from the sums drawn from the sun's view.
uniform sampler2D liquid_light_map;  // optical depth of red, green, blue; minimum depth

// The surface reflects this fraction of the light or refracts it aside.
const float lost_at_surface = 0.22;

vec3 sun_through_liquid(SurfacePoint surface) {
  vec3 p = (frame.shadow * vec4(surface.point, 1.0)).xyz;
  vec4 found = texture(liquid_light_map, p.xy);
  // Half floats are coarse: points within a few texels of the liquid's surface count partially.
  float behind = clamp((p.z - found.a) / (6.0 * frame.shadow_size.z / frame.shadow_size.x) - 0.5, 0.0, 1.0);
  float covered = 1.0 - exp(-4.0 * max(found.r, max(found.g, found.b)));
  vec3 left = exp(-found.rgb) * (1.0 - lost_at_surface * covered);
  bool inside = frame.shadow_size.w > 0.5 && all(lessThan(abs(p.xy - 0.5), vec2(0.5)));
  return inside ? mix(vec3(1.0), left, behind) : vec3(1.0);
}
