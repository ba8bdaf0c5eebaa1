#include "souple/solver/shape_matching.h"

#include "souple/error.h"
#include "souple/math/elementary.h"
#include "souple/math/polar_decomposition.h"

#include <algorithm>
#include <numeric>

#include <fmt/core.h>

namespace souple {
namespace {

// Mass of a pinned particle, as a multiple of the free particles' total mass.
constexpr double pin_weight = 1e4;
// Ratio of squared thickness to squared length below which a direction is missing.
constexpr double flat = 1e-6;
// Sweeps of stacks: three per region, at most 30, or as many as the ratio of the masses; and what a substep may cost.
constexpr double sweeps_per_region = 3, max_stack_sweeps = 30, max_moves = 4e4;
// Boxes of regions touch when they are nearer than this part of the sum of their smallest extents.
constexpr float near_part = 0.1f;
constexpr double min_det = 0.1;  // below this determinant, linear regions become rigid

void require(bool valid, const char* name, float value, const char* expected) {
  if (!valid) throw Error(fmt::format("shape_matching: {} is {}, expected {}", name, value, expected));
}

void check(std::span<const std::uint32_t> particles, std::span<const Vec3d> rest,
           const ShapeMatchingOptions& options) {
  if (particles.size() != rest.size())
    throw Error(fmt::format("shape_matching: {} particles with {} rest positions, expected as many of each",
                            particles.size(), rest.size()));
  for (std::size_t i = 0; i < rest.size(); ++i)
    if (!is_finite(rest[i])) throw Error(fmt::format("shape_matching: rest position {} is not finite", i));
  require(options.linear >= 0 && options.linear <= 1, "linear", options.linear, "0 to 1");
  require(options.stiffness >= 0 && options.stiffness <= 1, "stiffness", options.stiffness, "0 to 1");
  require(options.compliance >= 0 && std::isfinite(options.compliance), "compliance", options.compliance,
          "a finite number of m/N, 0 or more");
  require(options.damping_time >= 0 && std::isfinite(options.damping_time), "damping_time",
          options.damping_time, "a finite number of seconds, 0 or more");
}

// Projection onto the directions in which the rest shape has no extent, whatever its masses. Sets
// `dimensions` to the number of the other directions.
Mat3d missing_directions(std::span<const Vec3d> rest, int& dimensions) {
  Vec3d center{};
  for (const Vec3d& q : rest) center += q / static_cast<double>(rest.size());
  Mat3d covariance;
  for (const Vec3d& q : rest) covariance = covariance + outer(q - center, q - center);
  const Svd<double> d = svd(covariance);
  Mat3d missing;
  dimensions = 0;
  for (int k = 0; k < 3; ++k) {
    if (d.sigma[k] > flat * d.sigma.x) {
      ++dimensions;
    } else {
      missing = missing + outer(d.u.column[k], d.u.column[k]);
    }
  }
  return missing;
}

// A^-1 within the present directions, 0 in the missing ones.
Mat3d pseudo_inverse(const Mat3d& a, const Mat3d& missing) {
  const double t = trace(a);
  if (!(t > 0)) return {};
  const Mat3d present = Mat3d::identity() - missing;
  const Mat3d result = inverse(present * a * present * (1 / t) + missing) - missing;
  const bool finite = std::isfinite(frobenius_squared(result));
  return finite ? result * (1 / t) : Mat3d{};
}

// det(A)^(-1/n) for a shape of n dimensions.
double to_unit_volume(double det, int dimensions) {
  if (dimensions == 3) return 1 / elementary::cbrt(det);
  return dimensions == 2 ? 1 / std::sqrt(det) : 1 / det;
}

}  // namespace

void ShapeMatching::add(std::span<const std::uint32_t> particles, std::span<const Vec3d> rest,
                        const ShapeMatchingOptions& options) {
  check(particles, rest, options);
  groups_.add(particles, kind());
  Region region;
  for (const Vec3d& q : rest) region.rest.push_back(q - rest[0]);
  region.missing = missing_directions(region.rest, region.dimensions);
  region.linear = static_cast<double>(options.linear);
  region.settings = {Sense::equality, static_cast<double>(options.compliance),
                     static_cast<double>(options.damping_time), static_cast<double>(options.stiffness)};
  region.inverse_mass.assign(rest.size(), -1);  // no mass yet: the first substep computes the masses
  region.mass.assign(rest.size(), 1);
  regions_.push_back(std::move(region));
}

void ShapeMatching::update_masses(Region& region, std::span<const std::uint32_t> group,
                                  const ParticleView& particles) {
  bool changed = false;
  for (std::size_t k = 0; k < group.size(); ++k) {
    const float w = particles.inverse_mass(group[k]);
    changed = changed || w != region.inverse_mass[k];
    region.inverse_mass[k] = w;
  }
  if (!changed) return;
  region.free_mass = 0;
  for (const float w : region.inverse_mass)
    if (w > 0) region.free_mass += 1 / static_cast<double>(w);
  const double pinned = region.free_mass > 0 ? pin_weight * region.free_mass : 1;
  region.total_mass = 0;
  region.center = {};
  for (std::size_t k = 0; k < group.size(); ++k) {
    const float w = region.inverse_mass[k];
    region.mass[k] = w > 0 ? 1 / static_cast<double>(w) : pinned;
    region.total_mass += region.mass[k];
    region.center += region.rest[k] * region.mass[k];
  }
  region.center = region.center / region.total_mass;
  Mat3d a_qq;
  for (std::size_t k = 0; k < group.size(); ++k) {
    const Vec3d q = region.rest[k] - region.center;
    a_qq = a_qq + outer(q, q) * region.mass[k];
  }
  region.rest_inverse = pseudo_inverse(a_qq, region.missing);
}

void ShapeMatching::prepare_sweeps(const ParticleView& particles, bool) {
  for (std::size_t i = 0; i < regions_.size(); ++i) update_masses(regions_[i], groups_[i], particles);
  by_particle_.resize(regions_.size());
  std::iota(by_particle_.begin(), by_particle_.end(), 0u);
  std::stable_sort(by_particle_.begin(), by_particle_.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return groups_[a][0] < groups_[b][0]; });
}

