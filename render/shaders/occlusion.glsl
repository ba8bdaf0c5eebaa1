// Reads the result of the occlusion pass, at half the resolution: openness, and nearness = 1 / depth along
// the view, which changes linearly across a plane on screen.
uniform sampler2D occlusion_map;

// Change of nearness per pixel in the plane with this normal, at the end of this ray.
vec2 slope_of_nearness(vec3 normal, vec3 ray, float nearness) {
  float facing = dot(normal, ray);
  facing = min(facing, -0.02 * length(ray));
  return nearness / facing * vec2(dot(normal, dFdx(ray)), dot(normal, dFdy(ray)));
}

// 0 in the plane, up to 1 at a fraction of the occlusion's radius from it.
float off_plane(float found, float expected, float nearness, float part) {
  float distance = abs(found - expected) / max(nearness * nearness, 1e-12);
  return min(distance / (part * frame.occlusion.x + 0.002 / max(nearness, 1e-6)), 1.0);
}

// Visible fraction of the sky at this pixel of the picture. It is taken from the four nearest pixels of the map that
// lie in its plane.
float sky_visibility(vec2 pixel, vec3 normal, vec3 ray, float depth) {
  if (frame.sample_info.w < 0.5) return 1.0;
  ivec2 last = textureSize(occlusion_map, 0) - 1;
  // Pixel 2 k of the picture corresponds to pixel k of the map.
  vec2 at = 0.5 * (pixel - 0.5);
  ivec2 corner = ivec2(floor(at));
  vec2 f = at - vec2(corner);
  float nearness = 1.0 / max(depth, 1e-6);
  vec2 slope = slope_of_nearness(normal, ray, nearness);
  vec2 sum = vec2(0.0);
  for (int i = 0; i < 4; ++i) {
    vec2 step_ = vec2(float(i & 1), float(i >> 1));
    vec2 found = texelFetch(occlusion_map, clamp(corner + ivec2(step_), ivec2(0), last), 0).xy;
    vec2 near = mix(1.0 - f, f, step_);
    float expected = nearness + dot(slope, 2.0 * (step_ - f));
    float weight = (near.x * near.y + 0.001) * max(1.0 - off_plane(found.y, expected, nearness, 0.1), 0.001);
    sum += vec2(found.x, 1.0) * weight;
  }
  return sum.x / sum.y;
}
