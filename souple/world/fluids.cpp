#include "souple/world/fluids.h"

#include "souple/collision/place.h"
#include "souple/world/fluid_skin.h"
#include "souple/world/state.h"

#include <algorithm>
#include <cmath>

namespace souple {

namespace {

constexpr std::size_t grain = 512;         // particles worth a thread
constexpr float nearest_to_walls = 0.25f;  // of a spacing: the density keeps particles at half of one

/// What the density solver asks.
struct Boundary {
  Surroundings& surroundings;
  FluidBodies& bodies;
  const SmallBodies& small_bodies;
  const Smoothing& smoothing;

  template <class Function>
  void for_near(std::size_t places, Threads& threads, const Function& f) const {
    if (!small_bodies.none()) return for_places(places, threads, f);
    const std::span<const std::uint32_t> near = surroundings.near();
    for_places(near.size(), threads, [&](std::size_t k) { f(near[k]); });
  }
  BoundarySums look(std::size_t place, const Vec3f& x) const {
    const std::span<NearPlane> planes = surroundings.of(place);
    for (NearPlane& plane : planes) bodies.follow(plane);
    BoundarySums sums = look_at(planes, x, smoothing);
    if (!small_bodies.none()) sums.value += small_bodies.taken(place);
    return sums;
  }
  void looked(std::span<const Vec4f> x, CoarsePressure& coarse) const {
    if (bodies.skin_count() > 0) bodies.weigh(surroundings, x, coarse);
  }
  void respond(std::size_t place, BoundarySums& sums) const {
    if (bodies.skin_count() > 0) bodies.respond(surroundings.of(place), sums);
  }
  void push(std::size_t place, float change) const {
    for (NearPlane& plane : surroundings.of(place)) plane.pushed += plane.slope * change;
  }
  void pushed(std::span<const float> change) const {
    if (bodies.skin_count() > 0) bodies.yield(surroundings, change);
  }
};

/// What is missing to `radius` before the walls near x. [m]
Vec3f out_of_walls(const Vec3f& x, std::span<const NearPlane> planes, float radius) {
  Vec3f way{};
  for (const NearPlane& plane : planes) {
    const float distance = dot(plane.normal, x + way) - plane.offset;
    if (plane.skin == NearPlane::nobody && distance < radius) way += plane.normal * (radius - distance);
  }
  return way;
}

}  // namespace

void Fluids::begin_step(WorldState& world, double dt) {
  report_ = {};
  substeps_ = 0;
  force_.clear();
  find_particles(world);
  if (none()) return;
  world.guarded("an emitter's motion", [&] { find_led(world, dt, particle_, may_be_led_); });
  choose_solver(world);
  solver_->begin_step();
  pressure_.assign(particle_.size(), 0);
  // Coordinates are from the middle of a metre near the first particle: far from the world's origin floats
  // are coarse.
  const Vec3d first = world.exact_position(particle_[0]);
  origin_ = {std::floor(first.x), std::floor(first.y), std::floor(first.z)};
  bodies_.begin_step(feels_, origin_);
  small_bodies_.begin_step(feels_small_, small_.size(), fluid_, origin_);
  world.guarded("a collider's motion", [&] {
    walls_.begin_step(world.tables.colliders, meets_, origin_, particle_.size(), world.time);
  });
}

void Fluids::build(const WorldState& world) {
  skinned_.clear();
  small_.clear();
  std::vector<Skin> skins;
  std::vector<SmallBody> small_bodies;
  float spacing = 0;
  for (const auto& object : world.objects)
    if (const auto* material = std::get_if<FluidMaterial>(&object->material)) spacing = material->spacing;
  for (std::uint32_t o = 0; spacing > 0 && o < world.objects.size(); ++o) {
    if (std::optional<Skin> skin = fluid_skin(*world.objects[o], spacing)) {
      skins.push_back(std::move(*skin));
      skinned_.push_back(o);
      continue;
    }
    const std::size_t before = small_bodies.size();
    append_small_bodies(*world.objects[o], spacing, world.particles.mass,
                        static_cast<std::uint32_t>(small_.size()), small_bodies);
    if (small_bodies.size() > before) small_.push_back(o);
  }
  bodies_.set_skins(std::move(skins));
  small_bodies_.set_bodies(std::move(small_bodies));
}

void Fluids::find_particles(const WorldState& world) {
  particle_.clear();
  fluid_.clear();
  objects_.clear();
  meets_.clear();
  feels_.clear();
  feels_small_.clear();
  viscosities_.clear();
  materials_.clear();
  for (std::uint32_t o = 0; o < world.objects.size(); ++o) {
    const Object& object = *world.objects[o];
    const auto* material = std::get_if<FluidMaterial>(&object.material);
    if (!material) continue;
    for (std::uint32_t i = object.begin; i < object.end; ++i) {
      if (world.particles.position[i].w == 0) continue;
      particle_.push_back(i);
      fluid_.push_back(static_cast<std::uint16_t>(objects_.size()));
    }
    objects_.push_back(o);
    for (const std::uint32_t body : skinned_)
      feels_.push_back(world.tables.against_objects.collide(o, body) ? 1 : 0);
    for (const std::uint32_t body : small_)
      feels_small_.push_back(world.tables.against_objects.collide(o, body) ? 1 : 0);
    viscosities_.push_back(material->viscosity);
    materials_.push_back(*material);
    for (std::uint32_t c = 0; c < world.tables.colliders.size(); ++c)
      meets_.push_back(world.tables.against_colliders.collide(o, c) ? 1 : 0);
  }
}

void Fluids::choose_solver(const WorldState& world) {
  const Object& first = *world.objects[objects_[0]];
  const float spacing = std::get<FluidMaterial>(first.material).spacing;
  const DensitySolver::Options wanted{.shape = world.settings.fluid.kernel,
                                      .passes = world.settings.fluid.iterations,
                                      .tolerance = world.settings.fluid.tolerance,
                                      .compressibility = world.settings.fluid.compressibility,
                                      .artificial_pressure = world.settings.fluid.artificial_pressure};
  if (solver_ && spacing_ == spacing && options_ == wanted) return;
  solver_ = std::make_unique<DensitySolver>(spacing, wanted);
  viscosity_ = Viscosity(wanted.shape);
  surface_tension_ = SurfaceTension(wanted.shape);
  vorticity_ = VorticityConfinement(wanted.shape);
  spacing_ = spacing;
  options_ = wanted;
}

// In the mouth of an emitter a particle goes straight on, whatever falls.
Vec3f Fluids::lead(const WorldState& world, std::size_t k, const Vec3f& predicted, float h) {
  led_[k] = 0;
  if (may_be_led_[k] == 0 || may_be_led_[k] > mouths_.size()) return predicted;
  const Mouth& mouth = mouths_[may_be_led_[k] - 1];
  const Vec3d velocity(world.particles.velocity[particle_[k]].xyz());
  if (!mouth.leads(Vec3d(start_[k]) + origin_, velocity)) return predicted;
  led_[k] = 1;
  return start_[k] + Vec3f(mouth.velocity) * h;
}

void Fluids::place(WorldState& world, float h, Threads& threads) {
  mouths_.clear();
  world.guarded("an emitter's motion", [&] { mouths_ = mouths_at(world, world.time); });
  led_.resize(particle_.size());
  placed_.resize(particle_.size());
  start_.resize(particle_.size());
  const Particles& particles = world.particles;
  const ParticleView view = world.view();
  const float radius = nearest_to_walls * spacing_;
  const bool displaced = world.settings.form == Form::displacement;
  threads.for_each(particle_.size(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const Vec4f& x = particles.position[particle_[k]];
      Vec3f at(Vec3d(x.xyz()) - origin_);
      if (displaced) at += particles.offset[particle_[k]].xyz();
      start_[k] = Vec3f(start_place(view, particle_[k]) - origin_);
      const Vec3f aim = lead(world, k, at, h);
      const Vec3f kept = walls_.keep_out(k, fluid_[k], start_[k], aim, radius);
      view.correct(particle_[k], kept - at);
      placed_[k] = {kept.x, kept.y, kept.z, x.w};
    }
  });
  solver_->place(placed_, threads);
}

