in vec2 sheet_place;
flat in vec4 text_colour;

uniform sampler2D glyph_map;

layout(location = 0) out vec4 out_colour;  // sRGB-encoded, as is all that lies below

void main() {
  out_colour = vec4(text_colour.rgb, text_colour.a * texture(glyph_map, sheet_place).r);
}
