#pragma once

#include "souple/scene/json.h"

#include <string>
#include <string_view>

namespace souple::scene_format {

/// Applies `path=value` to a scene: "substeps=20", "objects.flag.material.damping=0.1",
/// "objects[0].name=flag". List entries are found by name, else by index; missing objects on the path are
/// created. The value is JSON, or text if it does not parse. The reader validates the result later. Throws
/// Error.
void apply_override(Json& scene, const std::string& setting, std::string_view source);

}  // namespace souple::scene_format
