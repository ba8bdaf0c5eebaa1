#include "souple/world/validate.h"

#include "souple/error.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include <fmt/format.h>

namespace souple {
namespace {

/// A field and its valid range; `hi` is excluded if `open`.
struct Check {
  const char* field;
  double value, lo, hi;
  bool open = false;
};

constexpr double any = 1e30;
constexpr double infinite = std::numeric_limits<double>::infinity();

void check_all(std::string_view owner, std::initializer_list<Check> checks) {
  for (const Check& check : checks) {
    const bool below = check.open ? check.value < check.hi : check.value <= check.hi;
    if (check.value >= check.lo && below) continue;
    throw Error(fmt::format("{}: {} is {:g}, expected a number from {:g} to {}{:g}", owner, check.field,
                            check.value, check.lo, check.open ? "below " : "", check.hi));
  }
}

void require_finite(std::string_view owner, const char* field, const Vec3f& v) {
  if (!is_finite(v))
    throw Error(
        fmt::format("{}: {} is ({:g}, {:g}, {:g}), expected finite numbers", owner, field, v.x, v.y, v.z));
}

constexpr double min_positive = 1e-30;

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t above = row[j];
      row[j] = std::min({above + 1, row[j - 1] + 1, diagonal + (a[i - 1] == b[j - 1] ? 0 : 1)});
      diagonal = above;
    }
  }
  return row.back();
}

}  // namespace

namespace {

void check_range(const char* name, const FoamRange& range) {
  if (std::isfinite(range.low) && range.low >= 0 && range.high > range.low && double(range.high) <= any)
    return;
  throw Error(fmt::format("settings: fluid.foam.{} is from {:g} to {:g}, expected 0 <= low < high", name,
                          range.low, range.high));
}

void validate(const FoamParameters& f) {
  check_all("settings", {{"fluid.foam.max_particles", double(f.max_particles), 0, 1e8},
                         {"fluid.foam.trapped_air_rate", double(f.trapped_air_rate), 0, 1e6},
                         {"fluid.foam.wave_crest_rate", double(f.wave_crest_rate), 0, 1e6},
                         {"fluid.foam.longest_life", double(f.longest_life), 0, any},
                         {"fluid.foam.buoyancy", double(f.buoyancy), 0, any},
                         {"fluid.foam.drag", double(f.drag), min_positive, any},
                         {"fluid.foam.spray_neighbors", double(f.spray_neighbors), 0, 1000},
                         {"fluid.foam.bubble_neighbors", double(f.bubble_neighbors), 0, 1000}});
  check_range("trapped_air", f.trapped_air);
  check_range("wave_crest", f.wave_crest);
  check_range("energy", f.energy);
  check_range("life", f.life);
}

}  // namespace

void validate(const Settings& s) {
  validate(s.fluid.foam);
  check_all("settings", {{"substeps", double(s.substeps), 1, 100000},
                         {"iterations", double(s.iterations), 1, 100000},
                         {"threads", double(s.threads), 0, 1024},
                         {"solver.relaxation", double(s.solver.relaxation), min_positive, 2, true},
                         {"solver.chebyshev", double(s.solver.chebyshev), 0, 1, true},
                         {"solver.colors", double(s.solver.colors), 0, 64},
                         {"drag", double(s.drag), 0, any},
                         {"fluid.iterations", double(s.fluid.iterations), 0, 100},
                         {"fluid.tolerance", double(s.fluid.tolerance), 0, any},
                         {"fluid.compressibility", double(s.fluid.compressibility), 0, any},
                         {"fluid.artificial_pressure", double(s.fluid.artificial_pressure), 0, any},
                         {"sleeping.speed", double(s.sleeping.speed), 0, any},
                         {"sleeping.seconds", double(s.sleeping.seconds), min_positive, any},
                         {"wind.gust", double(s.wind.gust), 0, 1},
                         {"wind.gust_period", double(s.wind.gust_period), min_positive, any},
                         {"wind.air_density", double(s.wind.air_density), 0, any}});
  require_finite("settings", "gravity", s.gravity);
  require_finite("settings", "wind.velocity", s.wind.velocity);
}

void validate(const Transform& t, std::string_view owner) {
  const double q = std::sqrt(t.rotation.x * t.rotation.x + t.rotation.y * t.rotation.y +
                             t.rotation.z * t.rotation.z + t.rotation.w * t.rotation.w);
  check_all(owner, {{"transform's scale", t.scale, min_positive, any},
                    {"length of the rotation quaternion", q, 0.999, 1.001}});
  if (!is_finite(t.translation)) throw Error(fmt::format("{}: the translation is not finite", owner));
}

template <class Material>
double kinetic_friction_of(const Material& m) {
  return double(m.kinetic_friction.value_or(m.friction));
}

