// A picture as it is, opaque.
layout(location = 0) out vec4 out_colour;
uniform sampler2D colour_map;

void main() { out_colour = vec4(texelFetch(colour_map, ivec2(gl_FragCoord.xy), 0).rgb, 1.0); }
