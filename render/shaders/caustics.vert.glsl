// One ray of sunlight for each texel of the liquids' depth as the sun sees it: where it meets the floor.
#include "frame.glsl"
#include "liquid.glsl"

uniform sampler2D liquid_depth_map;
uniform sampler2D liquid_look_map;
uniform float height;  // of the floor [m]

float depth_at(ivec2 texel) {
  return texelFetch(liquid_depth_map, clamp(texel, ivec2(0), textureSize(liquid_depth_map, 0) - 1), 0).r;
}

// Change of depth per texel: the central difference, or that to the neighbor on the surface.
float slope_of(float z, float back, float forth) {
  if (back <= 0.0 && forth <= 0.0) return 0.0;
  return back <= 0.0 ? forth - z : (forth <= 0.0 ? z - back : 0.5 * (forth - back));
}

void main() {
  gl_PointSize = 3.0;  // as caustics.glsl assumes
  ivec2 size = textureSize(liquid_depth_map, 0);
  ivec2 texel = ivec2(gl_VertexID % size.x, gl_VertexID / size.x);
  vec2 clip = (vec2(texel) + 0.5) / vec2(size) * 2.0 - 1.0;
  float z = depth_at(texel);
  gl_Position = vec4(clip, 0.0, 1.0);
  if (z <= 0.0) return;  // no liquid: straight on
  vec2 slope = vec2(slope_of(z, depth_at(texel - ivec2(1, 0)), depth_at(texel + ivec2(1, 0))),
                    slope_of(z, depth_at(texel - ivec2(0, 1)), depth_at(texel + ivec2(0, 1))));
  vec3 normal = normalize(vec3(slope / pixel_size(z), 1.0));
  vec3 bent = refract(vec3(0.0, 0.0, -1.0), normal, 1.0 / texelFetch(liquid_look_map, texel, 0).x);
  vec3 direction = mat3(frame.inverse_view) * bent;
  vec2 scale = vec2(frame.projection[0][0], frame.projection[1][1]);
  vec3 point = (frame.inverse_view * vec4(clip / scale, -z + sun_offset(), 1.0)).xyz;
  float way = (height - point.y) / direction.y;
  vec4 end = frame.projection * (frame.view * vec4(point + direction * way, 1.0));
  bool meets = direction.y < -0.05 && way > 0.0;
  gl_Position = meets ? vec4(end.xy, 0.0, 1.0) : vec4(0.0, 0.0, 2.0, 1.0);
}
