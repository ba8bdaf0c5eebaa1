// Checkers without aliasing: the mean over a pixel instead of the value at its center (Inigo Quilez,
// "filtering the checkerboard", box filter).

// Fields of edge 1 in space, alternately 1 and 0; their mean where fields are smaller than a pixel.
float checker(vec3 p) {
  // Flat cloths, sides of boxes and their edges often lie exactly on field borders: the offset moves them
  // off.
  p = 0.999 * p + vec3(0.0, 0.5, 0.0);
  vec3 width = max(max(abs(dFdx(p)), abs(dFdy(p))), vec3(1e-5));
  vec3 a = p + 0.5 * width, b = p - 0.5 * width;
  // The integral of the square wave is a triangle wave.
  vec3 mean = 2.0 * (abs(fract(0.5 * a) - 0.5) - abs(fract(0.5 * b) - 0.5)) / width;
  mean = mix(clamp(mean, -1.0, 1.0), vec3(0.0), smoothstep(vec3(1.0), vec3(3.0), width));
  return 0.5 - 0.5 * mean.x * mean.y * mean.z;
}

float checker(vec2 p) {
  vec2 width = max(max(abs(dFdx(p)), abs(dFdy(p))), vec2(1e-5));
  vec2 a = p + 0.5 * width, b = p - 0.5 * width;
  vec2 mean = 2.0 * (abs(fract(0.5 * a) - 0.5) - abs(fract(0.5 * b) - 0.5)) / width;
  return 0.5 - 0.5 * mean.x * mean.y;
}
