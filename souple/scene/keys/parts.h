#pragma once

#include "souple/scene/scene.h"
#include "souple/scene/table.h"

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

// Parts of keys.cpp. Each file of this folder defines the keys of one part of a scene.

namespace souple::scene_format {

constexpr double far_away = 1e6;      // m
constexpr double max_vertices = 4e6;  // of one generated mesh
constexpr Range meters = signed_range(far_away);
constexpr Range size_range = positive(far_away);
constexpr Range unit = within(0, 1);
constexpr Range friction_range = from_zero(100);

template <class T>
std::shared_ptr<Table<T>> table(const char* name, const char* doc) {
  return std::make_shared<Table<T>>(name, doc);
}

// --- values.cpp ------------------------------------------------------------------------------------------

/// Three counts, or one for all three axes.
CodecPtr<std::array<int, 3>> counts(int max);
/// A bit mask as the list of the bits that are set, or "all".
CodecPtr<std::uint32_t> groups();
/// A switch or the word of a SelfCollision, "particles" only where it is possible.
CodecPtr<SelfCollision> self_collision(bool particles);

/// A struct written as its only field.
template <class Outer, class Inner, class Access>
class Wrapped : public Codec<Outer> {
 public:
  Wrapped(Access access, CodecPtr<Inner> inner) : access_(access), inner_(std::move(inner)) {}
  void read(const Json& json, const JsonPath& path, Outer& value) const override {
    inner_->read(json, path, std::invoke(access_, value));
  }
  Json write(const Outer& value) const override { return inner_->write(std::invoke(access_, value)); }
  TypeInfo describe(Format& format) const override { return inner_->describe(format); }

 private:
  Access access_;
  CodecPtr<Inner> inner_;
};
template <class Outer, class Inner>
CodecPtr<Outer> wrapped(Inner Outer::*access, CodecPtr<Inner> inner) {
  return std::make_shared<Wrapped<Outer, Inner, Inner Outer::*>>(access, std::move(inner));
}

template <class T>
void add_collision_keys(Table<T>& keys) {
  const CodecPtr<std::uint32_t> listed = groups();
  keys.template key<&T::collision, &CollisionFilter::groups>("collision_groups", listed,
                                                             "its collision groups, of 32")
      .template key<&T::collision, &CollisionFilter::mask>(
          "collision_mask", listed,
          "groups it collides with; two objects collide if each is in a group of the other's mask");
}

/// Keys of the friction of a surface or a pair.
template <class T>
void check_kinetic_friction(const T& value, const JsonPath& path) {
  const std::optional<float> friction = value.friction, kinetic = value.kinetic_friction;
  if (kinetic && friction && *kinetic > *friction)
    path.key("kinetic_friction").fail("must not be above \"friction\"");
}

// --- motion.cpp ------------------------------------------------------------------------------------------

/// Initial pose and scale of an object.
CodecPtr<TransformDescription> transform_codec();
/// Pose of a collider.
CodecPtr<TransformDescription> pose_codec();
CodecPtr<std::vector<KeyframeDescription>> keyframes_codec();
/// Fails unless each keyframe is later than the previous one.
void check_times(const std::vector<KeyframeDescription>& keyframes, const JsonPath& path);
/// Keys of a motion by keyframes.
template <class T>
Table<T>& add_keyframe_keys(Table<T>& keys, const char* doc) {
  return keys.template key<&T::keyframes>("keyframes", keyframes_codec(), doc)
      .template key<&T::loop>("loop", boolean(), "repeats the keyframes after the last")
      .needs("loop", "keyframes")
      .check([](const T& value, const JsonPath& path) { check_times(value.keyframes, path); });
}
CodecPtr<SequenceDescription> sequence_codec();

// --- meshes.cpp ------------------------------------------------------------------------------------------

/// The kinds of mesh that an object may have.
enum class MeshUse { surface, solid, points };
CodecPtr<MeshDescription> mesh_codec(MeshUse use);
/// The axis that points up in a file.
CodecPtr<UpAxis> up_codec();
/// Fails if a generated mesh has more than `max_vertices`.
void check_count(double vertices, const JsonPath& path);

// --- pins.cpp --------------------------------------------------------------------------------------------

/// The alternatives of a vertex selector.
std::vector<Alternative> selectors();
CodecPtr<PinDescription> pin_codec();
CodecPtr<AttachmentDescription> attachment_codec();

// --- maps.cpp --------------------------------------------------------------------------------------------

CodecPtr<MapsDescription> maps_codec();

// --- materials.cpp ---------------------------------------------------------------------------------------

CodecPtr<MaterialDescription<ClothMaterial>> cloth_material_codec();
CodecPtr<MaterialDescription<SoftBodyMaterial>> soft_body_material_codec();
CodecPtr<MaterialDescription<RopeMaterial>> rope_material_codec();
CodecPtr<MaterialDescription<GrainsMaterial>> grains_material_codec();
CodecPtr<MaterialDescription<FluidMaterial>> fluid_material_codec();
CodecPtr<ObstacleMaterial> obstacle_material_codec();
CodecPtr<RigidBodyMaterial> rigid_body_material_codec();

// --- objects.cpp, colliders.cpp, connections.cpp -----------------------------------------------------------

/// The solid of a collider, or the region of a drain.
CodecPtr<SurfaceLook> surface_look();
CodecPtr<ShapeDescription> shape_codec();
/// Any object, by its key "kind".
CodecPtr<AnyObjectDescription> object_codec();
CodecPtr<ColliderDescription> collider_codec();
CodecPtr<PairDescription> pair_codec();
CodecPtr<ConnectionDescription> connection_codec();

// --- joints.cpp ------------------------------------------------------------------------------------------

/// Any joint, by its key "kind".
CodecPtr<AnyJointDescription> joint_codec();

// --- ties.cpp --------------------------------------------------------------------------------------------

CodecPtr<TieDescription> tie_codec();

// --- flow.cpp --------------------------------------------------------------------------------------------

CodecPtr<EmitterDescription> emitter_codec();
CodecPtr<DrainDescription> drain_codec();

// --- settings.cpp ----------------------------------------------------------------------------------------

CodecPtr<Wind> wind_codec();
/// The keys of the scene that become `Settings`, except the wind.
void add_setting_keys(Table<SceneDescription>& keys);

}  // namespace souple::scene_format
