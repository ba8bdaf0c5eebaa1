#include "app/check_pictures.h"

#include "app/picture_files.h"
#include "souple/error.h"

#include <cstddef>
#include <variant>

#include <fmt/core.h>

namespace souple::app {

void check_pictures(const SceneDescription& scene) {
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    const auto* cloth = std::get_if<ClothDescription>(&scene.objects[i]);
    if (cloth == nullptr || !cloth->pattern || cloth->pattern->file.empty()) continue;
    try {
      picture_of(scene.folder / cloth->pattern->file);
    } catch (const Error& error) {
      throw Error(fmt::format("{}: objects[{}].pattern: {}", scene.source, i, error.what()));
    }
  }
  if (!scene.sky) return;
  try {
    sky_of(*scene.sky, scene.folder);
  } catch (const Error& error) {
    throw Error(fmt::format("{}: sky.file: {}", scene.source, error.what()));
  }
}

}  // namespace souple::app
