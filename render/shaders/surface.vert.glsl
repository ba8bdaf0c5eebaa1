#include "frame.glsl"
#include "common.glsl"

layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec3 texture_point;
layout(location = 3) in vec4 color;

uniform mat4 pose;

out vec3 world_point;
out vec3 world_normal;  // not normalized
out vec3 checker_point;
out vec4 vertex_color;
#ifdef WIREFRAME
out vec3 corner;  // barycentric
#endif

void main() {
  vec4 point = pose * vec4(position, 1.0);
  world_point = point.xyz;
  world_normal = mat3(pose) * normal;
  checker_point = texture_point;
  vertex_color = vec4(linear_of_srgb(color.rgb), color.a);
#ifdef WIREFRAME
  int k = gl_VertexID % 3;
  corner = vec3(k == 0, k == 1, k == 2);
#endif
  gl_Position = frame.projection * (frame.view * point);
}
