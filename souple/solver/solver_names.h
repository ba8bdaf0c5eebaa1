#pragma once

#include "souple/solver/solver.h"

#include <cstddef>
#include <string>
#include <utility>

// The only list of the names of solvers and their options: in scenes, on the command line, in reports.

namespace souple {

inline constexpr std::pair<const char*, Mode> mode_names[] = {
    {"small_steps", Mode::small_steps}, {"xpbd", Mode::xpbd}, {"pbd", Mode::pbd}};

inline constexpr std::pair<const char*, SolverKind> solver_names[] = {
    {"automatic", SolverKind::automatic},
    {"gauss_seidel", SolverKind::gauss_seidel},
    {"jacobi", SolverKind::jacobi},
    {"direct", SolverKind::direct},
    {"conjugate_gradient", SolverKind::conjugate_gradient},
    {"dense", SolverKind::dense},
    {"hierarchical", SolverKind::hierarchical}};

inline constexpr std::pair<const char*, Sweep> sweep_names[] = {{"forward", Sweep::forward},
                                                                {"symmetric", Sweep::symmetric}};

/// "?" for a value without a name.
template <class Value, std::size_t n>
std::string name_in(const std::pair<const char*, Value> (&names)[n], Value value) {
  for (const auto& [name, known] : names)
    if (known == value) return name;
  return "?";
}

}  // namespace souple
