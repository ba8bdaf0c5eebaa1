#pragma once

#include "souple/math/vec3.h"
#include "souple/queries/selector.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

// Ties of a scene file. Part of scene.h.

namespace souple {

/// Ties each of these vertices of `from` to the closest point of `to`.
struct StitchDescription {
  Selector where{};
  double distance = 0.01;  ///< vertices farther away are not tied [m]
};
struct SlideDescription {
  std::vector<std::uint32_t> along;  ///< vertices of `to`; empty: all of a rope
  double friction = 0;
};

/// With one of a point and a stitch.
struct TieDescription {
  std::string name;
  std::string from;               ///< an object or collider; empty: the world
  std::string to;                 ///< an object
  std::optional<Vec3d> point;     ///< m
  std::optional<Vec3d> to_point;  ///< m; if not given, `point`
  std::optional<StitchDescription> stitch;
  std::optional<double> rest_length;      ///< m; if not given, the distance at the start
  double compliance = 0;                  ///< m/N
  std::optional<double> breaking_force;   ///< N; if not given, it does not break
  std::optional<double> breaking_strain;  ///< if not given, it does not break
  std::optional<SlideDescription> slide;
};

}  // namespace souple
