#include "souple/stages/spin.h"

#include "souple/objects/object.h"

namespace souple {
namespace {

constexpr std::size_t spin_grain = 4096;  // least number of particles that pays for a thread

/// Calls f(i) for all particles of awake objects that rotate.
template <class Function>
void for_each_spinning(const ObjectsView& objects, Threads& threads, const Function& f) {
  if (!objects.particles.has_spin()) return;
  for (const auto& object : objects.objects) {
    if (!object->traits().rolls || object->sleep.island != 0) continue;
    const std::size_t first = object->begin;
    threads.for_each(object->particle_count(), spin_grain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = first + begin; i < first + end; ++i) f(i);
    });
  }
}

}  // namespace

void predict_spin(const ObjectsView& objects, const Substep& substep, Threads& threads) {
  Particles& p = objects.particles;
  for_each_spinning(objects, threads,
                    [&](std::size_t i) { p.turn[i].set_xyz(p.spin[i].xyz() * (substep.h * p.radius[i])); });
}

// spin += (turn - predicted turn) / (h r): the spin of a spin_grain without contacts keeps its bits.
void finish_spin(const ObjectsView& objects, const Substep& substep, Threads& threads) {
  Particles& p = objects.particles;
  for_each_spinning(objects, threads, [&](std::size_t i) {
    const float per_spin = substep.h * p.radius[i];
    if (!(per_spin > 0)) return;  // a thickness map may make it a point
    const Vec3f spin = p.spin[i].xyz();
    p.spin[i].set_xyz(spin + (p.turn[i].xyz() - spin * per_spin) / per_spin);
  });
}

float fastest_spin(const Particles& particles, const Object& object) {
  if (!object.traits().rolls) return 0;
  float fastest = 0;
  for (std::uint32_t i = object.begin; i < object.end; ++i)
    fastest = max(fastest, length(particles.spin[i].xyz()) * particles.radius[i]);
  return fastest;
}

}  // namespace souple
