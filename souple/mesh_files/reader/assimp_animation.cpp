#include "souple/mesh_files/reader/assimp_animation.h"

#include "souple/error.h"
#include "souple/mesh_files/mesh_text.h"
#include "souple/mesh_files/reader/assimp_file.h"
#include "souple/mesh_files/reader/pose.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include <assimp/anim.h>
#include <assimp/scene.h>
#include <fmt/core.h>

namespace souple::mesh_detail {

namespace {

constexpr std::uint64_t most_bytes = std::uint64_t(1) << 30;

const aiAnimation& find_animation(const aiScene& scene, const std::string& wanted, const std::string& file) {
  std::string names;
  for (unsigned i = 0; i < scene.mNumAnimations; ++i) {
    const aiAnimation& animation = *scene.mAnimations[i];
    const std::string name = animation.mName.C_Str();
    if (wanted.empty() ? scene.mNumAnimations == 1 : name == wanted) return animation;
    constexpr unsigned most = 20;
    if (i < most) names += (i == 0 ? "\"" : ", \"") + name + "\"";
    if (i == most) names += fmt::format(" and {} more", scene.mNumAnimations - most);
  }
  if (names.empty()) throw Error(file + ": holds no animation, expected keys of nodes, bones or shapes");
  if (wanted.empty())
    throw Error(fmt::format("{}: holds {} animations, expected the name of one: {}", file,
                            scene.mNumAnimations, names));
  throw Error(fmt::format("{}: holds no animation \"{}\"; expected one of {}", file, wanted, names));
}

/// The parts that a node of this name holds; all, if it is empty.
std::vector<ScenePart> find_parts(const aiScene& scene, const std::string& node, const std::string& file) {
  std::vector<ScenePart> parts = parts_of(scene);
  if (!node.empty())
    std::erase_if(parts, [&](const ScenePart& part) { return part.node->mName.C_Str() != node; });
  if (parts.empty())
    throw Error(fmt::format("{}: holds no object \"{}\" that an animation could move", file, node));
  return parts;
}

/// [s]
double duration_of(const aiAnimation& animation) {
  const double ticks = animation.mDuration;
  return std::isfinite(ticks) && ticks > 0 ? ticks / ticks_per_second(animation) : 0;
}

/// The last frame is the end itself, so that a cycle closes; one just before it would be there twice.
std::vector<double> frame_times(double duration, double frame_rate) {
  std::vector<double> times = {0};
  constexpr double same_frame = 1e-3;
  for (double frame = 1; frame < duration * frame_rate - same_frame; ++frame)
    times.push_back(frame / frame_rate);
  if (duration > 0) times.push_back(duration);
  return times;
}

void require_room(double frames, std::size_t points, double duration, const std::string& file) {
  const std::uint64_t most = most_bytes / sizeof(Vec3f) / std::max<std::uint64_t>(points, 1);
  if (frames <= double(most)) return;
  throw Error(fmt::format(
      "{}: an animation of {:.6g} s moves {} vertices in {:.0f} frames, expected at most {} frames, 1 "
      "GiB; a lower frame rate or one object of the file may do",
      file, duration, points, frames, most));
}

}  // namespace

MeshAnimation read_assimp_animation(const std::filesystem::path& path, const MeshAnimationImport& options) {
  MeshAnimation result;
  const std::string file = path.string();
  with_assimp_scene(path, [&](const aiScene& scene, const Mat3d& axes, double unit) {
    const aiAnimation& animation = find_animation(scene, options.animation, file);
    const std::vector<ScenePart> parts = find_parts(scene, options.node, file);
    for (const ScenePart& part : parts) result.points += part.mesh->mNumVertices;
    const double duration = duration_of(animation);
    require_room(std::ceil(duration * options.frame_rate) + 1, result.points, duration, file);
    result.times = frame_times(duration, options.frame_rate);
    Pose pose(scene);
    for (const double time : result.times) {
      pose.set(animation, time);
      for (const ScenePart& part : parts) {
        const std::vector<Affine> placements = pose.placements(part);
        const std::vector<Vec3d> vertices = pose.vertices(part);
        for (std::size_t i = 0; i < vertices.size(); ++i)
          result.positions.emplace_back(axes * placements[i].point(vertices[i]) * unit);
      }
    }
  });
  return result;
}

}  // namespace souple::mesh_detail
