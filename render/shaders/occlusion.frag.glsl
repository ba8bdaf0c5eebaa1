// Visible fraction of the sky at each pixel: Jimenez et al. 2016, "Practical real-time strategies for
// accurate indirect occlusion", section 4. Along a few directions on screen it finds the highest horizon on both sides.
// It integrates the part between them, weighted by the cosine, in closed form (eq. 7).
#include "frame.glsl"

in vec2 uv;
layout(location = 0) out vec2 out_occlusion;  // openness, 1 / depth

uniform sampler2D depth_map;  // half_depth
uniform sampler2D normal_map;

const int slices = 2;
const int steps = 3;
const float pi = 3.14159265;

vec3 view_point(vec2 at, float depth) {
  vec2 clip = 2.0 * at - 1.0;
  return vec3((clip + vec2(frame.projection[2][0], frame.projection[2][1])) * depth /
                  vec2(frame.projection[0][0], frame.projection[1][1]),
              -depth);
}

// The cosine of the horizon's angle to the eye, in direction `step_` on screen.
float horizon(vec3 point, vec3 normal, vec3 to_eye, vec2 step_, float first, float low) {
  vec2 size = vec2(textureSize(depth_map, 0));
  float highest = low;
  // Skip the pixel itself, which would add noise.
  vec2 beside = step_ * (1.4 / max(length(step_ * size), 1e-6));
  for (int i = 0; i < steps; ++i) {
    float t = (float(i) + first) / float(steps);
    vec2 at = uv + beside + step_ * (t * t);
    ivec2 pixel = ivec2(at * size);
    if (any(lessThan(pixel, ivec2(0))) || any(greaterThanEqual(pixel, ivec2(size)))) break;
    float depth = texelFetch(depth_map, pixel, 0).r;
    if (depth <= 0.0) continue;
    vec3 delta = view_point((vec2(pixel) + 0.5) / size, depth) - point;
    float distance2 = dot(delta, delta);
    float shorten = inversesqrt(max(distance2, 1e-20));
    float cosine = dot(delta, to_eye) * shorten;
    // Objects farther than the radius count less with distance. So do points hardly above the surface: pixel
    // centers lie beside the direction, so a floor at a grazing angle would occlude itself.
    float weight = clamp(2.0 - 2.0 * distance2 / (frame.occlusion.x * frame.occlusion.x), 0.0, 1.0) *
                   smoothstep(0.02, 0.15, dot(delta, normal) * shorten);
    highest = max(highest, mix(low, cosine, weight));
  }
  return highest;
}

float arc(float horizon_angle, float n) {
  return 0.25 * (-cos(2.0 * horizon_angle - n) + cos(n) + 2.0 * horizon_angle * sin(n));
}

// The target was cleared to (1, 0).
void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  float depth = texelFetch(depth_map, pixel, 0).r;
  if (depth <= 0.0) discard;
  vec3 point = view_point(uv, depth);
  vec3 to_eye = -normalize(point);
  vec3 normal = normalize(texelFetch(normal_map, pixel * 2, 0).xyz) * mat3(frame.inverse_view);
  // The radius on screen, as a fraction of its height.
  float radius = min(0.5 * frame.occlusion.x * frame.projection[1][1] / depth, 0.25);
  if (radius * frame.size.y < 1.5) discard;

  // 16 patterns in blocks of 4 x 4 pixels, averaged by occlusion_blur.frag.glsl.
  ivec2 cell = pixel & 3;
  int index = cell.x + 4 * cell.y;
  float turn = float((7 * index) & 15) / 16.0;
  float start = float((5 * index) & 15) / 16.0;
  turn = fract(turn + frame.sample_info.z);
  start = fract(start + 7.0 * frame.sample_info.z);
  float open = 0.0, unoccluded = 0.0;
  for (int i = 0; i < slices; ++i) {
    float angle = pi * (float(i) + turn) / float(slices);
    vec3 direction = vec3(cos(angle), sin(angle), 0.0);
    vec3 across = direction - to_eye * dot(direction, to_eye);
    vec3 axis = normalize(cross(direction, to_eye));
    vec3 projected = normal - axis * dot(normal, axis);
    float long_ = max(length(projected), 1e-4);
    float cosine = clamp(dot(projected, to_eye) / long_, -1.0, 1.0);
    float n = (dot(across, projected) < 0.0 ? -1.0 : 1.0) * acos(cosine);
    vec2 step_ = direction.xy * radius * vec2(frame.size.y * frame.size.z, 1.0);
    float right = horizon(point, normal, to_eye, step_, start, cos(n + 0.5 * pi));
    float left = horizon(point, normal, to_eye, -step_, start, cos(n - 0.5 * pi));
    float h0 = n + max(-acos(clamp(left, -1.0, 1.0)) - n, -0.5 * pi);
    float h1 = n + min(acos(clamp(right, -1.0, 1.0)) - n, 0.5 * pi);
    open += long_ * (arc(h0, n) + arc(h1, n));
    unoccluded += long_ * (cosine + n * sin(n));
  }
  // `unoccluded` is the value of the same slices for an open sky: 1 only in the mean over all directions.
  out_occlusion = vec2(clamp(open / max(unoccluded, 1e-4), 0.0, 1.0), 1.0 / depth);
}
