// Unit vectors as two numbers: on an octahedron, unfolded (Cigolle et al. 2014).
vec2 unfolded(vec3 n) {
  n /= abs(n.x) + abs(n.y) + abs(n.z);
  vec2 side = vec2(n.x < 0.0 ? -1.0 : 1.0, n.y < 0.0 ? -1.0 : 1.0);
  return n.z < 0.0 ? (1.0 - abs(n.yx)) * side : n.xy;
}

vec3 folded(vec2 p) {
  vec3 n = vec3(p, 1.0 - abs(p.x) - abs(p.y));
  vec2 side = vec2(n.x < 0.0 ? -1.0 : 1.0, n.y < 0.0 ? -1.0 : 1.0);
  n.xy = n.z < 0.0 ? (1.0 - abs(n.yx)) * side : n.xy;
  return normalize(n);
}