void ShapeMatching::find_stacks(const ParticleView& particles) {
  if (regions_.size() < 2) return;
  stacks_.resize(regions_.size());
  for (std::size_t i = 0; i < regions_.size(); ++i) {
    const std::span<const std::uint32_t> group = groups_[i];
    Vec3f lo = particles.relative(group[0], {}), hi = lo;
    for (const std::uint32_t particle : group) {
      const Vec3f x = particles.relative(particle, {});
      lo = {min(lo.x, x.x), min(lo.y, x.y), min(lo.z, x.z)};
      hi = {max(hi.x, x.x), max(hi.y, x.y), max(hi.z, x.z)};
    }
    const Vec3f size = hi - lo;
    const float near = near_part * min(size.x, min(size.y, size.z));
    const Vec3f margin{near, near, near};
    stacks_.set(i, lo - margin, hi + margin, regions_[i].free_mass);
  }
  stacks_.find();
}

// A region alone needs one sweep. Contacts take part in each sweep. With contacts it needs as many sweeps as its
// particles would (SetProjector::sweeps_needed), and in a stack as many as carry a weight through it.
template <class ForEach>
int ShapeMatching::sweeps_of(const Substep& substep, const ForEach& for_each) const {
  if (substep.mode == Mode::pbd) return 1;
  double softness = 0, stack = 1;  // softness: largest D / (2 alpha) [1/s^2]
  std::size_t moved = 0;
  Stacks::Size size;
  for_each([&](std::uint32_t i) {
    const Region& region = regions_[i];
    if (!(region.free_mass > 0)) return;
    moved += groups_[i].size();
    if (region.settings.compliance > 0)
      softness = std::fmax(softness, 1 / (2 * region.free_mass * region.settings.compliance));
    if (regions_.size() > 1) size.add(stacks_.size_of(i));
  });
  if (size.bodies > 1)
    stack =
        std::fmin(std::fmax(std::fmin(sweeps_per_region * static_cast<double>(size.bodies), max_stack_sweeps),
                            size.mass_ratio),
                  max_moves / static_cast<double>(moved));
  const double own = std::round(1 + 2.5 * softness * static_cast<double>(substep.h * substep.h));
  return static_cast<int>(
      std::fmax(std::fmin(own, max_sweeps(substep)), stack * std::fmin(1, 10.0 / substep.count)));
}

