// Cost and benefit of phantoms: requested colors against time and convergence, for docs/solvers.md.
//
//   partition [--threads N] [--runs N]
//
// Rigid bodies, every particle moved at random by up to a tenth of the mean edge, no gravity, the particles
// of lowest X pinned; one set each: the springs of a 200 x 200 cloth, of a ball, of a sheet some of whose
// edges are flipped, of a 32 x 32 cloth, and the neo-Hookean tets of a bar. Prints a Markdown table. The
// variants of a body run alternately, and the minimum time over all rounds is reported: the time of a solve
// of one iteration, and the time that each further iteration adds. Error: the root mean square of C as a
// percentage of its initial value, after 64 iterations, and in the time that 64 take without phantoms.

#include "souple/studies/partition.h"

#include "souple/constraints/distance.h"
#include "souple/constraints/neo_hookean.h"
#include "souple/error.h"
#include "souple/geometry/adjacency.h"
#include "souple/geometry/builders.h"
#include "souple/geometry/reorder.h"
#include "souple/solver/set_projector.h"
#include "souple/studies/make_solver.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <limits>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace souple {
namespace {

constexpr int many = 64;  // iterations

struct Body {
  std::string name;
  std::vector<Vec4f> position, offset, start;
  std::unique_ptr<Projector> set;

  /// `edge`: the mean length of an edge [m].
  Body(std::string called, const std::vector<Vec3d>& rest, double edge) : name(std::move(called)) {
    double lowest = std::numeric_limits<double>::infinity();
    for (const Vec3d& x : rest) lowest = std::min(lowest, x.x);
    std::uint32_t random = 1;
    const auto scatter = [&] {
      random = random * 1664525u + 1013904223u;
      return 0.1 * edge * (static_cast<double>(random >> 8) / (1 << 23) - 1);
    };
    for (const Vec3d& x : rest) {
      const bool pinned = x.x < lowest + 1e-6;
      const Vec3f at(pinned ? x : x + Vec3d{scatter(), scatter(), scatter()});
      position.push_back({at.x, at.y, at.z, pinned ? 0.0f : 1.0f});
    }
    offset.resize(position.size());
    start = offset;
  }
  ParticleView view() { return {position, offset, start}; }
};

double mean_length(const std::vector<Edge>& edges, const std::vector<Vec3d>& x) {
  double sum = 0;
  for (const Edge& edge : edges) sum += length(x[edge[0]] - x[edge[1]]);
  return sum / static_cast<double>(edges.size());
}

/// Orders particles along the Morton curve, as a world does.
template <class Mesh, class Elements>
Mesh renumbered(Mesh mesh, Elements Mesh::*elements) {
  const std::vector<std::uint32_t> order = morton_order(mesh.positions), number = inverse_order(order);
  Mesh result;
  for (const std::uint32_t i : order) result.positions.push_back(mesh.positions[i]);
  result.*elements = mesh.*elements;
  for (auto& element : result.*elements)
    for (std::uint32_t& i : element) i = number[i];
  return result;
}

Body springs(const std::string& name, const TriangleMesh& given) {
  const TriangleMesh mesh = renumbered(given, &TriangleMesh::triangles);
  const std::vector<Edge> edges = unique_edges(mesh.triangles);
  Body body(name, mesh.positions, mean_length(edges, mesh.positions));
  auto set = std::make_unique<SetProjector<Distance>>();
  const auto add = [&](std::uint32_t a, std::uint32_t b) {
    set->add({a, b}, {static_cast<float>(length(mesh.positions[a] - mesh.positions[b]))});
  };
  for (const Edge& edge : edges) add(edge[0], edge[1]);
  for (const Hinge& hinge : interior_edges(mesh.triangles)) add(hinge[2], hinge[3]);
  set->prepare(mesh.positions.size());
  body.set = std::move(set);
  return body;
}

Body bar() {
  const TetMesh mesh = renumbered(tet_bar(60, 12, 12, {5, 1, 1}), &TetMesh::tets);
  Body body("bar, tets", mesh.positions, mean_length(unique_edges(mesh.tets), mesh.positions));
  auto set = std::make_unique<SetProjector<NeoHookean>>();
  for (const Tet& tet : mesh.tets) {
    const Vec3d x[4] = {mesh.positions[tet[0]], mesh.positions[tet[1]], mesh.positions[tet[2]],
                        mesh.positions[tet[3]]};
    set->add(tet, NeoHookean::from_rest(x));
  }
  set->prepare(mesh.positions.size());
  body.set = std::move(set);
  return body;
}

/// A sheet of irregular triangles: flips edges of a grid, each triangle at most once in a round.
TriangleMesh irregular(int n) {
  TriangleMesh mesh = grid(n, n, 2);
  std::uint32_t random = 1;
  for (int round = 0; round < 2; ++round) {
    const TriangleEdges all = triangle_edges(mesh.triangles);
    std::set<Edge> edges;
    for (const Edge& edge : all.edges) edges.insert({std::min(edge[0], edge[1]), std::max(edge[0], edge[1])});
    std::vector<std::vector<std::uint32_t>> sides(all.edges.size());
    for (std::uint32_t t = 0; t < all.of_triangle.size(); ++t)
      for (const std::uint32_t edge : all.of_triangle[t]) sides[edge].push_back(t);
    std::vector<bool> changed(mesh.triangles.size());
    for (std::size_t e = 0; e < sides.size(); ++e) {
      random = random * 1664525u + 1013904223u;
      if (sides[e].size() != 2 || random >> 30 != 0 || changed[sides[e][0]] || changed[sides[e][1]]) continue;
      const std::uint32_t a = all.edges[e][0], b = all.edges[e][1];
      const auto opposite = [&](std::uint32_t t) {
        for (const std::uint32_t i : mesh.triangles[t])
          if (i != a && i != b) return i;
        return a;
      };
      const std::uint32_t c = opposite(sides[e][0]), d = opposite(sides[e][1]);
      if (c == d || !edges.insert({std::min(c, d), std::max(c, d)}).second) continue;
      mesh.triangles[sides[e][0]] = {a, c, d}, mesh.triangles[sides[e][1]] = {d, c, b};
      changed[sides[e][0]] = changed[sides[e][1]] = true;
    }
  }
  return mesh;
}

/// With one thread, CPU time: it excludes the time of other programs.
double milliseconds(const Threads& threads) {
  timespec now{};
  clock_gettime(threads.count() > 1 ? CLOCK_MONOTONIC : CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) * 1e3 + static_cast<double>(now.tv_nsec) * 1e-6;
}

/// A body with one number of colors. Splitting changes the set, so the variants of a body run alternately.
struct Variant {
  int colors = 0;
  int color_count = 0;
  std::size_t phantoms = 0;
  double one = std::numeric_limits<double>::infinity(), all = one;  // ms of 1 and of `many` iterations
  double error = 0, error_in_time = 0;

