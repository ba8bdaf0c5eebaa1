#include "souple/world/flow.h"

#include "souple/fluid/emission.h"
#include "souple/objects/kind_functions.h"
#include "souple/objects/object.h"
#include "souple/world/sleeping.h"
#include "souple/world/state.h"

#include <algorithm>
#include <cmath>

namespace souple {
namespace {

void append(WorldState& world, Object& fluid, const Drop& drop) {
  const std::uint32_t i = fluid.end;
  set_count(world, fluid, fluid.particle_count() + 1);
  world.particles.velocity[i].set_xyz(Vec3f(drop.velocity));
  world.set_position(i, drop.position);
}

void emit(WorldState& world, EmitterRecord& record) {
  Object& fluid = world.object(ObjectId{record.fluid});
  const auto spacing = static_cast<double>(std::get<FluidMaterial>(fluid.material).spacing);
  std::vector<Drop> drops;
  world.warnings.guarded("an emitter's motion", [&] {
    drops = next_drops(record, Vec3d(world.settings.gravity), spacing, world.time);
  });
  if (drops.empty()) return;
  const std::vector<std::uint8_t> blocked = blocked_drops(drops, world.objects_view(), spacing);
  wake_island(world, fluid);
  for (std::size_t k = 0; k < drops.size(); ++k) {
    if (blocked[k] != 0 || fluid.particle_count() == fluid.capacity) {
      ++world.report.fluid.held_back;
    } else {
      append(world, fluid, drops[k]);
      ++world.report.fluid.emitted;
    }
  }
}

/// Removes the particles `gone`; the others keep their order.
void remove_particles(WorldState& world, Object& fluid, const std::vector<std::uint32_t>& gone) {
  std::uint32_t to = gone[0];
  for (std::uint32_t from = gone[0], k = 0; from < fluid.particle_count(); ++from) {
    if (k < gone.size() && gone[k] == from) {
      ++k;
      continue;
    }
    world.particles.copy(fluid.begin + from, fluid.begin + to);
    ++to;
  }
  set_count(world, fluid, to);
}

void drain(WorldState& world, DrainRecord& record, double dt) {
  if (!is_open(record.drain.start, record.drain.end, world.time)) return;
  const bool limited = std::isfinite(record.drain.rate);
  for (const auto& object : world.objects) {
    const auto* material = std::get_if<FluidMaterial>(&object->material);
    if (!material || object->particle_count() == 0) continue;
    const auto d = static_cast<double>(material->spacing);
    if (limited) record.credit += static_cast<double>(record.drain.rate) * dt / (d * d * d);
    std::vector<std::uint32_t> gone =
        particles_in(record.drain, *object, world.objects_view(), *world.threads);
    // Volume that the drain could not remove for lack of fluid does not accumulate.
    if (limited && static_cast<double>(gone.size()) > record.credit)
      gone.resize(static_cast<std::size_t>(record.credit));
    if (limited) record.credit = std::min(record.credit - static_cast<double>(gone.size()), 1.0);
    if (gone.empty()) continue;
    wake_island(world, *object);
    remove_particles(world, *object, gone);
    world.report.fluid.drained += gone.size();
  }
}

}  // namespace

void update_flow(WorldState& world, double dt) {
  for (DrainRecord& record : world.flow.drains) drain(world, record, dt);
  for (EmitterRecord& record : world.flow.emitters) emit(world, record);
}

// In a fluid vertex n is particle n.
void set_count(WorldState& world, Object& fluid, std::uint32_t count) {
  const auto& material = std::get<FluidMaterial>(fluid.material);
  const float mass = material.density * material.spacing * material.spacing * material.spacing;
  const std::uint32_t before = fluid.particle_count();
  if (count == before) return;
  Particles& particles = world.particles;
  for (std::uint32_t k = std::min(before, count); k < std::max(before, count); ++k) {
    const std::uint32_t i = fluid.begin + k;
    const bool is_there = k < count;
    particles.position[i] = {0, 0, 0, is_there ? 1 / mass : 0};
    particles.offset[i] = particles.velocity[i] = {};
    particles.mass[i] = is_there ? mass : 0;
    particles.radius[i] = contact_radius(fluid.material);
    particles.contact_margin[i] = 0;
  }
  fluid.rest.resize(count);
  fluid.particle_of.resize(count), fluid.vertex_of.resize(count);
  for (std::uint32_t k = before; k < count; ++k) fluid.particle_of[k] = fluid.vertex_of[k] = k;
  fluid.end = fluid.begin + count;
  world.dirty.counts = true;
}

}  // namespace souple
