// Adds one sample to the others: by blending, or to what is read from their sum.
layout(location = 0) out vec4 out_colour;
uniform sampler2D colour_map;
#ifdef ADD_TO_SUM
uniform sampler2D sum_map;
#endif

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  out_colour = texelFetch(colour_map, pixel, 0);
#ifdef ADD_TO_SUM
  out_colour += texelFetch(sum_map, pixel, 0);
#endif
}
