#include "souple/fluid/stage/inflow_particles.h"

#include "souple/fluid/emission.h"
#include "souple/fluid/stage/fluid_input.h"
#include "souple/fluid/stage/fluid_registry.h"
#include "souple/state/warnings.h"

#include <algorithm>

namespace souple {
namespace {

std::vector<Inflow> inflows_at(const FluidInput& input, const FluidRegistry& registry, double t) {
  std::vector<Inflow> result;
  result.reserve(input.emitters.size());
  for (const EmitterRecord& record : input.emitters) {
    const auto d = static_cast<double>(registry.materials[registry.find(record.fluid)].spacing);
    const Nozzle nozzle = nozzle_at(record.emitter, t);
    const Vec3d v = nozzle.velocity + nozzle.direction * static_cast<double>(record.emitter.speed);
    const double depth = t >= record.emitter.start && !record.stalled ? inflow_depth * d : 0;
    result.push_back(
        {nozzle.position, nozzle.direction, v, static_cast<double>(record.emitter.radius) + 0.5 * d, depth});
  }
  return result;
}

}  // namespace

bool Inflow::drives(const Vec3d& x, const Vec3d& v) const {
  const Vec3d from = x - position;
  const double along = dot(from, direction);
  return along > -0.05 * depth && along < depth && length(from - direction * along) < radius &&
         dot(v, velocity) > 0.5 * dot(velocity, velocity);
}

void InflowParticles::begin_step(const FluidInput& input, const FluidRegistry& registry, double dt) {
  const std::vector<std::uint32_t>& particles = registry.particle;
  candidate_emitter_.assign(particles.size(), 0);
  is_inflow_.assign(particles.size(), 0);
  inflows_.clear();
  input.warnings.guarded("an emitter's motion",
                         [&] { inflows_ = inflows_at(input, registry, input.time + dt); });
  for (std::uint32_t e = 0; e < inflows_.size(); ++e) {
    const FluidRegistry::Source& fluid = registry.sources[registry.find(input.emitters[e].fluid)];
    const double range = inflows_[e].radius + inflows_[e].depth + 2 * dt * length(inflows_[e].velocity);
    auto i = std::lower_bound(particles.begin(), particles.end(), fluid.begin);
    for (; i != particles.end() && *i < fluid.end; ++i)
      if (length_squared(input.objects.particles.exact_position(*i) - inflows_[e].position) < range * range)
        candidate_emitter_[static_cast<std::size_t>(i - particles.begin())] = e + 1;
  }
}

void InflowParticles::begin_substep(const FluidInput& input, const FluidRegistry& registry) {
  inflows_.clear();
  input.warnings.guarded("an emitter's motion", [&] { inflows_ = inflows_at(input, registry, input.time); });
}

bool InflowParticles::update(std::size_t k, const Vec3d& x, const Vec3d& v) {
  const std::uint32_t emitter = candidate_emitter_[k];
  const bool is_inflow = emitter != 0 && emitter <= inflows_.size() && inflows_[emitter - 1].drives(x, v);
  is_inflow_[k] = is_inflow ? 1 : 0;
  return is_inflow;
}

}  // namespace souple
