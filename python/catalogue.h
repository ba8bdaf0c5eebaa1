#pragma once

#include "python/bound_world.h"
#include "souple/constraints/constraint.h"
#include "souple/solver/projector.h"

#include <memory>
#include <string>
#include <vector>

// Constraints of the user's own: arrays of a kind of the catalogue, and functions of Python.

namespace souple::python {

/// Constraints of one kind as arrays, which a world takes as a SetProjector.
struct ConstraintArrays {
  std::string kind;
  std::vector<std::uint32_t> particles;  ///< arity numbers a constraint
  std::vector<float> parameters;         ///< the floats of Params, a constraint after the other
  std::vector<float> compliances;        ///< packed, a constraint after the other
  std::vector<float> damping_times, stiffnesses;

  std::size_t size() const { return damping_times.size(); }
  std::unique_ptr<Projector> make() const;
};

/// A constraint whose value a function of Python computes.
struct CustomArguments {
  struct Item {
    std::vector<std::uint32_t> particles;
    py::object function;
    std::string name;
    Sense sense;
    float compliance, damping_time, stiffness;
    Vec3f origin;
  };
  std::vector<Item> items;

  std::unique_ptr<Projector> make(BoundWorld& world) const;
};

}  // namespace souple::python
