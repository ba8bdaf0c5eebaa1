// Glass: reflections of the sky and the sun over the picture behind it, which absorption and reflection dim.
// Blended as color + alpha * picture.
layout(location = 0) out vec4 out_color;
uniform vec4 color_first;  // tint
uniform vec4 look;          // roughness
uniform float has_normals;
uniform float has_liquids;
uniform sampler2D liquid_depth_map;

void main() {
  vec3 to_eye = normalize(frame.eye.xyz - world_point);
  vec3 flat_normal = cross(dFdx(world_point), dFdy(world_point));
  vec3 normal = has_normals > 0.5 ? world_normal : flat_normal;
  normal = dot(normal, normal) > 0.0 ? normalize(normal) : to_eye;
  if (dot(normal, to_eye) < 0.0) normal = -normal;
  // What lies behind the surface of a liquid is part of the picture that the liquid refracts.
  float depth = -(frame.view * vec4(world_point, 1.0)).z;
  float liquid = texelFetch(liquid_depth_map, ivec2(gl_FragCoord.xy), 0).r;
  if (has_liquids > 0.5 && liquid > 0.0 && depth > liquid) discard;

  // Schlick's approximation, for refractive index 1.5.
  float cosine = clamp(dot(normal, to_eye), 0.0, 1.0), away = 1.0 - cosine, away2 = away * away;
  float mirrors = 0.04 + 0.96 * away2 * away2 * away;
  Material clear = Material(vec3(0.0), look.x, 0.0, 0.0, 0.0);
  vec3 spark = lit(clear, normal, to_eye, vec3(1.0), 0.0);  // without diffuse reflection
  // Both sides of a wall reflect, and inside it light travels to the rim.
  vec3 rim = frame.horizon.rgb * (0.35 * away2 * away);
  vec3 reflected = min(sky_light(reflect(-to_eye, normal)) * (1.8 * mirrors) + rim + spark, vec3(8.0));
  // The way through a thin wall is longer at the rim.
  vec3 left = pow(color_first.rgb, vec3(min(0.5 / max(cosine, 0.12), 4.0)));
  float gray = dot(left, vec3(0.2126, 0.7152, 0.0722));
  vec3 tint = 0.08 * max(left - gray, vec3(0.0));
  out_color = vec4(tone_mapped(reflected) + tint, (1.0 - mirrors) * gray);
}
