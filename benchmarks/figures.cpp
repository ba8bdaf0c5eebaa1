// Prints the curves that script/figures draws, as JSON. Gauss-Seidel and the projection are those of the real solver.
//
//   figures gauss_seidel_2d      one particle, free in the xy plane, and two constraints a . x = b, two lines: first at a
//                                large angle, then nearly parallel
//   figures projection_2d        two constraints with the same circle C = 0; and two particles of different mass before and
//                                after one projection of their distance
//   figures elastic_integrators  see elastic_integrators.cpp

#include "benchmarks/elastic_integrators.h"
#include "souple/constraints/distance.h"
#include "souple/solver/custom_constraint.h"
#include "souple/solver/set_projector.h"
#include "souple/studies/make_solver.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <functional>
#include <memory>
#include <span>
#include <vector>

namespace souple::benchmarks {
namespace {

/// Solves once with Gauss-Seidel and moves `position` to the solution.
void solve(Projector& projector, std::vector<Vec4f>& position, int iterations, float relaxation = 1) {
  projector.prepare(position.size());
  std::vector<Vec4f> moving(position.size());
  const std::vector<Vec4f> start(position.size());
  const ParticleView view{.position = position, .moving = moving, .start = start};
  const Substep substep{.h = 1, .iterations = iterations};
  const std::unique_ptr<Solver> solver =
      make_solver({.kind = SolverKind::gauss_seidel, .relaxation = relaxation});
  const std::unique_ptr<Threads> threads = make_threads(Threading::serial, 1);
  std::array<Projector*, 1> projectors{&projector};
  solver->prepare(projectors, view);
  projector.begin_substep(view, substep);
  solver->solve(projectors, view, substep, *threads);
  for (std::size_t i = 0; i < position.size(); ++i) {
    const Vec3f x = position[i].xyz() + moving[i].xyz();
    position[i] = {x.x, x.y, x.z, position[i].w};
  }
}

using Function = std::function<float(const Vec3f& x, Vec3f& gradient)>;

/// The points at which Gauss-Seidel evaluates constraints of one particle, and the last one.
std::vector<Vec3f> path_of(std::span<const Function> constraints, const Vec3f& start, int iterations,
                           float relaxation = 1) {
  std::vector<Vec3f> path;
  CustomProjector projector;
  for (const Function& constraint : constraints)
    projector.add(std::make_shared<CallbackConstraint>(
        std::vector<std::uint32_t>{0}, [&](std::span<const Vec3f> x, std::span<Vec3f> gradient) {
          path.push_back(x[0]);
          return constraint(x[0], gradient[0]);
        }));
  path.clear();
  std::vector<Vec4f> position{{start.x, start.y, 0, 1}};
  solve(projector, position, iterations, relaxation);
  path.push_back(position[0].xyz());
  return path;
}

void print_points(const std::vector<Vec3f>& points) {
  for (std::size_t i = 0; i < points.size(); ++i)
    std::printf("%s[%.6g, %.6g]", i > 0 ? ", " : "", static_cast<double>(points[i].x),
                static_cast<double>(points[i].y));
}

/// a . x = b, through a point.
struct Line {
  Vec3f a;
  float b;

  Line(float x, float y, float degrees) {
    const float angle = degrees * 0.01745329252f;
    a = {-std::sin(angle), std::cos(angle), 0};
    b = a.x * x + a.y * y;
  }
};

void print_lines(const char* name, const std::array<Line, 2>& lines) {
  std::printf("{\"name\": \"%s\", \"lines\": [", name);
  std::vector<Function> constraints;
  for (const Line& line : lines) {
    std::printf("%s[%g, %g, %g]", constraints.empty() ? "" : ", ", static_cast<double>(line.a.x),
                static_cast<double>(line.a.y), static_cast<double>(line.b));
    constraints.emplace_back([line](const Vec3f& x, Vec3f& gradient) {
      gradient = line.a;
      return dot(line.a, x) - line.b;
    });
  }
  std::printf("], \"paths\": [");
  for (const float relaxation : {1.0f, 1.4f}) {
    std::printf("%s\n  {\"relaxation\": %g, \"points\": [", relaxation == 1 ? "" : ",",
                static_cast<double>(relaxation));
    print_points(path_of(constraints, {3.2f, 2.4f, 0}, 12, relaxation));
    std::printf("]}");
  }
  std::printf("]}");
}

void print_gauss_seidel() {
  std::printf("{\"cases\": [");
  print_lines("lines at 55 degrees", {Line(0, 0, -15), Line(0, 0, 40)});
  std::printf(",\n ");
  print_lines("lines at 20 degrees", {Line(0, 0, 5), Line(0, 0, 25)});
  std::printf("]}\n");
}

/// C = |x| - 1, or the quadratic C = (|x|^2 - 1) / 2 with the same zeros.
void print_circle(bool quadratic) {
  const Function circle = [quadratic](const Vec3f& x, Vec3f& gradient) {
    const float r = length(x);
    gradient = quadratic ? x : x / r;
    return quadratic ? 0.5f * (r * r - 1) : r - 1;
  };
  std::printf("{\"quadratic\": %s, \"points\": [", quadratic ? "true" : "false");
  print_points(path_of({&circle, 1}, {2, 1.2f, 0}, 3));
  std::printf("]}");
}

void print_projection() {
  std::printf("{\"circles\": [");
  print_circle(false);
  std::printf(",\n  ");
  print_circle(true);
  // Masses 1 and 3, at a distance of 2.4; at rest 1.
  std::vector<Vec4f> position{{-1.2f, -0.5f, 0, 1}, {1.05f, 0.34f, 0, 1.0f / 3}};
  SetProjector<Distance> projector;
  projector.add({0, 1}, {1.0f});
  std::printf("],\n \"pair\": {\"masses\": [1, 3], \"before\": [");
  print_points({position[0].xyz(), position[1].xyz()});
  solve(projector, position, 1);
  std::printf("], \"after\": [");
  print_points({position[0].xyz(), position[1].xyz()});
  std::printf("]}}\n");
}

}  // namespace
}  // namespace souple::benchmarks

int main(int argc, char** argv) {
  using namespace souple::benchmarks;
  const char* name = argc == 2 ? argv[1] : "";
  if (std::strcmp(name, "gauss_seidel_2d") == 0) {
    print_gauss_seidel();
  } else if (std::strcmp(name, "projection_2d") == 0) {
    print_projection();
  } else if (std::strcmp(name, "elastic_integrators") == 0) {
    print_elastic_integrators();
  } else {
    std::fputs("figures: expected gauss_seidel_2d, projection_2d or elastic_integrators\n", stderr);
    return 2;
  }
}
