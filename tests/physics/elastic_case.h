#pragma once

#include "souple/geometry/builders.h"
#include "souple/solver/projector.h"
#include "souple/souple.h"

#include <cmath>
#include <functional>
#include <vector>

// Helpers for tests of elastic bodies in equilibrium: running to the static state, and loads other than
// weight.

namespace souple {

/// Settings of a run to the static state: `drag` [1/s], `gravity` [m/s^2] downward.
inline Settings static_case(int substeps, int iterations, double drag, double gravity = 0) {
  return {.substeps = substeps,
          .iterations = iterations,
          .mode = Mode::xpbd,
          .gravity = {0, static_cast<float>(-gravity), 0},
          .drag = static_cast<float>(drag),
          .measure_residuals = false};
}

/// Runs until `measure` changes by less than the relative `tolerance` over three consecutive blocks of
/// `frames`, and returns it. Returns NaN if that does not happen within `blocks`, or if a value becomes
/// non-finite.
inline double settle(World& world, double dt, int frames, const std::function<double()>& measure,
                     double tolerance = 1e-4, int blocks = 400) {
  double before = measure();
  int calm = 0;
  for (int block = 0; block < blocks; ++block) {
    for (int frame = 0; frame < frames; ++frame)
      if (!world.step(dt).ok()) return std::nan("");
    const double now = measure();
    calm = std::fabs(now - before) <= tolerance * std::fabs(now) ? calm + 1 : 0;
    if (calm == 3) return now;
    before = now;
  }
  return std::nan("");
}

/// Forces [N] on individual vertices of an object, in user order. A projector moves predicted positions by w h^2 f once
/// per substep, as gravity does.
class NodalLoad final : public Projector {
 public:
  NodalLoad(std::vector<std::uint32_t> particles, std::vector<Vec3d> forces)
      : particles_(std::move(particles)), forces_(std::move(forces)) {}

  std::string_view kind() const override { return "nodal_load"; }
  std::size_t size() const override { return particles_.size(); }
  void prepare(std::size_t) override {}
  int color_count() const override { return 0; }
  void begin_substep(const ParticleView& view, const Substep& substep) override {
    const double hh = static_cast<double>(substep.h) * static_cast<double>(substep.h);
    for (std::size_t k = 0; k < particles_.size(); ++k)
      view.correct(particles_[k],
                   Vec3f(forces_[k] * (hh * static_cast<double>(view.inverse_mass(particles_[k])))));
  }
  std::size_t color_size(int) const override { return 0; }
  void project(int, std::size_t, std::size_t, const ParticleView&, const Substep&) override {}
  Residual residual(const ParticleView&, Threads*) const override { return {}; }
  void erase_particles(std::uint32_t, std::uint32_t) override {}

 private:
  std::vector<std::uint32_t> particles_;
  std::vector<Vec3d> forces_;
};

/// Applies the force forces[v] to every vertex v of an object.
inline ProjectorId add_load(World& world, ObjectId object, const std::vector<Vec3d>& forces) {
  std::vector<std::uint32_t> particles;
  for (std::uint32_t v = 0; v < forces.size(); ++v) particles.push_back(world.particle(object, v));
  return world.add_projector(std::make_unique<NodalLoad>(particles, forces));
}

/// Mean of one coordinate over the vertices whose rest coordinate `where` is `at` (to a millionth of
/// `scale`).
template <class Rest>
double mean_over(const World& world, ObjectId object, const Rest& rest, double Vec3d::*where, double at,
                 double Vec3d::*what, double scale) {
  double sum = 0, count = 0;
  const auto x = world.positions(object);
  for (std::size_t v = 0; v < rest.size(); ++v)
    if (std::fabs(rest[v].*where - at) < 1e-6 * scale) sum += Vec3d(x[v]).*what, ++count;
  return sum / count;
}

}  // namespace souple
