// The sky: a procedural one, of which render/sky.cpp contains the same model, or with SKY_MAP a panorama.

// Radiance from a unit direction: a blue zenith, a warm horizon, and the floor below it.
vec3 procedural_sky(vec3 direction) {
  bool above = direction.y > 0.0;
  float h = above ? direction.y : -direction.y * (frame.ground.z > 0.5 ? 3.0 : 1.0);
  // Haze ends higher in the sky for blue light than for red: the sky is blue, not gray, above the horizon.
  vec3 height = h * vec3(1.6, 1.0, 0.55);
  vec3 color = mix(above ? frame.sky.rgb : frame.floor_light.rgb, frame.horizon.rgb, 1.0 / (1.0 + height * (9.0 + 40.0 * height)));
  // The sun is not drawn, but the air around it glows.
  float cosine = above ? max(dot(direction, frame.to_sun.xyz), 0.0) : 0.0;
  float c2 = cosine * cosine, c4 = c2 * c2, c8 = c4 * c4, c16 = c8 * c8, c32 = c16 * c16;
  return color + frame.horizon.rgb * (0.12 * c4 + 0.5 * c32 * c32);
}

// Light of sky and floor that a white, diffuse surface with this unit normal reflects: irradiance / pi, from
// second-order spherical harmonics (Ramamoorthi and Hanrahan 2001).
vec3 ambient_light(vec3 n) {
  vec3 sum = 0.282095 * frame.irradiance[0].rgb;
  sum += 0.488603 * (n.y * frame.irradiance[1].rgb + n.z * frame.irradiance[2].rgb + n.x * frame.irradiance[3].rgb);
  sum += 1.092548 * (n.x * n.y * frame.irradiance[4].rgb + n.y * n.z * frame.irradiance[5].rgb + n.x * n.z * frame.irradiance[7].rgb);
  sum += 0.315392 * (3.0 * n.z * n.z - 1.0) * frame.irradiance[6].rgb;
  sum += 0.546274 * (n.x * n.x - n.y * n.y) * frame.irradiance[8].rgb;
  return max(sum, vec3(0.0));
}

#ifdef SKY_MAP
uniform sampler2D sky_map;

// Radiance of the panorama, averaged over texels of 2^level pixels. Its middle is in the direction of -Z.
vec3 panorama_light(vec3 direction, float level) {
  float around = atan(direction.x, -direction.z) * 0.15915494 + 0.5 + frame.horizon.w;
  float down = acos(clamp(direction.y, -1.0, 1.0)) * 0.31830989;
  return frame.sky.w * textureLod(sky_map, vec2(around, down), level).rgb;
}

vec3 sky_light(vec3 direction) { return panorama_light(direction, 0.0); }

vec3 sky_behind(vec3 direction) {
  return frame.floor_light.w > 0.5 ? sky_light(direction) : procedural_sky(direction);
}

// Light that a rough mirror sees around this direction: the width of its lobe is about the square of the roughness.
vec3 mirrored_light(vec3 direction, float roughness) {
  float level = log2(1.0 + 0.25 * roughness * roughness * float(textureSize(sky_map, 0).x));
  return mix(panorama_light(direction, level), ambient_light(direction), smoothstep(0.5, 1.0, roughness));
}
#else
vec3 sky_light(vec3 direction) { return procedural_sky(direction); }

vec3 sky_behind(vec3 direction) { return procedural_sky(direction); }

vec3 mirrored_light(vec3 direction, float roughness) {
  return mix(sky_light(direction), ambient_light(direction), roughness);
}
#endif
