#include "frame.glsl"

flat in vec3 ball_centre;
flat in float ball_radius;
flat in vec3 ball_colour;
flat in uint ball_index;
in vec2 plane_place;

#ifdef TARGET_PICK
layout(location = 0) out uvec2 picked;
uniform uint pick;
#endif
#ifdef TARGET_MATERIAL
#include "material.glsl"
uniform vec4 look;  // roughness, metalness, sheen
#endif

// z and w in clip space of what lies at z in view space.
vec2 clip_depth(float z) {
  return vec2(frame.projection[2][2] * z + frame.projection[3][2], frame.projection[2][3] * z + frame.projection[3][3]);
}

void main() {
  bool parallel = frame.projection[3][3] == 1.0;
  vec3 origin = parallel ? vec3(plane_place, 0.0) : vec3(0.0);
  vec3 direction = parallel ? vec3(0.0, 0.0, -1.0) : normalize(vec3(plane_place, -1.0));
  // From the foot of the perpendicular the two hits lie at equal distances. The usual b * b - c would lose its digits
  // to balls that are small and far.
  vec3 to_centre = ball_centre - origin;
  float foot = dot(to_centre, direction);
  vec3 off = foot * direction - to_centre;
  float half_chord = ball_radius * ball_radius - dot(off, off);
  if (half_chord < 0.0) discard;
  half_chord = sqrt(half_chord);

  float side = -1.0;
  vec2 clip = clip_depth((foot - half_chord) * direction.z);
  if (clip.x < -clip.y) {  // cut open by the near plane: its inside is seen
    side = 1.0;
    clip = clip_depth((foot + half_chord) * direction.z);
    if (clip.x < -clip.y) discard;
  }
  gl_FragDepth = 0.5 * clip.x / clip.y + 0.5;

#ifdef TARGET_PICK
  picked = uvec2(pick, ball_index);
#endif
#ifdef TARGET_MATERIAL
  vec3 normal = -side * (off + side * half_chord * direction) / ball_radius;
  write_material(ball_colour, mat3(frame.inverse_view) * normal, look.x, look.y, look.z);
#endif
}
