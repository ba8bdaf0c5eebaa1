#include "souple/world/stages.h"

#include "souple/world/contacts.h"
#include "souple/world/damping.h"
#include "souple/world/forces.h"

#include <atomic>
#include <cmath>
#include <limits>

namespace souple {
namespace {

/// `position` in the plain form, `offset` in the displacement form: what prediction and the solver move.
std::vector<Vec4f>& moving(WorldState& world) {
  return world.settings.form == Form::plain ? world.particles.position : world.particles.offset;
}

constexpr std::size_t particle_grain = 1024;  // particles worth a thread

// The first particle of a loop whose number is bad, whichever thread comes by it first. It names the culprit;
// the solver would spread what is not finite within the substep.
class FirstBad {
 public:
  void note(std::size_t i, const Vec3f& v) {
    if (std::isfinite(v.x + v.y + v.z)) return;
    std::size_t first = first_.load(std::memory_order_relaxed);
    while (i < first && !first_.compare_exchange_weak(first, i, std::memory_order_relaxed)) continue;
  }
  void tell(WorldState& world) const {
    const std::size_t first = first_.load(std::memory_order_relaxed);
    if (first != none && !world.first_bad) world.first_bad = first;
  }

 private:
  static constexpr std::size_t none = std::numeric_limits<std::size_t>::max();
  std::atomic<std::size_t> first_{none};
};

struct Air {
  bool windy;
  Vec3f wind;
};

void predict_one(WorldState& world, std::size_t i, const Air& air, float h, Vec4f& p, FirstBad& bad) {
  Particles& particles = world.particles;
  const Vec3f v = particles.velocity[i].xyz();
  const Vec3f x = particles.position[i].xyz();
  Vec3f v_star, move;
  switch (world.settings.integrator) {
    case Integrator::semi_implicit:
      v_star = v + acceleration(world, i, x, v, air.windy, air.wind, world.time) * h;
      move = v_star * h;
      break;
    case Integrator::explicit_euler:
      v_star = v + acceleration(world, i, x, v, air.windy, air.wind, world.time) * h;
      move = v * h;
      break;
    case Integrator::implicit_euler:
      v_star = implicit_velocity(world, i, x, v, h, air.windy, air.wind, world.time + static_cast<double>(h));
      move = v_star * h;
      break;
  }
  bad.note(i, v_star);
  particles.velocity[i].set_xyz(v_star);
  p.set_xyz(p.xyz() + move);
}

void predict(WorldState& world, const Substep& substep) {
  const bool windy = accumulate_wind(world, substep.h);
  const Air air{windy, wind_at(world.settings, world.time)};
  Particles& particles = world.particles;
  std::vector<Vec4f>& p = moving(world);
  FirstBad bad;
  // Users' force fields may share what they like: one thread calls them.
  const std::size_t grain = world.force_fields.empty() ? particle_grain : particles.size();
  world.threads->for_each(particles.size(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      particles.start[i] = p[i];
      if (particles.position[i].w != 0) predict_one(world, i, air, substep.h, p[i], bad);
    }
  });
  bad.tell(world);
}

// Pinned particles: to target(vertex, t + h) + offset, or nowhere.
void drive_pins(WorldState& world, const Substep& substep) {
  const double t = world.time + static_cast<double>(substep.h);
  std::vector<Vec4f>& p = moving(world);
  for (const auto& object : world.objects) {
    for (const PinnedParticle& pin : object->pins) {
      if (!pin.target) continue;
      const std::uint32_t i = object->begin + pin.particle;
      Vec3d goal = world.exact_position(i);
      world.guarded("a pin's target", [&] { goal = (*pin.target)(pin.vertex, t) + pin.offset; });
      if (world.settings.form == Form::plain) {
        p[i].set_xyz(Vec3f(goal));
      } else {
        p[i].set_xyz(Vec3f(goal - Vec3d(world.particles.position[i].xyz())));
      }
    }
  }
}

void drive_attachments(WorldState& world, const Substep& substep) {
  const double t = world.time + static_cast<double>(substep.h);
  for (Extra& extra : world.extras) world.guarded("an attachment's target", [&] { extra.follow(t); });
}

}  // namespace

void integrate(WorldState& world, const Substep& substep) {
  predict(world, substep);
  drive_pins(world, substep);
  drive_attachments(world, substep);
  if (world.settings.integrator != Integrator::semi_implicit) world.predicted = moving(world);
}

void solve(WorldState& world, const Substep& substep) {
  const ParticleView view = world.view();
  world.for_each_projector([&](Projector& projector) { projector.begin_substep(view, substep); });
  world.solver->solve(world.order, view, substep, *world.threads);
}

bool finish(WorldState& world, const Substep& substep) {
  Particles& particles = world.particles;
  const std::vector<Vec4f>& p = moving(world);
  const bool semi_implicit = world.settings.integrator == Integrator::semi_implicit;
  const bool displacement = world.settings.form == Form::displacement;
  FirstBad bad;
  const auto finish_one = [&](std::size_t i) {
    // v = v* + (p - p*) / h: a particle that nothing corrects keeps its velocity to the bit. The
    // semi-implicit p* is made again from v* with the roundings of the prediction. A pinned particle has no
    // v*: v = (p - x) / h.
    const Vec3f start = particles.start[i].xyz();
    const Vec3f v_star = particles.velocity[i].xyz();
    const bool pinned = particles.position[i].w == 0;
    const Vec3f base = pinned ? Vec3f{} : v_star;
    const Vec3f since = pinned          ? start
                        : semi_implicit ? start + v_star * substep.h
                                        : world.predicted[i].xyz();
    const Vec3f v = base + (p[i].xyz() - since) / substep.h;
    particles.velocity[i].set_xyz(v);
    bad.note(i, v);
    if (!displacement) return;
    // x += q; what x cannot represent stays in the offset.
    const Vec3f q = particles.offset[i].xyz();
    const Vec3f x = particles.position[i].xyz();
    const Vec3f moved = x + q;
    particles.position[i].set_xyz(moved);
    particles.offset[i].set_xyz(q - (moved - x));
    bad.note(i, moved);
  };
  world.threads->for_each(particles.size(), particle_grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) finish_one(i);
  });
  bad.tell(world);
  ++world.version;
  return !world.first_bad;
}

void update_velocities(WorldState& world, const Substep& substep) {
  apply_restitution(world, substep);
  for (const auto& object : world.objects) damp(world, *object, substep.h);
}

}  // namespace souple
