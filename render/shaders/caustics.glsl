// Sunlight on the floor over that without refraction, from the map of render/passes/caustics.h.
uniform sampler2D caustics_map;  // number of rays, each counted in 3 x 3 texels
uniform mat4 to_caustics;
uniform vec4 caustics_floor;  // height, tolerance [m]

float caustics(SurfacePoint surface) {
  vec2 uv = (to_caustics * vec4(surface.point, 1.0)).xy;
  float off = abs(surface.point.y - caustics_floor.x);
  bool on_floor = off < caustics_floor.y && surface.normal.y > 0.9;
  bool inside = all(lessThan(abs(uv - 0.5), vec2(0.49)));
  return on_floor && inside ? texture(caustics_map, uv).r / 9.0 : 1.0;
}
