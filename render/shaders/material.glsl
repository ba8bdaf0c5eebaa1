// Output of shaders with target material: the visible surface of a pixel. lighting.frag.glsl reads it.
layout(location = 0) out vec4 out_albedo;
layout(location = 1) out vec4 out_normal;

// `normal` is a unit vector in world space, towards the eye. Albedo is stored as its square root, for
// precision in 8 bits.
void write_material(vec3 albedo, vec3 normal, float roughness, float metalness, float sheen) {
  out_albedo = vec4(sqrt(clamp(albedo, 0.0, 1.0)), roughness);
  out_normal = vec4(normal, 1.0 + floor(clamp(metalness, 0.0, 1.0) * 15.0 + 0.5) + 0.9 * clamp(sheen, 0.0, 1.0));
}

// As write_material, for a material in which light spreads.
void write_translucent(vec3 albedo, vec3 normal, float roughness, float translucency) {
  out_albedo = vec4(sqrt(clamp(albedo, 0.0, 1.0)), roughness);
  out_normal = vec4(normal, 17.0 + clamp(translucency, 0.0, 1.0));
}

// The floor. lighting.frag.glsl reconstructs its point without the depth buffer, whose range ends earlier.
void write_ground(vec3 albedo) {
  out_albedo = vec4(sqrt(clamp(albedo, 0.0, 1.0)), 0.9);
  out_normal = vec4(0.0, 1.0, 0.0, -1.0);
}
