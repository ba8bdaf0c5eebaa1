#include "souple/mesh_files/mesh_animation.h"

#include "souple/error.h"
#include "souple/files/file.h"
#include "souple/mesh_files/assimp_reader.h"
#include "souple/mesh_files/read_mesh_bytes.h"

#include <algorithm>
#include <array>
#include <string_view>

#include <fmt/core.h>

namespace souple {

bool may_hold_mesh_animation(const std::filesystem::path& path) {
  constexpr std::array<std::string_view, 4> extensions = {".gltf", ".glb", ".fbx", ".dae"};
  return std::find(extensions.begin(), extensions.end(), lower_extension(path)) != extensions.end();
}

MeshAnimation read_mesh_animation(const std::filesystem::path& path, const MeshAnimationImport& options) {
  constexpr double highest_rate = 1e5;
  if (!(options.frame_rate > 0 && options.frame_rate <= highest_rate)) {
    throw Error(
        fmt::format("{}: found the frame rate {}, expected frames per second, greater than 0 and at most 1e5",
                    path.string(), options.frame_rate));
  }
  if (!may_hold_mesh_animation(path))
    throw Error(path.string() +
                ": no animation can be read from it, expected a .gltf, .glb, .fbx or .dae file");
  read_mesh_bytes(path);  // for its errors, which are more specific than assimp's
  return mesh_detail::read_animation_with_assimp(path, options);
}

}  // namespace souple
