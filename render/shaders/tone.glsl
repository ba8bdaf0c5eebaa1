// Maps scene light to linear screen colors by a filmic curve, W x^p / (x^p + c), p = 5/4 (the response of Naka and
// Rushton 1966). The exponent gives a toe that leaves blacks black, the sum a shoulder. c and W follow from f(0.18) =
// 0.18, middle gray, and f(5) = 1.
const float tone_c = 0.58508;
const float tone_w = 1.07825;

vec3 tone_mapped(vec3 color) {
  if (frame.sun_size.z < 0.5) return color;
  color = max(color, vec3(0.0));
  vec3 power = color * sqrt(sqrt(color));
  return min(tone_w * power / (power + tone_c), vec3(1.0));
}

// The inverse: scene light from a screen color.
vec3 scene_light(vec3 mapped) {
  if (frame.sun_size.z < 0.5) return mapped;
  mapped = clamp(mapped, vec3(0.0), vec3(0.998));
  return pow(tone_c * mapped / (tone_w - mapped), vec3(0.8));
}
