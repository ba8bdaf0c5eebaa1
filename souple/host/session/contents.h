#pragma once

#include "souple/host/session/drive.h"
#include "souple/host/session/materials.h"
#include "souple/scene/scene.h"

#include <map>
#include <optional>

namespace souple::host {

/// A mesh of the host as an object.
struct HostMesh {
  VertexWelder weld;
  Placement placement;        ///< where the host has it now
  Placement added;            ///< where it was when it came into this world
  std::vector<Vec3f> rest{};  ///< per particle, in the mesh's coordinates; obstacles stay as they are
  bool self_collision = false;
  std::size_t lattice_tets = 0;
  std::shared_ptr<Drive> drive{};  ///< of an obstacle that was moved
};

/// What the user said last of a vertex of the world's object.
struct Pin {
  std::uint32_t vertex = 0;
  bool pinned = true;
};

/// An object of a session, and how to make it again.
struct Item {
  Handle handle = 0;
  std::string name;
  Kind kind = Kind::cloth;
  AnyMaterial material{};
  std::vector<Pin> pins{};  ///< in the order the user said them, each vertex once: some share particles
  std::optional<HostMesh> mesh{};        ///< without it the object is one of the scene's
  std::optional<std::uint32_t> color{};  ///< 0xRRGGBB (sRGB), of the scene
  ObjectId id{};                         ///< in the world of now
};

/// 0xRRGGBB as numbers in [0, 1], in the same encoding; zeros for none.
std::array<float, 3> channels_of(const std::optional<std::uint32_t>& color);

/// The world of a session, and what it is made from, so that it can be made again from the start.
class Contents {
 public:
  using Tell = std::function<void(std::string)>;
  /// `tell` hears what is worth knowing about meshes.
  explicit Contents(Tell tell);

  World& world() { return world_; }
  const World& world() const { return world_; }
  const std::vector<std::unique_ptr<Item>>& items() const { return items_; }
  /// Throws Error in words about the object that is gone.
  Item& item(Handle handle) const;
  bool contains(Handle handle) const { return find(handle) != nullptr; }
  Item* find(ObjectId id) const;
  /// 0xRRGGBB (sRGB) as the scene file gives it, or nothing.
  std::optional<std::uint32_t> collider_color(const std::string& name) const;

  void open(const std::string& file);
  void clear();
  Handle add(Kind kind, const TriangleSoup& soup, const MeshOptions& options);
  void remove(Handle handle);
  /// Makes the world anew.
  void rebuild();

  void set_settings(const Settings& settings);
  void set_material(Handle handle, const AnyMaterial& material);
  void set_pinned(Handle handle, std::uint32_t vertex, bool pinned);
  void set_transform(Handle handle, const float* transform);
  /// Obstacles that the host moved go there during the step between.
  void begin_step(double dt);
  void end_step(bool made);

 private:
  Item* find(Handle handle) const;
  void replace(SceneDescription scene, bool has_scene);
  void listen();

  Tell tell_;
  SceneDescription scene_;
  bool has_scene_ = false;
  std::vector<std::string> removed_;  // of the scene's objects
  std::vector<std::unique_ptr<Item>> items_;
  std::map<Handle, std::string> gone_;
  Handle last_ = 0;
  World world_;
};

}  // namespace souple::host
