// How fast each solver removes the stretch of a rigid cloth: residual against iterations and CPU time.
//
//   convergence SOLVER SIZE BUDGET_MS [--relaxation X] [--chebyshev RHO] [--symmetric] [--threads N]
//
// A cloth of SIZE x SIZE vertices and 2 m, rigid along the edges of its triangles and across interior edges,
// no gravity, its first row pinned, stretched 10 % away from that row (no solver can move the pinned row, so
// it is not stretched). One solve of 1, 2, 4, ... iterations, each from that start, until one takes longer
// than the budget. Prints JSON: the curve's points with `iterations`, `ms` (CPU time of the process in the
// solve, minimum of three), `strain` (maximum of |C| / l) and `rms` (root mean square of C / l), both as
// fractions of the 10 % at the start.

#include "souple/constraints/distance.h"
#include "souple/error.h"
#include "souple/geometry/adjacency.h"
#include "souple/geometry/builders.h"
#include "souple/solver/set_projector.h"
#include "souple/state/particles.h"
#include "souple/studies/make_solver.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string>
#include <string_view>
#include <vector>

namespace {

using namespace souple;

struct Arguments {
  SolverSettings solver;
  std::string name;
  int size = 50;
  double budget = 1000;  // ms
  int threads = 1;
};

constexpr std::array<std::pair<std::string_view, SolverKind>, 6> kinds{
    {{"gauss_seidel", SolverKind::gauss_seidel},
     {"jacobi", SolverKind::jacobi},
     {"direct", SolverKind::direct},
     {"conjugate_gradient", SolverKind::conjugate_gradient},
     {"dense", SolverKind::dense},
     {"hierarchical", SolverKind::hierarchical}}};

Arguments parse(int count, char** words) {
  if (count < 4)
    throw Error("usage: convergence SOLVER SIZE BUDGET_MS [options]; see benchmarks/convergence.cpp");
  Arguments arguments;
  arguments.name = words[1];
  const auto* kind =
      std::find_if(kinds.begin(), kinds.end(), [&](const auto& k) { return k.first == words[1]; });
  if (kind == kinds.end()) throw Error("no solver is called '" + arguments.name + "'");
  arguments.solver.kind = kind->second;
  arguments.size = std::atoi(words[2]);
  arguments.budget = std::atof(words[3]);
  for (int i = 4; i < count; ++i) {
    const std::string_view word = words[i];
    if (word == "--symmetric") {
      arguments.solver.sweep = Sweep::symmetric;
    } else if (i + 1 < count && word == "--relaxation") {
      arguments.solver.relaxation = static_cast<float>(std::atof(words[++i]));
    } else if (i + 1 < count && word == "--chebyshev") {
      arguments.solver.chebyshev = static_cast<float>(std::atof(words[++i]));
    } else if (i + 1 < count && word == "--threads") {
      arguments.threads = std::atoi(words[++i]);
    } else {
      throw Error("unknown option '" + std::string(word) + "'");
    }
  }
  return arguments;
}

/// The stretched cloth.
struct Cloth {
  std::vector<Vec4f> position, offset, start;
  SetProjector<Distance> distances;

  Cloth(int size, double stretch) {
    const TriangleMesh mesh = grid(size, size, 2);
    const double mass = 0.2 * 4 / static_cast<double>(mesh.positions.size());
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
      const bool pinned = i < static_cast<std::size_t>(size);
      Vec3d x = mesh.positions[i];
      x.z = mesh.positions[0].z + (x.z - mesh.positions[0].z) * (1 + stretch);
      const Vec3f at(x);
      position.push_back({at.x, at.y, at.z, pinned ? 0 : static_cast<float>(1 / mass)});
    }
    offset.resize(position.size());
    start = offset;
    const auto add = [&](std::uint32_t a, std::uint32_t b) {
      distances.add({a, b}, {static_cast<float>(length(mesh.positions[a] - mesh.positions[b]))});
    };
    for (const Edge& edge : unique_edges(mesh.triangles)) add(edge[0], edge[1]);
    for (const Hinge& hinge : interior_edges(mesh.triangles)) add(hinge[2], hinge[3]);
    distances.prepare(position.size());
  }
  ParticleView view() { return {position, offset, start}; }
  void reset() { offset = start; }
};

struct Strain {
  double largest = 0, rms = 0;
};

Strain strain_of(Cloth& cloth) {
  Strain result;
  std::size_t i = 0;
  cloth.distances.visit(cloth.view(), [&](const ConstraintState& state) {
    const double strain = std::fabs(static_cast<double>(state.strain));
    result.largest = std::max(result.largest, strain);
    result.rms += strain * strain;
    ++i;
  });
  result.rms = std::sqrt(result.rms / static_cast<double>(i));
  return result;
}

double cpu_milliseconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) * 1e3 + static_cast<double>(now.tv_nsec) * 1e-6;
}

double solve(Cloth& cloth, Solver& solver, Threads& threads, int iterations, float relaxation) {
  cloth.reset();
  Projector* const projectors[] = {&cloth.distances};
  const Substep substep{.h = 1.0f / 600, .iterations = iterations, .relaxation = relaxation};
  const double begin = cpu_milliseconds();
  cloth.distances.begin_substep(cloth.view(), substep);
  solver.solve(projectors, cloth.view(), substep, threads);
  return cpu_milliseconds() - begin;
}

void run(const Arguments& arguments) {
  const double stretch = 0.1;
  Cloth cloth(arguments.size, stretch);
  const std::unique_ptr<Threads> threads =
      make_threads(arguments.threads > 1 ? Threading::automatic : Threading::serial, arguments.threads);
  const std::unique_ptr<Solver> solver = make_solver(arguments.solver);
  Projector* const projectors[] = {&cloth.distances};
  const double begin = cpu_milliseconds();
  solver->prepare(projectors, cloth.view());
  std::printf("{\"solver\": \"%s\", \"size\": %d, \"constraints\": %zu, \"prepare_ms\": %.3f, \"curve\": [",
              arguments.name.c_str(), arguments.size, cloth.distances.size(), cpu_milliseconds() - begin);
  double spent = 0;
  for (int iterations = 1; spent < arguments.budget; iterations *= 2) {
    spent = solve(cloth, *solver, *threads, iterations, arguments.solver.relaxation);
    for (int again = 0; again < 2 && spent < 200; ++again)
      spent = std::min(spent, solve(cloth, *solver, *threads, iterations, arguments.solver.relaxation));
    const Strain error = strain_of(cloth);
    std::printf("%s\n  {\"iterations\": %d, \"ms\": %.4g, \"strain\": %.5g, \"rms\": %.5g}",
                iterations > 1 ? "," : "", iterations, spent, error.largest / stretch, error.rms / stretch);
    std::fflush(stdout);
    if (!std::isfinite(error.rms)) break;
  }
  std::printf("],\n \"remark\": \"%s\"}\n", solver->diagnostic().c_str());
}

}  // namespace

int main(int count, char** words) {
  try {
    run(parse(count, words));
    return 0;
  } catch (const souple::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
}
