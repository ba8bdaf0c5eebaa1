// The step of a projection in the plane of one particle, and of two, from the real solver, as script/figures
// draws it.
//
//   projection_2d
//
// Prints JSON: for two constraints with the same circle C = 0, the points at which GaussSeidel evaluates them;
// and two particles of different mass before and after one projection of their distance.

#include "souple/constraints/distance.h"
#include "souple/solver/custom_constraint.h"
#include "souple/solver/set_projector.h"
#include "souple/studies/make_solver.h"

#include <array>
#include <cstdio>
#include <memory>
#include <vector>

namespace {

using namespace souple;

void solve(Projector& projector, std::span<Vec4f> position, int iterations) {
  std::vector<Vec4f> moving(position.size());
  const std::vector<Vec4f> start = moving;
  projector.prepare(position.size());
  const ParticleView view{position, moving, start};
  const Substep substep{.h = 1, .iterations = iterations};
  const std::unique_ptr<Solver> solver = make_solver({.kind = SolverKind::gauss_seidel});
  const std::unique_ptr<Threads> threads = make_threads(Threading::serial, 1);
  std::array<Projector*, 1> projectors{&projector};
  solver->prepare(projectors, view);
  projector.begin_substep(view, substep);
  solver->solve(projectors, view, substep, *threads);
  for (std::size_t i = 0; i < position.size(); ++i) position[i].set_xyz(position[i].xyz() + moving[i].xyz());
}

/// C = |x| - 1, or the quadratic C = (|x|^2 - 1) / 2 with the same zeros: fills its gradient.
float circle(bool quadratic, const Vec3f& x, Vec3f& gradient) {
  const float r = length(x);
  gradient = quadratic ? x : x / r;
  return quadratic ? 0.5f * (r * r - 1) : r - 1;
}

void print(const std::vector<Vec3f>& points) {
  for (std::size_t i = 0; i < points.size(); ++i)
    std::printf("%s[%.6g, %.6g]", i > 0 ? ", " : "", static_cast<double>(points[i].x),
                static_cast<double>(points[i].y));
}

void print_circle(bool quadratic) {
  std::vector<Vec3f> path;
  CustomProjector projector;
  projector.add(std::make_shared<CallbackConstraint>(
      std::vector<std::uint32_t>{0}, [&](std::span<const Vec3f> x, std::span<Vec3f> gradient) {
        path.push_back(x[0]);
        return circle(quadratic, x[0], gradient[0]);
      }));
  std::vector<Vec4f> position{{2, 1.2f, 0, 1}};
  path.clear();
  solve(projector, position, 3);
  path.push_back(position[0].xyz());
  std::printf("{\"quadratic\": %s, \"points\": [", quadratic ? "true" : "false");
  print(path);
  std::printf("]}");
}

// Masses 1 and 3, at a distance of 2.4; at rest 1.
void print_pair() {
  std::vector<Vec4f> position{{-1.2f, -0.5f, 0, 1}, {1.05f, 0.34f, 0, 1.0f / 3}};
  SetProjector<Distance> projector;
  projector.add({0, 1}, {1.0f});
  std::printf("{\"masses\": [1, 3], \"before\": [");
  print({position[0].xyz(), position[1].xyz()});
  solve(projector, position, 1);
  std::printf("], \"after\": [");
  print({position[0].xyz(), position[1].xyz()});
  std::printf("]}");
}

}  // namespace

int main() {
  std::printf("{\"circles\": [");
  print_circle(false);
  std::printf(",\n  ");
  print_circle(true);
  std::printf("],\n \"pair\": ");
  print_pair();
  std::printf("}\n");
}
