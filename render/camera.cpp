#include "render/camera.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace souple::render {

namespace {

float half_fov(float fov) {
  return std::clamp(fov, 1.0f, 170.0f) * float(pi / 360);
}

std::array<Vec3f, 8> corners(const Bounds& box) {
  std::array<Vec3f, 8> result;
  for (std::size_t i = 0; i < 8; ++i) {
    result[i] = {(i & 1) != 0 ? box.hi.x : box.lo.x, (i & 2) != 0 ? box.hi.y : box.lo.y,
                 (i & 4) != 0 ? box.hi.z : box.lo.z};
  }
  return result;
}

struct Range {
  float lo = std::numeric_limits<float>::max(), hi = std::numeric_limits<float>::lowest();
  void add(float value) {
    lo = std::min(lo, value);
    hi = std::max(hi, value);
  }
};

/// Position of an eye that sees points at x (across) and f (along the view) within the slope s on both sides:
/// |x_i - center| <= s (distance + f_i) for all i, with the smallest such distance.
struct Fit {
  float distance = 0, center = 0;
};

Fit fit(std::span<const Vec3f> points, const Vec3f& middle, const Vec3f& across, const Vec3f& along,
        float s) {
  Range left, right;  // ranges of x - s f and of x + s f
  for (const Vec3f& point : points) {
    const float x = dot(point - middle, across), f = dot(point - middle, along);
    left.add(x - s * f);
    right.add(x + s * f);
  }
  return {(left.hi - right.lo) / (2 * s), (left.hi + right.lo) / 2};
}

float length_along(std::span<const Vec3f> points, const Vec3f& direction) {
  Range range;
  for (const Vec3f& point : points) range.add(dot(point, direction));
  return range.hi - range.lo;
}

/// The camera, and the camera turned about its target in steps of 15 degrees, by small turns first. It turns around the
/// vertical, and upwards by up to 30 degrees.
std::vector<Camera> turned(const Camera& camera) {
  constexpr float step = float(pi / 12);
  std::vector<Camera> result;
  for (int sum = 0; sum <= 12; ++sum) {
    for (int up = 0; up <= std::min(sum, 2); ++up) {
      const int around = sum - up;
      for (const int turn : {around, -around}) {
        result.push_back(camera);
        if (sum > 0) result.back().orbit(step * float(turn), step * float(up));
      }
    }
  }
  return result;
}

}  // namespace

void Bounds::add(const Vec3f& point, float radius) {
  lo = {std::min(lo.x, point.x - radius), std::min(lo.y, point.y - radius), std::min(lo.z, point.z - radius)};
  hi = {std::max(hi.x, point.x + radius), std::max(hi.y, point.y + radius), std::max(hi.z, point.z + radius)};
}

void Bounds::add(const Bounds& other) {
  if (other.empty()) return;
  add(other.lo);
  add(other.hi);
}

Vec3f Camera::forward() const {
  const Vec3f direction = normalized(to - from);
  return direction == Vec3f{} ? Vec3f{0, 0, -1} : direction;
}

Vec3f Camera::right() const {
  const Vec3f side = cross(forward(), Vec3f{0, 1, 0});
  // Looking straight up or down, any right vector is valid.
  return length_squared(side) < 1e-12f ? Vec3f{1, 0, 0} : normalized(side);
}

Vec3f Camera::up() const {
  return cross(right(), forward());
}

Mat4 Camera::view() const {
  return look_at(from, from + forward(), up());
}

Mat4 Camera::projection(float aspect, const Bounds& scene) const {
  const float reach = std::max(distance(), 1e-3f);
  Range depth;
  if (scene.empty()) {
    depth.add(0.1f * reach);
    depth.add(10 * reach);
  } else {
    for (const Vec3f& corner : corners(scene)) depth.add(dot(corner - from, forward()));
  }
  // The error of a depth buffer depends on far / near mainly through near. With near = far / 2000, depths at
  // the far end are resolved to 0.1 %, and an eye inside the scene sees objects close to it.
  const float far = 1.1f * std::max(depth.hi, reach);
  const float nearest = std::min(far / 2000, 0.1f * reach);
  const float near = std::clamp(0.9f * depth.lo, nearest, far / 2);
  return perspective(2 * half_fov(fov), aspect, near, far);
}

