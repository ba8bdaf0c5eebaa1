#include "souple/mesh_files/reader/pose.h"

#include "souple/math/slerp.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <assimp/anim.h>
#include <assimp/scene.h>

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

std::vector<double> weights_at(const aiMeshMorphAnim& channel, double ticks) {
  std::vector<double> weights;
  if (channel.mNumKeys == 0) return weights;
  const Span span = span_at(channel.mKeys, channel.mNumKeys, ticks);
  const auto add = [&](const aiMeshMorphKey& key, double factor) {
    for (unsigned i = 0; i < key.mNumValuesAndWeights; ++i) {
      constexpr unsigned most_shapes = 1u << 16;
      if (key.mValues[i] >= most_shapes) continue;
      if (key.mValues[i] >= weights.size()) weights.resize(key.mValues[i] + std::size_t(1));
      weights[key.mValues[i]] += factor * key.mWeights[i];
    }
  };
  add(channel.mKeys[span.earlier], 1 - span.share);
  if (span.share > 0) add(channel.mKeys[span.later], span.share);
  return weights;
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

Pose::Pose(const aiScene& scene) {
  nodes_.push_back({scene.mRootNode, 0, affine_of(scene.mRootNode->mTransformation), {}});
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    const aiNode* const node = nodes_[i].node;
    place_of_[node] = i;
    by_name_.emplace(node->mName.C_Str(), i);
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

void Pose::set(const aiAnimation& animation, double seconds) {
  const double ticks = seconds * ticks_per_second(animation);
  for (unsigned i = 0; i < animation.mNumChannels; ++i) {
    const aiNodeAnim& channel = *animation.mChannels[i];
    const auto node = by_name_.find(channel.mNodeName.C_Str());
    if (node != by_name_.end()) nodes_[node->second].own = affine_at(channel, ticks);
  }
  for (unsigned i = 0; i < animation.mNumMorphMeshChannels; ++i) {
    const aiMeshMorphAnim& channel = *animation.mMorphMeshChannels[i];
    const std::string name = channel.mName.C_Str();
    shapes_[name.substr(0, name.find('*'))] = weights_at(channel, ticks);  // FBX: NAME*0
  }
  move_down();
}

const Affine* Pose::find(const std::string& name) const {
  const auto node = by_name_.find(name);
  return node == by_name_.end() ? nullptr : &nodes_[node->second].to_scene;
}

std::vector<Affine> Pose::placements(const ScenePart& part) const {
  const aiMesh& mesh = *part.mesh;
  const Affine& of_node = nodes_[place_of_.at(part.node)].to_scene;
  std::vector<Affine> placements(mesh.mNumVertices, of_node);
  std::vector<double> weights(mesh.mNumVertices, 0.0);
  for (unsigned b = 0; b < mesh.mNumBones; ++b) {
    const aiBone& bone = *mesh.mBones[b];
    const Affine* const to_scene = find(bone.mName.C_Str());
    if (to_scene == nullptr) continue;
    const Affine moved = *to_scene * affine_of(bone.mOffsetMatrix);
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

std::vector<Vec3d> Pose::vertices(const ScenePart& part) const {
  const aiMesh& mesh = *part.mesh;
  std::vector<Vec3d> vertices(mesh.mNumVertices);
  for (unsigned i = 0; i < mesh.mNumVertices; ++i) vertices[i] = vector_of(mesh.mVertices[i]);
  auto weights = shapes_.find(part.node->mName.C_Str());
  if (weights == shapes_.end()) weights = shapes_.find(mesh.mName.C_Str());
  if (weights == shapes_.end()) return vertices;
  const std::size_t shapes = std::min<std::size_t>(weights->second.size(), mesh.mNumAnimMeshes);
  for (std::size_t s = 0; s < shapes; ++s) {
    const aiAnimMesh& shape = *mesh.mAnimMeshes[s];
    const double weight = weights->second[s];
    if (weight == 0 || shape.mVertices == nullptr || shape.mNumVertices != mesh.mNumVertices) continue;
    for (unsigned i = 0; i < mesh.mNumVertices; ++i)
      vertices[i] += (vector_of(shape.mVertices[i]) - vector_of(mesh.mVertices[i])) * weight;
  }
  return vertices;
}

}  // namespace souple::mesh_detail
