// Adds one sample to the sum: by blending, or to the value read from the sum's texture.
layout(location = 0) out vec4 out_color;
uniform sampler2D color_map;
#ifdef ADD_TO_SUM
uniform sampler2D sum_map;
#endif

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  out_color = texelFetch(color_map, pixel, 0);
#ifdef ADD_TO_SUM
  out_color += texelFetch(sum_map, pixel, 0);
#endif
}
