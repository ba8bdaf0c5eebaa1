// Value noise on a lattice of integers.

// A number in [0, 1) for each cell, the same on every machine: integer arithmetic only.
float cell_noise(ivec2 cell) {
  uvec2 q = uvec2(cell) * uvec2(1597334673u, 3812015801u);
  uint n = (q.x ^ q.y) * 1597334673u;
  n = (n ^ (n >> 15)) * 2246822519u;
  return float(n >> 8) / 16777216.0;
}

// Smooth noise in [0, 1) with features of size 1.
float value_noise(vec2 p) {
  vec2 cell = floor(p), t = p - cell;
  ivec2 i = ivec2(cell);
  t = t * t * (3.0 - 2.0 * t);
  vec2 a = vec2(cell_noise(i), cell_noise(i + ivec2(0, 1)));
  vec2 b = vec2(cell_noise(i + ivec2(1, 0)), cell_noise(i + ivec2(1, 1)));
  vec2 across = mix(a, b, t.x);
  return mix(across.x, across.y, t.y);
}
