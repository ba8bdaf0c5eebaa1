// An ellipsoid as the smallest upright rectangle around its outline.
#include "frame.glsl"

layout(location = 0) in vec3 center;
// 1: the radius of a ball, see sphere.vert.glsl
layout(location = 3) in vec3 axis_x;  // half axes, m
layout(location = 4) in vec3 axis_y;
layout(location = 5) in vec3 axis_z;

flat out vec3 ball_center;  // in view space
flat out mat3 to_unit_ball;
out vec2 plane_point;  // intersection of the pixel's ray with the plane at distance 1 in front of the eye

// Where the tangent planes of the ellipsoid through the eye cut that plane: n = (1, 0, t) with (n . c)^2 =
// |A^T n|^2, the columns of A being the half axes (likewise for y). `across` and `ahead` are rows of A.
vec2 tangents(float c, float z, vec3 across, vec3 ahead) {
  float a = z * z - dot(ahead, ahead);
  if (a <= 0.0) return vec2(-1e9, 1e9);  // it extends beside or behind the eye
  float b = c * z - dot(across, ahead);
  float root = sqrt(max(b * b - a * (c * c - dot(across, across)), 0.0));
  return (vec2(-b - root, -b + root)) / a;
}

void main() {
  vec3 c = (frame.view * vec4(center, 1.0)).xyz;
  mat3 axes = mat3(frame.view) * mat3(axis_x, axis_y, axis_z);
  ball_center = c;
  to_unit_ball = inverse(axes);
  plane_point = vec2(0.0);
  mat3 rows = transpose(axes);
  bool parallel = frame.projection[3][3] == 1.0;
  // Written so that NaN counts as outside.
  if (!(abs(determinant(axes)) > 0.0) || !(parallel || -c.z > -length(rows[2]))) {
    gl_Position = vec4(0.0, 0.0, 2.0, 1.0);
    return;
  }
  vec2 x = parallel ? c.x + length(rows[0]) * vec2(-1.0, 1.0) : tangents(c.x, c.z, rows[0], rows[2]);
  vec2 y = parallel ? c.y + length(rows[1]) * vec2(-1.0, 1.0) : tangents(c.y, c.z, rows[1], rows[2]);
  vec2 scale = vec2(frame.projection[0][0], frame.projection[1][1]);
  vec2 offset = parallel ? frame.projection[3].xy : -frame.projection[2].xy;
  // Never wider than the screen: rasterizers lose precision on huge triangles.
  vec4 edges = clamp(vec4(x.x, y.x, x.y, y.y) * scale.xyxy + offset.xyxy, -1.0, 1.0);
  vec2 position = vec2((gl_VertexID & 1) == 0 ? edges.x : edges.z, gl_VertexID < 2 ? edges.y : edges.w);
  plane_point = (position - offset) / scale;
  gl_Position = vec4(position, 0.0, 1.0);
}
