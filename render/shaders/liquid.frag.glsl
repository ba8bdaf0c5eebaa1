// Shades liquids and foam over the lit scene: the refracted and attenuated image behind the surface, and its
// reflections.
#include "frame.glsl"
#include "common.glsl"
#include "surface_point.glsl"
#include "lighting.glsl"
#include "sunlight.glsl"
#include "tone.glsl"
#include "liquid.glsl"
#include "fresnel.glsl"
#include "sun_mirrored.glsl"

in vec3 ray;
layout(location = 0) out vec4 out_color;

uniform sampler2D color_map;  // the scene without liquids
uniform sampler2D liquid_depth_map;
uniform sampler2D liquid_look_map;
uniform sampler2D liquid_optics_map;  // optical depth of red, green, blue; thickness [m]
uniform sampler2D liquid_glow_map;  // optical depth by scattering; that of foam
uniform vec4 extinction;  // of all liquids [1/m]; w: 0 where they differ

float depth_at(ivec2 pixel) {
  return texelFetch(liquid_depth_map, clamp(pixel, ivec2(0), textureSize(liquid_depth_map, 0) - 1), 0).r;
}

// Depth difference to the next pixel: of the differences to both neighbors, the one on the same surface.
float slope_of(float z, float back, float forth) {
  bool ahead = back <= 0.0 || (forth > 0.0 && abs(forth - z) < abs(back - z));
  return ahead ? (forth > 0.0 ? forth - z : 0.0) : z - back;
}

vec2 slope_of_surface(ivec2 pixel, float z) {
  return vec2(slope_of(z, depth_at(pixel - ivec2(1, 0)), depth_at(pixel + ivec2(1, 0))),
              slope_of(z, depth_at(pixel - ivec2(0, 1)), depth_at(pixel + ivec2(0, 1))));
}

// Change of the thickness per pixel, over about a particle's size: shorter differences would show individual
// particles.
vec2 slope_of_thickness(vec2 uv, float reach) {
  vec2 x = vec2(reach * frame.size.z, 0.0), y = vec2(0.0, reach * frame.size.w);
  vec4 t = vec4(texture(liquid_optics_map, uv + x).a, texture(liquid_optics_map, uv - x).a,
                texture(liquid_optics_map, uv + y).a, texture(liquid_optics_map, uv - y).a);
  return (t.xz - t.yw) / (2.0 * reach);
}

// Opacity of foam from its optical depth: single bubbles are opaque, and dense foam keeps differences of density
// instead of turning into a white slab.
float foam_opacity(float depth) {
  return 0.56 * (1.0 - exp(-1.3 * depth)) + 0.36 * (1.0 - exp(-0.11 * depth));
}

// Change of the density of foam over two pixels, as its logarithm.
vec2 slope_of_foam(vec2 uv) {
  vec2 x = vec2(1.5 * frame.size.z, 0.0), y = vec2(0.0, 1.5 * frame.size.w);
  vec4 f = log(1.0 + vec4(texture(liquid_glow_map, uv + x).a, texture(liquid_glow_map, uv - x).a,
                          texture(liquid_glow_map, uv + y).a, texture(liquid_glow_map, uv - y).a));
  return f.xz - f.yw;
}

// Unit normal towards the eye, at depth z with this change per pixel.
vec3 normal_of(float z, vec2 slope) {
  vec3 dx = dFdx(ray), dy = dFdy(ray);
  vec3 normal = normalize(cross((ray + dx) * (z + slope.x) - ray * z, (ray + dy) * (z + slope.y) - ray * z));
  return dot(normal, ray) > 0.0 ? -normal : normal;
}

vec2 uv_of(vec4 clip) {
  return clamp(0.5 * clip.xy / max(clip.w, 1e-6) + 0.5, 0.5 * frame.size.zw, 1.0 - 0.5 * frame.size.zw);
}

float opaque_depth_at(vec2 uv) {
  return opaque_depth(texelFetch(depth_map, ivec2(uv * frame.size.xy), 0).r);
}

// Path of the light that is seen through a point of the surface.
struct Refraction {
  vec2 uv;  // point on the screen from which the light comes
  vec2 exit_uv;  // point on the screen where the path leaves the liquid
  bool shown;  // false: the light comes from outside the picture, or from a hidden point
  vec3 direction;  // direction of the light in that case
  float path_factor;  // length in the liquid over that of the straight path
  float whole;  // length in the liquid where the path ends at an opaque object in it, otherwise 0 [m]
};

