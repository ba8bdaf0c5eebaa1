#pragma once

#include "souple/geometry/adjacency.h"
#include "souple/math/vec3.h"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

// One scene as every engine gets it, and what each engine has to do with it.

namespace souple::peers {

/// Particles joined by rigid distances. [m, kg, s]
struct Contest {
  std::vector<Vec3d> positions;
  std::vector<double> masses;        ///< kg; 0: pinned
  std::vector<Edge> links;           ///< of particles, in the order of the mesh
  std::size_t constraints_each = 0;  ///< that each engine projects in one pass
  Vec3d velocity{};                  ///< of all at the start [m/s]
};

/// An engine with the scene in it.
class Contestant {
 public:
  virtual ~Contestant() = default;
  virtual std::string name() const = 0;
  /// One frame of dt seconds.
  virtual void step(double dt) = 0;
  /// In the order of the contest.
  virtual std::vector<Vec3d> positions() const = 0;
  /// Constraints projected in a frame.
  virtual double projections() const = 0;
};

/// Bullet's soft body: a link for every distance, stiffness 1. A frame is `substeps` calls of stepSimulation
/// with `iterations` of its position solver each.
std::unique_ptr<Contestant> make_bullet(const Contest& contest, int substeps, int iterations);

}  // namespace souple::peers
