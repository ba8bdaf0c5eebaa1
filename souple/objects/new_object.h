#pragma once

#include "souple/objects/materials.h"
#include "souple/objects/object_options.h"

#include <memory>
#include <string>
#include <vector>

namespace souple {

struct Object;
struct RigidDefinition;

/// An object that is not in a world yet.
struct NewObject {
  std::unique_ptr<Object> object;
  std::vector<double> mass;                ///< per particle [kg]; 0: only prescribed motion moves it
  std::unique_ptr<RigidDefinition> rigid;  ///< of rigid bodies
  std::vector<std::string> sentences;      ///< what its import repaired or left out, for the log

  NewObject();
  NewObject(NewObject&&) noexcept;
  ~NewObject();
};

/// An object of a material, without particles yet. Throws Error if the material, the options' transform, velocities or
/// max_particles are not valid.
NewObject start_object(std::string name, const Material& material, const ObjectOptions& options);
/// Call when particles and their masses are there: applies the options per vertex, and builds the constraints. Throws
/// Error if there are no particles, or a map, the layer or a constraint is not valid.
void finish_object(NewObject& made, const ObjectOptions& options);

/// Throws Error if `layer` is out of range, or if the object has no surface for a layer.
void require_layer(const Object& object, int layer);

}  // namespace souple