Ray Camera::ray(float x, float y, int width, int height) const {
  const float slope = 2 * std::tan(half_fov(fov)) / float(height);  // per pixel
  const float across = (x - float(width) / 2) * slope, above = (float(height) / 2 - y) * slope;
  return {from, normalized(forward() + right() * across + up() * above)};
}

std::optional<ScreenPoint> Camera::project(const Vec3f& point, int width, int height) const {
  const Vec3f offset = point - from;
  const float depth = dot(offset, forward());
  if (!(depth > 0)) return std::nullopt;
  const float pixel = pixel_size(depth, height);
  return ScreenPoint{float(width) / 2 + dot(offset, right()) / pixel,
                     float(height) / 2 - dot(offset, up()) / pixel, depth};
}

float Camera::pixel_size(float depth, int height) const {
  return 2 * std::tan(half_fov(fov)) * depth / float(height);
}

void Camera::orbit(float yaw, float pitch) {
  const Vec3d offset = Vec3d(from) - Vec3d(to);
  const double radius = length(offset);
  if (radius == 0) return;
  const double pole = 1.55;
  const double azimuth = std::atan2(offset.x, offset.z) + double(yaw);
  const double height = std::clamp(offset.y / radius, -1.0, 1.0);
  const double elevation = std::clamp(std::asin(height) + double(pitch), -pole, pole);
  const Vec3d direction{std::cos(elevation) * std::sin(azimuth), std::sin(elevation),
                        std::cos(elevation) * std::cos(azimuth)};
  from = Vec3f(Vec3d(to) + direction * radius);
}

void Camera::pan(float dx, float dy, int height) {
  const Vec3f shift = (up() * dy - right() * dx) * pixel_size(distance(), height);
  from += shift;
  to += shift;
}

void Camera::zoom(float factor) {
  from = to - forward() * std::clamp(distance() * factor, 1e-3f, 1e5f);
}

Fraction Camera::filled(std::span<const Vec3f> points, float aspect) const {
  Range across, above;
  for (const Vec3f& point : points) {
    const Vec3f offset = point - from;
    const float depth = dot(offset, forward());
    if (!(depth > 0)) continue;
    across.add(dot(offset, right()) / depth);
    above.add(dot(offset, up()) / depth);
  }
  if (across.lo > across.hi) return {};
  const float whole = 2 * std::tan(half_fov(fov));
  return {(across.hi - across.lo) / (whole * aspect), (above.hi - above.lo) / whole};
}

void Camera::frame(const Bounds& box, float aspect) {
  if (!box.empty()) frame(corners(box), aspect);
}

void Camera::frame(std::span<const Vec3f> points, float aspect) {
  if (points.empty()) return;
  const float margin_free = 0.88f;  // fraction of the picture that is filled; the rest is margin
  const float s = margin_free * std::tan(half_fov(fov));
  Bounds box;
  for (const Vec3f& point : points) box.add(point);
  const Vec3f along = forward(), middle = box.center();
  const Fit horizontal = fit(points, middle, right(), along, s * aspect);
  const Fit vertical = fit(points, middle, up(), along, s);
  const float away = std::clamp(std::max(horizontal.distance, vertical.distance), 1e-2f, 1e5f);
  to = middle + right() * horizontal.center + up() * vertical.center;
  from = to - along * away;
}

void Camera::turn_to_fill(std::span<const Vec3f> points, float aspect) {
  constexpr float least = 0.35f, shortest = 0.75f, steepest = 0.77f;
  const std::vector<Camera> cameras = turned(*this);
  std::vector<float> lengths;  // of the points across the view [m]
  lengths.reserve(cameras.size());
  for (const Camera& camera : cameras) lengths.push_back(length_along(points, camera.right()));
  const float longest = *std::max_element(lengths.begin(), lengths.end());
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    const bool from_its_end = lengths[i] < shortest * longest,
               from_above = cameras[i].forward().y < -steepest;
    if (i > 0 && (from_its_end || from_above)) continue;
    Camera framed = cameras[i];
    framed.frame(points, aspect);
    const Fraction fraction = framed.filled(points, aspect);
    if (std::min(fraction.width, fraction.height) < least) continue;
    *this = cameras[i];
    return;
  }
}

}  // namespace souple::render
