// Souple and Bullet in one run, at equal quality.
//
//   beside_bullet [--quick]   --quick: a small cloth and few frames, to try the program itself
//
// For each engine, the cheapest setting with which the benchmark `cloth` keeps its largest strain within a bound. A cloth that
// hangs at rest has 2 % during the last second. A pushed cloth has 5 % in each frame but the first two. The engines with these
// settings are then timed in turn, Souple with one thread and with two. An engine that does not stay within the bound
// appears with the setting that comes nearest. Prints JSON, and the trials as they end to the standard error.

#include "app/bench_scenes.h"
#include "benchmarks/bullet.h"
#include "souple/geometry/measures.h"
#include "souple/scene/json.h"
#include "souple/simd/instruction_set.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <utility>

namespace souple::peers {
namespace {

constexpr double frame = 1.0 / 60;  // s

struct Options {
  int size = 200;     ///< vertices along a side of the cloth
  int frames = 240;   ///< of a trial
  int longest = 250;  ///< settings that take longer per frame are not tried [ms]
};

class SoupleEngine final : public PeerEngine {
 public:
  explicit SoupleEngine(World world) : world_(std::move(world)) {}
  void step(double dt) override { world_.step(dt); }
  std::vector<Vec3d> positions() const override {
    const auto x = world_.positions(world_.objects()[0]);
    return {x.begin(), x.end()};
  }

 private:
  World world_;
};

World cloth_world(int size, const Settings& settings) {
  World world(settings);
  app::find_bench_scene("cloth").build(world, size);
  return world;
}

/// The benchmark `cloth`: distances along edges and across them, upper row pinned, pushed.
PeerScene cloth_scene(int size) {
  const TriangleMesh mesh = app::hanging_grid(size);
  const World world = cloth_world(size, {});
  const ObjectId cloth = world.objects()[0];
  PeerScene scene;
  scene.positions = mesh.positions;
  scene.masses = lumped_masses(mesh.positions, mesh.triangles, double(ClothMaterial{}.areal_density));
  for (const std::uint32_t i : world.pinned(cloth)) scene.masses[i] = 0;
  scene.links = unique_edges(mesh.triangles);
  for (const Hinge& hinge : interior_edges(mesh.triangles)) scene.links.push_back({hinge[2], hinge[3]});
  scene.velocity = Vec3d(world.velocities(cloth).back());
  return scene;
}

/// Largest relative extension of a link.
double largest_strain(const PeerScene& scene, const std::vector<Vec3d>& now) {
  double largest = 0;
  for (const Edge& link : scene.links) {
    const double rest = length(scene.positions[link[0]] - scene.positions[link[1]]);
    largest = std::max(largest, length(now[link[0]] - now[link[1]]) / rest - 1);
  }
  return largest;
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

/// Simulates frames of 1/60 s on all engines in turn, another one first in each frame. A slow phase of the machine then
/// affects all of them. Returns the median time of each. [ms]
std::vector<double> simulate(std::span<const std::unique_ptr<PeerEngine>> engines, int frames) {
  std::vector<std::vector<double>> milliseconds(engines.size());
  constexpr int warm_up = 2;
  for (int f = 0; f < frames; ++f)
    for (std::size_t k = 0; k < engines.size(); ++k) {
      const std::size_t engine = (k + static_cast<std::size_t>(f)) % engines.size();
      const auto start = std::chrono::steady_clock::now();
      engines[engine]->step(frame);
      const std::chrono::duration<double, std::milli> spent = std::chrono::steady_clock::now() - start;
      if (f >= warm_up || frames <= warm_up) milliseconds[engine].push_back(spent.count());
    }
  std::vector<double> result;
  result.reserve(milliseconds.size());
  for (const std::vector<double>& one : milliseconds) result.push_back(median(one));
  return result;
}

using scene_format::Json;

struct Motion {
  const char* name;
  bool pushed;
  double bound;
};
constexpr Motion motions[] = {{"hanging", false, 0.02}, {"swinging", true, 0.05}};

/// An engine with one number to choose: the substeps of a frame, or the iterations of its only substep.
struct Family {
  const char* name;
  bool threaded, chooses_iterations;
  std::unique_ptr<PeerEngine> (*make)(const PeerScene& scene, int size, const Motion& motion, int setting,
                                      int threads);

  std::string describe(int setting) const {
    const std::string number = std::to_string(setting);
    return chooses_iterations ? "1 x " + number : number + " x 1";
  }
};

std::unique_ptr<PeerEngine> souple(SolverKind solver, int size, const Motion& motion, int substeps,
                                   int threads) {
  Settings settings;
  settings.substeps = substeps;
  settings.threads = threads;
  settings.measure_residuals = false;
  settings.solver.kind = solver;
  World world = cloth_world(size, settings);
  const ObjectId cloth = world.objects()[0];
  if (!motion.pushed) world.set_velocities(cloth, std::vector<Vec3f>(world.positions(cloth).size()));
  return std::make_unique<SoupleEngine>(std::move(world));
}

constexpr Family families[] = {
    {"Souple, automatic", true, false,
     [](const PeerScene&, int size, const Motion& motion, int setting, int threads) {
       return souple(SolverKind::automatic, size, motion, setting, threads);
     }},
    {"Souple, gauss_seidel", true, false,
     [](const PeerScene&, int size, const Motion& motion, int setting, int threads) {
       return souple(SolverKind::gauss_seidel, size, motion, setting, threads);
     }},
    {"Bullet", false, false,
     [](const PeerScene& scene, int, const Motion&, int setting, int) {
       return make_bullet(scene, setting, 1);
     }},
    {"Bullet, one step a frame", false, true,
     [](const PeerScene& scene, int, const Motion&, int setting, int) {
       return make_bullet(scene, 1, setting);
     }}};

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
                                 int setting, const Options& options) {
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
    if (f == probe && median(milliseconds) > options.longest) return std::nullopt;
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
Trial search(const Family& family, const PeerScene& scene, const Motion& motion, const Options& options) {
  Trial best;
  for (const int setting : settings_to_try) {
    const std::optional<Trial> trial = try_setting(family, scene, motion, setting, options);
    if (!trial) break;
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

void compare(const Motion& motion, PeerScene scene, const Options& options, Json& list) {
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
    list.items.push_back(row_json(motion, contestants[k], milliseconds[k], ratio));
  }
}

void run(const Options& options) {
  const PeerScene scene = cloth_scene(options.size);
  Json result = Json::object(), list = Json::array();
  for (const Motion& motion : motions) compare(motion, scene, options, list);
  result.set("size", Json::whole(options.size));
  result.set("simd", Json::of(std::string(simd_name())));
  result.set("rows", std::move(list));
  std::fputs(dump_json(result).c_str(), stdout);
}

}  // namespace
}  // namespace souple::peers

int main(int argc, char** argv) {
  const bool quick = argc > 1 && std::string(argv[1]) == "--quick";
  souple::peers::run(quick ? souple::peers::Options{30, 80, 30} : souple::peers::Options{});
}