int ShapeMatching::sweeps_needed(const Substep& substep) const {
  return sweeps_of(substep, [&](const auto& f) {
    for (std::uint32_t i = 0; i < regions_.size(); ++i) f(i);
  });
}

int ShapeMatching::sweeps_needed(const Substep& substep, std::span<const IndexRange> particles) const {
  return sweeps_of(substep, [&](const auto& f) {
    const auto before = [&](std::uint32_t i, std::size_t particle) { return groups_[i][0] < particle; };
    auto at = by_particle_.begin();
    for (const IndexRange& range : particles)
      for (at = std::lower_bound(at, by_particle_.end(), range.begin, before);
           at != by_particle_.end() && groups_[*at][0] < range.end; ++at)
        f(*at);
  });
}

void ShapeMatching::begin_substep(const ParticleView& particles, const Substep&) {
  for (std::size_t i = 0; i < regions_.size(); ++i) {
    update_masses(regions_[i], groups_[i], particles);
    regions_[i].multiplier = 0;
  }
  find_stacks(particles);
}

ShapeMatching::Pose ShapeMatching::fit(const Region& region, std::span<const std::uint32_t> group,
                                       const ParticleView& particles) {
  Vec3d sum{};
  Mat3d a_pq;  // sum m x q^T: because sum m q = 0, the center of x cancels
  for (std::size_t k = 0; k < group.size(); ++k) {
    const Vec3d mx = Vec3d(particles.difference(group[k], group[0])) * region.mass[k];
    sum += mx;
    a_pq = a_pq + outer(mx, region.rest[k] - region.center);
  }
  Pose pose{sum / region.total_mass, nearest_rotation(a_pq)};
  if (region.linear == 0 || region.dimensions == 0) return pose;
  const Mat3d r = pose.transform;
  const Mat3d a = a_pq * region.rest_inverse;
  const double det = determinant(a + r * region.missing);
  const double beta = region.linear * std::clamp(det / min_det, 0.0, 1.0);
  pose.transform = a * (beta * to_unit_volume(std::fmax(det, min_det), region.dimensions)) + r * (1 - beta);
  return pose;
}

Vec3d ShapeMatching::to_goal(const Region& region, std::span<const std::uint32_t> group,
                             const ParticleView& particles, const Pose& pose, std::size_t k) {
  const Vec3d goal = pose.center + pose.transform * (region.rest[k] - region.center);
  return goal - Vec3d(particles.difference(group[k], group[0]));
}

// C^2 of the free particles.
double ShapeMatching::distance_squared(const Region& region, std::span<const std::uint32_t> group,
                                       const ParticleView& particles, const Pose& pose) {
  double sum = 0;
  for (std::size_t k = 0; k < group.size(); ++k)
    if (region.inverse_mass[k] > 0)
      sum += region.mass[k] * length_squared(to_goal(region, group, particles, pose, k));
  return sum / region.free_mass;
}

void ShapeMatching::project_one(std::size_t i, const ParticleView& particles, const Substep& substep) {
  Region& region = regions_[i];
  if (!(region.free_mass > 0)) return;
  const auto group = groups_[i];
  const Pose pose = fit(region, group, particles);
  ScalarState state;
  state.C = std::sqrt(distance_squared(region, group, particles, pose));
  if (state.C == 0) return;
  // grad_i C = -m_i d_i / (M C) with d = g - x, so w_i grad_i C = -d_i / (M C)
  const double scale = -1 / (region.free_mass * state.C);
  state.weighted_square = 1 / region.free_mass;
  const ScalarStep step = project_scalar(state, region.settings, region.multiplier, substep);
  if (substep.stores_multipliers()) region.multiplier += step.dlambda;
  // The first particle last: positions of all other particles are relative to it.
  for (std::size_t k = group.size(); k-- > 0;) {
    if (!(region.inverse_mass[k] > 0)) continue;
    particles.correct(group[k], Vec3f(to_goal(region, group, particles, pose, k) * (step.factor * scale)));
  }
}

// The rigid motion of the free particles, as for objects (world/damping.cpp).
namespace {

// x_i - x_j in the middle of the substep. There the velocities of a turning body, chords of circles, are a rotation. At
// its end they have a part towards the center, and damping of that part would brake the rotation.
Vec3d halfway(std::uint32_t i, std::uint32_t j, const ParticleView& particles,
              std::span<const Vec4f> velocity, double h) {
  return Vec3d(particles.difference(i, j)) - Vec3d(velocity[i].xyz() - velocity[j].xyz()) * (h / 2);
}

}  // namespace

