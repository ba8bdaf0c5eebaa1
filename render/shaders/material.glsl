// Output of shaders of target material: the surface at a pixel. lighting.frag.glsl reads it back.
layout(location = 0) out vec4 out_albedo;
layout(location = 1) out vec4 out_normal;

// `normal`: unit vector in the world toward the eye. Albedo is stored as its root because 8 bits are few.
void write_material(vec3 albedo, vec3 normal, float roughness, float metalness, float sheen) {
  out_albedo = vec4(sqrt(clamp(albedo, 0.0, 1.0)), roughness);
  out_normal = vec4(normal, 1.0 + floor(clamp(metalness, 0.0, 1.0) * 15.0 + 0.5) + 0.9 * clamp(sheen, 0.0, 1.0));
}

// The floor. lighting.frag.glsl recomputes its point without the depth buffer, which ends earlier.
void write_ground(vec3 albedo) {
  out_albedo = vec4(sqrt(clamp(albedo, 0.0, 1.0)), 0.9);
  out_normal = vec4(0.0, 1.0, 0.0, -1.0);
}
