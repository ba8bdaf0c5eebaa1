#include "render/tube.h"

#include "souple/math/scalar.h"

#include <algorithm>
#include <array>
#include <cmath>

// Rows of vertices from one end to the other: a pole, cap_rings - 1 rings of the first cap, a ring for each sample of
// the curve. The second cap follows in reverse.

namespace souple::render {
namespace {

constexpr std::size_t max_rings = 2000;     ///< long ropes have enough points to look smooth
constexpr float fields_per_radius = 0.18f;  ///< pitch of the strands

/// Catmull and Rom 1974, uniform: passes p1 at t = 0 and p2 at t = 1.
Vec3f catmull_rom(const std::array<Vec3f, 4>& p, float t) {
  const Vec3f a = p[1] * 2.0f, b = p[2] - p[0], c = p[0] * 2.0f - p[1] * 5.0f + p[2] * 4.0f - p[3];
  const Vec3f d = p[1] * 3.0f - p[0] - p[2] * 3.0f + p[3];
  return (a + (b + (c + d * t) * t) * t) * 0.5f;
}

/// Unit vector perpendicular to `along`: `fixed`, rotated by the shortest rotation from `pole` to `along`. It depends
/// smoothly on `along`, except at one direction that ropes seldom have.
Vec3f perpendicular(const Vec3f& along) {
  const Vec3f pole{0.48f, 0.6f, 0.64f}, fixed{0.8f, 0, -0.6f};
  const float c = 1 + dot(pole, along);
  if (c < 1e-4f) return fixed;
  const Vec3f sum = pole + along;
  return fixed - sum * (dot(fixed, sum) / c);  // Rodrigues, with fixed . pole = 0
}

/// Extrapolates a curve through c, b, a, evenly spaced, with constant curvature.
Vec3f beyond(const Vec3f& a, const Vec3f& b, const Vec3f& c) {
  return (a - b) * 3.0f + c;
}

Vec3f reflected(const Vec3f& v, const Vec3f& mirror) {
  const float square = length_squared(mirror);
  return square > 0 ? v - mirror * (2 * dot(mirror, v) / square) : v;
}

}  // namespace

void Tube::resize(std::size_t points, float radius, float length) {
  points_ = std::max<std::size_t>(points, 1);
  steps_ = static_cast<std::uint32_t>(std::clamp<std::size_t>(max_rings / points_, 1, 4));
  frames_.assign((points_ - 1) * steps_ + 1, {});
  const std::size_t rings = ring_count();
  positions_.assign(rings * row + 2, {});
  normals_.assign(positions_.size(), {});

  const float fields = std::max(2.0f, std::round(fields_per_radius * length / radius));
  texture_.resize(positions_.size());
  for (std::size_t v = 0; v < texture_.size(); ++v) {
    const float along = points_ > 1 ? parameter(v) / static_cast<float>(points_ - 1) : 0;
    const bool pole = v < 1 || v + 1 == texture_.size();
    const auto side = static_cast<float>(pole ? 0 : (v - 1) % row);
    texture_[v] = {along * fields + 2 * side / static_cast<float>(sides), 0.25f, 0.25f};
  }

  triangles_.clear();
  const auto at = [](std::size_t ring, std::uint32_t side) {
    return static_cast<std::uint32_t>(1 + ring * row + side);
  };
  const auto last = static_cast<std::uint32_t>(positions_.size() - 1);
  for (std::uint32_t s = 0; s < sides; ++s) {
    triangles_.push_back({0, at(0, s + 1), at(0, s)});
    for (std::size_t r = 0; r + 1 < rings; ++r) {
      triangles_.push_back({at(r, s), at(r, s + 1), at(r + 1, s + 1)});
      triangles_.push_back({at(r, s), at(r + 1, s + 1), at(r + 1, s)});
    }
    triangles_.push_back({last, at(rings - 1, s), at(rings - 1, s + 1)});
  }
}

float Tube::parameter(std::size_t vertex) const {
  if (vertex == 0) return 0;
  const std::size_t ring = std::min((vertex - 1) / row, ring_count() - 1);
  const std::size_t sample =
      std::clamp<std::size_t>(ring, cap_rings - 1, cap_rings - 2 + frames_.size()) - (cap_rings - 1);
  return static_cast<float>(sample) / static_cast<float>(steps_);
}

std::uint32_t Tube::point_of(std::size_t vertex) const {
  return static_cast<std::uint32_t>(std::lround(parameter(vertex)));
}

void Tube::sample_curve(std::span<const Vec3f> points) {
  const std::size_t n = points.size();
  frames_.back().center = points[n - 1];
  for (std::size_t i = 0; i + 1 < n; ++i) {
    const Vec3f before =
        i > 0 ? points[i - 1] : beyond(points[i], points[i + 1], points[std::min(i + 2, n - 1)]);
    const Vec3f after =
        i + 2 < n ? points[i + 2] : beyond(points[i + 1], points[i], points[i > 0 ? i - 1 : 0]);
    for (std::uint32_t k = 0; k < steps_; ++k)
      frames_[i * steps_ + k].center = catmull_rom({before, points[i], points[i + 1], after},
                                                   static_cast<float>(k) / static_cast<float>(steps_));
  }
}

// Where neighbors coincide, the tangent is undefined: it is copied from the previous sample, or at the start
// from the first defined one.
void Tube::set_tangents() {
  const std::size_t n = frames_.size();
  Vec3f along{};
  for (std::size_t j = 0; j < n; ++j) {
    const auto at = [&](std::size_t k) { return frames_[std::min(k, n - 1)].center; };
    const Vec3f before = j > 0 ? at(j - 1) : beyond(at(0), at(1), at(2));
    const Vec3f after = j + 1 < n ? at(j + 1) : beyond(at(j), at(n > 1 ? n - 2 : 0), at(n > 2 ? n - 3 : 0));
    const Vec3f direction = normalized(after - before);
    const bool first = along == Vec3f{};
    if (length_squared(direction) > 0.5f) along = direction;
    frames_[j].along = along;
    if (first && !(along == Vec3f{}))
      for (std::size_t k = 0; k < j; ++k) frames_[k].along = along;
  }
  if (along == Vec3f{})
    for (Frame& frame : frames_) frame.along = {0, 1, 0};
}

// Rotation-minimizing frames by double reflection (Wang, Jüttler, Zheng and Liu 2008).
void Tube::propagate_frames() {
  frames_[0].across = perpendicular(frames_[0].along);
  for (std::size_t j = 0; j < frames_.size(); ++j) {
    Frame& frame = frames_[j];
    if (j > 0) {
      const Frame& before = frames_[j - 1];
      const Vec3f mirror = frame.center - before.center;
      const Vec3f along = reflected(before.along, mirror);
      frame.across = reflected(reflected(before.across, mirror), frame.along - along);
    }
    const Vec3f across = normalized(frame.across - frame.along * dot(frame.along, frame.across));
    frame.across = length_squared(across) > 0.5f ? across : perpendicular(frame.along);
    frame.up = cross(frame.along, frame.across);
  }
}

/// `angle` above the plane of the frame, towards `along`: 0 on the tube, up to a right angle on its caps.
void Tube::set_ring(std::size_t ring, const Frame& frame, float angle, float radius) {
  const float out = std::cos(angle), forward = std::sin(angle);
  for (std::uint32_t s = 0; s < row; ++s) {
    const float turned = 2 * float(pi) * static_cast<float>(s % sides) / static_cast<float>(sides);
    const Vec3f around = frame.across * std::cos(turned) + frame.up * std::sin(turned);
    const Vec3f normal = around * out + frame.along * forward;
    normals_[1 + ring * row + s] = normal;
    positions_[1 + ring * row + s] = frame.center + normal * radius;
  }
}

void Tube::update(std::span<const Vec3f> points, float radius) {
  sample_curve(points);
  set_tangents();
  propagate_frames();
  for (std::size_t j = 0; j < frames_.size(); ++j) set_ring(cap_rings - 1 + j, frames_[j], 0, radius);
  for (std::size_t c = 1; c < cap_rings; ++c) {
    const float angle = 0.5f * float(pi) * static_cast<float>(c) / static_cast<float>(cap_rings);
    set_ring(cap_rings - 1 - c, frames_.front(), -angle, radius);
    set_ring(cap_rings - 2 + frames_.size() + c, frames_.back(), angle, radius);
  }
  normals_.front() = -frames_.front().along;
  positions_.front() = frames_.front().center + normals_.front() * radius;
  normals_.back() = frames_.back().along;
  positions_.back() = frames_.back().center + normals_.back() * radius;
}

}  // namespace souple::render
