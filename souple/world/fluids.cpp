#include "souple/world/fluids.h"

#include "souple/collision/place.h"
#include "souple/world/add.h"
#include "souple/world/state.h"

#include <algorithm>
#include <cmath>

namespace souple {

namespace {

constexpr std::size_t grain = 512;  // particles worth a thread

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

/// How a fluid feels an object; nothing when it does not.
std::optional<Skin> skin_of(const Object& object) {
  const std::vector<Triangle>& faces = object.embedding ? object.mesh.triangles : object.surface;
  if (faces.empty()) return std::nullopt;
  Skin skin{.begin = object.begin,
            .end = object.end,
            .triangles = faces,
            .half_thickness = contact_radius(object.material),
            .closed = object.kind == ObjectKind::soft_body,
            .yielding = object.kind == ObjectKind::soft_body ? Yielding::rigidly : Yielding::locally};
  if (object.embedding) {
    for (std::size_t v = 0; v < object.mesh.positions.size(); ++v) {
      auto& particles = skin.particles.emplace_back();
      auto& weights = skin.weights.emplace_back();
      for (std::size_t k = 0; k < 4; ++k) {
        particles[k] = object.begin + object.embedding->vertices[v][k];
        weights[k] = static_cast<float>(object.embedding->weights[v][k]);
      }
    }
    return skin;
  }
  for (std::uint32_t i = object.begin; i < object.end; ++i) {
    skin.particles.push_back({i, i, i, i});
    skin.weights.push_back({1, 0, 0, 0});
  }
  return skin;
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
  walls_.begin_step(world.tables.colliders, meets_, origin_, particle_.size(), world.time);
}

void Fluids::build(const WorldState& world) {
  skinned_.clear();
  std::vector<Skin> skins;
  for (std::uint32_t o = 0; o < world.objects.size(); ++o) {
    if (world.objects[o]->kind == ObjectKind::fluid) continue;
    if (std::optional<Skin> skin = skin_of(*world.objects[o])) {
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
  limit_.clear();
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
    limit_.push_back(material->xsph);
    for (std::uint32_t c = 0; c < world.tables.colliders.size(); ++c)
      meets_.push_back(world.tables.against_colliders.collide(o, c) ? 1 : 0);
  }
}

void Fluids::choose_solver(const WorldState& world) {
  const Object& first = *world.objects[objects_[0]];
  const float spacing = std::get<FluidMaterial>(first.material).spacing;
  const DensitySolver::Options wanted{.shape = world.settings.fluid.kernel,
                                      .passes = world.settings.fluid.iterations};
  if (solver_ && spacing_ == spacing && options_ == wanted) return;
  solver_ = std::make_unique<DensitySolver>(spacing, wanted);
  spacing_ = spacing;
  options_ = wanted;
}

void Fluids::place(WorldState& world, Threads& threads) {
  placed_.resize(particle_.size());
  start_.resize(particle_.size());
  const Particles& particles = world.particles;
  const ParticleView view = world.view();
  const bool displaced = world.settings.form == Form::displacement;
  threads.for_each(particle_.size(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const Vec4f& x = particles.position[particle_[k]];
      Vec3f at(Vec3d(x.xyz()) - origin_);
      if (displaced) at += particles.offset[particle_[k]].xyz();
      placed_[k] = {at.x, at.y, at.z, x.w};
      start_[k] = Vec3f(start_place(view, particle_[k]) - origin_);
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
  place(world, threads);
  world.guarded("a collider's motion",
                [&] { walls_.begin_substep(world.time, static_cast<double>(substep.h)); });
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
    for (std::size_t k = begin; k < end; ++k) view.correct(particle_[order[k]], moved[k]);
  });
  if (bodies_.skin_count() > 0) bodies_.apply(surroundings_, order.size(), view);
  sum_forces(world, substep);
  note(substep);
}

// A push by slope lambda in a substep is an impulse of slope lambda / h on the particle.
void Fluids::sum_forces(const WorldState& world, const Substep& substep) {
  force_.resize(world.tables.colliders.size());
  const double scale = -1 / (static_cast<double>(substep.h) * static_cast<double>(substep.h) * substep.count);
  for (std::size_t k = 0; k < solver_->size(); ++k)
    for (const NearPlane& plane : surroundings_.of(k))
      if (plane.collider != NearPlane::nobody) force_[plane.collider] += Vec3d(plane.pushed) * scale;
}

// p_i = -lambda_i / (V h^2)
void Fluids::note(const Substep& substep) {
  ++substeps_;
  const auto order = solver_->order();
  const auto lambda = solver_->lambda();
  const float V = solver_->smoothing().volume(), factor = -1 / (V * substep.h * substep.h);
  double errors = 0, largest_error = 0, coarsest = 0;
  float pressure = 0;
  for (std::size_t k = 0; k < order.size(); ++k) {
    const float p = lambda[k] * factor;
    pressure_[order[k]] += p;
    pressure = std::max(pressure, p);
    // sqrt(p / rho), rho = m / V
    coarsest = std::max(coarsest, static_cast<double>(p * V * solver_->positions()[k].w));
    const double error = std::max(0.0, static_cast<double>(solver_->density_error(k)));
    errors += error;
    largest_error = std::max(largest_error, error);
  }
  report_.particles = order.size();
  report_.mean_density_error = errors / static_cast<double>(order.size());
  report_.largest_density_error = largest_error;
  report_.largest_pressure = std::max(report_.largest_pressure, static_cast<double>(pressure));
  report_.coarse_iterations += solver_->coarse_iterations();
  report_.largest_step = std::max(report_.largest_step, std::sqrt(coarsest) * static_cast<double>(substep.h) /
                                                            static_cast<double>(spacing_));
}

void Fluids::update_velocities(WorldState& world, const Substep& substep) {
  Threads& threads = *world.threads;
  const auto order = solver_->order();
  std::vector<Vec4f>& velocity = world.particles.velocity;
  velocity_.resize(order.size() + 1);
  velocity_.back() = {};
  threads.for_each(order.size(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) velocity_[k] = velocity[particle_[order[k]]];
  });
  solver_->smooth(velocity_, [&](std::size_t k, const Vec3f& spread) {
    const float share = -std::expm1(-limit_[fluid_[order[k]]] * substep.h);
    Vec4f& v = velocity[particle_[order[k]]];
    v.set_xyz(v.xyz() + spread * share);
  }, threads);
}

FluidReport Fluids::report() const {
  FluidReport report = report_;
  if (substeps_ > 0) report.coarse_iterations /= substeps_;
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