// Steps along the refracted path.
int march_steps() { return frame.sun_size.w > 0.5 ? 4 : 8; }
// Longest part of a path that the last step may leave out, as a factor: a path this much longer reaches its end.
float reaching() { return 1.0 / (1.0 - 1.0 / float(march_steps())) + 0.01; }

// `thickness` is that of all liquid on the ray [m].
Refraction refraction_at(SurfacePoint surface, vec2 slope, float thickness, vec4 look) {
  vec3 straight = normalize(ray);
  float along_view = 1.0 / length(ray);
  float cosine = max(-dot(straight, surface.normal), 0.15);
  Refraction refraction;
  vec3 bent = refract(straight, surface.normal, 1.0 / look.x);
  // As in a layer with parallel sides.
  refraction.path_factor = cosine / max(-dot(bent, surface.normal), 0.15);
  float path = thickness * refraction.path_factor;
  // Below the upper side of a pool, liquid reaches down to the floor. At its back, light that enters from above is
  // totally reflected, and the path goes on as if there were more of the pool.
  float height = frame.ground.z > 0.5 ? surface.point.y - frame.ground.x : 0.0;
  float down = height / max(-bent.y, 0.3);
  float pool = smoothstep(0.5, 0.8, surface.normal.y) * smoothstep(0.03, 0.15, path / max(down, 1e-6));
  path = mix(path, max(path, reaching() * down), height > 0.0 ? pool : 0.0);

  // March until the path meets an opaque object behind the surface; w is the depth along the view.
  vec4 start = frame.projection * (frame.view * vec4(surface.point, 1.0));
  vec4 whole = frame.projection * (frame.view * vec4(bent * path, 0.0));
  float part = 1.0, before = -1.0, noise = pixel_noise(gl_FragCoord.xy);
  bool hit = false;
  // An object that is nearer by more than this is not hit: the path passes behind it.
  float tolerance = 4.0 * path / float(march_steps()) + 0.5 * look.z;
  for (int i = 1; i <= march_steps(); ++i) {
    float at = (float(i) - noise) / float(march_steps());
    vec4 clip = start + whole * at;
    float there = opaque_depth_at(uv_of(clip));
    float over = clip.w - there;
    if (over > 0.0 && over < tolerance && there > surface.depth) {
      part = at - over / (over - before) / float(march_steps());
      hit = true;
      break;
    }
    before = min(over, -1e-6);
  }
  vec4 end = start + whole * part;
  refraction.exit_uv = uv_of(end);
  refraction.whole = hit ? part * path : 0.0;

  // Otherwise the light leaves through the back (Wyman 2005), at depth plus thickness.
  float reach = clamp(7.0 * look.z / pixel_size(surface.depth), 2.0, 64.0);
  vec2 back_slope = slope + slope_of_thickness(gl_FragCoord.xy * frame.size.zw, reach) * along_view;
  vec3 back = normal_of(surface.depth + thickness * along_view, back_slope);
  vec3 out_ = refract(bent, back, look.x);
  // Beyond the critical angle the light leaves along the back, for that is mostly an error of this normal.
  bool total = dot(out_, out_) < 0.5;
  vec3 along = bent - back * dot(bent, back);
  out_ = total ? along / max(length(along), 1e-4) : out_;
  // The back is known roughly: half the bend there, so that its unevenness does not mix sky and floor.
  refraction.direction = normalize(mix(straight, out_, 0.5));
  // Continue to the objects behind, over a limited distance: otherwise small waves would distort the image
  // too much.
  float gap = clamp((opaque_depth_at(uv_of(end)) - end.w) / along_view, 0.0, 2.0 * path + 20.0 * look.z);
  vec4 onward = end + frame.projection * (frame.view * vec4(refraction.direction * gap, 0.0));
  end = hit ? end : onward;
  refraction.uv = uv_of(end);
  refraction.shown = hit || (end.w > 0.0 && all(lessThanEqual(abs(end.xy), vec2(end.w))));
  // The point straight ahead is shown if an object in front of the liquid hides the end, or if the path passes behind
  // an object.
  float there = opaque_depth_at(refraction.uv);
  if (there < surface.depth || (refraction.whole == 0.0 && refraction.shown && there < end.w - tolerance)) {
    refraction.uv = gl_FragCoord.xy * frame.size.zw;
    refraction.exit_uv = refraction.uv;
    refraction.shown = true;
  }
  return refraction;
}

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  vec2 uv = gl_FragCoord.xy * frame.size.zw;
  SurfacePoint behind = surface_point(pixel, ray);
  float opaque = behind.kind == kind_sky ? 1e30 : behind.depth;
  float z = texelFetch(liquid_depth_map, pixel, 0).r;
  bool wet = z > 0.0 && z < opaque;
  vec4 glow = texture(liquid_glow_map, uv);
  if (!wet && glow.a < 0.002) discard;
  vec4 optics = texture(liquid_optics_map, uv);
  vec4 look = texelFetch(liquid_look_map, pixel, 0);
  vec3 to_eye = -normalize(ray);

  SurfacePoint surface;
  surface.kind = kind_surface;
  surface.depth = wet ? z : min(opaque, frame.ground.w);
  surface.point = frame.eye.xyz + ray * surface.depth;
  vec2 slope = slope_of_surface(pixel, z);
  surface.normal = wet ? normal_of(z, slope) : vec3(0.0, 1.0, 0.0);
  surface.code = 0.0;
  vec3 normal = surface.normal;
  float sun = sun_visibility(surface);
  vec3 sunlight = sun_color * (frame.to_sun.w * sun);

  vec3 seen = texelFetch(color_map, pixel, 0).rgb;
  if (wet) {
    float cosine = clamp(dot(normal, to_eye), 0.0, 1.0);
    float mirrors = fresnel(cosine, look.x);
    // The clouds of the lowest particles reach below the floor: liquid that stands on an object fills the gap.
    float gap = (opaque - z) * length(ray);
    float standing = optics.a > 0.0 ? 1.0 - smoothstep(1.5, 3.0, (gap - optics.a) / look.z) : 0.0;
    float thickness = mix(optics.a, max(reaching() * gap, optics.a), standing);
    Refraction refraction = refraction_at(surface, slope, thickness, look);
    // Where there is nothing behind, the sky in the light's direction is exact.
    bool only_sky = texelFetch(normal_map, ivec2(refraction.uv * frame.size.xy), 0).w == 0.0;
    // It is blurred, as by small waves: the horizon would show every unevenness of the back.
    vec3 around_sky = mix(sky_light(refraction.direction), ambient_light(refraction.direction), 0.8);
    vec3 through = refraction.shown && !only_sky ? scene_light(texture(color_map, refraction.uv).rgb) : around_sky;
    // The attenuated image is that at the exit point, so thickness is looked up there.
    if (depth_at(ivec2(refraction.exit_uv * frame.size.xy)) > 0.0) {
      optics = texture(liquid_optics_map, refraction.exit_uv);
      glow.rgb = texture(liquid_glow_map, refraction.exit_uv).rgb;
    }
    vec3 depth = optics.rgb * refraction.path_factor;
    if (refraction.whole > 0.0 && extinction.w > 0.0) depth = extinction.rgb * refraction.whole;
    vec3 left = exp(-depth);
    vec3 cloudy = glow.rgb / max(optics.rgb, vec3(1e-9)) * (1.0 - left);
    float facing = 0.5 + 0.5 * dot(normal, frame.to_sun.xyz);
    vec3 scattered = cloudy * (ambient_light(normal) + sunlight * (facing * facing / pi));
    vec3 mirrored = sky_light(reflect(-to_eye, normal));
    // At the shore the layer is thinner than the particles' radius: the last pixels of its edge fade.
    mirrors *= smoothstep(0.0, 0.2, (opaque - z) / look.z);
    vec3 halfway = normalize(frame.to_sun.xyz + to_eye);
    float spark = sun_mirrored(normal, to_eye, look.y) * fresnel(max(dot(halfway, to_eye), 0.0), look.x);
    seen = tone_mapped(mix(through * left + scattered, mirrored, mirrors) + sun_color * (spark * sun));
  }
  // Foam: the gradient of its density tilts the normal, so that lumps and streaks show.
  float hides = foam_opacity(glow.a);
  vec2 lumps = slope_of_foam(uv);
  vec3 to_right = normalize(dFdx(ray)), to_top = normalize(dFdy(ray));
  vec3 around = normalize(mix(normal, vec3(0.0, 1.0, 0.0), 0.5) - clamp(2.0 * lumps.x, -1.2, 1.2) * to_right - clamp(2.0 * lumps.y, -1.2, 1.2) * to_top);
  float lit_ = max(0.2 + 0.8 * dot(around, frame.to_sun.xyz), 0.0);
  vec3 white = 0.85 * (ambient_light(around) + sunlight * (lit_ / pi));
  out_color = vec4(mix(seen, tone_mapped(white), hides), 1.0);
}
