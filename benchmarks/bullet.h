#pragma once

#include "souple/geometry/adjacency.h"
#include "souple/math/vec3.h"

#include <memory>
#include <vector>

// A scene for every engine, and the interface of an engine.

namespace souple::peers {

/// Particles joined by rigid distances. [m, kg, s]
struct PeerScene {
  std::vector<Vec3d> positions;
  std::vector<double> masses;  ///< kg; 0: pinned
  std::vector<Edge> links;     ///< pairs of particles, in the order of the mesh
  Vec3d velocity{};            ///< initial velocity of all particles [m/s]
};

/// An engine that simulates the scene.
class PeerEngine {
 public:
  virtual ~PeerEngine() = default;
  /// Simulates one frame of dt seconds.
  virtual void step(double dt) = 0;
  /// In the order of PeerScene::positions.
  virtual std::vector<Vec3d> positions() const = 0;
};

/// Bullet's soft body: a link for every distance, stiffness 1. A frame is `substeps` calls of stepSimulation
/// with `iterations` of its position solver each.
std::unique_ptr<PeerEngine> make_bullet(const PeerScene& input, int substeps, int iterations);

}  // namespace souple::peers
