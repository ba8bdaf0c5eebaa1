#include "souple/world/led_particles.h"

#include "souple/world/flow.h"
#include "souple/world/state.h"

#include <algorithm>

namespace souple {
namespace {

std::vector<Mouth> mouths_at(const WorldState& world, double t) {
  std::vector<Mouth> result;
  for (const EmitterRecord& record : world.emitters) {
    const auto d =
        static_cast<double>(std::get<FluidMaterial>(world.object(ObjectId{record.fluid}).material).spacing);
    const Nozzle nozzle = nozzle_at(record.emitter, t);
    const Vec3d v = nozzle.velocity + nozzle.direction * static_cast<double>(record.emitter.speed);
    const double depth = t >= record.emitter.start ? mouth_depth * d : 0;
    result.push_back(
        {nozzle.position, nozzle.direction, v, static_cast<double>(record.emitter.radius) + 0.5 * d, depth});
  }
  return result;
}

}  // namespace

bool Mouth::leads(const Vec3d& x, const Vec3d& v) const {
  const Vec3d from = x - position;
  const double along = dot(from, direction);
  return along > -0.05 * depth && along < depth && length(from - direction * along) < radius &&
         dot(v, velocity) > 0.5 * dot(velocity, velocity);
}

void LedParticles::begin_step(WorldState& world, double dt, std::span<const std::uint32_t> particles) {
  may_be_led_.assign(particles.size(), 0);
  led_.assign(particles.size(), 0);
  mouths_.clear();
  world.guarded("an emitter's motion", [&] { mouths_ = mouths_at(world, world.time + dt); });
  for (std::uint32_t e = 0; e < mouths_.size(); ++e) {
    const Object& fluid = world.object(ObjectId{world.emitters[e].fluid});
    const double reach = mouths_[e].radius + mouths_[e].depth + 2 * dt * length(mouths_[e].velocity);
    auto i = std::lower_bound(particles.begin(), particles.end(), fluid.begin);
    for (; i != particles.end() && *i < fluid.end; ++i)
      if (length_squared(world.exact_position(*i) - mouths_[e].position) < reach * reach)
        may_be_led_[static_cast<std::size_t>(i - particles.begin())] = e + 1;
  }
}

void LedParticles::begin_substep(WorldState& world) {
  mouths_.clear();
  world.guarded("an emitter's motion", [&] { mouths_ = mouths_at(world, world.time); });
}

bool LedParticles::decide(std::size_t k, const Vec3d& x, const Vec3d& v) {
  const std::uint32_t emitter = may_be_led_[k];
  const bool is_led = emitter != 0 && emitter <= mouths_.size() && mouths_[emitter - 1].leads(x, v);
  led_[k] = is_led ? 1 : 0;
  return is_led;
}

}  // namespace souple
