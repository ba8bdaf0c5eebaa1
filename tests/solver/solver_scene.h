#pragma once

#include "souple/constraints/distance.h"
#include "souple/solver/set_projector.h"
#include "souple/studies/make_solver.h"
#include "tests/solver/body.h"

#include <memory>
#include <vector>

namespace souple::test {

inline SolverSettings kind_of(SolverKind kind) {
  SolverSettings settings;
  settings.kind = kind;
  return settings;
}

/// Particles that a solver moves, substep by substep. This is a simulation loop without a World, and a test can read
/// all of its data.
struct SolverScene {
  Body body;
  std::vector<Vec3f> velocity;
  std::vector<std::unique_ptr<Projector>> projectors;
  std::unique_ptr<Solver> solver;
  std::unique_ptr<Threads> threads = make_threads(Threading::serial, 1);
  Vec3f gravity{};
  float damping = 1;  ///< factor of the velocity per substep
  Substep substep{.h = 0.01f};

  void add(const Vec3d& x, double mass) {
    body.add(x, mass > 0 ? static_cast<float>(1 / mass) : 0.0f);
    velocity.push_back({});
  }
  template <class Kind>
  SetProjector<Kind>& add() {
    projectors.push_back(std::make_unique<SetProjector<Kind>>());
    return static_cast<SetProjector<Kind>&>(*projectors.back());
  }
  std::vector<Projector*> order() const {
    std::vector<Projector*> result;
    for (const auto& projector : projectors) result.push_back(projector.get());
    return result;
  }
  void use(const SolverSettings& settings) {
    for (const auto& projector : projectors) projector->prepare(body.position.size());
    solver = make_solver(settings);
    substep.relaxation = settings.relaxation;
    solver->prepare(order(), body.view());
  }
  /// Solves the constraints of one substep that starts at the current positions.
  void solve() {
    body.start = body.offset;
    solve_from_start();
  }
  void solve_from_start() {
    const ParticleView view = body.view();
    for (const auto& projector : projectors) projector->begin_substep(view, substep);
    solver->solve(order(), view, substep, *threads);
  }
  void step() {
    const float h = substep.h;
    body.start = body.offset;
    for (std::size_t i = 0; i < velocity.size(); ++i)
      if (body.position[i].w > 0)
        body.offset[i].set_xyz(body.offset[i].xyz() + (velocity[i] + gravity * h) * h);
    solve_from_start();
    for (std::size_t i = 0; i < velocity.size(); ++i) {
      velocity[i] = (body.offset[i].xyz() - body.start[i].xyz()) * (damping / h);
      const Vec3f x = body.position[i].xyz(), moved = x + body.offset[i].xyz();
      body.offset[i].set_xyz(body.offset[i].xyz() - (moved - x));
      body.position[i].set_xyz(moved);
    }
  }
};

/// Calls link(a, b) for the rows, columns and both diagonals of n x n particles.
template <class Link>
void for_each_link(std::uint32_t n, const Link& link) {
  for (std::uint32_t row = 0; row < n; ++row)
    for (std::uint32_t column = 0; column < n; ++column) {
      const std::uint32_t i = row * n + column;
      if (column + 1 < n) link(i, i + 1);
      if (row + 1 < n) link(i, i + n);
      if (row + 1 < n && column + 1 < n) link(i, i + n + 1), link(i + 1, i + n);
    }
}

/// A flat sheet of n x n particles in the XZ plane, at distances of `spacing`, with springs along rows,
/// columns and both diagonals. `pinned`: pins the first row.
inline SolverScene sheet(std::size_t n, double spacing, double mass, float compliance, bool pinned) {
  SolverScene scene;
  for (std::size_t row = 0; row < n; ++row)
    for (std::size_t column = 0; column < n; ++column)
      scene.add({spacing * static_cast<double>(column), 0, spacing * static_cast<double>(row)},
                pinned && row == 0 ? 0 : mass);
  auto& links = scene.add<Distance>();
  for_each_link(static_cast<std::uint32_t>(n), [&](std::uint32_t a, std::uint32_t b) {
    links.add({a, b}, {static_cast<float>(length(scene.body.at(a) - scene.body.at(b)))}, {compliance});
  });
  return scene;
}

}  // namespace souple::test
