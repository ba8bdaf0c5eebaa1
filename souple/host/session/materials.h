#pragma once

#include "souple/host/session.h"
#include "souple/world/world.h"

namespace souple::host {

using AnyMaterial = Material;

/// The default material of a kind, or its preset of that name. Throws Error with the nearest name if there is
/// none.
AnyMaterial make_material(Kind kind, const std::string& preset);
/// Names of the kind's presets.
std::vector<std::string> preset_names(Kind kind);

/// Values of the tunables that have an effect.
std::vector<Parameter> parameters_of(const AnyMaterial& material, Mode mode);
/// A copy of the material with one number changed. Throws Error with the nearest name if there is no such
/// tunable.
AnyMaterial with_parameter(const AnyMaterial& material, const std::string& name, double value);

}  // namespace souple::host
