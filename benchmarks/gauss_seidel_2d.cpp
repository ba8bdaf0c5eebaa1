// The path of Gauss-Seidel in the plane of two unknowns, from the real solver, as script/figures draws it.
//
//   gauss_seidel_2d
//
// One particle, free in the xy plane, and two constraints a . x = b, two lines in that plane: first at a
// large angle, then nearly parallel. Prints JSON: for each case and each relaxation, the points at which
// GaussSeidel evaluates the constraints.

#include "souple/solver/custom_constraint.h"
#include "souple/studies/make_solver.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <memory>
#include <vector>

namespace {

using namespace souple;

/// a . x = b.
struct Line {
  Vec3f a;
  float b;
};

struct Case {
  const char* name;
  std::array<Line, 2> lines;
  Vec3f start;
};

// Each evaluation of a constraint records the particle's position.
std::vector<Vec3f> path_of(const Case& scene, float relaxation, int iterations) {
  std::vector<Vec3f> path;
  const std::vector<Vec4f> position{{scene.start.x, scene.start.y, 0, 1}}, start(1);
  std::vector<Vec4f> moving(1);
  CustomProjector lines;
  for (const Line& line : scene.lines)
    lines.add(std::make_shared<CallbackConstraint>(
        std::vector<std::uint32_t>{0}, [&path, line](std::span<const Vec3f> x, std::span<Vec3f> gradient) {
          path.push_back(x[0]);
          gradient[0] = line.a;
          return dot(line.a, x[0]) - line.b;
        }));
  lines.prepare(1);
  const ParticleView view{position, moving, start};
  const Substep substep{.h = 1, .iterations = iterations};
  SolverSettings settings;
  settings.relaxation = relaxation;
  const std::unique_ptr<Solver> solver = make_solver(settings);
  const std::unique_ptr<Threads> threads = make_threads(Threading::serial, 1);
  std::array<Projector*, 1> projectors{&lines};
  solver->prepare(projectors, view);
  path.clear();
  lines.begin_substep(view, substep);
  solver->solve(projectors, view, substep, *threads);
  path.push_back(position[0].xyz() + moving[0].xyz());
  return path;
}

void print(const Case& scene, bool first) {
  std::printf("%s\n  {\"name\": \"%s\", \"lines\": [", first ? "" : ",", scene.name);
  for (std::size_t i = 0; i < 2; ++i)
    std::printf("%s[%g, %g, %g]", i > 0 ? ", " : "", static_cast<double>(scene.lines[i].a.x),
                static_cast<double>(scene.lines[i].a.y), static_cast<double>(scene.lines[i].b));
  std::printf("],\n   \"paths\": [");
  bool next = false;
  for (const float relaxation : {1.0f, 1.4f}) {
    std::printf("%s\n    {\"relaxation\": %g, \"points\": [", next ? "," : "",
                static_cast<double>(relaxation));
    const std::vector<Vec3f> path = path_of(scene, relaxation, 12);
    for (std::size_t i = 0; i < path.size(); ++i)
      std::printf("%s[%.6g, %.6g]", i > 0 ? ", " : "", static_cast<double>(path[i].x),
                  static_cast<double>(path[i].y));
    std::printf("]}");
    next = true;
  }
  std::printf("]}");
}

Line through(float x, float y, float degrees) {
  const float angle = degrees * 0.01745329252f;
  const Vec3f normal{-std::sin(angle), std::cos(angle), 0};
  return {normal, normal.x * x + normal.y * y};
}

}  // namespace

int main() {
  const Case cases[] = {{"lines at 55 degrees", {through(0, 0, -15), through(0, 0, 40)}, {3.2f, 2.4f, 0}},
                        {"lines at 20 degrees", {through(0, 0, 5), through(0, 0, 25)}, {3.2f, 2.4f, 0}}};
  std::printf("{\"cases\": [");
  for (const Case& scene : cases) print(scene, &scene == &cases[0]);
  std::printf("]}\n");
}
