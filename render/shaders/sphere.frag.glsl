#include "frame.glsl"
#include "ball.glsl"

flat in vec3 ball_color;
flat in uint ball_index;

#ifdef TARGET_PICK
layout(location = 0) out uvec2 picked;
uniform uint pick;
#endif
#ifdef TARGET_MATERIAL
#include "material.glsl"
uniform vec4 look;  // roughness, metalness, sheen
#endif

void main() {
  Chord chord = chord_of_ball();
  if (chord.half_squared < 0.0) discard;
  float half_chord = sqrt(chord.half_squared);

  float side = -1.0;
  vec2 clip = clip_depth((chord.foot - half_chord) * chord.direction.z);
  if (clip.x < -clip.y) {  // cut by the near plane: its inside is visible
    side = 1.0;
    clip = clip_depth((chord.foot + half_chord) * chord.direction.z);
    if (clip.x < -clip.y) discard;
  }
  gl_FragDepth = 0.5 * clip.x / clip.y + 0.5;

#ifdef TARGET_PICK
  picked = uvec2(pick, ball_index);
#endif
#ifdef TARGET_MATERIAL
  vec3 normal = -side * (chord.off + side * half_chord * chord.direction) / ball_radius;
  write_material(ball_color, mat3(frame.inverse_view) * normal, look.x, look.y, look.z);
#endif
}
