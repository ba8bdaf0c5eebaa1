// Adds one sample to the others, by blending.
layout(location = 0) out vec4 out_colour;
uniform sampler2D colour_map;

void main() { out_colour = texelFetch(colour_map, ivec2(gl_FragCoord.xy), 0); }
