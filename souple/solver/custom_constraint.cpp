#include "souple/solver/custom_constraint.h"

#include "souple/error.h"

#include <exception>

namespace souple {
namespace {

std::string label(const CustomConstraint& constraint) {
  return "custom constraint '" + constraint.name + "'";
}

ScalarSettings settings_of(const CustomConstraint& c) {
  return {c.sense, static_cast<double>(c.compliance), static_cast<double>(c.damping_time),
          static_cast<double>(c.stiffness)};
}

bool valid(const ScalarSettings& settings) {
  return settings.compliance >= 0 && std::isfinite(settings.compliance) && settings.damping_time >= 0 &&
         std::isfinite(settings.damping_time) && settings.stiffness >= 0 && settings.stiffness <= 1;
}

constexpr const char* expected_settings =
    ": expected compliance and damping_time finite and 0 or more, stiffness from 0 to 1";

}  // namespace

void CustomProjector::add(std::shared_ptr<CustomConstraint> constraint) {
  if (!constraint) throw Error("the custom constraint is null, expected an object");
  const std::string what = label(*constraint);
  if (!valid(settings_of(*constraint))) throw Error(what + expected_settings);
  const auto particles = constraint->particles();
  Item item;
  item.position.resize(particles.size());
  item.gradient.resize(particles.size());
  groups_.add(particles, what);
  concurrent_ = concurrent_ && constraint->concurrent;
  item.constraint = std::move(constraint);
  items_.push_back(std::move(item));
}

std::string CustomProjector::take_error() {
  std::string first;
  for (Item& item : items_) {
    if (first.empty()) first = item.error;
    item.error.clear();
  }
  return first;
}

// Returns whether C and gradient are usable.
bool CustomProjector::evaluate(Item& item, std::span<const std::uint32_t> group,
                               const ParticleView& particles, float& C) {
  std::string reason;
  try {
    if (!valid(settings_of(*item.constraint)))
      throw Error(std::string("invalid settings") + expected_settings);
    const Vec3f origin = item.constraint->origin();
    for (std::size_t k = 0; k < group.size(); ++k) {
      item.position[k] = particles.relative(group[k], origin);
      item.gradient[k] = {};
    }
    C = item.constraint->evaluate(item.position, item.gradient);
    bool finite = std::isfinite(C);
    for (const Vec3f& g : item.gradient) finite = finite && is_finite(g);
    if (finite) return true;
    reason = "C or its gradient is not finite";
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& e) {
    reason = e.what();
  } catch (...) {
    reason = "it threw an object that is not a std::exception";
  }
  if (item.error.empty()) item.error = label(*item.constraint) + ": " + reason;
  return false;
}

void CustomProjector::begin_substep(const ParticleView&, const Substep&) {
  for (Item& item : items_) item.multiplier = 0;
}

void CustomProjector::project_one(std::size_t i, const ParticleView& particles, const Substep& substep) {
  Item& item = items_[i];
  const auto group = groups_[i];
  float C = 0;
  if (!evaluate(item, group, particles, C)) return;
  const ScalarSettings settings = settings_of(*item.constraint);
  ScalarState state;
  state.C = static_cast<double>(C);
  for (std::size_t k = 0; k < group.size(); ++k) {
    const Vec3d gradient(item.gradient[k]);
    state.weighted_square += static_cast<double>(particles.inverse_mass(group[k])) * length_squared(gradient);
  }
  const ScalarStep step = project_scalar(state, settings, item.multiplier, substep);
  bool finite = true;
  for (std::size_t k = 0; k < group.size(); ++k) {
    const auto w = static_cast<double>(particles.inverse_mass(group[k]));
    item.gradient[k] = Vec3f(Vec3d(item.gradient[k]) * (w * step.factor));  // now the correction
    finite = finite && is_finite(item.gradient[k]);
  }
  if (!finite) {
    if (item.error.empty()) item.error = label(*item.constraint) + ": its correction is not finite";
    return;
  }
  if (substep.stores_multipliers()) item.multiplier += step.dlambda;
  for (std::size_t k = 0; k < group.size(); ++k)
    if (particles.inverse_mass(group[k]) > 0) particles.correct(group[k], item.gradient[k]);
}

void CustomProjector::damp_one(std::size_t i, const ParticleView& particles, std::span<Vec4f> velocity,
                               const Substep& substep) {
  Item& item = items_[i];
  const ScalarSettings settings = settings_of(*item.constraint);
  float C = 0;
  if (!(settings.damping_time > 0) || !evaluate(item, groups_[i], particles, C)) return;
  const auto group = groups_[i];
  ScalarState state{static_cast<double>(C)};
  double rate = 0;
  for (std::size_t k = 0; k < group.size(); ++k) {
    const Vec3d gradient(item.gradient[k]);
    state.weighted_square += static_cast<double>(particles.inverse_mass(group[k])) * length_squared(gradient);
    rate += dot(gradient, Vec3d(velocity[group[k]].xyz()));
  }
  const double dlambda = damp_scalar(state, rate, settings, substep);
  if (!std::isfinite(dlambda)) return;
  for (std::size_t k = 0; k < group.size(); ++k)
    add_velocity(velocity[group[k]],
                 Vec3d(item.gradient[k]) * (static_cast<double>(particles.inverse_mass(group[k])) * dlambda));
}

Residual CustomProjector::residual(const ParticleView& particles, Threads*) const {
  Residual result;
  for (std::size_t i = 0; i < items_.size(); ++i) {
    float C = 0;
    if (!evaluate(items_[i], groups_[i], particles, C)) continue;
    add_to_residual(result, settings_of(*items_[i].constraint), static_cast<double>(C));
  }
  return result;
}

void CustomProjector::visit(const ParticleView& particles, const ConstraintVisitor& visitor) const {
  groups_.for_each([&](std::uint32_t i, int color) {
    Item& item = items_[i];
    const std::string error = item.error;  // visiting records no error
    float C = 0;
    if (!evaluate(item, groups_[i], particles, C)) C = 0;
    item.error = error;
    const double violation = violation_of(settings_of(*item.constraint), static_cast<double>(C));
    visitor({groups_[i], color, 0, static_cast<float>(violation)});
  });
}

void CustomProjector::erase_particles(std::uint32_t begin, std::uint32_t end) {
  keep_only(items_, groups_.erase_particles(begin, end));
}

}  // namespace souple
