#include "souple/mesh_files/reader/assimp_animation.h"

#include "souple/error.h"
#include "souple/mesh_files/mesh_bytes.h"
#include "souple/mesh_files/mesh_text.h"
#include "souple/mesh_files/reader/assimp_file.h"
#include "souple/mesh_files/reader/pose.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include <assimp/anim.h>
#include <assimp/scene.h>
#include <fmt/core.h>

namespace souple::mesh_detail {

namespace {

constexpr std::uint64_t most_bytes = std::uint64_t(1) << 30;

/// "a", "b" and 3 more
std::string listed(const std::vector<std::string>& names) {
  constexpr std::size_t most = 20;
  std::string text;
  for (std::size_t i = 0; i < std::min(most, names.size()); ++i)
    text += (i == 0 ? "\"" : ", \"") + names[i] + "\"";
  return names.size() > most ? fmt::format("{} and {} more", text, names.size() - most) : text;
}

const aiAnimation& find_animation(const aiScene& scene, const std::string& wanted, const std::string& file) {
  std::vector<std::string> names;
  for (unsigned i = 0; i < scene.mNumAnimations; ++i) {
    const aiAnimation& animation = *scene.mAnimations[i];
    names.emplace_back(animation.mName.C_Str());
    if (wanted.empty() ? scene.mNumAnimations == 1 : names.back() == wanted) return animation;
  }
  if (names.empty()) throw Error(file + ": holds no animation, expected keys of nodes, bones or shapes");
  if (wanted.empty())
    throw Error(fmt::format("{}: holds {} animations, expected the name of one: {}", file, names.size(),
                            listed(names)));
  throw Error(fmt::format("{}: holds no animation \"{}\"; expected one of {}", file, wanted, listed(names)));
}

/// The parts that a node of this name holds; all, if it is empty.
std::vector<ScenePart> find_parts(const aiScene& scene, const std::string& node, const std::string& file) {
  std::vector<ScenePart> parts;
  std::set<std::string> names;
  for (const ScenePart& part : parts_of(scene)) {
    const std::string name = part.node->mName.C_Str();
    if (node.empty() || name == node) parts.push_back(part);
    names.insert(name);
  }
  if (names.empty()) throw Error(file + ": holds no mesh that an animation could move");
  if (parts.empty())
    throw Error(fmt::format("{}: holds no object \"{}\" with a mesh; expected one of {}", file, node,
                            listed({names.begin(), names.end()})));
  return parts;
}

bool is_finite_value(const aiVector3D& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}
bool is_finite_value(const aiQuaternion& q) {
  return std::isfinite(q.x) && std::isfinite(q.y) && std::isfinite(q.z) && std::isfinite(q.w);
}
bool is_finite_key(const aiMeshMorphKey& key) {
  return std::isfinite(key.mTime) && std::all_of(key.mWeights, key.mWeights + key.mNumValuesAndWeights,
                                                 [](double w) { return std::isfinite(w); });
}
template <class Key>
bool is_finite_key(const Key& key) {
  return std::isfinite(key.mTime) && is_finite_value(key.mValue);
}

/// Checks the keys of one kind, and lengthens `last` to the time of the last one [ticks].
template <class Key>
void check_keys(const Key* keys, unsigned count, const char* name, const std::string& file, double& last) {
  for (unsigned k = 0; k < count; ++k) {
    if (!is_finite_key(keys[k]))
      throw Error(fmt::format(
          "{}: key {} of \"{}\" has a time or a value that is not finite, expected numbers", file, k, name));
    last = std::max(last, keys[k].mTime);
  }
}

/// [s]. A file that states none lasts until its last key. Throws Error where a key is not finite.
double duration_of(const aiAnimation& animation, const std::string& file) {
  double last = 0;
  for (unsigned i = 0; i < animation.mNumChannels; ++i) {
    const aiNodeAnim& channel = *animation.mChannels[i];
    const char* const name = channel.mNodeName.C_Str();
    check_keys(channel.mPositionKeys, channel.mNumPositionKeys, name, file, last);
    check_keys(channel.mRotationKeys, channel.mNumRotationKeys, name, file, last);
    check_keys(channel.mScalingKeys, channel.mNumScalingKeys, name, file, last);
  }
  for (unsigned i = 0; i < animation.mNumMorphMeshChannels; ++i) {
    const aiMeshMorphAnim& channel = *animation.mMorphMeshChannels[i];
    check_keys(channel.mKeys, channel.mNumKeys, channel.mName.C_Str(), file, last);
  }
  const double ticks = animation.mDuration == 0 ? last : animation.mDuration;
  // assimp makes nonsense of an FBX that states neither LocalStart nor LocalStop.
  if (!std::isfinite(ticks) || ticks < 0)
    throw Error(
        fmt::format("{}: the animation \"{}\" lasts {:.6g} s, expected a finite time that the file states",
                    file, animation.mName.C_Str(), ticks / ticks_per_second(animation)));
  return ticks / ticks_per_second(animation);
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

void require_finite(const Vec3d& x, std::size_t vertex, const ScenePart& part, double time,
                    const std::string& file) {
  if (is_finite(x) && std::max({std::abs(x.x), std::abs(x.y), std::abs(x.z)}) <= largest_coordinate) return;
  throw Error(
      fmt::format("{}: vertex {} of \"{}\" is at ({:.3g}, {:.3g}, {:.3g}) after {:.6g} s, expected finite "
                  "numbers within 1e18",
                  file, vertex, part.node->mName.C_Str(), x.x, x.y, x.z, time));
}

}  // namespace

MeshAnimation read_assimp_animation(const std::filesystem::path& path, const MeshAnimationImport& options) {
  MeshAnimation result;
  const std::string file = path.string();
  with_assimp_scene(path, [&](const aiScene& scene, const Mat3d& axes, double unit) {
    const aiAnimation& animation = find_animation(scene, options.animation, file);
    const std::vector<ScenePart> parts = find_parts(scene, options.node, file);
    for (const ScenePart& part : parts) result.points += part.mesh->mNumVertices;
    const double duration = duration_of(animation, file);
    require_room(std::ceil(duration * options.frame_rate) + 1, result.points, duration, file);
    result.times = frame_times(duration, options.frame_rate);
    result.positions.reserve(result.times.size() * result.points);
    Pose pose(scene, file);
    pose.animate(animation);
    for (const double time : result.times) {
      pose.set(time);
      for (const ScenePart& part : parts) {
        const std::vector<Affine> placements = pose.placements(part);
        const std::vector<Vec3d> vertices = pose.vertices(part);
        for (std::size_t i = 0; i < vertices.size(); ++i) {
          const Vec3d x = axes * placements[i].point(vertices[i]) * unit;
          require_finite(x, i, part, time, file);
          result.positions.emplace_back(x);
        }
      }
    }
  });
  return result;
}

}  // namespace souple::mesh_detail
