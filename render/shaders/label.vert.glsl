// A corner of a glyph, or of the box behind a text.
layout(location = 0) in vec4 rectangle;  // left, top, right, bottom: pixels from the top left corner
layout(location = 1) in vec4 source;  // left, top, right, bottom in the glyph sheet, in [0, 1]
layout(location = 2) in vec4 color;

uniform vec2 pixels;  // size of the picture

out vec2 sheet_uv;
flat out vec4 text_color;

void main() {
  vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1);
  vec2 position = mix(rectangle.xy, rectangle.zw, corner) / pixels;
  sheet_uv = mix(source.xy, source.zw, corner);
  text_color = color;
  gl_Position = vec4(2.0 * position.x - 1.0, 1.0 - 2.0 * position.y, 0.0, 1.0);
}
