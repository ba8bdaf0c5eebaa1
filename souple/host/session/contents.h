#pragma once

#include "souple/host/session/drive.h"
#include "souple/host/session/materials.h"
#include "souple/host/vertex_welder.h"

#include <map>
#include <optional>

namespace souple {
struct SceneDescription;
}

namespace souple::host {

/// A mesh of the host that became an object.
struct HostMesh {
  VertexWelder weld;
  Placement placement;        ///< current placement in the host
  Placement added;            ///< placement when the mesh was added to the current world
  std::vector<Vec3f> rest{};  ///< per particle: rest position in mesh coordinates; unused for obstacles
  bool self_collision = false;
  std::size_t lattice_tets = 0;
  std::shared_ptr<Drive> drive{};  ///< motion of an obstacle that the host moved
};

/// The last pin request for a vertex of the world's object.
struct Pin {
  std::uint32_t vertex = 0;
  bool pinned = true;
};

/// An object of a session, and the data to rebuild it.
struct Item {
  Handle handle = 0;
  std::string name;
  Kind kind = Kind::cloth;
  AnyMaterial material{};
  std::vector<Pin> pins{};               ///< in request order, each vertex once; vertices may share particles
  std::optional<HostMesh> mesh{};        ///< empty: the object belongs to the scene
  std::optional<std::uint32_t> color{};  ///< 0xRRGGBB (sRGB), from the scene
  float wind_exposure = 1;
  ObjectId id{};  ///< in the current world
};

/// A collider that the host added.
struct HostCollider {
  Handle handle = 0;
  Shape shape;
  ColliderSurface surface;
  Transform pose{};  ///< the last that the host set
  ColliderId id{};   ///< in the current world
};

ColliderId add_collider_to(World& world, const HostCollider& collider);

/// Two vertices of the world's objects that the host connected.
struct Connection {
  Handle handle = 0;
  Handle object[2]{};
  std::uint32_t vertex[2]{};
  float distance = 0, compliance = 0;
  ProjectorId id{};  ///< in the current world
};

/// R, G, B of 0xRRGGBB as numbers in [0, 1], sRGB; zeros without a color.
std::array<float, 3> channels_of(const std::optional<std::uint32_t>& color);

/// The world of a session, and the data to rebuild it from the start.
class Contents {
 public:
  using Report = std::function<void(std::string)>;
  /// `report` receives notes about meshes.
  explicit Contents(Report report);
  ~Contents();

  World& world() { return world_; }
  const World& world() const { return world_; }
  const std::vector<std::unique_ptr<Item>>& items() const { return items_; }
  /// Throws Error if the object does not exist; the message names a removed object.
  Item& item(Handle handle) const;
  bool contains(Handle handle) const { return find(handle) != nullptr; }
  Item* find(ObjectId id) const;
  /// 0xRRGGBB (sRGB) from the scene file, or nullopt.
  std::optional<std::uint32_t> collider_color(const std::string& name) const;

  void open(const std::string& file);
  void clear();
  Handle add(Kind kind, const TriangleSoup& soup, const MeshOptions& options);
  void remove(Handle handle);
  /// Rebuilds the world.
  void rebuild();

  void set_settings(const Settings& settings);
  void set_material(Handle handle, const AnyMaterial& material);
  void set_pinned(Handle handle, std::uint32_t vertex, bool pinned);
  void set_transform(Handle handle, const float* transform);
  void move_pin(Handle handle, std::uint32_t vertex, const Vec3f& position);
  Handle add_collider(const Shape& shape, const float* transform, const ColliderSurface& surface);
  void move_collider(Handle handle, const float* transform);
  void remove_collider(Handle handle);
  Handle connect(Connection connection);
  void disconnect(Handle handle);
  void set_wind_exposure(Handle handle, float exposure);
  /// Between these two calls, the step moves obstacles to the transforms that the host set.
  void begin_step(double dt);
  void end_step(bool made);

 private:
  Item* find(Handle handle) const;
  void replace(SceneDescription scene, bool has_scene);
  std::vector<HostCollider>::iterator find_collider(Handle handle);
  ProjectorId connect_in(World& world, const Connection& connection,
                         const std::function<ObjectId(Handle)>& object) const;
  void listen();

  Report report_;
  std::unique_ptr<SceneDescription> scene_;  // never null
  bool has_scene_ = false;
  std::vector<std::string> removed_;  // names of removed scene objects
  std::vector<std::unique_ptr<Item>> items_;
  std::vector<HostCollider> colliders_;
  std::vector<Connection> connections_;
  std::map<Handle, std::string> gone_;
  Handle last_ = 0;
  World world_;
};

}  // namespace souple::host
