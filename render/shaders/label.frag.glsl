in vec2 sheet_uv;
flat in vec4 text_color;

uniform sampler2D glyph_map;

layout(location = 0) out vec4 out_color;  // sRGB-encoded, like the picture below

void main() {
  out_color = vec4(text_color.rgb, text_color.a * texture(glyph_map, sheet_uv).r);
}
