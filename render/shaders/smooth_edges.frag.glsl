// Antialiasing of a picture with one sample per pixel: FXAA (Lottes 2009, "FXAA"), its edge search. Where luma jumps,
// it follows the edge to both ends. The distance to the nearer end determines how much color from beyond the edge the
// pixel gets.
in vec2 uv;
layout(location = 0) out vec4 out_color;
uniform sampler2D color_map;  // encoded; alpha is luma; interpolated

const float min_contrast = 0.045;
const int steps = 7;

float luma(vec2 at) { return textureLod(color_map, at, 0.0).a; }

float luma_of(ivec2 at) { return texelFetch(color_map, at, 0).a; }

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  ivec2 size = textureSize(color_map, 0);
  vec4 here = texelFetch(color_map, at, 0);
  float up = luma_of(at + ivec2(0, 1)), down = luma_of(at + ivec2(0, -1)), right = luma_of(at + ivec2(1, 0)), left = luma_of(at + ivec2(-1, 0));
  float highest = max(here.a, max(max(up, down), max(left, right)));
  float lowest = min(here.a, min(min(up, down), min(left, right)));
  float contrast = highest - lowest;
  // Pixels at the picture's rim have neighbors on three sides only.
  bool at_rim = any(lessThan(at, ivec2(1))) || any(greaterThanEqual(at, size - 1));
  bool edge = !at_rim && contrast >= max(min_contrast, 0.12 * highest);
  // Software renderers compute both sides of branches; only loops can skip work: no iteration without an
  // edge.
  int turns = edge ? steps : 0;

  vec2 pixel = 1.0 / vec2(size);
  float up_right = luma_of(at + ivec2(1, 1)), down_left = luma_of(at + ivec2(-1, -1));
  float up_left = luma_of(at + ivec2(-1, 1)), down_right = luma_of(at + ivec2(1, -1));
  float across_rows = abs(up_left + down_left - 2.0 * left) + 2.0 * abs(up + down - 2.0 * here.a) +
                      abs(up_right + down_right - 2.0 * right);
  float across_columns = abs(up_left + up_right - 2.0 * up) + 2.0 * abs(left + right - 2.0 * here.a) +
                         abs(down_left + down_right - 2.0 * down);
  bool horizontal = across_rows >= across_columns;

  // The edge lies between this pixel and the neighbor that differs most.
  float before = horizontal ? down : left, after = horizontal ? up : right;
  bool to_before = abs(before - here.a) >= abs(after - here.a);
  vec2 normal = (horizontal ? vec2(0.0, pixel.y) : vec2(pixel.x, 0.0)) * (to_before ? -1.0 : 1.0);
  float mean = 0.5 * (here.a + (to_before ? before : after));
  float enough = 0.25 * max(abs(before - here.a), abs(after - here.a));

  vec2 along = horizontal ? vec2(pixel.x, 0.0) : vec2(0.0, pixel.y);
  vec2 middle = uv + 0.5 * normal;
  float reach_a = 0.0, reach_b = 0.0, end_a = 0.0, end_b = 0.0;
  bool done_a = false, done_b = false;
  float stride = 1.0;
  for (int i = 0; i < turns && !(done_a && done_b); ++i) {
    if (!done_a) {
      reach_a += stride;
      end_a = luma(middle - along * reach_a) - mean;
      done_a = abs(end_a) >= enough;
    }
    if (!done_b) {
      reach_b += stride;
      end_b = luma(middle + along * reach_b) - mean;
      done_b = abs(end_b) >= enough;
    }
    stride = i < 3 ? 1.0 : 2.0;
  }
  float nearer = min(reach_a, reach_b);
  float end = reach_a < reach_b ? end_a : end_b;
  // If the color at the nearer end matches this side, the edge does not cross this pixel.
  bool moved = (end < 0.0) != (here.a - mean < 0.0);
  float shift = moved ? 0.5 - nearer / max(reach_a + reach_b, 1.0) : 0.0;

  // Spots smaller than an edge.
  float around = (2.0 * (up + down + left + right) + up_left + up_right + down_left + down_right) / 12.0;
  float spot = smoothstep(0.0, 1.0, clamp(abs(around - here.a) / max(contrast, 1e-3), 0.0, 1.0));
  shift = edge ? max(shift, 0.6 * spot * spot) : 0.0;
  out_color = vec4(textureLod(color_map, uv + normal * shift, 0.0).rgb, 1.0);
}
