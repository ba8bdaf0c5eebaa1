#include "souple/solver/enclosed_volume.h"

#include "souple/error.h"
#include "souple/geometry/edge_uses.h"
#include "souple/math/elementary.h"
#include "souple/math/scalar.h"

#include <algorithm>

#include <fmt/core.h>

namespace souple {
namespace {

void require(bool valid, const char* name, double value, const char* expected) {
  if (!valid) throw Error(fmt::format("enclosed_volume: {} is {:g}, expected {}", name, value, expected));
}

void check(double rest_volume, const EnclosedVolumeOptions& o) {
  const auto positive = [](float v) { return v >= 0 && std::isfinite(v); };
  require(std::isfinite(rest_volume), "rest_volume", rest_volume, "a finite number of m^3");
  require(std::isfinite(o.pressure), "pressure", static_cast<double>(o.pressure), "a finite number of Pa");
  require(positive(o.volume_factor), "volume_factor", static_cast<double>(o.volume_factor),
          "a finite number, 0 or more");
  require(positive(o.compliance), "compliance", static_cast<double>(o.compliance),
          "a finite number of m^3/Pa, 0 or more");
  require(positive(o.damping_time), "damping_time", static_cast<double>(o.damping_time),
          "a finite number of seconds, 0 or more");
  require(o.stiffness >= 0 && o.stiffness <= 1, "stiffness", static_cast<double>(o.stiffness), "0 to 1");
}

// Throws Error unless every edge is used equally often in both directions: only then is the volume
// independent of the origin.
void require_closed(std::span<const Triangle> triangles) {
  EdgeUses(triangles).for_each_proper([](std::span<const EdgeUse> uses) {
    int sum = 0;
    for (const EdgeUse& use : uses) sum += use.forward ? 1 : -1;
    if (sum != 0)
      throw Error(
          fmt::format("enclosed_volume: the edge between particles {} and {} has no triangle on its other "
                      "side, or one wound the other way; expected a closed surface: fill its holes, weld its "
                      "seams and wind its triangles consistently",
                      uses[0].low, uses[0].high));
  });
}

/// All but the means.
std::vector<std::uint32_t> particles_of(std::span<const Triangle> triangles,
                                        std::span<const EnclosedVolume::Mean> means) {
  std::vector<std::uint32_t> vertices;
  for (const Triangle& t : triangles) vertices.insert(vertices.end(), t.begin(), t.end());
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  for (const EnclosedVolume::Mean& mean : means) std::erase(vertices, mean.vertex);
  return vertices;
}

}  // namespace

void EnclosedVolume::add(std::span<const Triangle> triangles, double rest_volume,
                         const EnclosedVolumeOptions& options, std::span<const Mean> means) {
  check(rest_volume, options);
  require_closed(triangles);
  const std::vector<std::uint32_t> particles = particles_of(triangles, means);
  groups_.add(particles, kind());
  const auto local_of = [&](std::uint32_t vertex) {
    std::size_t i = 0;
    for (; i < means.size(); ++i)
      if (means[i].vertex == vertex) return static_cast<std::uint32_t>(particles.size() + i);
    return static_cast<std::uint32_t>(std::lower_bound(particles.begin(), particles.end(), vertex) -
                                      particles.begin());
  };
  Surface surface;
  for (const Mean& mean : means) {
    Mean& local = surface.means.emplace_back(Mean{local_of(mean.vertex), {}});
    for (const std::uint32_t i : mean.of) local.of.push_back(local_of(i));
  }
  for (const Triangle& t : triangles) {
    Triangle local;
    std::transform(t.begin(), t.end(), local.begin(), local_of);
    if (rest_volume < 0) std::swap(local[1], local[2]);
    surface.triangles.push_back(local);
  }
  surface.target_volume = std::fabs(rest_volume) * static_cast<double>(options.volume_factor);
  surface.pressure = static_cast<double>(options.pressure);
  surface.keep_volume = options.keep_volume;
  surface.settings = {Sense::equality, static_cast<double>(options.compliance),
                      static_cast<double>(options.damping_time), static_cast<double>(options.stiffness)};
  surface.position.resize(particles.size() + means.size());
  surface.gradient.resize(particles.size() + means.size());
  surfaces_.push_back(std::move(surface));
}

// Fills `gradient` and returns V. Positions are relative to the surface's first particle.
double EnclosedVolume::measure(Surface& surface, std::span<const std::uint32_t> group,
                               const ParticleView& particles) {
  for (std::size_t k = 0; k < group.size(); ++k) {
    surface.position[k] = Vec3d(particles.difference(group[k], group[0]));
    surface.gradient[k] = {};
  }
  for (const Mean& mean : surface.means) {
    Vec3d sum{};
    for (const std::uint32_t i : mean.of) sum += surface.position[i];
    surface.position[mean.vertex] = sum / static_cast<double>(mean.of.size());
    surface.gradient[mean.vertex] = {};
  }
  double six_volumes = 0;
  for (const Triangle& t : surface.triangles) {
    const Vec3d &x0 = surface.position[t[0]], &x1 = surface.position[t[1]], &x2 = surface.position[t[2]];
    const Vec3d normal = cross(x1 - x0, x2 - x0);
    six_volumes += dot(x0, normal);
    for (const std::uint32_t k : t) surface.gradient[k] += normal / 6.0;
  }
  for (const Mean& mean : surface.means) {
    const Vec3d share = surface.gradient[mean.vertex] / static_cast<double>(mean.of.size());
    for (const std::uint32_t i : mean.of) surface.gradient[i] += share;
  }
  return six_volumes / 6;
}

void EnclosedVolume::begin_substep(const ParticleView& particles, const Substep& substep) {
  const auto h = static_cast<double>(substep.h);
  for (std::size_t i = 0; i < surfaces_.size(); ++i) {
    Surface& surface = surfaces_[i];
    surface.multiplier = 0;
    if (surface.pressure == 0) continue;
    const auto group = groups_[i];
    measure(surface, group, particles);
    const double factor = h * h * surface.pressure;
    move(i, factor * limit_of(i, factor, particles), particles);
  }
}

// By how much of `factor` particles may move along w grad C: no farther than a part of the surface's size at rest. One that was
// crushed or torn apart does not explode.
double EnclosedVolume::limit_of(std::size_t i, double factor, const ParticleView& particles) const {
  const Surface& surface = surfaces_[i];
  const auto group = groups_[i];
  double farthest = 0;
  for (std::size_t k = 0; k < group.size(); ++k)
    farthest = std::fmax(farthest, static_cast<double>(particles.inverse_mass(group[k])) *
                                       length(surface.gradient[k]) * std::fabs(factor));
  const double most = 0.25 * elementary::cbrt(surface.target_volume * 3 / (4 * pi));
  return most > 0 && farthest > most ? most / farthest : 1;
}

void EnclosedVolume::move(std::size_t i, double factor, const ParticleView& particles) const {
  const auto group = groups_[i];
  for (std::size_t k = 0; k < group.size(); ++k) {
    const auto w = static_cast<double>(particles.inverse_mass(group[k]));
    if (w > 0) particles.correct(group[k], Vec3f(surfaces_[i].gradient[k] * (w * factor)));
  }
}

void EnclosedVolume::project_one(std::size_t i, const ParticleView& particles, const Substep& substep) {
  Surface& surface = surfaces_[i];
  if (!surface.keep_volume) return;
  const auto group = groups_[i];
  ScalarState state;
  state.C = measure(surface, group, particles) - surface.target_volume;
  for (std::size_t k = 0; k < group.size(); ++k)
    state.weighted_square +=
        static_cast<double>(particles.inverse_mass(group[k])) * length_squared(surface.gradient[k]);
  const ScalarStep step = project_scalar(state, surface.settings, surface.multiplier, substep);
  const double limit = limit_of(i, step.factor, particles);
  if (substep.stores_multipliers()) surface.multiplier += step.dlambda * limit;
  move(i, step.factor * limit, particles);
}

void EnclosedVolume::damp_one(std::size_t i, const ParticleView& particles, std::span<Vec4f> velocity,
                              const Substep& substep) {
  Surface& surface = surfaces_[i];
  if (!surface.keep_volume || !(surface.settings.damping_time > 0)) return;
  const auto group = groups_[i];
  ScalarState state{measure(surface, group, particles) - surface.target_volume};
  double rate = 0;
  for (std::size_t k = 0; k < group.size(); ++k) {
    state.weighted_square +=
        static_cast<double>(particles.inverse_mass(group[k])) * length_squared(surface.gradient[k]);
    rate += dot(surface.gradient[k], Vec3d(velocity[group[k]].xyz()));
  }
  const double dlambda = damp_scalar(state, rate, surface.settings, substep);
  for (std::size_t k = 0; k < group.size(); ++k)
    add_velocity(velocity[group[k]],
                 surface.gradient[k] * (static_cast<double>(particles.inverse_mass(group[k])) * dlambda));
}

Residual EnclosedVolume::residual(const ParticleView& particles, Threads*) const {
  Residual result;
  for (std::size_t i = 0; i < surfaces_.size(); ++i)
    if (surfaces_[i].keep_volume)
      add_to_residual(result, surfaces_[i].settings, volume(i, particles) - surfaces_[i].target_volume);
  return result;
}

void EnclosedVolume::visit(const ParticleView& particles, const ConstraintVisitor& visitor) const {
  groups_.for_each([&](std::uint32_t i, int color) {
    const Surface& surface = surfaces_[i];
    const double C = surface.keep_volume ? volume(i, particles) - surface.target_volume : 0;
    visitor({groups_[i], color, 0, static_cast<float>(violation_of(surface.settings, C))});
  });
}

double EnclosedVolume::volume(std::size_t i, const ParticleView& particles) const {
  return measure(surfaces_[i], groups_[i], particles);
}

void EnclosedVolume::erase_particles(std::uint32_t begin, std::uint32_t end) {
  keep_only(surfaces_, groups_.erase_particles(begin, end));
}

std::size_t EnclosedVolume::bytes() const {
  std::size_t sum = groups_.bytes() + bytes_of(surfaces_);
  for (const Surface& surface : surfaces_) {
    sum += bytes_of(surface.triangles, surface.means, surface.position, surface.gradient);
    for (const Mean& mean : surface.means) sum += bytes_of(mean.of);
  }
  return sum;
}

}  // namespace souple
