#include "souple/world/validate.h"

#include "souple/error.h"
#include "souple/objects/checks.h"

#include <cmath>

#include <fmt/format.h>

namespace souple {
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
  check_all("settings", {{"mode", double(s.mode), 0, double(Mode::pbd)},
                         {"integrator", double(s.integrator), 0, double(Integrator::implicit_euler)},
                         {"solver.kind", double(s.solver.kind), 0, double(SolverKind::hierarchical)},
                         {"solver.sweep", double(s.solver.sweep), 0, double(Sweep::symmetric)},
                         {"fluid.kernel", double(s.fluid.kernel), 0, double(SmoothingShape::wide_wendland)},
                         {"detection", double(s.detection), 0, double(Detection::discrete)},
                         {"segment_test", double(s.segment_test), 0, double(SegmentTest::watertight)},
                         {"threading", double(s.threading), 0, double(Threading::tbb)},
                         {"substeps", double(s.substeps), 1, 100000},
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

}  // namespace souple
