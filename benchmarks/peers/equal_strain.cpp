#include "benchmarks/peers/equal_strain.h"

#include "benchmarks/peers/peer_scene.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>

namespace souple::peers {
namespace {

using scene_format::Json;

struct Motion {
  const char* name;
  bool pushed;
  double bound;
};
constexpr Motion motions[] = {{"hanging", false, 0.02}, {"swinging", true, 0.05}};

/// An engine with one number to choose.
struct Family {
  const char* name;
  bool threaded;
  std::unique_ptr<PeerEngine> (*make)(const PeerScene& scene, int size, const Motion& motion, int setting,
                                      int threads);
  std::string (*describe)(int setting);
};

std::unique_ptr<PeerEngine> souple(SolverKind solver, int size, const Motion& motion, int substeps,
                                   int threads) {
  Settings settings;
  settings.substeps = substeps;
  settings.threads = threads;
  settings.measure_residuals = false;
  settings.solver.kind = solver;
  return make_souple_cloth(size, settings, motion.pushed, "");
}

std::string times_one(int setting) {
  return std::to_string(setting) + " x 1";
}

constexpr Family families[] = {
    {"Souple, automatic", true,
     [](const PeerScene&, int size, const Motion& motion, int setting, int threads) {
       return souple(SolverKind::automatic, size, motion, setting, threads);
     },
     times_one},
    {"Souple, gauss_seidel", true,
     [](const PeerScene&, int size, const Motion& motion, int setting, int threads) {
       return souple(SolverKind::gauss_seidel, size, motion, setting, threads);
     },
     times_one},
    {"Bullet", false,
     [](const PeerScene& scene, int, const Motion&, int setting, int) {
       return make_bullet(scene, setting, 1);
     },
     times_one},
    {"Bullet, one step a frame", false,
     [](const PeerScene& scene, int, const Motion&, int setting, int) {
       return make_bullet(scene, 1, setting);
     },
     [](int setting) { return "1 x " + std::to_string(setting); }}};

constexpr int settings_to_try[] = {1, 2, 3, 4, 6, 8, 10, 12, 16, 20, 30, 40, 60, 80, 120, 160, 240, 320};
/// A trial ends when its strain is this many times the bound: the setting is hopeless.
constexpr double hopeless = 4;

struct Trial {
  int setting = 0;
  double milliseconds = 0;  ///< a frame
  double strain = std::numeric_limits<double>::infinity();
  bool within_bound = false;
};

/// Simulates until the strain is hopeless. Nothing if a frame takes too long.
std::optional<Trial> try_setting(const Family& family, const PeerScene& scene, const Motion& motion,
                                 int setting, const EqualStrainOptions& options) {
  const std::unique_ptr<PeerEngine> engine = family.make(scene, options.size, motion, setting, 2);
  constexpr int warm_up = 2, probe = 5;
  const int last_second = std::max(options.frames - 60, warm_up);
  Trial trial{setting};
  double strain = 0;
  std::vector<double> milliseconds;
  for (int f = 0; f < options.frames; ++f) {
    const auto start = std::chrono::steady_clock::now();
    engine->step(frame);
    const std::chrono::duration<double, std::milli> spent = std::chrono::steady_clock::now() - start;
    if (f >= 1) milliseconds.push_back(spent.count());
    if (f == probe && median(milliseconds) > options.max_milliseconds) return std::nullopt;
    if (f < warm_up) continue;
    const double now = largest_strain(scene, engine->positions());
    if (motion.pushed || f >= last_second || !(now <= hopeless * motion.bound))
      strain = std::isfinite(now) ? std::max(strain, now) : std::numeric_limits<double>::infinity();
    if (!(strain <= hopeless * motion.bound)) break;
  }
  trial.milliseconds = median(milliseconds);
  trial.strain = strain;
  trial.within_bound = strain <= motion.bound;
  return trial;
}

/// The cheapest setting within the bound, or the one that comes nearest to it.
Trial search(const Family& family, const PeerScene& scene, const Motion& motion,
             const EqualStrainOptions& options) {
  Trial best;
  for (const int setting : settings_to_try) {
    const std::optional<Trial> trial = try_setting(family, scene, motion, setting, options);
    if (!trial) break;
    if (options.prints)
      std::fprintf(stderr, "  %-9s %-26s %8s  %9.2f ms  %8.3g %%\n", motion.name, family.name,
                   family.describe(setting).c_str(), trial->milliseconds, 100 * trial->strain);
    if (best.setting == 0 || trial->strain <= best.strain) best = *trial;
    if (trial->within_bound) break;
  }
  return best;
}

/// A family with the setting found, and threads: one row of the table.
struct Contestant {
  const Family* family;
  Trial trial;
  int threads;
};

Json row_json(const Motion& motion, const Contestant& contestant, double milliseconds, double ratio) {
  Json row = Json::object();
  row.set("motion", Json::of(std::string(motion.name)));
  row.set("bound", Json::of(static_cast<float>(motion.bound)));
  row.set("engine", Json::of(std::string(contestant.family->name)));
  row.set("threads", Json::whole(contestant.threads));
  row.set("setting", Json::of(contestant.family->describe(contestant.trial.setting)));
  row.set("ms_per_frame", Json::of(static_cast<float>(milliseconds)));
  row.set("ratio", Json::of(static_cast<float>(ratio)));
  const double strain = contestant.trial.strain;
  row.set("largest_strain", std::isfinite(strain) ? Json::of(static_cast<float>(strain)) : Json{});
  row.set("within_bound", Json::of(contestant.trial.within_bound));
  return row;
}

void print_row(const Motion& motion, const Contestant& contestant, double milliseconds, double ratio) {
  std::printf("%-9s %-26s %d threads %8s %10.2f ms %8.2f %10.3g %%%s\n", motion.name, contestant.family->name,
              contestant.threads, contestant.family->describe(contestant.trial.setting).c_str(), milliseconds,
              ratio, 100 * contestant.trial.strain, contestant.trial.within_bound ? "" : ": above the bound");
}

void compare(const Motion& motion, PeerScene scene, const EqualStrainOptions& options, Json& list) {
  if (!motion.pushed) scene.velocity = {};
  std::vector<Contestant> contestants;
  for (const Family& family : families) {
    const Trial trial = search(family, scene, motion, options);
    if (trial.setting == 0) continue;  // even one substep takes too long
    for (const int threads : {1, 2})
      if (family.threaded || threads == 1) contestants.push_back({&family, trial, threads});
  }
  std::vector<std::unique_ptr<PeerEngine>> engines;
  engines.reserve(contestants.size());
  for (const Contestant& c : contestants)
    engines.push_back(c.family->make(scene, options.size, motion, c.trial.setting, c.threads));
  const std::vector<double> milliseconds = simulate(engines, std::min(options.frames, 30));
  for (std::size_t k = 0; k < contestants.size(); ++k) {
    const double ratio = milliseconds[k] / milliseconds[0];
    if (options.prints) print_row(motion, contestants[k], milliseconds[k], ratio);
    list.items.push_back(row_json(motion, contestants[k], milliseconds[k], ratio));
  }
}

}  // namespace

scene_format::Json compare_at_equal_strain(const EqualStrainOptions& options) {
  const PeerScene scene = cloth_scene(options.size);
  Json list = Json::array();
  for (const Motion& motion : motions) compare(motion, scene, options, list);
  return list;
}

}  // namespace souple::peers
