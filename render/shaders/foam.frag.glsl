// Sums the occlusion by foam: -log of the transmitted light. Fades below the surface of the liquid.
#include "frame.glsl"
#include "ball.glsl"
#include "liquid.glsl"

layout(location = 0) out vec4 out_optics;
layout(location = 1) out vec4 out_glow;

uniform float strength;  // -log(1 - opacity)
uniform sampler2D depth_map;
uniform sampler2D liquid_depth_map;

void main() {
  Chord chord = chord_of_ball();
  if (chord.half_squared <= 0.0) discard;
  float depth = -chord.foot * chord.direction.z;
  ivec2 pixel = ivec2(gl_FragCoord.xy) * 2;
  if (depth > opaque_depth(texelFetch(depth_map, pixel, 0).r) + ball_radius) discard;
  float surface = texelFetch(liquid_depth_map, pixel, 0).r;
  float below = surface > 0.0 ? max(depth - surface - ball_radius, 0.0) / (8.0 * ball_radius) : 0.0;
  float middle = chord.half_squared / (ball_radius * ball_radius);
  out_optics = vec4(0.0);
  out_glow = vec4(0.0, 0.0, 0.0, strength * middle / (1.0 + below * below));
}
