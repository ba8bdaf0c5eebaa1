#include "souple/stages/balance.h"

#include "souple/objects/kind_functions.h"
#include "souple/objects/object.h"
#include "souple/solver/facets.h"
#include "souple/solver/kernels/projection.h"

#include <algorithm>
#include <cmath>
#include <functional>

namespace souple {
namespace {

constexpr std::size_t enough_samples = 512;
/// A constraint without compliance counts as one of this fraction of D = sum_i w_i |grad_i C|^2.
constexpr double stiffest = 1e-6;

constexpr double max_unbalanced = 0.25, max_stretch = 0.003, max_soft_body_stretch = 1e-4;
constexpr std::uint64_t flagged_after = 2;  // measurements

/// Every stride-th of `count` elements is chosen.
std::size_t stride_of(std::size_t count) {
  return std::max<std::size_t>(1, count / enough_samples);
}

bool is_elastic(const Object& object) {
  return functions_of(object.kind).add_elements != nullptr;
}

double norm(const Mat3d& m) {
  return std::sqrt(frobenius_squared(m));
}

/// y = alpha^-1 y, with alpha~ = alpha / h^2 as constraints are linearized.
template <int rows>
void apply_stiffness(const LinearConstraint& constraint, const ParticleView& view, double h2,
                     double (&y)[3]) {
  double alpha[rows * (rows + 1) / 2], b[rows];
  for (int r = 0, k = 0; r < rows; ++r) {
    b[r] = y[r];
    for (int s = 0; s <= r; ++s, ++k)
      alpha[k] = static_cast<double>(constraint.alpha[static_cast<std::size_t>(k)]);
    const std::size_t arity = constraint.particles.size();
    double D = 0;
    for (std::size_t i = 0; i < arity; ++i) {
      const Vec3f& gradient = constraint.gradient[static_cast<std::size_t>(r) * arity + i];
      D += static_cast<double>(view.inverse_mass(constraint.particles[i]) * dot(gradient, gradient));
    }
    alpha[k - 1] = std::max(alpha[k - 1], stiffest * D);
  }
  solve_symmetric<rows>(alpha, b);
  for (int r = 0; r < rows; ++r) y[r] = b[r] / h2;
}

void apply_stiffness(const LinearConstraint& constraint, const ParticleView& view, double h2,
                     double (&y)[3]) {
  if (constraint.C.size() == 1) return apply_stiffness<1>(constraint, view, h2, y);
  if (constraint.C.size() == 2) return apply_stiffness<2>(constraint, view, h2, y);
  apply_stiffness<3>(constraint, view, h2, y);
}

/// From E, F, the load and K; for a sleeping object the last measurement.
Imbalance imbalance_of(const Object& object, const Mat3d& elastic, const Mat3d& carried, double load,
                       double stiffness) {
  if (object.sleep.island != 0) return object.imbalance;
  const double force = norm(elastic - carried), all = norm(elastic) + norm(carried) + load;
  if (!(std::isfinite(force) && all > 0 && stiffness > 0)) return {};
  Imbalance result{.unbalanced = force / all, .stretch = force / stiffness};
  const double limit = object.traits().shape == ObjectShape::solid ? max_soft_body_stretch : max_stretch;
  if (result.unbalanced > max_unbalanced && result.stretch > limit)
    result.times_not_converged = object.imbalance.times_not_converged + 1;
  return result;
}

}  // namespace

void Balance::choose(const ObjectsView& objects, std::span<Projector* const> constraints) {
  parts_ = {};
  objects_.clear();
  elastic_.clear();
  for (std::uint32_t o = 0; o < objects.objects.size(); ++o) {
    const Object& object = *objects.objects[o];
    if (!is_elastic(object) || object.end == object.begin) continue;
    const auto number = static_cast<std::uint32_t>(objects_.size());
    Part& part = parts_[number % period];
    const std::size_t count = object.end - object.begin, stride = stride_of(count);
    const auto begin = static_cast<std::uint32_t>(part.particles.size());
    for (std::size_t i = object.begin + stride / 2; i < object.end; i += stride)
      part.particles.push_back(static_cast<std::uint32_t>(i));
    const auto end = static_cast<std::uint32_t>(part.particles.size());
    part.samples.push_back({number, begin, end, static_cast<double>(count) / (end - begin)});
    objects_.emplace_back().index = o;
  }
  for (Projector* projector : constraints) choose_constraints(objects, *projector);
}

void Balance::choose_constraints(const ObjectsView& objects, Projector& projector) {
  const LinearFacet* const linear = projector.facets().linear;
  if (linear == nullptr) return;
  std::vector<std::vector<std::uint32_t>> of_object(objects.objects.size());
  std::uint32_t number = 0;
  linear->linearize(objects.view(), {.h = 1}, [&](const LinearConstraint& constraint) {
    of_object[objects.object_of[constraint.particles[0]]].push_back(number++);
  });
  elastic_.push_back(&projector);
  for (Part& part : parts_) part.sets.emplace_back().linear = linear;
  for (std::uint32_t o = 0; o < objects_.size(); ++o) {
    const std::vector<std::uint32_t>& all = of_object[objects_[o].index];
    if (all.empty()) continue;
    Set& set = parts_[o % period].sets.back();
    const std::size_t stride = stride_of(all.size());
    const auto begin = static_cast<std::uint32_t>(set.constraints.size());
    for (std::size_t i = stride / 2; i < all.size(); i += stride) set.constraints.push_back(all[i]);
    const auto end = static_cast<std::uint32_t>(set.constraints.size());
    set.samples.push_back({o, begin, end, static_cast<double>(all.size()) / (end - begin)});
  }
}

void Balance::begin(std::uint64_t step, const ParticleView& view) {
  part_ = step % period;
  const std::vector<std::uint32_t>& particles = parts_[part_].particles;
  start_.resize(particles.size());
  for (std::size_t k = 0; k < particles.size(); ++k) start_[k] = view.moving[particles[k]].xyz();
  external_.begin(elastic_, particles);
}

Vec3d Balance::center_of(const ObjectsView& objects, const Samples& samples) const {
  const ParticleView view = objects.view();
  const Object& object = *objects.objects[objects_[samples.object].index];
  Vec3d sum{};
  for (const PinnedParticle& pin : object.pins) sum += view.exact_position(object.begin + pin.particle);
  if (!object.pins.empty()) return sum * (1 / static_cast<double>(object.pins.size()));
  for (std::uint32_t k = samples.begin; k < samples.end; ++k)
    sum += view.exact_position(parts_[part_].particles[k]);
  return sum * (1.0 / (samples.end - samples.begin));
}

void Balance::add_carried(const ObjectsView& objects, double gravity, double h) {
  const ParticleView view = objects.view();
  for (const Samples& samples : parts_[part_].samples) {
    Measured& sums = objects_[samples.object];
    sums.elastic = sums.carried = {};
    sums.stiffness = sums.load = 0;
    sums.center = center_of(objects, samples);
    for (std::uint32_t k = samples.begin; k < samples.end; ++k) {
      const std::uint32_t i = parts_[part_].particles[k];
      if (view.inverse_mass(i) == 0) continue;
      const double m = samples.weight / static_cast<double>(view.inverse_mass(i));
      const Vec3d u = view.exact_position(i) - sums.center;
      const Vec3d moved(view.moving[i].xyz() - start_[k] - external_.sums()[k]);
      sums.carried = sums.carried + outer(moved * (m / (h * h)), u);
      sums.load += m * gravity * length(u);
    }
  }
}

void Balance::add_elastic(const ParticleView& view, const Substep& substep, const Set& set) {
  const double h2 = static_cast<double>(substep.h) * static_cast<double>(substep.h);
  for (const Samples& samples : set.samples) {
    Measured& sums = objects_[samples.object];
    const auto add = [&](const LinearConstraint& constraint) {
      double y[3] = {}, rate[3] = {}, z[3] = {};  // C, grad C . u
      Mat3d gradients[3];                         // sum_i grad_i C u_i^T
      const std::size_t arity = constraint.particles.size(), rows = constraint.C.size();
      for (std::size_t r = 0; r < rows; ++r) {
        y[r] = static_cast<double>(constraint.C[r]);
        for (std::size_t i = 0; i < arity; ++i) {
          if (view.inverse_mass(constraint.particles[i]) == 0) continue;
          const Vec3d u = view.exact_position(constraint.particles[i]) - sums.center;
          const Vec3d gradient(constraint.gradient[r * arity + i]);
          gradients[r] = gradients[r] + outer(gradient, u);
          rate[r] += dot(gradient, u);
        }
        z[r] = rate[r];
      }
      apply_stiffness(constraint, view, h2, y);
      apply_stiffness(constraint, view, h2, z);
      for (std::size_t r = 0; r < rows; ++r) {
        sums.elastic = sums.elastic - gradients[r] * (samples.weight * y[r]);
        sums.stiffness += samples.weight * z[r] * rate[r];
      }
    };
    set.linear->linearize_some({&set.constraints[samples.begin], samples.end - samples.begin}, view, substep,
                               std::ref(add));  // a copy would allocate
  }
}

void Balance::measure(const ObjectsView& objects, double gravity, const Substep& substep) {
  const ParticleView view = objects.view();
  add_carried(objects, gravity, static_cast<double>(substep.h));
  for (const Set& set : parts_[part_].sets) add_elastic(view, substep, set);
  for (const Samples& samples : parts_[part_].samples) {
    const Measured& measured = objects_[samples.object];
    Object& object = *objects.objects[measured.index];
    object.imbalance =
        imbalance_of(object, measured.elastic, measured.carried, measured.load, measured.stiffness);
  }
}

std::optional<std::size_t> Balance::worst(const ObjectsView& objects) const {
  std::optional<std::size_t> worst;
  double most = 0;
  for (std::size_t k = 0; k < objects_.size(); ++k) {
    const Object& object = *objects.objects[objects_[k].index];
    if (object.sleep.island != 0 || object.imbalance.times_not_converged < flagged_after) continue;
    if (!worst || object.imbalance.stretch > most) worst = k, most = object.imbalance.stretch;
  }
  return worst;
}

}  // namespace souple
