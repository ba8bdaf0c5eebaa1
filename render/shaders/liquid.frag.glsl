// Shades liquids and foam over the lit scene: the refracted and attenuated background, and the
// reflection.
#include "frame.glsl"
#include "common.glsl"
#include "surface_point.glsl"
#include "lighting.glsl"
#include "sunlight.glsl"
#include "tone.glsl"
#include "liquid.glsl"

in vec3 ray;
layout(location = 0) out vec4 out_color;

uniform sampler2D color_map;  // the scene without liquids
uniform sampler2D liquid_depth_map;
uniform sampler2D liquid_look_map;
uniform sampler2D liquid_optics_map;  // optical depth of red, green, blue; thickness [m]
uniform sampler2D liquid_glow_map;    // scattered part of the optical depth; optical depth of foam

float depth_at(ivec2 pixel) {
  return texelFetch(liquid_depth_map, clamp(pixel, ivec2(0), textureSize(liquid_depth_map, 0) - 1), 0).r;
}

// Derivative of depth along the surface: of the differences to two neighbors, the one within the surface.
float slope_of(float z, float back, float forth) {
  bool ahead = back <= 0.0 || (forth > 0.0 && abs(forth - z) < abs(back - z));
  return ahead ? (forth > 0.0 ? forth - z : 0.0) : z - back;
}

vec2 slope_of_surface(ivec2 pixel, float z) {
  return vec2(slope_of(z, depth_at(pixel - ivec2(1, 0)), depth_at(pixel + ivec2(1, 0))),
              slope_of(z, depth_at(pixel - ivec2(0, 1)), depth_at(pixel + ivec2(0, 1))));
}

// Derivative of the path length in the liquid, over about a particle: a shorter distance would show particles.
vec2 slope_of_thickness(vec2 place, float reach) {
  vec2 x = vec2(reach * frame.size.z, 0.0), y = vec2(0.0, reach * frame.size.w);
  vec4 t = vec4(texture(liquid_optics_map, place + x).a, texture(liquid_optics_map, place - x).a,
                texture(liquid_optics_map, place + y).a, texture(liquid_optics_map, place - y).a);
  return (t.xz - t.yw) / (2.0 * reach);
}

// Unit normal toward the eye of a surface at depth z with these derivatives.
vec3 normal_of(float z, vec2 slope) {
  vec3 dx = dFdx(ray), dy = dFdy(ray);
  vec3 normal = normalize(cross((ray + dx) * (z + slope.x) - ray * z, (ray + dy) * (z + slope.y) - ray * z));
  return dot(normal, ray) > 0.0 ? -normal : normal;
}

// The reflected part of unpolarized light at a smooth surface (Fresnel).
float fresnel(float cosine, float index) {
  float g = sqrt(max(index * index - 1.0 + cosine * cosine, 0.0));
  float a = (g - cosine) / max(g + cosine, 1e-4);
  float b = (cosine * (g + cosine) - 1.0) / (cosine * (g - cosine) + 1.0);
  return 0.5 * a * a * (1.0 + b * b);
}

// Reflected environment: sky above, floor below; without a floor, sky all around.
vec3 surroundings(vec3 direction) {
  if (direction.y > 0.0 || frame.ground.z < 0.5) return sky_light(direction);
  vec3 up = vec3(0.0, 1.0, 0.0);
  vec3 albedo = mix(frame.ground_color.rgb, frame.ground_second.rgb, 0.5);
  vec3 floor_light = albedo * (ambient_strength * ambient_light(up) + sun_color * (frame.to_sun.w * max(frame.to_sun.y, 0.0) / pi));
  vec3 horizon = sky_light(normalize(vec3(direction.x, 0.0, direction.z)));
  return mix(horizon, floor_light, 1.0 - exp(9.0 * direction.y));  // haze ends the floor
}

vec2 place_of(vec4 clip) {
  return clamp(0.5 * clip.xy / max(clip.w, 1e-6) + 0.5, 0.5 * frame.size.zw, 1.0 - 0.5 * frame.size.zw);
}

float opaque_depth_at(vec2 place) {
  return opaque_depth(texelFetch(depth_map, ivec2(place * frame.size.xy), 0).r);
}

// Path of the light seen through a point of the surface.
struct Way {
  vec2 place;      // origin of the light on the screen
  vec2 left;       // exit point from the liquid
  bool shown;      // false: the origin is outside the picture or hidden
  vec3 direction;  // direction to sample the environment in that case
  float shorter;   // ratio of path lengths in the liquid: unrefracted to refracted
};

const int march_steps = 8;

