// Reads what occlusion_blur.frag.glsl left, at half the resolution, from those of the four nearest pixels that
// lie about as far away. `depth` along the view.
uniform sampler2D occlusion_map;

float sky_visibility(vec2 pixel, float depth) {
  if (frame.sample_info.w < 0.5) return 1.0;
  ivec2 last = textureSize(occlusion_map, 0) - 1;
  // Pixel 2 k of the picture stands for pixel k of the map.
  vec2 at = 0.5 * (pixel - 0.5);
  ivec2 corner = ivec2(floor(at));
  vec2 f = at - vec2(corner);
  float tolerance = 0.1 * frame.occlusion.x + 0.002 * depth;
  vec2 sum = vec2(0.0);
  for (int i = 0; i < 4; ++i) {
    ivec2 step_ = ivec2(i & 1, i >> 1);
    vec2 found = texelFetch(occlusion_map, clamp(corner + step_, ivec2(0), last), 0).xy;
    vec2 near = mix(1.0 - f, f, vec2(step_));
    float weight = (near.x * near.y + 0.001) * max(1.0 - abs(found.y - depth) / tolerance, 0.001);
    sum += vec2(found.x, 1.0) * weight;
  }
  return sum.x / sum.y;
}
