#pragma once

#include "souple/math/vec3.h"
#include "souple/objects/handles.h"

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace souple {

/// Handle of a tie.
struct TieId {
  std::uint32_t value = 0;
  friend bool operator==(const TieId&, const TieId&) = default;
};

/// A point that moves with up to three vertices of an object: the sum of their positions times weights. Weights are at
/// least 0 and sum to 1. A vertex, or a point of an edge, has weights of 0.
struct SurfacePoint {
  ObjectId object;
  std::array<std::uint32_t, 3> vertices{};
  std::array<double, 3> weights{1, 0, 0};
};

/// One side of a tie: a point of an object of any kind but fluids, a collider, or the world, which does not move.
class TieSide {
 public:
  TieSide() = default;  ///< the world
  /// The point of the object's surface or line that is closest to the point of the options.
  TieSide(ObjectId object) : what_(object) {}
  TieSide(const SurfacePoint& point) : what_(point) {}
  TieSide(ColliderId collider) : what_(collider) {}

  const SurfacePoint* point() const { return std::get_if<SurfacePoint>(&what_); }
  const ColliderId* collider() const { return std::get_if<ColliderId>(&what_); }
  /// The object of either way to name it.
  const ObjectId* object() const {
    const SurfacePoint* const at = point();
    return at ? &at->object : std::get_if<ObjectId>(&what_);
  }
  bool is_world() const { return what_.index() == 0; }

 private:
  std::variant<std::monostate, ObjectId, SurfacePoint, ColliderId> what_;
};

/// Lets the point of b slide along a chain of edges.
struct TieSlide {
  /// Vertices of b, neighbors joined by a straight line. Empty: all of a rope. The tie stops at both ends.
  std::vector<std::uint32_t> along{};
  double friction = 0;  ///< Coulomb's coefficient
};

/// Place of a tie when it is added, and its limits.
struct TieOptions {
  std::string name{};              ///< for the log; empty: "tie"
  Vec3d point{};                   ///< of both sides [m]
  std::optional<Vec3d> point_b{};  ///< that of b if it is elsewhere [m]
  /// m; 0: the points are drawn together. Not given: as they lie. A rigid body, a collider and the world then hold the
  /// point of the other side where it is; otherwise it is their distance. Points at no distance get no contact with each
  /// other.
  std::optional<double> rest_length{};
  double compliance = 0;                                             ///< m/N; 0 is rigid
  double breaking_force = std::numeric_limits<double>::infinity();   ///< N
  double breaking_strain = std::numeric_limits<double>::infinity();  ///< (length - rest length) / rest length
  std::optional<TieSlide> slide{};
};

/// State and force of a tie.
struct TieReport {
  std::string_view name{};     ///< valid until a tie is added or removed
  Vec3d point_a{}, point_b{};  ///< in the world [m]
  Vec3d force{};               ///< on b, mean over the last step [N]
  double rest_length = 0;      ///< m
  std::uint32_t segment =
      0;  ///< of a tie that slides: b is between the vertices `segment` and `segment` + 1 of the chain
  double along = 0;  ///< where between them, 0 to 1
  bool broken = false;
};

}  // namespace souple
