#pragma once

#include "render/camera.h"
#include "souple/math/vec3.h"

#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <vector>

// Reference image of balls: ray casting on the CPU in double precision.

namespace souple::render {

struct Ball {
  Vec3d center;
  double radius = 0;
};

struct BallHit {
  int ball = -1;     ///< -1: none
  double depth = 0;  ///< along the view [m]
  Vec3d point{};     ///< m
};

/// The first ball on the ray through a point of the picture.
inline BallHit cast(std::span<const Ball> balls, const Camera& camera, double x, double y, int width,
                    int height) {
  const Vec3d forward = normalized(Vec3d(camera.to) - Vec3d(camera.from));
  const Vec3d right = normalized(cross(forward, Vec3d{0, 1, 0}));
  const Vec3d up = cross(right, forward);
  const double slope = 2 * std::tan(double(camera.fov) * pi / 360) / height;
  const Vec3d direction =
      normalized(forward + right * ((x - 0.5 * width) * slope) + up * ((0.5 * height - y) * slope));
  BallHit best;
  double least = std::numeric_limits<double>::max();
  for (std::size_t i = 0; i < balls.size(); ++i) {
    const Vec3d to_center = balls[i].center - Vec3d(camera.from);
    const double foot = dot(to_center, direction);
    const double off = length_squared(to_center - direction * foot);
    const double square = balls[i].radius * balls[i].radius - off;
    if (square < 0) continue;
    const double t = foot - std::sqrt(square);
    if (t <= 0 || t >= least) continue;
    least = t;
    best = {int(i), t * dot(direction, forward), Vec3d(camera.from) + direction * t};
  }
  return best;
}

/// The ball that covers a pixel and everything within `reach` pixels of its center, or -1 for none; empty
/// where points differ.
inline std::optional<int> unambiguous_ball(std::span<const Ball> balls, const Camera& camera, int x, int y,
                                           int width, int height, double reach) {
  const int middle = cast(balls, camera, x + 0.5, y + 0.5, width, height).ball;
  for (int i = 0; i < 8; ++i) {
    const double angle = i * pi / 4;
    const double px = x + 0.5 + reach * std::cos(angle), py = y + 0.5 + reach * std::sin(angle);
    if (cast(balls, camera, px, py, width, height).ball != middle) return std::nullopt;
  }
  return middle;
}

}  // namespace souple::render
