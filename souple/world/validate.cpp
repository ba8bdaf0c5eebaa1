#include "souple/world/validate.h"

#include "souple/error.h"
#include "souple/objects/checks.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include <fmt/format.h>

namespace souple {
namespace {

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
  if (std::isfinite(range.low) && range.low >= 0 && range.high > range.low &&
      double(range.high) <= range::finite)
    return;
  throw Error(fmt::format("settings: fluid.foam.{} is from {:g} to {:g}, expected 0 <= low < high", name,
                          range.low, range.high));
}

void validate(const FoamParameters& f) {
  check_all("settings", {{"fluid.foam.max_particles", double(f.max_particles), 0, 1e8},
                         {"fluid.foam.trapped_air_rate", double(f.trapped_air_rate), 0, 1e6},
                         {"fluid.foam.wave_crest_rate", double(f.wave_crest_rate), 0, 1e6},
                         {"fluid.foam.longest_life", double(f.longest_life), 0, range::finite},
                         {"fluid.foam.buoyancy", double(f.buoyancy), 0, range::finite},
                         {"fluid.foam.drag", double(f.drag), range::positive, range::finite},
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
                         {"solver.relaxation", double(s.solver.relaxation), range::positive, 2, true},
                         {"solver.chebyshev", double(s.solver.chebyshev), 0, 1, true},
                         {"solver.colors", double(s.solver.colors), 0, 64},
                         {"drag", double(s.drag), 0, range::finite},
                         {"fluid.iterations", double(s.fluid.iterations), 0, 100},
                         {"fluid.tolerance", double(s.fluid.tolerance), 0, range::finite},
                         {"fluid.compressibility", double(s.fluid.compressibility), 0, range::finite},
                         {"fluid.artificial_pressure", double(s.fluid.artificial_pressure), 0, range::finite},
                         {"sleeping.speed", double(s.sleeping.speed), 0, range::finite},
                         {"sleeping.seconds", double(s.sleeping.seconds), range::positive, range::finite},
                         {"wind.gust", double(s.wind.gust), 0, 1},
                         {"wind.gust_period", double(s.wind.gust_period), range::positive, range::finite},
                         {"wind.air_density", double(s.wind.air_density), 0, range::finite}});
  require_finite("settings", "gravity", s.gravity);
  require_finite("settings", "wind.velocity", s.wind.velocity);
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
