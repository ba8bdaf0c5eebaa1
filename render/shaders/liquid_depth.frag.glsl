// The nearest ball of any liquid at each pixel: its depth along the view, and the optical properties of its
// surface.
#include "frame.glsl"
#include "ball.glsl"
#include "liquid.glsl"

layout(location = 0) out float out_depth;
layout(location = 1) out vec4 out_look;  // refractive index, roughness, radius of the balls [m]

uniform vec4 look;

void main() {
  Chord chord = chord_of_ball();
  if (chord.half_squared < 0.0) discard;
  float z = (chord.foot - sqrt(chord.half_squared)) * chord.direction.z;
  vec2 clip = clip_depth(z);
  if (clip.x < -clip.y) discard;  // the eye is inside the ball
  gl_FragDepth = 0.5 * clip.x / clip.y + 0.5;
  out_depth = frame.projection[3][3] == 1.0 ? sun_offset() - z : -z;
  out_look = look;
}
