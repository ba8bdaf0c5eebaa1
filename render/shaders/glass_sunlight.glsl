// Sunlight lost in glass, seen from the sun, where it enters. It is the summed optical depth of red, green, blue, of
// the wall and the reflections at both its sides. Depth in the sun's map; its minimum is kept.
#include "fresnel.glsl"

layout(location = 0) out vec4 out_optics;
uniform vec4 color_first;  // tint
uniform float has_normals;

void main() {
  vec3 flat_normal = cross(dFdx(world_point), dFdy(world_point));
  vec3 normal = normalize(has_normals > 0.5 ? world_normal : flat_normal);
  float cosine = max(abs(dot(normal, frame.eye.xyz)), 0.02);
  float passes = max(1.0 - fresnel(cosine, 1.5), 0.05);
  float way = 1.0 / sqrt(1.0 - (1.0 - cosine * cosine) / 2.25);
  vec3 tint = max(color_first.rgb, vec3(0.01));
  out_optics = vec4(-log(tint) * way - 2.0 * log(passes), gl_FragCoord.z);
}