void validate(const ClothMaterial& m, std::string_view owner) {
  check_all(owner, {{"areal_density", double(m.areal_density), min_positive, any},
                    {"membrane_stiffness", double(m.membrane_stiffness), 0,
                     m.stretch == StretchModel::springs ? infinite : any},
                    {"weft_stiffness", double(m.weft_stiffness), 0, any},
                    {"shear_stiffness", double(m.shear_stiffness), 0, any},
                    {"poisson_ratio", double(m.poisson_ratio), 0, 1, true},
                    {"bending_stiffness", double(m.bending_stiffness), 0,
                     m.bending == BendingModel::distance ? infinite : any},
                    {"thickness", double(m.thickness), 0, any},
                    {"friction", double(m.friction), 0, any},
                    {"kinetic_friction", kinetic_friction_of(m), 0, double(m.friction)},
                    {"restitution", double(m.restitution), 0, 1},
                    {"damping_time", double(m.damping_time), 0, any},
                    {"damping", double(m.damping), 0, any},
                    {"air_drag", double(m.air_drag), 0, any},
                    {"air_lift", double(m.air_lift), 0, any},
                    {"pbd_stretch", double(m.pbd_stretch), 0, 1},
                    {"pbd_bending", double(m.pbd_bending), 0, 1}});
}

void validate(const SoftBodyMaterial& m, std::string_view owner) {
  check_all(owner, {{"young_modulus", double(m.young_modulus), min_positive, any},
                    {"poisson_ratio", double(m.poisson_ratio), 0, 0.5, true},
                    {"density", double(m.density), min_positive, any},
                    {"thickness", double(m.thickness), 0, any},
                    {"friction", double(m.friction), 0, any},
                    {"kinetic_friction", kinetic_friction_of(m), 0, double(m.friction)},
                    {"restitution", double(m.restitution), 0, 1},
                    {"damping_time", double(m.damping_time), 0, any},
                    {"damping", double(m.damping), 0, any},
                    {"pbd_stiffness", double(m.pbd_stiffness), 0, 1}});
}

void validate(const RopeMaterial& m, std::string_view owner) {
  check_all(owner, {{"radius", double(m.radius), min_positive, any},
                    {"young_modulus", double(m.young_modulus), min_positive, any},
                    {"density", double(m.density), min_positive, any},
                    {"bending_stiffness", double(m.bending_stiffness), 0, any},
                    {"friction", double(m.friction), 0, any},
                    {"kinetic_friction", kinetic_friction_of(m), 0, double(m.friction)},
                    {"restitution", double(m.restitution), 0, 1},
                    {"damping_time", double(m.damping_time), 0, any},
                    {"damping", double(m.damping), 0, any},
                    {"pbd_stretch", double(m.pbd_stretch), 0, 1},
                    {"pbd_bending", double(m.pbd_bending), 0, 1}});
}

void validate(const GrainsMaterial& m, std::string_view owner) {
  check_all(owner, {{"radius", double(m.radius), min_positive, any},
                    {"density", double(m.density), min_positive, any},
                    {"friction", double(m.friction), 0, any},
                    {"kinetic_friction", kinetic_friction_of(m), 0, double(m.friction)},
                    {"rolling_friction", double(m.rolling_friction), 0, any},
                    {"restitution", double(m.restitution), 0, 1},
                    {"damping", double(m.damping), 0, any}});
}

void validate(const FluidMaterial& m, std::string_view owner) {
  check_all(owner, {{"spacing", double(m.spacing), min_positive, any},
                    {"density", double(m.density), min_positive, any},
                    {"viscosity", double(m.viscosity), 0, any},
                    {"xsph", double(m.xsph), 0, any},
                    {"surface_tension", double(m.surface_tension), 0, any},
                    {"contact_angle", double(m.contact_angle), 0, 180},
                    {"vorticity", double(m.vorticity), 0, any},
                    {"air_drag", double(m.air_drag), 0, any},
                    {"foam", double(m.foam), 0, 1000},
                    {"friction", double(m.friction), 0, 1},
                    {"restitution", double(m.restitution), 0, 1}});
}

void validate(const ObstacleMaterial& m, std::string_view owner) {
  check_all(owner, {{"thickness", double(m.thickness), 0, any},
                    {"friction", double(m.friction), 0, any},
                    {"kinetic_friction", kinetic_friction_of(m), 0, double(m.friction)},
                    {"restitution", double(m.restitution), 0, 1}});
}

std::string nearest_name(std::string_view name, std::span<const std::string_view> names) {
  std::string_view nearest;
  std::size_t best = std::max<std::size_t>(2, name.size() / 2) + 1;
  for (const std::string_view candidate : names) {
    const std::size_t distance = edit_distance(name, candidate);
    if (distance < best) best = distance, nearest = candidate;
  }
  if (!nearest.empty()) return fmt::format("; did you mean '{}'?", nearest);
  if (names.empty()) return "; there is none";
  return names.size() > 20 ? std::string() : fmt::format("; there are: {}", fmt::join(names, ", "));
}

}  // namespace souple
