// Shades one layer of glass over the picture behind it. A ray is refracted where it enters (Snell), goes straight to
// the plane of the surface where it leaves, and is refracted again. Its end is found on the screen.
#include "frame.glsl"
#include "common.glsl"
#include "lighting.glsl"
#include "tone.glsl"
#include "liquid.glsl"
#include "octahedron.glsl"
#include "fresnel.glsl"
#include "sun_mirrored.glsl"

in vec3 ray;
layout(location = 0) out vec4 out_color;

uniform float part;  // as GlassPart
uniform float glass_scale;  // pixels per pixel of the layer along an edge
uniform int steps;  // towards what a ray meets
uniform sampler2D color_map;  // the picture behind
uniform sampler2D depth_map;
uniform sampler2D liquid_depth_map;
uniform sampler2D glass_entry_map;
uniform sampler2D glass_exit_map;
uniform sampler2D glass_look_map;

const float index = 1.5;

// Depth along the view of the nearest object behind this layer of glass [m].
float depth_behind(vec2 uv) {
  ivec2 pixel = ivec2(clamp(uv, vec2(0.0), vec2(1.0)) * (frame.size.xy - 0.01));
  float depth = min(opaque_depth(texelFetch(depth_map, pixel, 0).r), frame.ground.w);
  float liquid = part > 1.5 ? texelFetch(liquid_depth_map, pixel, 0).r : 0.0;
  return liquid > 0.0 ? min(depth, liquid) : depth;
}

// Where the light from `direction` at a point of the glass comes from: a point of the screen, or the sky.
struct Source {
  vec2 uv;
  bool is_sky;
};

Source source_behind(vec3 point, vec3 direction) {
  vec2 here = gl_FragCoord.xy * frame.size.zw, uv = here;
  // In clip space, where w is the depth along the view.
  vec4 from = frame.projection * (frame.view * vec4(point, 1.0));
  vec4 to = frame.projection * (frame.view * vec4(direction, 0.0));
  float depth = from.w, advance = max(to.w, 0.05);
  for (int i = 0; i < steps; ++i) {
    vec4 clip = from + to * max((depth_behind(uv) - depth) / advance, 0.0);
    uv = 0.5 * clip.xy / clip.w + 0.5;
  }
  // Hidden by something in front of the glass, or outside the picture.
  bool hidden = depth_behind(uv) < depth;
  vec2 border = 0.5 * frame.size.zw;
  vec2 kept = clamp(hidden ? here : uv, border, 1.0 - border);
  bool outside = any(greaterThan(abs(uv - kept), vec2(0.05))) && !hidden;
  // To the side or back: not on the screen.
  return Source(kept, to.w < 0.05 || (outside && direction.y > 0.0));
}

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  ivec2 of_layer = pixel / int(glass_scale);
  vec4 entry = texelFetch(glass_entry_map, of_layer, 0);
  if (entry.w == 0.0) discard;
  vec4 exit_ = texelFetch(glass_exit_map, of_layer, 0), look = texelFetch(glass_look_map, of_layer, 0);
  vec3 along = normalize(ray), normal = folded(entry.xy);
  vec3 start = frame.eye.xyz + ray * entry.z, end = start, leaving = along;
  float cosine = clamp(-dot(along, normal), 0.02, 1.0);
  float mirrors = fresnel(cosine, index), mirrors_back = mirrors, walls = 0.5 / cosine;
  bool total = false;
  if (exit_.w == entry.w && look.w > 0.0) {
    vec3 inside = refract(along, normal, 1.0 / index), back = folded(exit_.xy);
    float straight = dot(ray, ray) > 0.0 ? (exit_.z - entry.z) * length(ray) : 0.0;
    float outward = max(dot(inside, back), 0.05);
    float way = clamp(dot(ray * (exit_.z - entry.z), back) / outward, 0.0, 2.0 * straight);
    end = start + inside * way;
    leaving = refract(inside, -back, index);
    mirrors_back = dot(leaving, leaving) > 0.5 ? fresnel(clamp(dot(leaving, back), 0.02, 1.0), index) : 0.0;
    total = dot(leaving, leaving) < 0.5;
    if (total) leaving = reflect(inside, back);
    walls = way / look.w;
  }
  vec3 left = pow(look.rgb, vec3(min(walls, 6.0)));
  vec3 to_eye = -along;
  vec3 spark = sun_color * min(0.04 * sun_mirrored(normal, to_eye, 0.12), 8.0);
  vec3 mirrored = sky_light(reflect(along, normal)) * (mirrors + (1.0 - mirrors) * (1.0 - mirrors) * mirrors_back);
  Source source = source_behind(end, leaving);
  vec2 uv = total ? gl_FragCoord.xy * frame.size.zw : source.uv;
  vec3 behind = source.is_sky && !total ? sky_light(leaving) : scene_light(texture(color_map, uv).rgb);
  // After total reflection light crosses more walls, which the screen does not show: it comes from all around.
  if (total) behind = 0.35 * ambient_light(leaving) + 0.5 * behind;
  vec3 through = behind * left * ((1.0 - mirrors) * (1.0 - mirrors_back));
  out_color = vec4(tone_mapped(through + mirrored + spark), 1.0);
}
