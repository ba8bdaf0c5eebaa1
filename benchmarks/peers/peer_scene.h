#pragma once

#include "souple/geometry/adjacency.h"
#include "souple/math/vec3.h"
#include "souple/world/world.h"

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

// A scene for every engine, and the interface of an engine.

namespace souple::peers {

/// Particles joined by rigid distances. [m, kg, s]
struct PeerScene {
  std::vector<Vec3d> positions;
  std::vector<double> masses;        ///< kg; 0: pinned
  std::vector<Edge> links;           ///< pairs of particles, in the order of the mesh
  std::size_t constraints_each = 0;  ///< number of constraints that each engine projects in one pass
  Vec3d velocity{};                  ///< initial velocity of all particles [m/s]
};

/// An engine that simulates the scene.
class PeerEngine {
 public:
  virtual ~PeerEngine() = default;
  virtual std::string name() const = 0;
  /// Simulates one frame of dt seconds.
  virtual void step(double dt) = 0;
  /// In the order of PeerScene::positions.
  virtual std::vector<Vec3d> positions() const = 0;
  /// Number of constraints projected in a frame.
  virtual double projections() const = 0;
};

/// The benchmark `cloth`: distances along edges and across them, upper row pinned, pushed.
PeerScene cloth_scene(int size);

/// Souple with the first object of a world, which has the particles of a scene.
std::unique_ptr<PeerEngine> make_souple(World world, std::string name);
/// Souple with the benchmark `cloth`; not `pushed`: at rest.
std::unique_ptr<PeerEngine> make_souple_cloth(int size, const Settings& settings, bool pushed,
                                              std::string name);

/// Bullet's soft body: a link for every distance, stiffness 1. A frame is `substeps` calls of stepSimulation
/// with `iterations` of its position solver each.
std::unique_ptr<PeerEngine> make_bullet(const PeerScene& input, int substeps, int iterations);

/// Simulates frames of 1/60 s on all engines in turn, another one first in each frame, so that a slow phase of the
/// machine affects all of them. Returns the median time of each. [ms]
std::vector<double> simulate(std::span<const std::unique_ptr<PeerEngine>> engines, int frames);

constexpr double frame = 1.0 / 60;  ///< s

/// Largest relative extension of a link.
double largest_strain(const PeerScene& scene, const std::vector<Vec3d>& now);
double median(std::vector<double> values);

}  // namespace souple::peers