// `thickness`: of all liquid on the ray, in meters.
Way way_through(SurfacePoint surface, vec2 slope, float thickness, vec4 look) {
  vec3 straight = normalize(ray);
  float along_view = 1.0 / length(ray);
  float cosine = max(-dot(straight, surface.normal), 0.15);
  Way way;
  vec3 bent = refract(straight, surface.normal, 1.0 / look.x);
  way.shorter = cosine / max(-dot(bent, surface.normal), 0.15);  // as in a layer with parallel sides
  float path = thickness * way.shorter;

  // Up to an opaque object behind the surface; w is the depth along the view.
  vec4 start = frame.projection * (frame.view * vec4(surface.point, 1.0));
  vec4 whole = frame.projection * (frame.view * vec4(bent * path, 0.0));
  float part = 1.0, before = -1.0, noise = pixel_noise(gl_FragCoord.xy);
  bool met = false;
  // Objects nearer by more than this are not hit: the path continues behind them.
  float tolerance = 4.0 * path / float(march_steps) + 0.5 * look.z;
  for (int i = 1; i <= march_steps; ++i) {
    float at = (float(i) - noise) / float(march_steps);
    vec4 clip = start + whole * at;
    float there = opaque_depth_at(place_of(clip));
    float over = clip.w - there;
    if (over > 0.0 && over < tolerance && there > surface.depth) {
      part = at - over / (over - before) / float(march_steps);
      met = true;
      break;
    }
    before = min(over, -1e-6);
  }
  vec4 end = start + whole * part;
  way.left = place_of(end);

  // Otherwise it exits through the back (Wyman 2005), where depth and thickness add up to the path; or total reflection.
  float reach = clamp(2.5 * look.z / pixel_size(surface.depth), 2.0, 32.0);
  vec2 back_slope = slope + slope_of_thickness(gl_FragCoord.xy * frame.size.zw, reach) * along_view;
  vec3 back = normal_of(surface.depth + thickness * along_view, back_slope);
  vec3 out_ = refract(bent, back, look.x);
  way.direction = dot(out_, out_) < 0.5 ? reflect(bent, back) : out_;
  // Continues to the background, with a limit, or small waves would distort it.
  float gap = clamp((opaque_depth_at(place_of(end)) - end.w) / along_view, 0.0, 2.0 * path + 20.0 * look.z);
  vec4 onward = end + frame.projection * (frame.view * vec4(way.direction * gap, 0.0));
  end = met ? end : onward;
  way.place = place_of(end);
  way.shown = met || (end.w > 0.0 && all(lessThanEqual(abs(end.xy), vec2(end.w))));
  // If an object in front of the liquid hides the end, or the path continues behind one, shows the unrefracted background.
  float there = opaque_depth_at(way.place);
  if (there < surface.depth || (!met && way.shown && there < end.w - tolerance)) {
    way.place = gl_FragCoord.xy * frame.size.zw;
    way.left = way.place;
    way.shown = true;
  }
  return way;
}

float sun_mirrored(vec3 normal, vec3 to_eye, float roughness) {
  vec3 halfway = normalize(frame.to_sun.xyz + to_eye);
  float nl = max(dot(normal, frame.to_sun.xyz), 0.0), nv = max(dot(normal, to_eye), 1e-3);
  float nh = max(dot(normal, halfway), 0.0);
  float a2 = max(pow(roughness, 4.0), 1e-5);
  float d = nh * nh * (a2 - 1.0) + 1.0;
  float visibility = 0.5 / (nl * sqrt(nv * nv * (1.0 - a2) + a2) + nv * sqrt(nl * nl * (1.0 - a2) + a2) + 1e-5);
  return frame.to_sun.w * nl * visibility * a2 / (pi * d * d);
}

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  vec2 place = gl_FragCoord.xy * frame.size.zw;
  SurfacePoint behind = surface_point(pixel, ray);
  float opaque = behind.kind == kind_sky ? 1e30 : behind.depth;
  float z = texelFetch(liquid_depth_map, pixel, 0).r;
  bool wet = z > 0.0 && z < opaque;
  vec4 glow = texture(liquid_glow_map, place);
  if (!wet && glow.a < 0.002) discard;
  vec4 optics = texture(liquid_optics_map, place);
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
    Way way = way_through(surface, slope, optics.a, look);
    vec3 through = way.shown ? scene_light(texture(color_map, way.place).rgb) : surroundings(way.direction);
    // The visible background is attenuated, so samples the optical depth in front of it.
    if (depth_at(ivec2(way.left * frame.size.xy)) > 0.0) {
      optics = texture(liquid_optics_map, way.left);
      glow.rgb = texture(liquid_glow_map, way.left).rgb;
    }
    vec3 depth = optics.rgb * way.shorter;
    vec3 left = exp(-depth);
    vec3 cloudy = glow.rgb / max(optics.rgb, vec3(1e-9)) * (1.0 - left);
    float facing = 0.5 + 0.5 * dot(normal, frame.to_sun.xyz);
    vec3 scattered = cloudy * (ambient_strength * ambient_light(normal) + sunlight * (facing * facing / pi));
    vec3 mirrored = surroundings(reflect(-to_eye, normal));
    // At its edge the layer is thinner than its splats: fades the edge.
    mirrors *= smoothstep(0.0, 0.6, (opaque - z) / look.z);
    vec3 halfway = normalize(frame.to_sun.xyz + to_eye);
    float spark = sun_mirrored(normal, to_eye, look.y) * fresnel(max(dot(halfway, to_eye), 0.0), look.x);
    seen = tone_mapped(mix(through * left + scattered, mirrored, mirrors) + sun_color * (spark * sun));
  }
  float hides = 1.0 - exp(-glow.a);
  vec3 around = normalize(mix(normal, vec3(0.0, 1.0, 0.0), 0.5));
  float lit_ = max(0.35 + 0.65 * dot(around, frame.to_sun.xyz), 0.0);
  vec3 white = 0.85 * (ambient_strength * ambient_light(around) + sunlight * (lit_ / pi));
  out_color = vec4(mix(seen, tone_mapped(white), hides), 1.0);
}
