// Sums, along the ray through each pixel, the amount of each liquid, and the optical depth of the part in
// front of opaque objects. A particle is a cloud of density k (1 - q^2) at q radii from its center, which has
// no visible edge. Its integral along a chord is k half (1 - s^2) 4/3 at s radii from the center, of which (2
// + 3 u - u^3) / 4 lies before the part u of the half chord.
#include "frame.glsl"
#include "ball.glsl"

layout(location = 0) out vec4 out_optics;
#ifdef SUNLIGHT
// From the sun: optical depth of red, green, blue, summed. Depth in the sun's map; its minimum is kept.
#else
#include "liquid.glsl"
layout(location = 1) out vec4 out_glow;
uniform sampler2D depth_map;
uniform vec3 scattering;  // 1/m
uniform int scale;  // each pixel here covers this number of pixels of the picture along each edge
#endif
uniform vec3 extinction;  // 1/m
uniform float density;    // k

float part_before(float t, Chord chord, float half_chord) {
  float u = clamp((t - chord.foot) / half_chord, -1.0, 1.0);
  return (2.0 + 3.0 * u - u * u * u) * 0.25;
}

void main() {
  Chord chord = chord_of_ball();
  if (chord.half_squared <= 0.0) discard;
  float half_chord = sqrt(chord.half_squared);
  float length_ = density * chord.half_squared / (ball_radius * ball_radius) * half_chord * (4.0 / 3.0);
#ifdef SUNLIGHT
  vec2 clip = clip_depth((chord.foot - half_chord) * chord.direction.z);
  out_optics = vec4(extinction * length_, 0.5 * clip.x / clip.y + 0.5);
#else
  float ends = opaque_depth(texelFetch(depth_map, ivec2(gl_FragCoord.xy) * scale, 0).r) / -chord.direction.z;
  float behind_eye = part_before(0.0, chord, half_chord);
  float seen = length_ * max(part_before(ends, chord, half_chord) - behind_eye, 0.0);
  out_optics = vec4(extinction * seen, length_ * (1.0 - behind_eye));
  out_glow = vec4(scattering * seen, 0.0);
#endif
}
