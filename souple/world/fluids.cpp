#include "souple/world/fluids.h"

#include "souple/collision/place.h"
#include "souple/fluid/air_drag.h"
#include "souple/world/fluid_skin.h"
#include "souple/world/forces.h"
#include "souple/world/state.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace souple {

namespace {

constexpr std::size_t grain = 512;         // particles worth a thread
constexpr float nearest_to_walls = 0.25f;  // of a spacing: the density keeps particles at half of one

/// What the density solver asks.
struct Boundary {
  Surroundings& surroundings;
  FluidBodies& bodies;
  const Smoothing& smoothing;

  BoundarySums look(std::size_t place, const Vec3f& x) const {
    const std::span<NearPlane> planes = surroundings.of(place);
    for (NearPlane& plane : planes) bodies.follow(plane);
    return look_at(planes, x, smoothing);
  }
  void looked(std::span<const Vec4f> x, CoarsePressure& coarse) const {
    if (bodies.skin_count() > 0) bodies.weigh(surroundings, x.size(), x, coarse);
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

void Fluids::begin_step(WorldState& world) {
  report_ = {};
  substeps_ = 0;
  force_.clear();
  find_particles(world);
  if (none()) return;
  choose_solver(world);
  solver_->begin_step();
  pressure_.assign(particle_.size(), 0);
  // Coordinates are from the middle of a metre near the first particle: far from the world's origin floats
  // are coarse.
  const Vec3d first = world.exact_position(particle_[0]);
  origin_ = {std::floor(first.x), std::floor(first.y), std::floor(first.z)};
  bodies_.begin_step(feels_, origin_);
  world.guarded("a collider's motion", [&] {
    walls_.begin_step(world.tables.colliders, meets_, origin_, particle_.size(), world.time);
  });
}

void Fluids::build(const WorldState& world) {
  skinned_.clear();
  std::vector<Skin> skins;
  float spacing = 0;
  for (const auto& object : world.objects)
    if (const auto* material = std::get_if<FluidMaterial>(&object->material)) spacing = material->spacing;
  if (spacing == 0) return bodies_.set_skins({});
  for (std::uint32_t o = 0; o < world.objects.size(); ++o) {
    if (world.objects[o]->kind == ObjectKind::fluid) continue;
    if (std::optional<Skin> skin = fluid_skin(*world.objects[o], spacing)) {
      skins.push_back(std::move(*skin));
      skinned_.push_back(o);
    }
  }
  bodies_.set_skins(std::move(skins));
}

void Fluids::find_particles(const WorldState& world) {
  particle_.clear();
  fluid_.clear();
  objects_.clear();
  meets_.clear();
  feels_.clear();
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
                                      .tolerance = world.settings.fluid.tolerance};
  if (solver_ && spacing_ == spacing && options_ == wanted) return;
  solver_ = std::make_unique<DensitySolver>(spacing, wanted);
  viscosity_ = Viscosity(wanted.shape);
  surface_tension_ = SurfaceTension(wanted.shape);
  vorticity_ = VorticityConfinement(wanted.shape);
  spacing_ = spacing;
  options_ = wanted;
}

void Fluids::place(WorldState& world, Threads& threads) {
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
      const Vec3f kept = walls_.keep_out(k, fluid_[k], start_[k], at, radius);
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
  place(world, threads);
  if (bodies_.skin_count() > 0)
    bodies_.begin_substep(world.view(), world.particles.mass, placed_,
                          Surroundings::reach(solver_->smoothing()), threads);
  look_around(threads);
  Boundary boundary{surroundings_, bodies_, solver_->smoothing()};
  solver_->solve(boundary, threads);
  const ParticleView view = world.view();
  const auto order = solver_->order();
  const auto moved = solver_->moved();
  threads.for_each(order.size(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const Vec3f at = solver_->positions()[k].xyz();
      view.correct(particle_[order[k]],
                   moved[k] + out_of_walls(at, surroundings_.of(k), nearest_to_walls * spacing_));
    }
  });
  if (bodies_.skin_count() > 0) bodies_.apply(surroundings_, order.size(), view);
  note(world, substep);
}

// A push by slope lambda in a substep is an impulse of slope lambda / h on the particle.
//   p_i = -lambda_i / (V h^2),   sqrt(p / rho) with rho = m / V
// Sums are of chunks, combined in order: the same for any number of threads.
void Fluids::note(const WorldState& world, const Substep& substep) {
  constexpr std::size_t chunk_size = 2048;
  const std::size_t places = solver_->size(), chunks = (places + chunk_size - 1) / chunk_size;
  const std::size_t colliders = world.tables.colliders.size();
  const auto order = solver_->order();
  const auto lambda = solver_->lambda();
  const auto x = solver_->positions();
  const float V = solver_->smoothing().volume(), factor = -1 / (V * substep.h * substep.h);
  noted_.assign(chunks, {});
  pushed_.assign(chunks * colliders, {});
  world.threads->for_each(chunks, 1, [&](std::size_t first, std::size_t last) {
    for (std::size_t chunk = first; chunk < last; ++chunk) {
      Noted& noted = noted_[chunk];
      for (std::size_t k = chunk * chunk_size; k < std::min(places, (chunk + 1) * chunk_size); ++k) {
        const float p = lambda[k] * factor;
        pressure_[order[k]] += p;
        noted.pressure = std::max(noted.pressure, p);
        noted.coarsest = std::max(noted.coarsest, p * V * x[k].w);
        const float error = std::max(0.0f, solver_->density_error(k));
        noted.errors += static_cast<double>(error);
        noted.largest_error = std::max(noted.largest_error, error);
        for (const NearPlane& plane : surroundings_.of(k))
          if (plane.collider != NearPlane::nobody)
            pushed_[chunk * colliders + plane.collider] += Vec3d(plane.pushed);
      }
    }
  });
  Noted all;
  for (const Noted& noted : noted_) all.add(noted);
  const auto h = static_cast<double>(substep.h);
  force_.resize(colliders);
  for (std::size_t n = 0; n < pushed_.size(); ++n)
    force_[n % colliders] += pushed_[n] * (-1 / (h * h * substep.count));
  ++substeps_;
  report_.particles = places;
  report_.mean_density_error = all.errors / static_cast<double>(places);
  report_.largest_density_error = static_cast<double>(all.largest_error);
  report_.largest_pressure = std::max(report_.largest_pressure, static_cast<double>(all.pressure));
  report_.coarse_iterations += solver_->coarse_iterations();
  report_.iterations += solver_->passes();
  report_.largest_step = std::max(
      report_.largest_step, std::sqrt(static_cast<double>(all.coarsest)) * h / static_cast<double>(spacing_));
}

// What several walls say together, as if they hid one another.
void Fluids::find_wall_friction(float h, Threads& threads) {
  const auto x = solver_->positions();
  const auto order = solver_->order();
  wall_friction_.resize(x.size());
  for_places(x.size(), threads, [&](std::size_t k) {
    Vec3f motion{};
    float sum = 0, left = 1;
    for (const NearPlane& plane : surroundings_.of(k)) {
      if (plane.skin != NearPlane::nobody) continue;
      const float value = solver_->smoothing().wall(dot(plane.normal, x[k].xyz()) - plane.offset).value;
      motion += plane.motion * value;
      sum += value;
      left *= 1 - value;
    }
    const Vec3f speed = sum > 0 ? motion * (1 / (sum * h)) : Vec3f{};
    wall_friction_[k] = {speed.x, speed.y, speed.z, (1 - left) * materials_[fluid_[order[k]]].friction};
  });
}

void Fluids::find_near_walls(Threads& threads) {
  const auto x = solver_->positions();
  near_walls_.resize(x.size());
  for_places(x.size(), threads, [&](std::size_t k) {
    near_walls_[k] = {};
    float nearest = std::numeric_limits<float>::max();
    for (const NearPlane& plane : surroundings_.of(k)) {
      const float distance = dot(plane.normal, x[k].xyz()) - plane.offset;
      if (plane.skin != NearPlane::nobody || distance >= nearest) continue;
      nearest = distance;
      near_walls_[k] = {plane.normal, distance};
    }
  });
}

// The strongest of what the fluids of a world want is done for all of them, but for viscosity and drag, which
// each has for itself.
void Fluids::apply_forces(const WorldState& world, const Substep& substep) {
  Threads& threads = *world.threads;
  const FluidView view{solver_->padded_positions(), velocity_, solver_->neighbours(), solver_->smoothing()};
  const auto most = [&](float FluidMaterial::*value) {
    float result = 0;
    for (const FluidMaterial& material : materials_) result = std::max(result, material.*value);
    return result;
  };
  find_wall_friction(substep.h, threads);
  const ImplicitViscosity::Report viscous = viscosity_.apply(view, wall_friction_, substep.h, threads);
  report_.viscosity_iterations += viscous.iterations;
  if (const float sigma = most(&FluidMaterial::surface_tension); sigma > 0) {
    find_near_walls(threads);
    const float angle = materials_[0].contact_angle * static_cast<float>(pi) / 180;
    surface_tension_.apply(view, near_walls_, {sigma, SurfaceTension::adhesion_of(angle)}, substep.h,
                           threads);
  }
  if (const float epsilon = most(&FluidMaterial::vorticity); epsilon > 0)
    vorticity_.apply(view, epsilon, substep.h, threads);
  if (const float coefficient = most(&FluidMaterial::air_drag); coefficient > 0) {
    covered_.resize(view.size());
    for_places(view.size(), threads, [&](std::size_t k) { covered_[k] = 1 + solver_->density_error(k); });
    const AirDrag air{wind_at(world.settings, world.time), world.settings.wind.air_density, coefficient};
    apply_air_drag(view, covered_, air, substep.h, threads);
  }
}

// XSPH as a viscosity: of the rate c it has nu = c m2 / 6, m2 = 6 d^2 wall(d/2).value; see xsph.h.
void Fluids::update_velocities(WorldState& world, const Substep& substep) {
  Threads& threads = *world.threads;
  const auto order = solver_->order();
  std::vector<Vec4f>& velocity = world.particles.velocity;
  velocity_.resize(order.size() + 1);
  velocity_.back() = {};
  const float exchange = spacing_ * spacing_ * solver_->smoothing().wall(spacing_ / 2).value;
  for_places(order.size(), threads, [&](std::size_t k) {
    const FluidMaterial& material = materials_[fluid_[order[k]]];
    velocity_[k] = velocity[particle_[order[k]]];
    velocity_[k].w = material.viscosity + material.density * material.xsph * exchange;
  });
  apply_forces(world, substep);
  double fastest = 0;
  for (std::size_t k = 0; k < order.size(); ++k)
    fastest = std::max(fastest, static_cast<double>(length_squared(velocity_[k].xyz())));
  report_.fastest = std::max(report_.fastest, std::sqrt(fastest));
  report_.largest_step =
      std::max(report_.largest_step,
               std::sqrt(fastest) / 1.5 * static_cast<double>(substep.h) / static_cast<double>(spacing_));
  for_places(order.size(), threads,
             [&](std::size_t k) { velocity[particle_[order[k]]].set_xyz(velocity_[k].xyz()); });
}

FluidReport Fluids::report() const {
  FluidReport report = report_;
  if (substeps_ > 0)
    report.iterations /= substeps_, report.coarse_iterations /= substeps_,
        report.viscosity_iterations /= substeps_;
  return report;
}

Vec3d Fluids::force(std::size_t collider) const {
  return collider < force_.size() ? force_[collider] : Vec3d{};
}

float Fluids::pressure(std::uint32_t particle) const {
  const auto at = std::lower_bound(particle_.begin(), particle_.end(), particle);
  if (at == particle_.end() || *at != particle || substeps_ == 0) return 0;
  return pressure_[static_cast<std::size_t>(at - particle_.begin())] / static_cast<float>(substeps_);
}

}  // namespace souple
