// Maps scene light to screen colors: colors below 0.76 are unchanged; brighter ones are compressed at
// constant hue and slowly turn white (after Khronos' PBR neutral tone mapper).
vec3 tone_mapped(vec3 color) {
  const float start = 0.76;
  const float desaturation = 0.15;
  float peak = max(color.r, max(color.g, color.b));
  if (peak < start) return color;
  float d = 1.0 - start;
  float new_peak = 1.0 - d * d / (peak + d - start);
  color *= new_peak / peak;
  float g = 1.0 - 1.0 / (desaturation * (peak - new_peak) + 1.0);
  return mix(color, vec3(new_peak), g);
}

// The inverse: scene light from a screen color.
vec3 scene_light(vec3 mapped) {
  const float start = 0.76;
  const float desaturation = 0.15;
  float new_peak = min(max(mapped.r, max(mapped.g, mapped.b)), 0.995);
  float d = 1.0 - start;
  float peak = d * d / (1.0 - new_peak) + start - d;
  float g = 1.0 - 1.0 / (desaturation * (peak - new_peak) + 1.0);
  return new_peak < start ? mapped : (mapped - new_peak * g) / (1.0 - g) * (peak / new_peak);
}