  double each() const { return (all - one) / (many - 1); }
};

/// Runs f(solve) on the body at its initial positions, where solve(iterations) returns its time.
template <class Function>
void with_solver(Body& body, Variant& variant, Threads& threads, const Function& f) {
  Projector* const projectors[] = {body.set.get()};
  body.set->facets().study->restore();
  const std::unique_ptr<Solver> solver = make_solver({.colors = variant.colors});
  solver->prepare(projectors, body.view());
  variant.color_count = body.set->color_count();
  f([&](int iterations) {
    const Substep substep{.h = 1.0f / 600, .iterations = iterations, .mode = Mode::pbd};
    body.offset = body.start;
    body.set->begin_substep(body.view(), substep);
    const ActiveScope awake(threads);
    const double begin = milliseconds(threads);
    solver->solve(projectors, body.view(), substep, threads);
    return milliseconds(threads) - begin;
  });
  const auto count = static_cast<std::uint32_t>(body.position.size());
  variant.phantoms = variant.colors == 0 ? 0 : split(*body.set, variant.colors, count).size();
}

void measure(Body& body, Threads& threads, int runs) {
  const auto rms = [&] {
    double sum = 0;
    body.set->visit(body.view(), [&](const ConstraintState& state) {
      sum += static_cast<double>(state.residual) * static_cast<double>(state.residual);
    });
    return std::sqrt(sum / static_cast<double>(body.set->size()));
  };
  const double before = rms();
  const auto error = [&] { return 100 * rms() / before; };
  std::vector<Variant> variants;
  for (const int colors : {0, 8, 6, 4, 3, 2, 1}) variants.push_back({.colors = colors});
  for (int turn = 0; turn < runs; ++turn)
    for (Variant& variant : variants)
      with_solver(body, variant, threads, [&](const auto& solve) {
        for (int again = 0; again < 5; ++again) variant.one = std::min(variant.one, solve(1));
        variant.all = std::min(variant.all, solve(many));
        variant.error = error();
      });
  for (Variant& variant : variants)
    with_solver(body, variant, threads, [&](const auto& solve) {
      const double time = variants[0].all - variant.one;
      solve(1 + std::max(0, static_cast<int>(std::lround(time / variant.each()))));
      variant.error_in_time = error();
    });
  for (const Variant& variant : variants)
    std::printf("| %s, %zu | %d | %d | %zu | %.4g | %.4g | %.3g | %.3g |\n", body.name.c_str(),
                body.set->size(), variant.colors, variant.color_count, variant.phantoms, variant.one,
                variant.each(), variant.error, variant.error_in_time);
  std::fflush(stdout);
}

void run(int threads, int runs) {
  const std::unique_ptr<Threads> workers =
      make_threads(threads > 1 ? Threading::pool : Threading::serial, threads);
  std::printf(
      "| constraints | colors requested | used | phantoms | one iteration [ms] | each further [ms] | error "
      "after %d [%%] | error in equal time [%%] |\n|---|---:|---:|---:|---:|---:|---:|---:|\n",
      many);
  std::vector<Body> bodies;
  bodies.push_back(springs("cloth, springs", grid(200, 200, 2)));
  bodies.push_back(bar());
  bodies.push_back(springs("ball, springs", sphere(6, 1)));
  bodies.push_back(springs("irregular sheet, springs", irregular(200)));
  bodies.push_back(springs("small cloth, springs", grid(32, 32, 2)));
  for (Body& body : bodies) measure(body, *workers, runs);
}

}  // namespace
}  // namespace souple

int main(int count, char** words) {
  try {
    int threads = 1, runs = 5;
    for (int i = 1; i + 1 < count; i += 2)
      (std::string_view(words[i]) == "--threads" ? threads : runs) = std::atoi(words[i + 1]);
    souple::run(threads, runs);
    return 0;
  } catch (const souple::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
}
