#pragma once

#include "souple/math/transform.h"
#include "souple/world/materials.h"
#include "souple/world/settings.h"

#include <span>
#include <string>
#include <string_view>

// Checks of what users hand in. All throw Error naming the owner, the field, its value and what was expected.

namespace souple {

void validate(const Settings& settings);
void validate(const Transform& transform, std::string_view owner);
void validate(const ClothMaterial& material, std::string_view owner);
void validate(const SoftBodyMaterial& material, std::string_view owner);
void validate(const RopeMaterial& material, std::string_view owner);
void validate(const GrainsMaterial& material, std::string_view owner);
void validate(const FluidMaterial& material, std::string_view owner);
void validate(const ObstacleMaterial& material, std::string_view owner);

/// "; did you mean 'flag'?" when one of the names is near, "; there are: a, b" when there are few, or
/// nothing.
std::string nearest_name(std::string_view name, std::span<const std::string_view> names);

}  // namespace souple
