// One triangle that covers the screen, and the ray from the eye through each of its points.
#include "frame.glsl"

out vec2 uv;  // in [0, 1] across the screen
out vec3 ray;  // world space; its component along the view is 1

void main() {
  uv = vec2(gl_VertexID == 1 ? 2.0 : 0.0, gl_VertexID == 2 ? 2.0 : 0.0);
  gl_Position = vec4(2.0 * uv - 1.0, 0.0, 1.0);
  vec4 far = frame.inverse_projection * vec4(gl_Position.xy, 1.0, 1.0);
  ray = mat3(frame.inverse_view) * (far.xyz / -far.z);
}
