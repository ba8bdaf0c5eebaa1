// Cost of a simulated second at equal error: constraints of this engine beside the same energies as forces, integrated
// explicitly and implicitly. Cloth of springs, and a bar of tets, in motion and at rest.
//
//   equal_error [--quick] [--engine]
//
// For each method the steps of a frame of 1/60 s grow until its error is below 1 % twice in a row and the cost grows.
// They also stop growing when a second takes longer than 1 s. Errors relative to the same discrete model, converged in
// double precision:
//   motion: sqrt(mean |x - x_converged|^2 / mean |x_converged - x_start|^2), over particles and frames of 1 s;
//   rest:   |drop of the end - that of static equilibrium|, relative to it, after 3 s with drag.
// Costs are processor time of one thread, the median of three rounds over all methods in turn. Methods that take more
// than 0.3 s a second run once. --engine: the engine alone, for other instruction sets (SOUPLE_SIMD). Prints JSON.

#include "benchmarks/elastic_scenes.h"
#include "souple/simd/instruction_set.h"

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace souple::benchmarks {
namespace {

constexpr double dt = 1.0 / 60;
constexpr int ladder[] = {1,  2,  3,   4,   6,   8,   12,  16,  24,   32,  48,
                          64, 96, 128, 192, 256, 384, 512, 768, 1024, 1536};
constexpr double good_enough = 0.01, longest = 1;  // s per simulated second
bool quick = false, engine_only = false, first = true;

double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + static_cast<double>(now.tv_nsec) * 1e-9;
}

/// Positions after each frame.
using Frames = std::vector<std::vector<Vec3d>>;

struct Run {
  Frames frames;       // of motion; at rest the last one only
  double seconds = 0;  // of processor time
  bool finite = true;
};

struct Point {
  int steps = 0;  // per frame
  double error = 0;
  std::vector<double> costs;  // s per simulated second
};

struct Contender {
  std::string name;
  std::function<Run(int steps)> run;
  std::vector<Point> points;
};

void keep(Run& run, bool all, std::vector<Vec3d> x) {
  if (!all) run.frames.clear();
  run.frames.push_back(std::move(x));
}

template <class Scene>
Run run_model(const Scene& scene, Method method, LinearSolver solver, int frames, bool all, int steps) {
  ElasticModel model(scene.mesh(), scene.material());
  start(scene, model);
  Run run;
  for (int frame = 0; frame < frames && run.finite; ++frame) {
    const double begin = cpu_seconds();
    for (int i = 0; i < steps; ++i) model.step(method, dt / steps, solver);
    run.seconds += cpu_seconds() - begin;
    run.finite = model.is_finite();
    keep(run, all, model.x);
  }
  return run;
}

template <class Scene>
Run run_world(const Scene& scene, SolverKind solver, int frames, bool all, int substeps) {
  World world({.substeps = substeps,
               .drag = scene.drag,
               .measure_residuals = false,
               .solver = {.kind = solver},
               .threads = 1});
  const ObjectId object = start(scene, world);
  Run run;
  for (int frame = 0; frame < frames && run.finite; ++frame) {
    const double begin = cpu_seconds();
    run.finite = world.step(dt).ok();
    run.seconds += cpu_seconds() - begin;
    const auto x = world.positions(object);
    keep(run, all, {x.begin(), x.end()});
  }
  return run;
}

// Newton's method with pseudo time steps.
template <class Scene>
std::vector<Vec3d> equilibrium(const Scene& scene) {
  ElasticModel model(scene.mesh(), scene.material());
  start(scene, model);
  model.drag = 20;
  for (int i = 0; i < 200; ++i) model.step(Method::implicit_euler, dt, LinearSolver::ldlt);
  for (int i = 0; i < 200; ++i) model.step(Method::implicit_euler, 1, LinearSolver::ldlt);
  return model.x;
}

template <class Scene>
double error_of(const Scene& scene, const Run& run, const Frames& converged) {
  if (!run.finite || run.frames.size() != converged.size()) return HUGE_VAL;
  if (converged.size() == 1) {
    const double drop = end_height(scene, converged[0]);
    return std::fabs(end_height(scene, run.frames[0]) / drop - 1);
  }
  const auto rest = scene.mesh().positions;
  double difference = 0, motion = 0;
  for (std::size_t f = 0; f < converged.size(); ++f)
    for (std::size_t i = 0; i < rest.size(); ++i) {
      difference += length_squared(run.frames[f][i] - converged[f][i]);
      motion += length_squared(converged[f][i] - rest[i]);
    }
  return std::sqrt(difference / motion);
}

template <class Scene>
std::vector<Contender> contenders(const Scene& scene, int frames, bool all) {
  std::vector<Contender> result;
  const auto add = [&](const char* name, Method method, LinearSolver solver) {
    if (engine_only) return;
    result.push_back(
        {name, [=](int steps) { return run_model(scene, method, solver, frames, all, steps); }, {}});
  };
  add("forces, semi-implicit", Method::semi_implicit, {});
  add("forces, implicit, conjugate gradients", Method::implicit_euler, LinearSolver::conjugate_gradient);
  add("forces, implicit, factorized", Method::implicit_euler, LinearSolver::ldlt);
  add("forces, implicit midpoint, factorized", Method::implicit_midpoint, LinearSolver::ldlt);
  const auto engine = [&](const std::string& name, SolverKind solver) {
    result.push_back({name + ", " + std::string(simd_name()),
                      [=](int steps) { return run_world(scene, solver, frames, all, steps); },
                      {}});
  };
  engine("constraints, Gauss-Seidel", SolverKind::gauss_seidel);
  engine("constraints, automatic", SolverKind::automatic);
  return result;
}

// The ladder of one contender: errors, and the cost of a first round.
template <class Scene>
void climb(const Scene& scene, const Frames& converged, double seconds, Contender& contender) {
  int accurate = 0;
  double cheapest = HUGE_VAL;
  for (const int steps : ladder) {
    const Run run = contender.run(steps);
    const double cost = run.seconds / seconds;
    contender.points.push_back({steps, error_of(scene, run, converged), {cost}});
    std::fprintf(stderr, "  %-50s %5d %10.4g %10.4g ms\n", contender.name.c_str(), steps,
                 contender.points.back().error, 1e3 * cost);
    accurate = contender.points.back().error < good_enough ? accurate + 1 : 0;
    if (accurate > 0) cheapest = std::min(cheapest, cost);
    // More steps may cost less: the solver then sweeps less in each.
    if (cost > longest || (accurate >= 2 && cost > 1.3 * cheapest)) break;
  }
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

// The cheapest number of steps for which the error, and that of all higher numbers, is within `bound`.
const Point* cheapest_within(const Contender& contender, double bound) {
  const Point* found = nullptr;
  for (auto point = contender.points.rbegin(); point != contender.points.rend() && point->error <= bound;
       ++point)
    if (found == nullptr || median(point->costs) < median(found->costs)) found = &*point;
  return found;
}

void print(const Contender& contender) {
  std::printf("\n  {\"name\": \"%s\"", contender.name.c_str());
  for (const auto& [key, bound] : {std::pair{"within_5", 0.05}, std::pair{"within_2", 0.02}})
    if (const Point* const point = cheapest_within(contender, bound))
      std::printf(", \"%s\": {\"steps\": %d, \"ms\": %.4g}", key, point->steps, 1e3 * median(point->costs));
  std::printf(", \"points\": [");
  bool next = false;
  for (const Point& point : contender.points) {
    if (!std::isfinite(point.error)) continue;
    std::printf("%s{\"steps\": %d, \"error\": %.4g, \"ms\": %.4g}", next ? ", " : "", point.steps,
                point.error, 1e3 * median(point.costs));
    next = true;
  }
  std::printf("]}");
}

// Steps a frame of the converged motion: eight times as many as explicit forces need to be stable.
template <class Scene>
int converged_steps(const Scene& scene) {
  int steps = 16;
  while (!run_model(scene, Method::semi_implicit, {}, 6, false, steps).finite) steps += steps / 4;
  return std::max(512, 8 * steps);
}

template <class Scene>
void compare(const char* name, double stiffness, const Scene& scene, bool in_motion) {
  const int frames = in_motion ? 60 : 180;
  std::fprintf(stderr, "%s, %g\n", name, stiffness);
  const Frames converged =
      in_motion ? run_model(scene, Method::semi_implicit, {}, frames, true, converged_steps(scene)).frames
                : Frames{equilibrium(scene)};
  std::fprintf(stderr, "  end at %.6f m\n", end_height(scene, converged.back()));
  std::vector<Contender> all = contenders(scene, frames, in_motion);
  for (Contender& one : all) climb(scene, converged, frames * dt, one);
  for (int round = 0; round < (quick ? 0 : 2); ++round)
    for (Contender& one : all)
      for (Point& point : one.points)
        if (std::isfinite(point.error) && point.costs[0] < 0.3)
          point.costs.push_back(one.run(point.steps).seconds / (frames * dt));
  std::printf("%s\n {\"case\": \"%s\", \"stiffness\": %g, \"methods\": [", first ? "" : ",", name, stiffness);
  first = false;
  for (const Contender& one : all) {
    print(one);
    if (&one != &all.back()) std::printf(",");
  }
  std::printf("]}");
  std::fflush(stdout);
}

}  // namespace
}  // namespace souple::benchmarks

int main(int argc, char** argv) {
  using namespace souple::benchmarks;
  for (int i = 1; i < argc; ++i) {
    quick = quick || std::strcmp(argv[i], "--quick") == 0;
    engine_only = engine_only || std::strcmp(argv[i], "--engine") == 0;
  }
  const int n = quick ? 12 : 30, across = quick ? 2 : 4;
  std::printf("[");
  compare("cloth at rest", 4000, ClothScene{.n = n, .drag = 5}, false);
  compare("bar at rest", 2e6, BarScene{.n = across, .drag = 8}, false);
  for (const float Y : {40.f, 400.f, 4e3f, 4e4f, 4e5f})
    compare("cloth in motion", static_cast<double>(Y), ClothScene{.n = n, .spin = 2, .stiffness = Y}, true);
  for (const float E : {1e5f, 1e6f, 1e7f, 1e8f, 1e9f})
    compare("bar in motion", static_cast<double>(E),
            BarScene{.n = across, .young_modulus = E, .hinged = true}, true);
  std::printf("]\n");
}
