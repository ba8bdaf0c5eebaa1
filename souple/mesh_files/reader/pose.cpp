#include "souple/mesh_files/reader/pose.h"

#include "souple/error.h"
#include "souple/files/file.h"
#include "souple/math/slerp.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include <assimp/anim.h>
#include <assimp/scene.h>
#include <fmt/core.h>

namespace souple::mesh_detail {

namespace {

Affine affine_of(const aiMatrix4x4& m) {
  return {Mat3d({double(m.a1), double(m.b1), double(m.c1)}, {double(m.a2), double(m.b2), double(m.c2)},
                {double(m.a3), double(m.b3), double(m.c3)}),
          {double(m.a4), double(m.b4), double(m.c4)}};
}

Affine operator*(const Affine& a, const Affine& b) {
  return {a.linear * b.linear, a.point(b.translation)};
}

Vec3d vector_of(const aiVector3D& v) {
  return {double(v.x), double(v.y), double(v.z)};
}

Quatd quaternion_of(const aiQuaternion& q) {
  return {double(q.x), double(q.y), double(q.z), double(q.w)};
}

/// The keys around a time: the earlier and the later one, and how far it is from one to the other.
struct Span {
  unsigned earlier, later;
  double share;
};
template <class Key>
Span span_at(const Key* keys, unsigned count, double ticks) {
  const Key* const later =
      std::upper_bound(keys, keys + count, ticks, [](double t, const Key& key) { return t < key.mTime; });
  const auto after = unsigned(later - keys);
  if (after == 0) return {0, 0, 0};
  if (after == count) return {count - 1, count - 1, 0};
  const double begin = keys[after - 1].mTime;
  return {after - 1, after, (ticks - begin) / (keys[after].mTime - begin)};
}

Vec3d vector_at(const aiVectorKey* keys, unsigned count, double ticks, const Vec3d& without_keys) {
  if (count == 0) return without_keys;
  const Span span = span_at(keys, count, ticks);
  return vector_of(keys[span.earlier].mValue) * (1 - span.share) +
         vector_of(keys[span.later].mValue) * span.share;
}

Quatd rotation_at(const aiQuatKey* keys, unsigned count, double ticks) {
  if (count == 0) return {};
  const Span span = span_at(keys, count, ticks);
  return slerp(normalized(quaternion_of(keys[span.earlier].mValue)),
               normalized(quaternion_of(keys[span.later].mValue)), span.share);
}

/// Scaled first, then rotated, then translated.
Affine affine_at(const aiNodeAnim& channel, double ticks) {
  const Vec3d scale = vector_at(channel.mScalingKeys, channel.mNumScalingKeys, ticks, {1, 1, 1});
  const Quatd rotation = rotation_at(channel.mRotationKeys, channel.mNumRotationKeys, ticks);
  return {rotation_matrix(rotation) * Mat3d::diagonal(scale),
          vector_at(channel.mPositionKeys, channel.mNumPositionKeys, ticks, {})};
}

/// NAME*0 of an FBX is NAME.
std::string without_number(const std::string& name) {
  const std::size_t star = name.find_last_of('*');
  const bool numbered = star != std::string::npos && star + 1 < name.size() &&
                        name.find_first_not_of("0123456789", star + 1) == std::string::npos;
  return numbered ? name.substr(0, star) : name;
}

}  // namespace

double ticks_per_second(const aiAnimation& animation) {
  constexpr double if_not_stated = 25;  // of assimp
  return animation.mTicksPerSecond > 0 ? animation.mTicksPerSecond : if_not_stated;
}

std::vector<ScenePart> parts_of(const aiScene& scene) {
  std::vector<ScenePart> parts;
  // An explicit stack: a file may nest nodes deeper than the call stack allows.
  std::vector<const aiNode*> open = {scene.mRootNode};
  while (!open.empty()) {
    const aiNode* const node = open.back();
    open.pop_back();
    for (unsigned i = 0; i < node->mNumMeshes; ++i) parts.push_back({scene.mMeshes[node->mMeshes[i]], node});
    for (unsigned i = node->mNumChildren; i-- > 0;) open.push_back(node->mChildren[i]);
  }
  return parts;
}

Pose::Pose(const aiScene& scene, const std::string& file) : file_(file) {
  const std::string extension = lower_case(std::filesystem::path(file).extension().string());
  is_gltf_ = extension == ".gltf" || extension == ".glb";
  is_fbx_ = extension == ".fbx";
  nodes_.push_back({scene.mRootNode, 0, affine_of(scene.mRootNode->mTransformation), {}});
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    const aiNode* const node = nodes_[i].node;
    place_of_[node] = i;
    if (!by_name_.emplace(node->mName.C_Str(), i).second) shared_names_.insert(node->mName.C_Str());
    for (unsigned m = 0; m < node->mNumMeshes; ++m) ++holders_[scene.mMeshes[node->mMeshes[m]]];
    for (unsigned child = 0; child < node->mNumChildren; ++child)
      nodes_.push_back({node->mChildren[child], i, affine_of(node->mChildren[child]->mTransformation), {}});
  }
  move_down();
}

