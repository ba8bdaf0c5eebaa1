// Reflection of light.

struct Material {
  vec3 albedo;
  float roughness, metalness, sheen;
};

const float pi = 3.14159265;
// The sky gives less light than it shows, like a photographer's backdrop: otherwise shadows would be pale.
const float ambient_strength = 0.5;
// A little warmer than the sky: shadows look cool and lit surfaces neutral.
const vec3 sun_color = vec3(1.05, 1.0, 0.92);

// Radiance of the sky in a direction (unit).
vec3 sky_light(vec3 direction) {
  float h = max(direction.y, 0.0);
  vec3 color = mix(frame.sky.rgb, frame.horizon.rgb, 1.0 / (1.0 + h * (3.0 + 4.5 * h)));  // about exp(-3 h)
  // The sun itself is not drawn, but the air around it glows.
  float cosine = max(dot(direction, frame.to_sun.xyz), 0.0);
  float c2 = cosine * cosine, c6 = c2 * c2 * c2, c12 = c6 * c6, c24 = c12 * c12;
  color += frame.horizon.rgb * (0.10 * c6 + 0.18 * c24 * c24);
  return color;
}

// Mean radiance from sky and floor on a rough surface with this normal.
vec3 ambient_light(vec3 normal) {
  float up = normal.y;
  vec3 above = mix(frame.horizon.rgb, frame.sky.rgb, clamp(0.5 + 0.5 * up, 0.0, 1.0));
  return mix(frame.floor_light.rgb * 0.75, above, smoothstep(-1.0, 0.8, up));
}

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

  vec3 direct = (diffuse_albedo / pi + specular + sheen_color * sheen) * (frame.to_sun.w * nl) * sun * sun_color;

  // The sky: diffuse, and a rough mirror (Karis 2014, the analytic fit for mobile).
  vec4 r = m.roughness * vec4(-1.0, -0.0275, -0.572, 0.022) + vec4(1.0, 0.0425, 1.04, -0.04);
  float a004 = min(r.x * r.x, exp2(-9.28 * nv)) * r.x + r.y;
  vec2 fit = vec2(-1.04, 1.04) * a004 + r.zw;
  vec3 mirrored = reflect(-to_eye, normal);
  vec3 around = mix(mirrored.y > 0.0 ? sky_light(mirrored) : frame.floor_light.rgb * 0.75, ambient_light(mirrored),
                    m.roughness);
  vec3 rim = sheen_color * (m.sheen * 0.35 * (1.0 - nv) * (1.0 - nv) * (1.0 - nv));
  vec3 ambient = ambient_strength * (ambient_light(normal) * (diffuse_albedo + rim) + around * (f0 * fit.x + fit.y));
  return direct + ambient * open;
}
