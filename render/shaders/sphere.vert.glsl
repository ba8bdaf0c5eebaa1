// A ball as the smallest upright rectangle around its outline.
#include "common.glsl"
#include "frame.glsl"

layout(location = 0) in vec3 center;
layout(location = 1) in float radius;
layout(location = 2) in vec4 color;  // sRGB-encoded

flat out vec3 ball_center;  // in view space
flat out float ball_radius;
flat out vec3 ball_color;  // linear
flat out uint ball_index;
// Intersection of the pixel's ray with the plane at distance 1 in front of the eye; orthographic: any plane.
out vec2 plane_point;

// Where the tangent rays of a circle from the eye cut the line at distance 1. The circle is `across` from the line of
// view and `ahead` of the eye. These tangents are exact also for a ball near the edge of the picture.
vec2 tangents(float across, float ahead, float r) {
  float outside = (ahead - r) * (ahead + r);
  // The circle extends beside or behind the eye: there is no bound.
  if (ahead <= r) return vec2(-1e9, 1e9);
  float root = r * sqrt(max(across * across + outside, 0.0));
  return vec2(across * ahead - root, across * ahead + root) / outside;
}

void main() {
  vec3 c = (frame.view * vec4(center, 1.0)).xyz;
  bool parallel = frame.projection[3][3] == 1.0;
  ball_center = c;
  ball_radius = radius;
  ball_color = linear_of_srgb(color.rgb);
  ball_index = uint(gl_InstanceID);
  plane_point = vec2(0.0);
  if (!(radius > 0.0) || !(parallel || -c.z > -radius)) {  // written so that NaN counts as outside
    gl_Position = vec4(0.0, 0.0, 2.0, 1.0);
    return;
  }
  vec2 x = parallel ? c.x + radius * vec2(-1.0, 1.0) : tangents(c.x, -c.z, radius);
  vec2 y = parallel ? c.y + radius * vec2(-1.0, 1.0) : tangents(c.y, -c.z, radius);
  // From that plane to the screen; the offset shifts the pixel grid, or the window of an orthographic view.
  vec2 scale = vec2(frame.projection[0][0], frame.projection[1][1]);
  vec2 offset = parallel ? frame.projection[3].xy : -frame.projection[2].xy;
  // Never wider than the screen: rasterizers lose precision on huge triangles.
  vec4 edges = clamp(vec4(x.x, y.x, x.y, y.y) * scale.xyxy + offset.xyxy, -1.0, 1.0);
  vec2 position = vec2((gl_VertexID & 1) == 0 ? edges.x : edges.z, gl_VertexID < 2 ? edges.y : edges.w);
  plane_point = (position - offset) / scale;
  gl_Position = vec4(position, 0.0, 1.0);
}
