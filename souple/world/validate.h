#pragma once

#include "souple/math/transform.h"
#include "souple/objects/materials.h"
#include "souple/stages/settings.h"

#include <span>
#include <string>
#include <string_view>

// Checks of user input. All throw Error with the owner, the field, its value and the expected range.

namespace souple {

void validate(const Settings& settings);
void validate(const Transform& transform, std::string_view owner);
void validate(const ClothMaterial& material, std::string_view owner);
void validate(const SoftBodyMaterial& material, std::string_view owner);
void validate(const RopeMaterial& material, std::string_view owner);
void validate(const GrainsMaterial& material, std::string_view owner);
void validate(const FluidMaterial& material, std::string_view owner);
void validate(const ObstacleMaterial& material, std::string_view owner);

/// "; did you mean 'flag'?" if a name is similar, "; there are: a, b" if there are few names, "; there is
/// none" without names, or nothing.
std::string nearest_name(std::string_view name, std::span<const std::string_view> names);

}  // namespace souple
