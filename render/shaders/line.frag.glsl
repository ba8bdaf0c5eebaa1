flat in vec2 start;
flat in vec2 end;
flat in vec4 line_color;
flat in float half_width;

layout(location = 0) out vec4 out_color;

void main() {
  // Distance to the segment: ends are round, so lines with a common end join.
  vec2 along = end - start, offset = gl_FragCoord.xy - start;
  float part = clamp(dot(offset, along) / max(dot(along, along), 1e-12), 0.0, 1.0);
  float off = length(offset - part * along);
  // Coverage of a pixel by a band of this width, as if the pixel were a strip along it.
  float coverage = clamp(half_width + 0.5 - off, 0.0, min(1.0, 2.0 * half_width));
  if (coverage <= 0.0) discard;
  out_color = vec4(line_color.rgb, line_color.a * coverage);
}