void Pose::move_down() {
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    Node& node = nodes_[i];
    node.to_scene = i == 0 ? node.own : nodes_[node.parent].to_scene * node.own;
  }
}

std::size_t Pose::find(const std::string& name) const {
  const auto node = by_name_.find(name);
  if (node == by_name_.end()) return nodes_.size();
  if (shared_names_.count(name) > 0)
    throw Error(
        fmt::format("{}: several nodes are named \"{}\", and bones or an animation move one of them; "
                    "expected names of their "
                    "own, which assimp needs to tell them apart",
                    file_, name));
  return node->second;
}

// A key of an FBX holds the shapes that have a key at its time, one of glTF all shapes.
std::vector<Pose::ShapeTrack> Pose::tracks_of(const aiMeshMorphAnim& channel) {
  constexpr unsigned most_shapes = 1u << 16;
  std::map<unsigned, std::vector<ShapeTrack::Key>> keys;
  for (unsigned k = 0; k < channel.mNumKeys; ++k) {
    const aiMeshMorphKey& key = channel.mKeys[k];
    for (unsigned i = 0; i < key.mNumValuesAndWeights; ++i) {
      if (key.mValues[i] < most_shapes) keys[key.mValues[i]].push_back({key.mTime, key.mWeights[i]});
    }
  }
  std::vector<ShapeTrack> tracks;
  tracks.reserve(keys.size());
  for (auto& [shape, of_shape] : keys) tracks.push_back({shape, std::move(of_shape)});
  return tracks;
}

void Pose::animate(const aiAnimation& animation) {
  animation_ = &animation;
  for (unsigned i = 0; i < animation.mNumChannels; ++i) find(animation.mChannels[i]->mNodeName.C_Str());
  shape_tracks_.clear();
  for (unsigned i = 0; i < animation.mNumMorphMeshChannels; ++i) {
    const aiMeshMorphAnim& channel = *animation.mMorphMeshChannels[i];
    const std::string name = is_fbx_ ? without_number(channel.mName.C_Str()) : channel.mName.C_Str();
    find(name);
    shape_tracks_[name] = tracks_of(channel);
  }
}

void Pose::set(double seconds) {
  const double ticks = seconds * ticks_per_second(*animation_);
  for (unsigned i = 0; i < animation_->mNumChannels; ++i) {
    const aiNodeAnim& channel = *animation_->mChannels[i];
    const auto node = by_name_.find(channel.mNodeName.C_Str());
    if (node != by_name_.end()) nodes_[node->second].own = affine_at(channel, ticks);
  }
  for (const auto& [name, tracks] : shape_tracks_) {
    std::vector<double>& weights = weights_[name];
    for (const ShapeTrack& track : tracks) {
      if (track.shape >= weights.size()) weights.resize(track.shape + std::size_t(1));
      const Span span = span_at(track.keys.data(), unsigned(track.keys.size()), ticks);
      weights[track.shape] =
          track.keys[span.earlier].weight * (1 - span.share) + track.keys[span.later].weight * span.share;
    }
  }
  move_down();
}

