#include "souple/scene/first_frame.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string_view>
#include <vector>

#include <fmt/core.h>

namespace souple {

namespace {

// Residuals relative to the size of the mesh. A character in another pose than at rest stays below `pose`.
constexpr double pose = 0.35;
// Two unrelated orders of vertices have a residual of sqrt(2).
constexpr double unrelated = 1.0;

/// Points about their mean.
struct Cloud {
  std::vector<Vec3d> points;
  double size = 0;  ///< root mean square distance from the mean
};

template <class Points>
Cloud centered(const Points& points) {
  Cloud cloud;
  Vec3d mean{};
  for (const auto& x : points) mean += Vec3d(x);
  mean = mean / static_cast<double>(points.size());
  double sum = 0;
  for (const auto& x : points) {
    cloud.points.push_back(Vec3d(x) - mean);
    sum += length_squared(cloud.points.back());
  }
  cloud.size = std::sqrt(sum / static_cast<double>(points.size()));
  return cloud;
}

/// A rotation by multiples of 90 degrees: component i of the result is sign[i] x[axis[i]].
struct AxisRotation {
  std::array<int, 3> axis{0, 1, 2};
  std::array<int, 3> sign{1, 1, 1};

  Vec3d operator()(const Vec3d& x) const {
    return {sign[0] * x[axis[0]], sign[1] * x[axis[1]], sign[2] * x[axis[2]]};
  }
  bool operator==(const AxisRotation&) const = default;
};

/// All 24, the identity first.
std::vector<AxisRotation> axis_rotations() {
  constexpr std::array<std::array<int, 3>, 6> orders{
      {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}}};
  std::vector<AxisRotation> all;
  for (std::size_t order = 0; order < orders.size(); ++order)
    for (int signs = 0; signs < 8; ++signs) {
      const AxisRotation r{orders[order], {signs & 4 ? -1 : 1, signs & 2 ? -1 : 1, signs & 1 ? -1 : 1}};
      const int parity = order < 3 ? 1 : -1;
      if (parity * r.sign[0] * r.sign[1] * r.sign[2] > 0) all.push_back(r);
    }
  return all;
}

AxisRotation rotation_to_y_up(UpAxis up) {
  if (up == UpAxis::z) return {{0, 2, 1}, {1, 1, -1}};
  if (up == UpAxis::x) return {{1, 0, 2}, {-1, 1, 1}};
  return {};
}

/// The mesh as `scale` times the rotated frame, both about their means.
struct Fit {
  AxisRotation rotation;
  double scale = 1;
  double residual = std::numeric_limits<double>::infinity();  ///< relative to the size of the mesh
};

/// The scale s that minimizes sum |a - s R b|^2: s = sum a . R b / sum |b|^2.
Fit best_scale(const Cloud& mesh, const Cloud& frame, const AxisRotation& rotation) {
  const auto count = static_cast<double>(mesh.points.size());
  double product = 0;
  for (std::size_t i = 0; i < mesh.points.size(); ++i)
    product += dot(mesh.points[i], rotation(frame.points[i]));
  const double correlation = product / (count * mesh.size * frame.size);
  return {rotation, correlation * mesh.size / frame.size,
          correlation > 0 ? std::sqrt(std::max(0.0, 1 - correlation * correlation)) : 1.0};
}

double residual_as_it_is(const Cloud& mesh, const Cloud& frame) {
  double sum = 0;
  for (std::size_t i = 0; i < mesh.points.size(); ++i)
    sum += length_squared(mesh.points[i] - frame.points[i]);
  return std::sqrt(sum / static_cast<double>(mesh.points.size())) / mesh.size;
}

/// The first of equally good rotations. The identity comes first, then those that `up` makes, then all others.
Fit best_fit(const Cloud& mesh, const Cloud& frame) {
  constexpr double margin = 0.98;
  std::vector<AxisRotation> rotations{{}, rotation_to_y_up(UpAxis::z), rotation_to_y_up(UpAxis::x)};
  for (const AxisRotation& rotation : axis_rotations()) rotations.push_back(rotation);
  Fit best;
  for (const AxisRotation& rotation : rotations) {
    const Fit fit = best_scale(mesh, frame, rotation);
    if (fit.residual < margin * best.residual - 1e-6) best = fit;
  }
  return best;
}

int degrees_of(const AxisRotation& r) {
  int trace = 0;
  for (int i = 0; i < 3; ++i)
    trace += r.axis[static_cast<std::size_t>(i)] == i ? r.sign[static_cast<std::size_t>(i)] : 0;
  return trace == 3 ? 0 : (trace == 1 ? 90 : (trace == 0 ? 120 : 180));  // 1 + 2 cos(angle)
}

/// The `up` with which the file is read as the mesh; nothing if no `up` does.
std::optional<UpAxis> up_for(UpAxis read_as, const AxisRotation& rotation) {
  const AxisRotation before = rotation_to_y_up(read_as);
  for (const UpAxis up : {UpAxis::x, UpAxis::y, UpAxis::z}) {
    const AxisRotation wanted = rotation_to_y_up(up);
    bool same = true;
    for (const Vec3d& e : {Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}})
      same = same && rotation(before(e)) == wanted(e);
    if (same) return up;
  }
  return std::nullopt;
}

std::string_view letter(UpAxis up) {
  return up == UpAxis::x ? "x" : (up == UpAxis::y ? "y" : "z");
}

std::string named(const Fit& fit, const MeshImport& import) {
  const bool rotated = !(fit.rotation == AxisRotation{});
  const bool scaled = std::abs(fit.scale - 1) > 0.05;
  const std::optional<UpAxis> up = up_for(import.up, fit.rotation);
  std::string what = "is the mesh", keys;
  if (rotated) what += fmt::format(" rotated by {} degrees", degrees_of(fit.rotation));
  if (scaled) what += fmt::format("{} {:.3g} times as large", rotated ? " and" : "", 1 / fit.scale);
  if (rotated && up) keys += fmt::format("\"up\": \"{}\"", letter(*up));
  if (scaled) keys += fmt::format("{}\"scale\": {:.3g}", keys.empty() ? "" : ", ", import.scale * fit.scale);
  if (rotated && !up) return what + "; export the animation with the axes of the mesh";
  return what + "; add " + keys + " to the sequence";
}

}  // namespace

std::string first_frame_remark(std::span<const Vec3d> mesh, std::span<const Vec3f> frame,
                               const MeshImport& import) {
  if (mesh.empty() || mesh.size() != frame.size()) return {};
  std::vector<Vec3d> as_read;
  for (const Vec3f& x : frame) as_read.push_back(imported(Vec3d(x), import));
  const Cloud a = centered(mesh), b = centered(as_read);
  if (!(a.size > 0) || !(b.size > 0)) return {};
  const double residual = residual_as_it_is(a, b);
  if (residual < pose) return {};
  const Fit fit = best_fit(a, b);
  const bool differs = !(fit.rotation == AxisRotation{}) || std::abs(fit.scale - 1) > 0.05;
  if (differs && fit.residual < pose && fit.residual < 0.5 * residual) return named(fit, import);
  if (residual < unrelated) return {};
  return fmt::format(
      "does not resemble the mesh: its vertices are {:.3g} m from those of the mesh, which is {:.3g} m "
      "large; "
      "do both have the same vertices in the same order?",
      residual * a.size, a.size);
}

}  // namespace souple
