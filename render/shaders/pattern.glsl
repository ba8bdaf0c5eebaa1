// Printed patterns and weaves without aliasing: means over a pixel (box filter). Points are in fields of the
// pattern; a flat cloth has y = 0.25.
#include "checker.glsl"
#include "noise.glsl"

// As Pattern in draw_list.h.
const int pattern_checker = 0, pattern_stripes = 1, pattern_plaid = 2, pattern_dots = 3, pattern_strands = 4;

// Share of a pixel of this width at x that a band [start, start + size] covers, repeated with this period.
float band(float x, float width, float start, float size, float period) {
  float middle = (fract((x - start - 0.5 * size) / period + 0.5) - 0.5) * period;
  float covered = clamp(0.5 * (size + width) - abs(middle), 0.0, min(size, width)) / width;
  return mix(covered, size / period, smoothstep(0.5 * period, period, width));
}

// Two directions along the cloth; closed cloths get both from three coordinates.
vec2 along_cloth(vec3 p) { return p.xz + 0.7 * p.y; }

float stripes(vec2 p, vec2 width) {
  return band(p.x, width.x, 0.0, 1.0, 2.0) * (1.0 - band(p.x, width.x, 0.42, 0.16, 2.0));
}

// A wide and a narrow band of each direction, woven: where both cross, the color is full.
float plaid(vec2 p, vec2 width) {
  float warp = band(p.x, width.x, 0.0, 1.3, 3.0) + band(p.x, width.x, 2.0, 0.22, 3.0);
  float weft = band(p.y, width.y, 0.0, 1.3, 3.0) + band(p.y, width.y, 2.0, 0.22, 3.0);
  return 0.5 * (warp + weft);
}

// Dots of the second color: balls at the centers of the fields in space.
float dots(vec3 p, vec2 width) {
  float off = length(fract(p) - 0.5) - 0.38;
  float w = max(max(width.x, width.y), 1e-4);
  return mix(clamp(off / w + 0.5, 0.0, 1.0), 0.72, smoothstep(0.5, 1.0, w));
}

// Share of the first color at p.
float printed(int pattern, vec3 p) {
  vec2 q = along_cloth(p);
  vec2 width = max(max(abs(dFdx(q)), abs(dFdy(q))), vec2(1e-5));
  if (pattern == pattern_stripes) return stripes(q, width);
  if (pattern == pattern_plaid) return plaid(q, width);
  if (pattern == pattern_dots) return dots(p, width);
  return checker(p);
}

// Brightness of a plain weave: threads over and under, and threads of uneven thickness.
float weave(vec3 p) {
  const float threads = 22.0;  // per field
  vec2 q = along_cloth(p);
  vec2 width = max(abs(dFdx(q)), abs(dFdy(q)));
  float fine = threads * max(width.x, width.y);
  vec2 wave = cos(6.2831853 * threads * q);
  float over = 0.5 * wave.x * wave.y * (1.0 - smoothstep(0.15, 0.5, fine));
  float uneven = value_noise(q * vec2(1.5, 17.0)) + value_noise(q.yx * vec2(1.5, 17.0) + 40.0) - 1.0;
  return 1.0 + 0.36 * over + 0.20 * uneven * (1.0 - smoothstep(0.4, 1.4, fine));
}

// Brightness of the strands of a rope, dark in the grooves between them.
float strands(float x) {
  float width = max(fwidth(x), 1e-4);
  float across = fract(x) * 2.0 - 1.0;
  float a2 = across * across;
  return mix(1.12 - 0.8 * a2 * a2, 0.96, smoothstep(0.3, 1.0, width));
}