std::vector<Affine> Pose::placements(const ScenePart& part) const {
  const aiMesh& mesh = *part.mesh;
  if (mesh.mNumBones > 0 && holders_.at(part.mesh) > 1)
    throw Error(
        fmt::format("{}: the mesh \"{}\" has bones, and {} nodes hold it; expected one, because assimp knows "
                    "one skin of a mesh",
                    file_, mesh.mName.C_Str(), holders_.at(part.mesh)));
  const Affine& of_node = nodes_[place_of_.at(part.node)].to_scene;
  std::vector<Affine> placements(mesh.mNumVertices, of_node);
  std::vector<double> weights(mesh.mNumVertices, 0.0);
  for (unsigned b = 0; b < mesh.mNumBones; ++b) {
    const aiBone& bone = *mesh.mBones[b];
    const std::size_t place = find(bone.mName.C_Str());
    if (place == nodes_.size()) continue;
    const Affine moved = nodes_[place].to_scene * affine_of(bone.mOffsetMatrix);
    for (unsigned i = 0; i < bone.mNumWeights; ++i) {
      const unsigned vertex = bone.mWeights[i].mVertexId;
      const double weight = double(bone.mWeights[i].mWeight);
      if (vertex >= mesh.mNumVertices || !(weight > 0)) continue;
      Affine& sum = placements[vertex];
      if (weights[vertex] == 0) sum = {Mat3d{}, {}};
      sum = {sum.linear + moved.linear * weight, sum.translation + moved.translation * weight};
      weights[vertex] += weight;
    }
  }
  for (std::size_t i = 0; i < placements.size(); ++i) {
    if (weights[i] > 0)
      placements[i] = {placements[i].linear * (1 / weights[i]), placements[i].translation / weights[i]};
  }
  return placements;
}

std::vector<double> Pose::weights_of(const ScenePart& part) const {
  const aiMesh& mesh = *part.mesh;
  auto animated = weights_.find(part.node->mName.C_Str());
  if (animated == weights_.end() && by_name_.count(mesh.mName.C_Str()) == 0)
    animated = weights_.find(mesh.mName.C_Str());
  std::vector<double> weights;
  if (animated != weights_.end()) {
    weights = animated->second;
    // assimp takes the tangents of several shapes' cubic keys for weights.
    if (is_gltf_ && mesh.mNumAnimMeshes > 0 && weights.size() > mesh.mNumAnimMeshes)
      throw Error(
          fmt::format("{}: the shapes of \"{}\" have cubic keys, which assimp cannot read; expected linear "
                      "keys, or a key a frame",
                      file_, part.node->mName.C_Str()));
  } else if (is_gltf_) {
    for (unsigned s = 0; s < mesh.mNumAnimMeshes; ++s)
      weights.push_back(double(mesh.mAnimMeshes[s]->mWeight));
  }
  weights.resize(mesh.mNumAnimMeshes);
  return weights;
}

std::vector<Vec3d> Pose::vertices(const ScenePart& part) const {
  const aiMesh& mesh = *part.mesh;
  std::vector<Vec3d> vertices(mesh.mNumVertices);
  for (unsigned i = 0; i < mesh.mNumVertices; ++i) vertices[i] = vector_of(mesh.mVertices[i]);
  const std::vector<double> weights = weights_of(part);
  for (std::size_t s = 0; s < weights.size(); ++s) {
    const aiAnimMesh& shape = *mesh.mAnimMeshes[s];
    const double weight = weights[s];
    if (weight == 0 || shape.mVertices == nullptr || shape.mNumVertices != mesh.mNumVertices) continue;
    for (unsigned i = 0; i < mesh.mNumVertices; ++i)
      vertices[i] += (vector_of(shape.mVertices[i]) - vector_of(mesh.mVertices[i])) * weight;
  }
  return vertices;
}

}  // namespace souple::mesh_detail