ShapeMatching::RigidMotion ShapeMatching::rigid_motion(const Region& region,
                                                       std::span<const std::uint32_t> group,
                                                       const ParticleView& particles,
                                                       std::span<const Vec4f> velocity, double h) {
  RigidMotion motion;
  for (std::size_t k = 0; k < group.size(); ++k) {
    if (!(region.inverse_mass[k] > 0)) continue;
    motion.center += halfway(group[k], group[0], particles, velocity, h) * region.mass[k];
    motion.velocity += Vec3d(velocity[group[k]].xyz()) * region.mass[k];
  }
  motion.center = motion.center / region.free_mass;
  motion.velocity = motion.velocity / region.free_mass;
  Mat3d second;
  Vec3d momentum{};
  for (std::size_t k = 0; k < group.size(); ++k) {
    if (!(region.inverse_mass[k] > 0)) continue;
    const Vec3d r = halfway(group[k], group[0], particles, velocity, h) - motion.center;
    second = second + outer(r, r) * region.mass[k];
    momentum += cross(r, Vec3d(velocity[group[k]].xyz()) - motion.velocity) * region.mass[k];
  }
  // A rod or a point has no inertia about its axis, hence no spin there: a small relative inertia is added.
  const double t = trace(second);
  if (t > 0) motion.spin = inverse(Mat3d::identity() * (t * (1 + 1e-9)) - second) * momentum;
  return motion;
}

// The forces of all changes of shape have one stiffness. The energy is that of springs from every particle to its goal,
// sum m |x - g|^2 / (2 alpha M). Kelvin-Voigt damping is that of dampers beside these springs, as the goals move with
// the body. In an implicit Euler step of size h, gamma = tau / h,
//   u <- alpha~ / (alpha~ + gamma / M) u,   u_i: velocity of particle i relative to the rigid motion
void ShapeMatching::damp_one(std::size_t i, const ParticleView& particles, std::span<Vec4f> velocity,
                             const Substep& substep) {
  const Region& region = regions_[i];
  if (!(region.free_mass > 0) || !(region.settings.damping_time > 0)) return;
  const auto group = groups_[i];
  const double h = static_cast<double>(substep.h),
               gamma = region.settings.damping_time / h / region.free_mass;
  const double removed = gamma / (gamma + region.settings.compliance / (h * h));
  const RigidMotion motion = rigid_motion(region, group, particles, velocity, h);
  for (std::size_t k = 0; k < group.size(); ++k) {
    if (!(region.inverse_mass[k] > 0)) continue;
    const Vec3d r = halfway(group[k], group[0], particles, velocity, h) - motion.center;
    const Vec3d rigid = motion.velocity + cross(motion.spin, r);
    add_velocity(velocity[group[k]], (rigid - Vec3d(velocity[group[k]].xyz())) * removed);
  }
}

double ShapeMatching::distance(std::size_t i, const ParticleView& particles) const {
  Region& region = regions_[i];
  update_masses(region, groups_[i], particles);
  if (!(region.free_mass > 0)) return 0;
  const Pose pose = fit(region, groups_[i], particles);
  return std::sqrt(distance_squared(region, groups_[i], particles, pose));
}

Residual ShapeMatching::residual(const ParticleView& particles, Threads*) const {
  Residual result;
  for (std::size_t i = 0; i < regions_.size(); ++i) {
    const double C = distance(i, particles);
    if (regions_[i].free_mass > 0) add_to_residual(result, regions_[i].settings, C);
  }
  return result;
}

void ShapeMatching::visit(const ParticleView& particles, const ConstraintVisitor& visitor) const {
  groups_.for_each([&](std::uint32_t i, int color) {
    visitor({groups_[i], color, 0, static_cast<float>(distance(i, particles))});
  });
}

void ShapeMatching::erase_particles(std::uint32_t begin, std::uint32_t end) {
  keep_only(regions_, groups_.erase_particles(begin, end));
}

std::size_t ShapeMatching::bytes() const {
  std::size_t sum = groups_.bytes() + bytes_of(regions_);
  for (const Region& region : regions_) sum += bytes_of(region.rest, region.inverse_mass, region.mass);
  return sum;
}

}  // namespace souple
