#include "benchmarks/peers/peer_scene.h"

#include "app/bench_scenes.h"
#include "souple/geometry/measures.h"

#include <algorithm>
#include <chrono>
#include <utility>

namespace souple::peers {
namespace {

class SoupleEngine final : public PeerEngine {
 public:
  SoupleEngine(World world, std::string name) : world_(std::move(world)), name_(std::move(name)) {}
  std::string name() const override { return name_; }
  void step(double dt) override { world_.step(dt); }
  std::vector<Vec3d> positions() const override {
    const auto x = world_.positions(world_.objects()[0]);
    return {x.begin(), x.end()};
  }
  double projections() const override {
    return static_cast<double>(world_.report().constraints) * world_.settings().substeps;
  }

 private:
  World world_;
  std::string name_;
};

World cloth_world(int size, const Settings& settings) {
  World world(settings);
  app::find_bench_scene("cloth").build(world, size);
  return world;
}

}  // namespace

PeerScene cloth_scene(int size) {
  const TriangleMesh mesh = app::hanging_grid(size);
  const World world = cloth_world(size, {});
  const ObjectId cloth = world.objects()[0];
  PeerScene scene;
  scene.positions = mesh.positions;
  scene.masses = lumped_masses(mesh.positions, mesh.triangles, double(ClothMaterial{}.areal_density));
  for (const std::uint32_t i : world.pinned(cloth)) scene.masses[i] = 0;
  scene.links = unique_edges(mesh.triangles);
  for (const Hinge& hinge : interior_edges(mesh.triangles)) scene.links.push_back({hinge[2], hinge[3]});
  scene.velocity = Vec3d(world.velocities(cloth).back());
  return scene;
}

std::unique_ptr<PeerEngine> make_souple(World world, std::string name) {
  return std::make_unique<SoupleEngine>(std::move(world), std::move(name));
}

std::unique_ptr<PeerEngine> make_souple_cloth(int size, const Settings& settings, bool pushed,
                                              std::string name) {
  World world = cloth_world(size, settings);
  const ObjectId cloth = world.objects()[0];
  if (!pushed) world.set_velocities(cloth, std::vector<Vec3f>(world.positions(cloth).size()));
  return make_souple(std::move(world), std::move(name));
}

double largest_strain(const PeerScene& scene, const std::vector<Vec3d>& now) {
  double largest = 0;
  for (const Edge& link : scene.links) {
    const double rest = length(scene.positions[link[0]] - scene.positions[link[1]]);
    largest = std::max(largest, length(now[link[0]] - now[link[1]]) / rest - 1);
  }
  return largest;
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

std::vector<double> simulate(std::span<const std::unique_ptr<PeerEngine>> engines, int frames) {
  std::vector<std::vector<double>> milliseconds(engines.size());
  constexpr int warm_up = 2;
  for (int f = 0; f < frames; ++f)
    for (std::size_t k = 0; k < engines.size(); ++k) {
      const std::size_t engine = (k + static_cast<std::size_t>(f)) % engines.size();
      const auto start = std::chrono::steady_clock::now();
      engines[engine]->step(frame);
      const std::chrono::duration<double, std::milli> spent = std::chrono::steady_clock::now() - start;
      if (f >= warm_up || frames <= warm_up) milliseconds[engine].push_back(spent.count());
    }
  std::vector<double> result;
  result.reserve(milliseconds.size());
  for (const std::vector<double>& one : milliseconds) result.push_back(median(one));
  return result;
}

}  // namespace souple::peers
