// A line as a quad around it on the screen, one pixel wider for its soft edge.
layout(location = 0) in vec3 from;
layout(location = 1) in vec3 to;
layout(location = 2) in vec4 color;  // sRGB-encoded
layout(location = 3) in float width;  // pixels

#include "common.glsl"
#include "frame.glsl"

uniform vec2 pixels;  // size of the picture

flat out vec2 start;  // pixels from the bottom left corner
flat out vec2 end;
flat out vec4 line_color;  // linear
flat out float half_width;

// In clip space, moved towards the eye by the length of some pixels. So a line on a surface lies in front of the facets
// it cuts, and its position on the screen does not change.
vec4 clip_of(vec3 point) {
  vec4 position = frame.view * vec4(point, 1.0);
  float pull = min(6.0 / (pixels.y * frame.projection[1][1]), 0.004);
  position.xyz *= 1.0 - pull;
  return frame.projection * position;
}

vec2 pixel_of(vec4 clip) {
  return (0.5 * clip.xy / clip.w + 0.5) * pixels;
}

// Moves a to the intersection of segment a b with the near plane if a is nearer than that plane.
vec4 cut(vec4 a, vec4 b) {
  float da = a.z + a.w, db = b.z + b.w;
  return da < 0.0 ? mix(a, b, da / (da - db)) : a;
}

void main() {
  vec4 clip_a = clip_of(from), clip_b = clip_of(to);
  half_width = 0.5 * width;
  line_color = vec4(linear_of_srgb(color.rgb), color.a);
  if ((clip_a.z < -clip_a.w && clip_b.z < -clip_b.w) || !(width > 0.0)) {
    gl_Position = vec4(0.0, 0.0, 2.0, 1.0);  // outside
    return;
  }
  vec4 a = cut(clip_a, clip_b), b = cut(clip_b, clip_a);
  start = pixel_of(a);
  end = pixel_of(b);
  vec2 along = end - start;
  along = dot(along, along) > 1e-12 ? normalize(along) : vec2(1.0, 0.0);
  vec2 across = vec2(-along.y, along.x);
  float reach = half_width + 1.0;
  bool at_b = gl_VertexID >= 2;
  vec2 position = (at_b ? end + along * reach : start - along * reach) + ((gl_VertexID & 1) == 0 ? across : -across) * reach;
  vec4 clip = at_b ? b : a;
  gl_Position = vec4((2.0 * position / pixels - 1.0) * clip.w, clip.zw);
}