void Fluids::look_around(Threads& threads) {
  const float reach = Surroundings::reach(solver_->smoothing());
  const auto order = solver_->order();
  const auto x = solver_->positions();
  surroundings_.look(
      x.size(),
      [&](std::size_t k, std::vector<NearPlane>& planes) {
        const std::uint32_t i = order[k];
        walls_.find(i, fluid_[i], x[k].xyz(), reach, planes);
        if (bodies_.skin_count() > 0) bodies_.find(i, fluid_[i], x[k].xyz(), start_[i], reach, planes);
      },
      threads);
}

void Fluids::press(WorldState& world, const Substep& substep) {
  Threads& threads = *world.threads;
  world.guarded("a collider's motion",
                [&] { walls_.begin_substep(world.time, static_cast<double>(substep.h)); });
  place(world, substep.h, threads);
  if (bodies_.skin_count() > 0)
    bodies_.begin_substep(world.view(), world.particles.mass, placed_,
                          Surroundings::reach(solver_->smoothing()), threads);
  look_around(threads);
  if (!small_bodies_.none())
    small_bodies_.find(solver_->positions(), solver_->order(), surroundings_, solver_->smoothing(),
                       world.view(), threads);
  Boundary boundary{surroundings_, bodies_, small_bodies_, solver_->smoothing()};
  solver_->solve(boundary, threads, substep.h);
  const ParticleView view = world.view();
  const auto order = solver_->order();
  const auto moved = solver_->moved();
  const auto given = small_bodies_.none() ? std::span<const Vec3f>{}
                                          : small_bodies_.press(solver_->positions(), moved, view);
  threads.for_each(order.size(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      if (led_[order[k]] != 0) continue;
      const Vec3f at = solver_->positions()[k].xyz();
      view.correct(particle_[order[k]],
                   moved[k] + out_of_walls(at, surroundings_.of(k), nearest_to_walls * spacing_));
      if (!given.empty()) view.correct(particle_[order[k]], given[k] * -solver_->positions()[k].w);
    }
  });
  if (bodies_.skin_count() > 0) bodies_.apply(surroundings_, view);
  note(world, substep);
}

}  // namespace souple
