#pragma once

#include "souple/host/session.h"
#include "souple/world/world.h"

#include <variant>

namespace souple::host {

using AnyMaterial = std::variant<ClothMaterial, SoftBodyMaterial, RopeMaterial, GrainsMaterial,
                                 ObstacleMaterial, FluidMaterial>;

AnyMaterial material_of(const World& world, ObjectId object);
void set_material(World& world, ObjectId object, const AnyMaterial& material);
/// The default of a kind, or its preset of that name; Error with the nearest name when there is none.
AnyMaterial make_material(Kind kind, const std::string& preset);
/// Presets that fit the kind.
std::vector<std::string> preset_names(Kind kind);

/// What the tunables stand at; only those that turn something.
std::vector<Parameter> parameters_of(const AnyMaterial& material, Mode mode);
/// The same material with one number changed. Error with the nearest name when there is no such tunable.
AnyMaterial with_parameter(const AnyMaterial& material, const std::string& name, double value);

}  // namespace souple::host
