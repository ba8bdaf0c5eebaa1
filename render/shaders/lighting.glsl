// Reflection of light.
#include "sky.glsl"

struct Material {
  vec3 albedo;
  float roughness, metalness, sheen, translucency;
};

const float pi = 3.14159265;
// Warmer than the sky: shadows look cool. As sun_color in draw_list.h.
const vec3 sun_color = vec3(1.10, 1.0, 0.86);

// Visibility of the floor through the haze, in which it ends before the horizon.
float ground_visibility(vec3 point) {
  float distance = length(point - frame.eye.xyz) / frame.ground.w;
  return exp(-distance * distance);
}

// Radiance towards `to_eye`. `sun` is the visible fraction of the sun, per color channel; `open` the visible
// fraction of the sky.
vec3 lit(Material m, vec3 normal, vec3 to_eye, vec3 sun, float open) {
  vec3 to_sun = frame.to_sun.xyz;
  vec3 halfway = normalize(to_sun + to_eye);
  float nl = max(dot(normal, to_sun), 0.0);
  float nv = max(dot(normal, to_eye), 1e-3);
  float nh = max(dot(normal, halfway), 0.0);
  float vh = max(dot(to_eye, halfway), 0.0);

  vec3 diffuse_albedo = m.albedo * (1.0 - m.metalness);
  vec3 f0 = mix(vec3(0.04), m.albedo, m.metalness);

  // GGX with Smith's joint visibility (Heitz 2014) and Schlick's Fresnel term.
  float a = max(m.roughness * m.roughness, 0.01);
  float a2 = a * a;
  float d = nh * nh * (a2 - 1.0) + 1.0;
  float distribution = a2 / (pi * d * d);
  float visibility = 0.5 / (nl * sqrt(nv * nv * (1.0 - a2) + a2) + nv * sqrt(nl * nl * (1.0 - a2) + a2) + 1e-5);
  float away = 1.0 - vh, away2 = away * away;
  vec3 fresnel = f0 + (1.0 - f0) * (away2 * away2 * away);
  vec3 specular = fresnel * (distribution * visibility);

  // Sheen: cloth scatters at grazing angles (Estevez and Kulla 2017, roughness 0.5).
  float sine2 = 1.0 - nh * nh;
  float sheen = m.sheen * (2.0 + 2.0) * sine2 / (2.0 * pi) / (4.0 * (nl + nv - nl * nv) + 1e-4);
  vec3 sheen_color = mix(vec3(1.0), m.albedo, 0.6);

  // In a translucent material light spreads around the terminator, most where little is absorbed (wrapped
  // diffuse lighting, Green 2004, "Real-Time Approximations to Subsurface Scattering").
  vec3 wrap = m.translucency * (0.1 + 0.6 * m.albedo);
  vec3 wrapped = clamp((dot(normal, to_sun) + wrap) / ((1.0 + wrap) * (1.0 + 0.5 * wrap)), 0.0, 1.0);
  vec3 reflected = diffuse_albedo / pi * wrapped + (specular + sheen_color * sheen) * nl;
  vec3 direct = reflected * frame.to_sun.w * sun * sun_color;

  // The sky: diffuse, and a rough mirror (Karis 2014, the analytic fit for mobile).
  vec4 r = m.roughness * vec4(-1.0, -0.0275, -0.572, 0.022) + vec4(1.0, 0.0425, 1.04, -0.04);
  float a004 = min(r.x * r.x, exp2(-9.28 * nv)) * r.x + r.y;
  vec2 fit = vec2(-1.04, 1.04) * a004 + r.zw;
  vec3 mirrored = reflect(-to_eye, normal);
  vec3 around = mirrored_light(mirrored, m.roughness);
  vec3 rim = sheen_color * (m.sheen * 0.35 * (1.0 - nv) * (1.0 - nv) * (1.0 - nv));
  vec3 ambient = ambient_light(normal) * (diffuse_albedo + rim) + around * (f0 * fit.x + fit.y);
  return direct + ambient * open;
}
